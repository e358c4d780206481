// Predictions of a history model, tests of its residual, and the equation of motion that it samples.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "expr/digits.hpp"
#include "regress/history_rows.hpp"

namespace lunid {

using detail::HistoryRows;
using detail::HistorySignals;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kGrown = 1e6;  // times the measured output: a run without bound

HistoryRows rows_of(const HistoryModel& model) {
  std::vector<Expr> features;
  for (const HistoryTerm& term : model.terms) features.push_back(term.feature);
  return HistoryRows(features, model.options);
}

VectorXd coefficients_of(const HistoryModel& model) {
  VectorXd out(static_cast<Index>(model.terms.size()));
  for (Index i = 0; i < out.size(); ++i) out[i] = model.terms[static_cast<std::size_t>(i)].coefficient;
  return out;
}

/// Scores of the predictions from `first` on.
void score(Prediction& p, const VectorXd& measured) {
  const Index rows = measured.size() - p.first;
  if (p.ended >= 0 || rows < 1) {
    p.rmse = std::numeric_limits<double>::infinity();
    p.fit = -p.rmse;
    return;
  }
  const VectorXd y = measured.tail(rows);
  p.rmse = std::sqrt((p.values.tail(rows) - y).squaredNorm() / static_cast<double>(rows));
  const double spread = std::sqrt((y.array() - y.mean()).square().mean());
  p.fit = spread > 0 ? 100 * (1 - p.rmse / spread) : kNan;
}

void check_time(const HistoryModel& model, const Record& record) {
  if (std::abs(record.dt() / model.dt - 1) > 1e-9)
    throw InputError("history model: fitted at a sampling time of " + exact_number(model.dt) + " s, the record has " +
                         exact_number(record.dt()) + " s: resample it",
                     {}, Fault::data);
}

}  // namespace

Prediction predict(const HistoryModel& model, const Record& record, int steps) {
  if (steps < 0) throw InputError("history model: steps: expected >= 0, got " + std::to_string(steps));
  check_time(model, record);
  HistoryRows rows = rows_of(model);
  const VectorXd b = coefficients_of(model);
  const HistorySignals signals = detail::signals_of(record, model.options);
  const double limit = kGrown * std::max(signals.y.cwiseAbs().maxCoeff(), 1e-300);
  Prediction p;
  VectorXd features(b.size());
  if (steps == 0) {
    p.first = rows.first();
    p.values = signals.y;
    VectorXd none = VectorXd::Zero(signals.y.size());
    for (Index k = p.first; k < p.values.size(); ++k) {
      rows.at(p.values.data(), signals.u.data(), none.data(), k, features.data());
      p.values[k] = features.dot(b);
      if (std::abs(p.values[k]) <= limit) continue;
      p.ended = k;
      p.values.tail(p.values.size() - k).setConstant(kNan);
      break;
    }
  } else {
    const VectorXd errors = detail::innovations(rows, b, signals);
    p.first = rows.first() + steps - 1;
    p.values = signals.y;
    VectorXd y = signals.y, e = errors;
    for (Index k = p.first; k < y.size(); ++k) {
      const Index from = k - steps + 1;  // the first step that is not measured
      for (Index j = from; j <= k; ++j) {
        rows.at(y.data(), signals.u.data(), e.data(), j, features.data());
        y[j] = features.dot(b);
        e[j] = 0;
      }
      p.values[k] = y[k];
      y.segment(from, steps) = signals.y.segment(from, steps);
      e.segment(from, steps) = errors.segment(from, steps);
    }
  }
  score(p, signals.y);
  return p;
}

namespace {

/// Correlations of two series of equal length: a(k) with b(k - lag).
ResidualTest correlate(std::string name, const VectorXd& a, const VectorXd& b, int first, int last) {
  const VectorXd x = a.array() - a.mean(), z = b.array() - b.mean();
  const double size = x.norm() * z.norm();
  const Index n = x.size();
  ResidualTest test{
      std::move(name), first, VectorXd::Zero(last - first + 1), 1.96 / std::sqrt(static_cast<double>(n)), 0, true};
  for (int lag = first; lag <= last; ++lag) {
    const double value = lag >= 0 ? x.tail(n - lag).dot(z.head(n - lag)) : x.head(n + lag).dot(z.tail(n + lag));
    test.correlation[lag - first] = size > 0 ? value / size : 0;
    test.outside += std::abs(test.correlation[lag - first]) > test.bound;
  }
  // As many outside, of lags that are within with 95 %: binomial tail.
  const int count = last - first + 1;
  double probability = std::pow(0.95, count), tail = 1;
  for (int k = 0; k < test.outside; ++k) {
    tail -= probability;
    probability *= 0.05 / 0.95 * (count - k) / (k + 1);
  }
  test.passed = tail > 0.01;
  return test;
}

bool is_linear(const HistoryModel& model) {
  for (const HistoryTerm& term : model.terms)
    if (!term.feature.is_symbol() && !term.feature.is_constant()) return false;
  return true;
}

}  // namespace

