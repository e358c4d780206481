#pragma once
// The fixed path of systems with switches or bounds, substep by substep. A substep runs in one frozen mode. Where an
// event function falls below zero within it, the place is found by stepping to a part of the substep (a bracketed
// Newton), the mode is decided there and the rest of the substep follows. Internal to this room.
#include <optional>
#include <vector>

#include "simulate/fixed.hpp"
#include "simulate/saltation.hpp"
#include "simulate/segment.hpp"

namespace lunid {

class EventRun {
 public:
  /// At the first row. The problem is to stay.
  EventRun(const FixedProblem& problem, const Eigen::VectorXd& x0);
  FixedOutcome run(RowSink& sink);

  // ---- its parts, for those who take substeps themselves (SwitchBundle) ----
  /// One substep with all its events; false when the run stops: outcome() says why.
  bool substep(Eigen::Index row, int j);
  const FixedOutcome& outcome() const { return outcome_; }
  /// The present state and what was observed there; both may be set, in the mode that they were observed in.
  std::vector<double>& x() { return x_; }
  Observation& now() { return now_; }
  ModeMachine& modes() { return modes_; }

 private:
  /// The inputs, with their rates where an event function moves with them.
  Drive drive(Segment& segment, double s) const noexcept {
    return d_.input_rates ? segment.drive_with_rates(s) : segment.drive(s);
  }
  Drive drive_at_start(Eigen::Index row) const noexcept {
    Segment first = segment_of(problem_, row, 0);
    return drive(first, 0);
  }
  bool advance(Segment& segment);
  void step(Segment& segment, double from, double to) noexcept;
  template <int N>
  void step_state(Segment& segment, double from, double to) noexcept;
  void linearise(Segment& segment, double from, double to) noexcept;
  void step_sensitivities(Segment& segment, double from, double to) noexcept;
  double probe(Segment& segment, double from, double to, int event) noexcept;
  int first_event(Segment& segment, double from, double& to) noexcept;
  int due() const noexcept;
  int estimate_first(double width) const noexcept;
  int find_dip(Segment& segment, double from, double& to) noexcept;
  bool fell_here(const Segment& segment, int event) const noexcept;
  double estimate_zero(double h, int event) const noexcept;
  double locate(Segment& segment, double from, double to, int event) noexcept;
  double inside(Segment& segment, double from, double to, int event) noexcept;
  void accept(Segment& segment, double from, double to);
  void happen(Segment& segment, double at, int event);
  bool failed(Segment& segment, double at, Stop stop);

  const FixedProblem& problem_;
  const Dynamics& d_;
  const int n_, p_;
  ModeMachine modes_;
  std::optional<Sensitivities> sensitivities_;
  Saltation saltation_;
  std::vector<double> x_, trial_, stage_, k_;
  Observation now_, then_;
  Observation above_;           ///< at the last place where the event that was located was above zero
  bool closed_in_ = false;      ///< that place is within the tolerance before the one found
  bool linearised_ = false;     ///< slopes_ are those of the trial
  std::vector<double> slopes_;  ///< dx'/dx and dx'/dtheta at each stage
  std::vector<double> ks_, s_stage_;
  FixedOutcome outcome_;
};

}  // namespace lunid
