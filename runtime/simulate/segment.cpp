#include "simulate/segment.hpp"

#include <algorithm>
#include <array>

namespace lunid {
namespace {

namespace dp = dormand_prince;
constexpr int places = Segment::places;

/// Coefficients of the polynomial through values at the places of the stages and the end: the inverse of the
/// Vandermonde matrix, coefficient i of value j at [i][j].
using Inverse = std::array<std::array<double, places>, places>;
Inverse invert_places() {
  Inverse inverse{};
  for (int j = 0; j < places; ++j) {  // Lagrange's basis polynomial j, multiplied out
    std::array<double, places> c{1};
    for (int other = 0, degree = 0; other < places; ++other) {
      if (other == j) continue;
      const double scale = 1 / (dp::place[j] - dp::place[other]);
      for (int i = ++degree; i >= 0; --i) c[i] = scale * ((i > 0 ? c[i - 1] : 0) - dp::place[other] * c[i]);
    }
    for (int i = 0; i < places; ++i) inverse[i][j] = c[i];
  }
  return inverse;
}

}  // namespace

Drive Segment::drive(double s) noexcept { return s == 0 ? at_node(0) : s == 1 ? at_node(dp::nodes) : within(s); }

Drive Segment::within(double s) noexcept {
  Drive d(t + s * h, exogenous);
  for (int i = 0; i < exogenous; ++i) {
    const double* c = polynomial(i);
    for (int k = places - 1; k >= 0; --k) d.u[i] = d.u[i] * s + c[k];
  }
  return d;
}

Drive Segment::drive_with_rates(double s) noexcept {
  Drive d = drive(s);
  for (int i = 0; i < exogenous; ++i) {
    const double* c = polynomial(i);
    for (int k = places - 1; k > 0; --k) d.rate[i] = d.rate[i] * s + k * c[k];
    d.rate[i] /= h;
  }
  return d;
}

const double* Segment::polynomial(int i) noexcept {
  if (known_) return coefficient_[i];
  static const Inverse inverse = invert_places();
  for (int k = 0; k < exogenous; ++k)
    for (int row = 0; row < places; ++row) {
      coefficient_[k][row] = 0;
      for (int j = 0; j < places; ++j) coefficient_[k][row] += inverse[row][j] * input[k][j];
    }
  known_ = true;
  return coefficient_[i];
}

Segment segment_of(const FixedProblem& problem, Eigen::Index row, int substep) noexcept {
  Segment g;
  g.h = problem.dt / problem.substeps;
  g.row = row;
  g.substep = substep;
  const Eigen::Index index = row * problem.substeps + substep;
  g.t = problem.t0 + static_cast<double>(index) * g.h;
  g.exogenous = problem.dynamics->exogenous;
  const bool last = row + 1 == problem.rows;  // the last row has no interval after it
  for (int i = 0; i < g.exogenous; ++i) {
    const double* u = problem.drive[i] + dp::nodes * index;
    for (int node = 0; node <= dp::nodes; ++node) g.input[i][node] = last ? u[0] : u[node];
    if (problem.hold) g.input[i][dp::nodes] = u[0];
  }
  return g;
}

Drive stage_drive(Segment& segment, double from, double to, int stage) noexcept {
  return from == 0 && to == 1 ? segment.at_node(std::min(stage, dp::nodes))
                              : segment.drive(stage >= dp::nodes ? to : from + dp::place[stage] * (to - from));
}

}  // namespace lunid