std::vector<ResidualTest> residual_tests(const HistoryModel& model, const Record& record, int lags) {
  check_time(model, record);
  HistoryRows rows = rows_of(model);
  const HistorySignals signals = detail::signals_of(record, model.options);
  const Index from = rows.first(), n = signals.y.size() - from;
  if (lags < 1 || lags >= n / 4)
    throw InputError("history model: lags: expected 1 to a quarter of the rows, got " + std::to_string(lags));
  const VectorXd e = detail::innovations(rows, coefficients_of(model), signals).tail(n), u = signals.u.tail(n);
  std::vector<ResidualTest> tests = {correlate("residual with itself", e, e, 1, lags),
                                     correlate("residual with the input", e, u, -lags, lags)};
  if (is_linear(model)) return tests;
  const VectorXd squared = u.array().square();
  tests.push_back(correlate("residual with the squared input", e, squared, -lags, lags));
  tests.push_back(correlate("squared residual with the squared input", e.array().square(), squared, -lags, lags));
  return tests;
}

namespace {

/// Coefficients a_i of past outputs and b_i of inputs by lag; throws InputError where the model is not linear.
struct Linear {
  std::vector<double> a, b;  // a[i - 1] of y_i, b[i] of u_i
};

Linear linear_of(const HistoryModel& model, const VectorXd& coefficients) {
  if (!is_linear(model)) throw InputError("history model: only a linear one has poles and an equation of motion");
  Linear out;
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const Expr feature = model.terms[i].feature;
    if (feature.is_constant() || feature.name().rfind("e_", 0) == 0) continue;
    const bool output = feature.name().rfind(model.options.output + "_", 0) == 0;
    const auto lag = static_cast<std::size_t>(std::atoi(feature.name().c_str() + feature.name().rfind('_') + 1));
    std::vector<double>& list = output ? out.a : out.b;
    const std::size_t place = output ? lag - 1 : lag;
    if (list.size() <= place) list.resize(place + 1, 0);
    list[place] = coefficients[static_cast<Index>(i)];
  }
  return out;
}

/// Roots of z^n - a1 z^(n-1) - ... - an (Durand 1960; Kerner 1966): all at once, from points on a spiral.
std::vector<std::complex<double>> roots(const std::vector<double>& a) {
  using Complex = std::complex<long double>;
  const std::size_t n = a.size();
  std::vector<Complex> z(n);
  for (std::size_t i = 0; i < n; ++i) z[i] = std::pow(Complex(0.4L, 0.9L), static_cast<int>(i));
  for (int pass = 0; pass < 500; ++pass) {
    long double change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      Complex value = 1, others = 1;
      for (const double coefficient : a) value = value * z[i] - static_cast<long double>(coefficient);
      for (std::size_t j = 0; j < n; ++j)
        if (j != i) others *= z[i] - z[j];
      const Complex step = value / others;
      z[i] -= step;
      change = std::max(change, std::abs(step));
    }
    if (change < 1e-17L) break;
  }
  std::vector<std::complex<double>> out;
  for (const Complex& root : z) out.emplace_back(static_cast<double>(root.real()), static_cast<double>(root.imag()));
  return out;
}

struct Equation {
  double m = 0, c = 0, k = 0;
};

/// m, c, k of two poles and the static gain.
Equation equation_of(const Linear& linear, double dt) {
  const double a1 = linear.a[0], a2 = linear.a[1];
  double gain = 0;
  for (const double b : linear.b) gain += b;
  gain /= 1 - a1 - a2;
  // z1 z2 = -a2 = exp((s1 + s2) dt); the two roots of z^2 - a1 z - a2
  const std::complex<double> half = std::sqrt(std::complex<double>(a1 * a1 / 4 + a2, 0));
  const std::complex<double> s1 = std::log(a1 / 2 + half) / dt, s2 = std::log(a1 / 2 - half) / dt;
  Equation e;
  e.k = 1 / gain;
  e.m = e.k / (s1 * s2).real();
  e.c = -e.m * (s1 + s2).real();
  return e;
}

