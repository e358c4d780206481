#pragma once
// What a fit leaves open of how its free runs are integrated, chosen from the record's motion and the first guess.
// Internal to this room.
#include <span>

#include "simulate/fit.hpp"

namespace lunid {

/// The model's parameters, without what a fit has beside them.
inline std::span<const double> own_values(const System& system, const Eigen::VectorXd& theta) {
  return {theta.data(), static_cast<std::size_t>(system.parameters())};
}

/// True where all that is fitted are states as they are: what the adjoint has slopes of.
bool states_alone(const Model& model, const std::vector<FitData>& data, const FitOptions& options);

/// What a fit is held against first.
std::string first_channel(const System& system, const FitData& data, const FitOptions& options);

/// The options with all of it decided: substeps (those given, or what a tenth of the sensors' noise asks for), the
/// solver and the gradient.
FitOptions with_steps(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                      FitOptions options);

/// Of a motion's dominant frequency [rows], over the whole of it or over pieces that move as much: a spring that
/// hardens is faster while the motion is large, a sweep at its end.
double shortest_period(std::span<const double> motion);

}  // namespace lunid
