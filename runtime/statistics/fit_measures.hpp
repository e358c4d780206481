#pragma once
// Distances of a model from a measurement. All spans of one length; a value that is not finite gives NaN.
#include <cstddef>
#include <span>

namespace lunid {

double rmse(std::span<const double> measured, std::span<const double> model);
/// RMSE over the standard deviation of the measurement; infinite for a constant one that is not met.
double nrmse(std::span<const double> measured, std::span<const double> model);
/// 1 - sum of squared errors over the sum of squares about the mean: 1 - nrmse^2.
double r_squared(std::span<const double> measured, std::span<const double> model);
/// 100 (1 - nrmse) [%]: 100 for a perfect model, 0 for the measured mean. (Ljung 1999, System Identification.)
double fit_percent(std::span<const double> measured, std::span<const double> model);
/// The gap of a free run: nrmse of the rows after the lead-in.
double gap(std::span<const double> measured, std::span<const double> model, std::size_t lead_in);

}  // namespace lunid
