#pragma once
// What a Savitzky-Golay filter does, beside its use in record.hpp.
#include <Eigen/Core>

#include "record/derivative_error.hpp"
#include "record/record.hpp"

namespace lunid {

/// Weights of the middle of the window, 2*half_width + 1 of them, for samples one apart.
Eigen::VectorXd savitzky_golay_weights(int derivative, const SavitzkyGolay& options);
/// Standard deviation of the filter's output when its input is white noise of standard deviation 1.
double savitzky_golay_noise(double dt, int derivative, const SavitzkyGolay& options);
/// The window of least error for a signal of so many rows.
SavitzkyGolay choose_savitzky_golay(const DerivativeError& error, Eigen::Index rows, int derivative);

}  // namespace lunid
