#pragma once
// A work of DESIGN section 5: ours beside a hand-written limit, timed in the same process.
#include <functional>
#include <string>
#include <vector>

namespace bench {

struct Work {
  std::string name;
  double limit = 1;  ///< of the ratio
  std::function<void()> ours;
  std::function<void()> hand;  ///< the hand-written limit; empty: none
  double allowance = 0;        ///< [s]; > 0: the ratio is (ours - hand) / allowance
  int repetitions = 7;
  /// Seconds by a clock of its own, for ours and the limit, instead of the time that they take.
  std::function<double()> ours_seconds = {}, hand_seconds = {};
};

std::vector<Work> free_run_works();
std::vector<Work> sundials_works();
std::vector<Work> trajectory_fit_works();
std::vector<Work> regression_works();
std::vector<Work> ensemble_works();
std::vector<Work> statistics_works();
std::vector<Work> surface_works();
/// `lunid`: the executable, beside which the drawing module lies.
std::vector<Work> figure_works(const std::string& lunid);
/// Whole processes.
std::vector<Work> process_works(const std::string& lunid);

}  // namespace bench
