#pragma once
// Runs over whole periods of the excitation on the fixed path, switches located.
#include <atomic>
#include <span>
#include <string>
#include <vector>

#include "simulate/fixed.hpp"
#include "simulate/harmonics.hpp"

namespace lunid {

/// What is driven, and by what.
struct PeriodicProblem {
  const Dynamics* dynamics = nullptr;
  std::span<const double> theta;
  std::vector<HarmonicInput> inputs;
  Eigen::VectorXd start;                         ///< a state from which simulations begin: rest
  int harmonics = 0;                             ///< of harmonic balance; 0: chosen along the branch
  int max_harmonics = 63;                        ///< where they are chosen
  double accuracy = 1e-6;                        ///< of the harmonics left out, over the amplitude
  const std::atomic<bool>* cancelled = nullptr;  ///< set by Ctrl-C
};

/// One period, or several: rows + 1 even samples.
struct Period {
  Eigen::MatrixXd x, rate;     ///< (rows + 1) x n
  Eigen::MatrixXd monodromy;   ///< d end / d start, n x n, where asked for
  Eigen::MatrixXd mean_slope;  ///< d (mean over the rows but the last) / d start, with it
  double omega = 0;            ///< of the excitation [rad/s]
  int periods = 1;
  double stuck = 0;  ///< [s]
  long events = 0;
  std::string fault;  ///< why it did not come to its end, or ""

  double dt() const;
  Eigen::VectorXd end() const { return x.row(x.rows() - 1).transpose(); }
  /// `kinks`: states whose rate may jump; theirs are the extremes of the samples.
  std::vector<Motion> motions(int harmonics, const std::vector<bool>& kinks) const;
};

class PeriodRun {
 public:
  explicit PeriodRun(const PeriodicProblem& problem);

  /// Steps per period: those that the fastest oscillation of the linearised motion asks for, a power of two. More than
  /// `most_rows` are refused: the returned fault says so.
  Eigen::Index rows() const { return rows_; }
  std::string choose_rows(const Period& period);
  std::string choose_rows(const Eigen::VectorXd& x, double omega);

  Period run(const Eigen::VectorXd& x0, double omega, bool sensitivities, int periods = 1);
  /// One period without sensitivities, in `refinement` times as many steps: for its extremes.
  Period run_fine(const Eigen::VectorXd& x0, double omega, int refinement);
  long steps() const { return steps_; }
  const std::vector<bool>& kinks() const { return kinks_; }

 private:
  void make_grid(double omega, Eigen::Index rows);
  double fastest(const Eigen::VectorXd& x, double phase, double omega) const;

  PeriodicProblem problem_;
  Eigen::Index rows_ = 128;
  std::vector<Eigen::VectorXd> grid_;
  double grid_omega_ = -1;
  Eigen::Index grid_rows_ = 0;
  std::vector<bool> kinks_;
  bool moving_ = false;  ///< inputs change with the frequency
  long steps_ = 0;
};

/// Runs from x0 until the state at the end of a period (or of up to four of them, a subharmonic) no longer changes, by
/// `tolerance` of the motion's size.
struct Settled {
  Period period;  ///< the last one, or the last few where the motion is subharmonic or does not settle
  bool steady = false;
  long periods = 0;  ///< that were run
};
Settled settle(PeriodRun& run, Eigen::VectorXd x0, double omega, long max_periods, double tolerance);

}  // namespace lunid