/// The input coefficients that an equation has for a force held (lags 1, 2) or straight (lags 0, 1, 2) between samples.
/// From the step, or ramp, response at the first samples: y_k = a1 y_(k-1) + a2 y_(k-2) + sum b_i u_(k-i).
std::vector<double> input_coefficients(const Equation& e, const Linear& linear, double dt, bool straight) {
  using Complex = std::complex<double>;
  const Complex half = std::sqrt(Complex(e.c * e.c / 4 - e.m * e.k, 0));
  const Complex s1 = (-e.c / 2 + half) / e.m, s2 = (-e.c / 2 - half) / e.m;
  // Response to F = t^n / n!: from the partial fractions of 1 / (s^(n+1) (m s^2 + c s + k)).
  const auto response = [&](double t) {
    const Complex p = std::exp(s1 * t), q = std::exp(s2 * t);
    if (!straight) return ((1.0 + (s2 * p - s1 * q) / (s1 - s2)) / e.k).real();
    const Complex ramp = t + (s1 + s2) / (s1 * s2) + (s2 / s1 * p - s1 / s2 * q) / (s1 - s2);
    return (ramp / e.k).real();
  };
  std::vector<double> b(3, 0);
  if (!straight) {
    const double y1 = response(dt), y2 = response(2 * dt);
    b[1] = y1;
    b[2] = y2 - linear.a[0] * y1 - b[1];
  } else {  // a triangle of height 1: ramps from -dt, 0 and dt
    const double h0 = response(dt) / dt, h1 = (response(2 * dt) - 2 * response(dt)) / dt;
    const double h2 = (response(3 * dt) - 2 * response(2 * dt) + response(dt)) / dt;
    b[0] = h0;
    b[1] = h1 - linear.a[0] * h0;
    b[2] = h2 - linear.a[0] * h1 - linear.a[1] * h0;
  }
  return b;
}

}  // namespace

std::vector<std::pair<double, double>> history_poles(const HistoryModel& model) {
  std::vector<std::pair<double, double>> out;
  for (const std::complex<double>& z : roots(linear_of(model, coefficients_of(model)).a)) {
    const std::complex<double> s = std::log(z) / model.dt;
    out.emplace_back(s.real(), s.imag());
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    const double x = std::hypot(a.first, a.second), y = std::hypot(b.first, b.second);
    return std::abs(x - y) > 1e-9 * y ? x < y : a.second < b.second;
  });
  return out;
}

ContinuousModel to_continuous(const HistoryModel& model) {
  const VectorXd b = coefficients_of(model);
  const Linear linear = linear_of(model, b);
  if (linear.a.size() != 2 || linear.b.empty() || linear.b.size() > 3)
    throw InputError(
        "history model: an equation m*a + c*v + k*y = F has two output lags and inputs of lags 0 to 2, this "
        "one has " +
        std::to_string(linear.a.size()) + " and " + std::to_string(linear.b.size()));
  const double square = linear.a[0] * linear.a[0] / 4 + linear.a[1];
  if (square > 0 && linear.a[0] / 2 - std::sqrt(square) <= 0)
    throw InputError(
        "history model: a pole on the negative real axis belongs to no equation of motion: sample faster, "
        "or describe the noise (noise_lags)");
  const Equation e = equation_of(linear, model.dt);
  if (!(std::isfinite(e.k) && std::isfinite(e.m)) || e.k == 0)
    throw InputError("history model: no static gain, so that the mass cannot be told");
  ContinuousModel out{e.m, e.c, e.k, kNan, kNan, kNan, 0};
  Eigen::MatrixXd slope(3, b.size());
  for (Index i = 0; i < b.size(); ++i) {  // central differences of a smooth function of few numbers
    const double step = 1e-6 * std::max(std::abs(b[i]), 1e-3 * b.cwiseAbs().minCoeff());
    VectorXd up = b, down = b;
    up[i] += step;
    down[i] -= step;
    const Equation hi = equation_of(linear_of(model, up), model.dt), lo = equation_of(linear_of(model, down), model.dt);
    slope.col(i) << (hi.m - lo.m) / (2 * step), (hi.c - lo.c) / (2 * step), (hi.k - lo.k) / (2 * step);
  }
  const Eigen::Matrix3d covariance = slope * model.covariance * slope.transpose();
  out.mass_std = std::sqrt(covariance(0, 0));
  out.damping_std = std::sqrt(covariance(1, 1));
  out.stiffness_std = std::sqrt(covariance(2, 2));
  const std::vector<double> expected = input_coefficients(e, linear, model.dt, model.between != Interpolation::hold);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double got = i < linear.b.size() ? linear.b[i] : 0;
    difference += (got - expected[i]) * (got - expected[i]);
    size += expected[i] * expected[i];
  }
  out.mismatch = std::sqrt(difference / size);
  return out;
}

}  // namespace lunid
