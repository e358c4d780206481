#pragma once
// One-step prediction: each row from the measured state of the row before it.
#include "simulate/fit.hpp"

namespace lunid {

/// What a model predicts of a record of one coordinate, as its channels show it; NaN in the first row.
struct OneStep {
  Eigen::VectorXd y, v;
};

/// Each row but the first is run to from measured_state() of the row before it, over four substeps. Throws InputError
/// for models with internal states, which no channel shows, and Fault::interrupted.
OneStep predict_one_step(const System& system, std::span<const double> theta, const Record& record,
                         const Excitations& excitation, const std::atomic<bool>* cancelled = nullptr);

}  // namespace lunid
