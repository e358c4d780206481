#include "simulate/harmonics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// Points without a meaning, the same in every run: what holds at all of them holds everywhere, but for accidents.
double probe_value(int point, int input) { return std::sin(1.7 * point + 2.3 * input + 0.4) + 0.2; }
constexpr int probes = 5;

/// Values of the rates at a probe with the time t.
std::vector<double> probe(const Dynamics& d, std::span<const double> theta, int point, double t,
                          std::vector<double>& in) {
  in.assign(static_cast<std::size_t>(d.inputs()), 0.0);
  for (int i = 1; i < d.inputs(); ++i) in[i] = probe_value(point, i);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  in[0] = t;
  std::vector<double> out(d.rate.outputs()), scratch(d.rate.registers() + 1);
  d.rate.run_point(in.data(), out.data(), scratch.data());
  return out;
}

struct Wave {
  double value, slope, curvature;
};
Wave wave_at(const VectorXd& series, double tau) {
  Wave w{series[0], 0, 0};
  for (Index k = 1; 2 * k < series.size(); ++k) {
    const double a = series[2 * k - 1], b = series[2 * k], angle = static_cast<double>(k) * tau;
    const double c = std::cos(angle), s = std::sin(angle), order = static_cast<double>(k);
    w.value += a * c + b * s;
    w.slope += order * (b * c - a * s);
    w.curvature -= order * order * (a * c + b * s);
  }
  return w;
}

/// The extreme value near a sample that is one among samples.
double extreme_near(const VectorXd& series, double tau) {
  double value = wave_at(series, tau).value;
  for (int i = 0; i < 4; ++i) {
    const Wave w = wave_at(series, tau);
    if (w.curvature == 0) break;
    tau -= w.slope / w.curvature;
    const double next = wave_at(series, tau).value;
    if (!(std::abs(next - value) <= 0.1 * series.cwiseAbs().sum())) break;
    value = next;
  }
  return value;
}

}  // namespace

MatrixXd input_values(std::span<const HarmonicInput> inputs, int exogenous, double omega, const VectorXd& phase) {
  MatrixXd u = MatrixXd::Zero(phase.size(), exogenous);
  for (const HarmonicInput& h : inputs) {
    std::complex<double> factor = h.coefficient;
    for (int i = 0; i < h.derivative; ++i) factor *= std::complex<double>(0, h.harmonic * omega);
    for (Index i = 0; i < phase.size(); ++i) {
      const double angle = h.harmonic * phase[i];
      u(i, h.input) += factor.real() * std::cos(angle) - factor.imag() * std::sin(angle);
    }
  }
  return u;
}

FourierTable::FourierTable(int harmonics, Index samples) : phase_(samples), values_(samples, 2 * harmonics + 1) {
  std::vector<double> c(samples), s(samples);
  for (Index i = 0; i < samples; ++i) {
    phase_[i] = 2 * pi * static_cast<double>(i) / static_cast<double>(samples);
    c[i] = std::cos(phase_[i]);
    s[i] = std::sin(phase_[i]);
  }
  values_.col(0).setOnes();
  for (Index k = 1; k <= harmonics; ++k)
    for (Index i = 0; i < samples; ++i) {
      values_(i, 2 * k - 1) = c[(k * i) % samples];
      values_(i, 2 * k) = s[(k * i) % samples];
    }
}

MatrixXd FourierTable::series(const MatrixXd& samples) const {
  MatrixXd series = (values_.transpose() * samples) * (2.0 / static_cast<double>(values_.rows()));
  series.row(0) *= 0.5;
  return series;
}

MatrixXd phase_derivative(const MatrixXd& series) {
  MatrixXd out = MatrixXd::Zero(series.rows(), series.cols());
  for (Index k = 1; 2 * k < series.rows(); ++k) {
    out.row(2 * k - 1) = static_cast<double>(k) * series.row(2 * k);
    out.row(2 * k) = -static_cast<double>(k) * series.row(2 * k - 1);
  }
  return out;
}

DerivativeColumns::DerivativeColumns(const Dynamics& dynamics, std::span<const double> theta)
    : d_(dynamics), theta_(theta.begin(), theta.end()), n_(dynamics.n) {}

