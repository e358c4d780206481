#pragma once
// Fits of sets on the trajectory while they grow: short ones of all that were proposed, long ones of the best.
#include <cmath>

#include "discover/accept.hpp"
#include "discover/propose.hpp"

namespace lunid {

/// A fit on the fixed path: a set that runs away would be followed by implicit steps for minutes. `substeps` 0: chosen
/// anew.
FitOptions fixed_fit(const Study& study, int iterations, double tolerance, int substeps);

/// Fits a set from a start that is near already. `substeps`: 0 chooses them anew.
FitResult fit_near(const Study& study, const Candidate& candidate, const Eigen::VectorXd& start, int iterations,
                   int substeps, const std::vector<FitSegment>& first_states = {});

/// Root mean square of a fit's weighted residual [m] ([N] with imposed motion).
inline double rms(const FitResult& fit) { return std::sqrt(fit.cost / static_cast<double>(fit.rows)); }
inline double rms(const Candidate& c) { return rms(c.fit); }

/// Something is left beside what noise alone leaves of a set (noise_alone), and this part of it more. Above three times
/// the sensors' noise whatever the forces' is: an excitation that is rough may be taken for noise.
bool is_above_noise(const Study& study, const Candidate& c, double more = 0.05);

/// All parameters are solved for at once: none has to be guessed.
bool all_linear(const Shape& shape);

/// Holds references. Threads may share one.
class ProposalFits {
 public:
  /// `force_rows`: over how many rows a candidate's force_cost is a sum.
  ProposalFits(const Study& study, const Candidate& baseline, Eigen::Index force_rows);

  /// From the force's start, and, where that is no better than the parent, from the parent with the effect at zero.
  void begin(Candidate& c, const Candidate& parent) const;
  /// Some iterations more of a set that ran.
  void go_on(Candidate& c, int iterations) const;
  /// An effect that has run into a limit of its shape may have started on the wrong side of it: the force, smoothed and
  /// noisy, is a poor judge of what happens within a narrow range. The entry's other guesses on the trajectory, from
  /// the parent with the effect at zero.
  void leave_limits(Candidate& c, const Shape& shape, const Candidate& parent) const;
  /// The same for one that stays above the noise, from where it is; and from short free runs on.
  void leave_minimum(Candidate& c, const Shape& shape) const;
  /// The latter alone, once: from where the fit converges, else from where it is.
  void begin_in_short_runs(Candidate& c) const;
  /// The error of the motion that the force foretells; 0 where none tells: of faults of a channel, and in decays.
  double promised(const Candidate& c) const;
  /// To the end; and from short free runs on where the free run stays behind what the force promised, if that is less
  /// than an error that is reached already.
  void end(Candidate& c, double to_beat) const;

 private:
  int coarse_substeps(const Candidate& c) const;
  void begin_at_parent(Candidate& c, const Candidate& parent) const;
  void lengthen_steps(Candidate& c) const;
  /// The better of the fit and those that begin at `from` with the entry's own nonlinear parameters as guessed, or as
  /// these are led along the motion; one at no limit before one at a limit.
  void try_guesses(Candidate& c, const Shape& shape, const Eigen::VectorXd& from) const;
  std::vector<Eigen::VectorXd> starts_along_the_motion(const Candidate& c, const Shape& shape,
                                                       const Eigen::VectorXd& parent) const;
  /// The better of the fit and one that begins at `from` on short free runs, as long as those leave less than an error
  /// that is reached already.
  void try_short_runs(Candidate& c, const Eigen::VectorXd& from, double to_beat) const;

  const Study& study_;
  const Candidate& baseline_;
  Eigen::Index force_rows_;
  bool decays_;  ///< no force acts in any training record
};

}  // namespace lunid
