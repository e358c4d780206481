#pragma once
// First states of free runs with the parameters held. Internal to this room.
#include "simulate/fit_problem.hpp"

namespace lunid {

/// First states that are read off noisy data lose a lightly damped or strongly nonlinear motion at once, whatever the
/// parameters: the measured motion at each segment's first row is fitted to a stretch of rows that doubles as long as
/// the run follows it, and taken where the whole segment's cost is lower with it. Internal states and coordinates that
/// no sensor sees stay as they are: a few rows hardly show them.
void settle_first_states(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                         const FitOptions& options, std::vector<FitSegment>& segments);

}  // namespace lunid