bool DerivativeColumns::run(const MatrixXd& u, const MatrixXd& x) {
  const Index rows = x.rows();
  if (out_.rows() != rows) out_.resize(rows, d_.derivatives.outputs());
  std::vector<const double*> in{&zero_};
  for (int i = 0; i < d_.exogenous; ++i) in.push_back(u.data() + i * rows);
  for (int i = 0; i < n_; ++i) in.push_back(x.data() + i * rows);
  std::vector<int> stride(in.size(), 1);
  stride[0] = 0;
  for (const double& value : theta_) in.push_back(&value);
  stride.resize(in.size(), 0);
  std::vector<double*> out;
  for (Index i = 0; i < out_.cols(); ++i) out.push_back(out_.col(i).data());
  d_.derivatives.run_columns(in, stride, static_cast<std::size_t>(rows), out);
  return out_.leftCols(n_ + n_ * n_).allFinite();
}

std::vector<std::pair<int, int>> displacement_pairs(const Dynamics& d) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < d.degrees; ++i) pairs.emplace_back(2 * i, 2 * i + 1);
  return pairs;
}

bool depends_on_time(const Dynamics& d, std::span<const double> theta) {
  std::vector<double> in;
  for (int point = 0; point < probes; ++point) {
    const std::vector<double> first = probe(d, theta, point, 0.3, in);
    for (const double t : {0.0, 1.1, 17.9, 230.7}) {
      const std::vector<double> then = probe(d, theta, point, t, in);
      for (int i = 0; i < d.n; ++i)
        if (then[i] != first[i] && !(std::isnan(then[i]) && std::isnan(first[i]))) return true;
    }
  }
  return false;
}

Motion motion_of_series(const VectorXd& series) {
  Motion m;
  m.harmonics.emplace_back(series[0], 0.0);
  for (Index k = 1; 2 * k < series.size(); ++k) m.harmonics.emplace_back(series[2 * k - 1], -series[2 * k]);
  const int orders = static_cast<int>(m.harmonics.size());
  const Index samples = 16 * orders;
  Index lowest = 0, highest = 0;
  double low = INFINITY, high = -INFINITY;
  for (Index i = 0; i < samples; ++i) {
    const double value = wave_at(series, 2 * pi * static_cast<double>(i) / static_cast<double>(samples)).value;
    if (value < low) low = value, lowest = i;
    if (value > high) high = value, highest = i;
  }
  const double step = 2 * pi / static_cast<double>(samples);
  m.min = std::min(low, extreme_near(series, step * static_cast<double>(lowest)));
  m.max = std::max(high, extreme_near(series, step * static_cast<double>(highest)));
  return m;
}

void widen_by_cubic(double x0, double x1, double d0, double d1, double& low, double& high) {
  if (!((d0 > 0) != (d1 > 0)) && d0 != 0) return;
  const double a = 2 * (x0 - x1) + d0 + d1, b = 3 * (x1 - x0) - 2 * d0 - d1;  // x0 + d0 s + b s^2 + a s^3
  const double root = std::sqrt(std::max(0.0, b * b - 3 * a * d0));
  for (const double sign : {-1.0, 1.0}) {
    const double q = -(b + sign * root);
    for (const double s : {q / (3 * a), d0 / q}) {
      if (!(s > 0 && s < 1)) continue;
      const double value = x0 + s * (d0 + s * (b + s * a));
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
}

Motion motion_of_samples(const VectorXd& x, const VectorXd& rate, double dt, int harmonics, int periods) {
  Motion m;
  const Index rows = x.size() - 1;
  m.min = x.minCoeff();
  m.max = x.maxCoeff();
  for (Index i = 0; i < rows && rate.size() > 0; ++i)
    widen_by_cubic(x[i], x[i + 1], rate[i] * dt, rate[i + 1] * dt, m.min, m.max);
  std::vector<double> c(rows), s(rows);
  for (Index i = 0; i < rows; ++i) {
    c[i] = std::cos(2 * pi * static_cast<double>(i) / static_cast<double>(rows));
    s[i] = std::sin(2 * pi * static_cast<double>(i) / static_cast<double>(rows));
  }
  for (Index k = 0; k <= harmonics; ++k) {
    std::complex<double> sum = 0;
    for (Index i = 0; i < rows; ++i) {
      const Index at = (k * periods * i) % rows;
      sum += x[i] * std::complex<double>(c[at], -s[at]);
    }
    m.harmonics.push_back(sum * ((k == 0 ? 1.0 : 2.0) / static_cast<double>(rows)));
  }
  return m;
}

}  // namespace lunid
