#pragma once
// What frequency responses and backbones check before they begin. Internal to this room.
#include "simulate/period_run.hpp"
#include "simulate/response.hpp"

namespace lunid {

/// Throws InputError with `caller` in front.
void check_periodic(const char* caller, const System& system, std::span<const double> theta,
                    std::span<const HarmonicInput> inputs);
/// Throws InputError where a bounded state stands in the way of harmonic balance.
void check_balance(const char* caller, const Dynamics& dynamics, const char* instead);

/// Rest, internal states at their initial values.
Eigen::VectorXd rest_of(const System& system);
/// "34.51 Hz"
std::string in_hertz(double frequency);

}  // namespace lunid
