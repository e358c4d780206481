#pragma once
// The experiment that would tell rivals apart: of a small family of excitations the one whose answers differ most, when
// each rival may fit its parameters to what the other would have measured.
#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "discover/experiment_family.hpp"
#include "discover/units.hpp"
#include "simulate/model.hpp"

namespace lunid {

/// What the machine can do.
struct ExperimentLimits {
  double force = 0;  ///< largest |F| [N], > 0; not asked of an imposed motion
  double displacement = std::numeric_limits<double>::infinity();  ///< largest |y| of any rival [m], > 0
  double from = 0, to = 0;                                        ///< band of the excitation [Hz], 0 < from < to
};

struct ExperimentOptions {
  ExperimentLimits limits;
  double duration = 0;         ///< [s], at least five periods of limits.from
  double rate = 0;             ///< [Hz], at least eight rows in a period of limits.to
  std::string measured = "y";  ///< of each coordinate: its displacement y, velocity v or acceleration a
  double noise = 0;            ///< standard deviation of what is measured [SI] (imposed motion: force [N]), > 0
  Units units;                 ///< of the models' motion and force, for messages
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
  const std::atomic<bool>* cancelled = nullptr;
};
/// Throws InputError naming option, value and the admissible range.
void validate(const ExperimentOptions& options, bool imposed);

/// What an excitation makes of two rivals.
struct RivalPair {
  int a = 0, b = 0;       ///< from 0
  double separation = 0;  ///< rms difference left after the refit [standard deviations of the noise]
};

struct ExperimentCandidate {
  std::string name, words;
  double level = 0;       ///< largest |F| [N]; of an imposed motion largest |y| [m]
  Record excitation;      ///< channel F; of an imposed motion y v a
  double peak = 0;        ///< largest |y| of any rival [m]
  double separation = 0;  ///< of the pair that is hardest to tell
  double expected_z = 0;  ///< of the test that compares the two (Vuong's): 2.3 tells them with an even chance, 4 surely
  std::vector<RivalPair> pairs;
  std::string remark;  ///< why it has no separation
  bool decides() const { return expected_z >= 4; }
};

struct ExperimentDesign {
  std::vector<std::string> rivals;
  std::vector<ExperimentCandidate> candidates;  ///< best first
  ExperimentOptions options;
  double beyond = 1;  ///< the limits over those of the records that the rivals were fitted to, where that is said
  bool empty() const { return candidates.empty(); }
  const ExperimentCandidate& best() const { return candidates.front(); }
};

/// Runs every rival under every excitation of the family, at the highest level that the limits allow and at parts of
/// it, and scores them by T-optimality: the least squared difference between one rival's motion and the other's best
/// refit to it (Atkinson & Fedorov 1975, Biometrika 62, 57). The force acts on the first driven coordinate; all
/// coordinates are measured. Changes the models' pool: main thread only. Throws InputError for fewer than two models,
/// for a parameter without a value, and for free and imposed motion together.
ExperimentDesign design_experiment(const std::vector<Model>& rivals, const std::vector<std::string>& names,
                                   const ExperimentOptions& options);

/// "stepped_amplitude (sine at 12 Hz in five steps of amplitude, up to 30 N): predicted separation 4.2 standard
/// deviations of the noise"; where none decides that is said.
std::string sentence_of(const ExperimentDesign& design);
/// The table of all candidates.
std::string to_terminal(const ExperimentDesign& design);

}  // namespace lunid
