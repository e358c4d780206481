#include "simulate/acceleration.hpp"

#include <cmath>

namespace lunid {
namespace {

using Eigen::Index;

/// A rate by the branches' own signs that differs from the run's by more than this part is not that of its mode.
constexpr double same_rate = 1e-9;

}  // namespace

std::vector<Eigen::MatrixXd> acceleration_slopes(const System& system, std::span<const double> theta,
                                                 const Excitations& given, const SensitivityRun& run) {
  const Dynamics& d = system.dynamics();
  const Excitations excitation = given.of(system, theta);
  const Index rows = run.run.x.rows(), columns = d.p + d.n;
  std::vector<double> in(d.inputs(), 0.0), out(d.derivatives.outputs()), scratch(d.derivatives.registers() + 1);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  std::vector<Eigen::MatrixXd> slopes(
      static_cast<std::size_t>(d.degrees),
      Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::quiet_NaN()));
  const double *const jx = out.data() + d.n, *const jtheta = jx + d.n * d.n;
  for (Index row = 0; row < rows && run.run.x.row(row).allFinite(); ++row) {
    in[0] = run.run.t0 + run.run.dt * static_cast<double>(row);
    for (int i = 0; i < d.exogenous; ++i) in[1 + i] = excitation[i].at(in[0]);
    for (int i = 0; i < d.n; ++i) in[1 + d.exogenous + i] = run.run.x(row, i);
    d.derivatives.run_point(in.data(), out.data(), scratch.data());
    for (int degree = 0; degree < d.degrees; ++degree) {
      const int v = 2 * degree + 1;
      const double a = run.run.a(row, degree), rate = out[static_cast<std::size_t>(v)];
      auto slope = slopes[static_cast<std::size_t>(degree)].row(row);
      if (!(std::abs(rate - a) <= same_rate * (std::abs(rate) + std::abs(a)))) {
        if (a == 0) slope.setZero();
        continue;
      }
      slope.setZero();
      for (int j = 0; j < d.p; ++j) slope[j] = jtheta[v * d.p + j];
      for (int i = 0; i < d.n; ++i) slope += jx[v * d.n + i] * run.dx[static_cast<std::size_t>(i)].row(row);
    }
  }
  return slopes;
}

}  // namespace lunid
