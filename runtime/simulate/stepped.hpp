#pragma once
// Frequency responses by simulation: stepped and swept sine.
#include "simulate/period_run.hpp"
#include "simulate/response.hpp"

namespace lunid {

/// At each frequency in turn the run goes on from where the last one ended until it is steady.
void run_stepped(const PeriodicProblem& problem, const ResponseOptions& options, ResponseCurve& out);
/// One run under a sine whose frequency moves at a constant rate; a point for each of its periods.
void run_swept(const PeriodicProblem& problem, const ResponseOptions& options, ResponseCurve& out);

}  // namespace lunid
