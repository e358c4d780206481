// Backbone curves: the unknowns of harmonic balance with the frequency and the negative damping that keeps the motion
// up, over the logarithm of the mode's amplitude.
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "expr/digits.hpp"
#include "simulate/continuation.hpp"
#include "simulate/harmonic_choice.hpp"
#include "simulate/response_checks.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr int max_harmonics = 63;

/// A mode of the linearised system: x = Re(shape exp(root t)).
struct Mode {
  VectorXd rest;
  std::complex<double> root;
  Eigen::VectorXcd shape;
  int state = 0;  ///< the displacement that moves most
};

MatrixXd slopes_at(const Dynamics& d, std::span<const double> theta, const VectorXd& x, VectorXd& rate) {
  std::vector<double> in(d.inputs(), 0.0), out(d.derivatives.outputs()), scratch(d.derivatives.registers() + 1);
  std::copy(x.begin(), x.end(), in.begin() + 1 + d.exogenous);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  d.derivatives.run_point(in.data(), out.data(), scratch.data());
  rate = Eigen::Map<const VectorXd>(out.data(), d.n);
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(out.data() + d.n, d.n,
                                                                                                  d.n);
}

/// A state of rest near x, by Newton's method; where rest may lie anywhere, the nearest.
VectorXd rest_near(const Dynamics& d, std::span<const double> theta, VectorXd x) {
  VectorXd rate;
  for (int i = 0; i < 50; ++i) {
    const MatrixXd slopes = slopes_at(d, theta, x, rate);
    if (!slopes.allFinite() || !rate.allFinite())
      throw InputError("backbone: the model has no finite stiffness at rest");
    if (rate.isZero(0)) return x;
    const VectorXd step = slopes.completeOrthogonalDecomposition().solve(-rate);
    x += step;
    if (step.norm() <= 1e-14 * x.norm()) return x;
  }
  throw InputError("backbone: no state of rest was found near the displacement 0");
}

Mode mode_of(const Dynamics& d, std::span<const double> theta, const VectorXd& start, int which,
             const std::vector<std::pair<int, int>>& pairs) {
  Mode mode;
  mode.rest = rest_near(d, theta, start);
  VectorXd rate;
  const Eigen::EigenSolver<MatrixXd> solver(slopes_at(d, theta, mode.rest, rate));
  std::vector<Index> order;
  for (Index i = 0; i < d.n; ++i)
    if (solver.eigenvalues()[i].imag() > 1e-9 * solver.eigenvalues().cwiseAbs().maxCoeff()) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::abs(solver.eigenvalues()[a]) < std::abs(solver.eigenvalues()[b]);
  });
  const auto count = static_cast<int>(order.size());
  if (which > count)
    throw InputError("backbone: mode: the model has " + std::to_string(count) + " oscillating mode" +
                     (count == 1 ? "" : "s") + " at rest, got " + std::to_string(which));
  const Index at = order[static_cast<std::size_t>(which - 1)];
  mode.root = solver.eigenvalues()[at];
  mode.shape = solver.eigenvectors().col(at);
  double most = 0;
  for (const auto& [y, v] : pairs) {
    if (!(std::abs(mode.shape[y]) > most)) continue;
    most = std::abs(mode.shape[y]);
    mode.state = y;
  }
  mode.shape /= mode.shape[mode.state];
  return mode;
}

/// Unknowns: q, log(omega), driving / omega. Parameter: log of the first cosine of the mode's displacement, whose first
/// sine is zero.
class BackboneCurve : public Curve {
 public:
  BackboneCurve(const Dynamics& d, std::span<const double> theta, const BackboneOptions& options, const Mode& mode)
      : options_(options), balance_(d, theta, {}), choice_(d, options.harmonics, max_harmonics, options.accuracy) {
    choice_.begin(balance_);
    const auto& unknowns = balance_.unknowns();
    place_ = std::find(unknowns.begin(), unknowns.end(), mode.state) - unknowns.begin();
    largest_ = VectorXd::Zero(static_cast<Index>(unknowns.size()));
  }

  const HarmonicBalance& balance() const { return balance_; }
  Index size() const override { return balance_.size() + 2; }
  static double omega(const VectorXd& x) { return std::exp(x[x.size() - 2]); }
  static double driving(const VectorXd& x) { return x[x.size() - 1] * omega(x); }
  static VectorXd coefficients(const VectorXd& x) { return x.head(x.size() - 2); }

  VectorXd start(const Mode& mode, double amplitude) const {
    VectorXd x = VectorXd::Zero(size());
    for (std::size_t i = 0; i < balance_.unknowns().size(); ++i) {
      const int state = balance_.unknowns()[i];
      const Index first = static_cast<Index>(i) * balance_.rows();
      x[first] = mode.rest[state];
      x[first + 1] = amplitude * mode.shape[state].real();
      x[first + 2] = -amplitude * mode.shape[state].imag();
    }
    x[size() - 2] = std::log(std::abs(mode.root));
    x[size() - 1] = -2 * mode.root.real() / std::abs(mode.root);
    return x;
  }

  bool evaluate(const VectorXd& x, double lambda, VectorXd& r, MatrixXd* dx, VectorXd* dlambda) override {
    check_cancelled(options_.cancelled);
    const Index m = balance_.size(), cosine = place_ * balance_.rows() + 1;
    const double w = omega(x);
    VectorXd part;
    if (!balance_.residual(coefficients(x), w, driving(x), part, dx ? &slopes_ : nullptr)) return false;
    r.resize(m + 2);
    r.head(m) = part;
    r[m] = x[cosine + 1];
    r[m + 1] = x[cosine] - std::exp(lambda);
    if (!dx) return true;
    dx->setZero(m + 2, m + 2);
    dx->topLeftCorner(m, m) = slopes_.q;
    dx->col(m).head(m) = w * (slopes_.omega + x[m + 1] * slopes_.driving);
    dx->col(m + 1).head(m) = w * slopes_.driving;
    (*dx)(m, cosine + 1) = 1;
    (*dx)(m + 1, cosine) = 1;
    dlambda->setZero(m + 2);
    (*dlambda)[m + 1] = -std::exp(lambda);
    return true;
  }

  VectorXd weights(const VectorXd& x, double) override {
    VectorXd w = VectorXd::Ones(x.size());
    w.head(x.size() - 2) = series_weights(balance_, coefficients(x), largest_);
    return w;
  }

  bool adapt(const VectorXd& x, double, const std::vector<VectorXd*>& vectors) override {
    if (!choice_.adapt(balance_, coefficients(x), omega(x))) return false;
    for (VectorXd* vector : vectors) {
      const VectorXd ends = vector->tail(2), q = balance_.resized(coefficients(*vector), balance_.harmonics());
      vector->resize(q.size() + 2);
      *vector << q, ends;
    }
    return true;
  }

  bool truncated() const { return choice_.truncated(); }

 private:
  const BackboneOptions& options_;
  HarmonicBalance balance_;
  HarmonicChoice choice_;
  HarmonicBalance::Slopes slopes_;
  Index place_ = 0;
  VectorXd largest_;
};

BackbonePoint point_at(const BackboneCurve& curve, const VectorXd& x) {
  BackbonePoint point;
  const double omega = BackboneCurve::omega(x);
  point.frequency = omega / (2 * pi);
  point.damping = 0.5 * x[x.size() - 1];
  point.harmonics = curve.balance().harmonics();
  const MatrixXd series = curve.balance().series(BackboneCurve::coefficients(x), omega);
  for (Index i = 0; i < series.cols(); ++i) point.motion.push_back(motion_of_series(series.col(i)));
  return point;
}

void follow(BackboneCurve& curve, const Mode& mode, const BackboneOptions& options, Backbone& out) {
  Continuation continuation(curve, {.max_step = options.max_step});
  const double start = std::log(options.from);
  const auto amplitude = [&](const BackbonePoint& point) {
    return point.motion[static_cast<std::size_t>(mode.state)].amplitude();
  };
  out.complete = false;
  if (!continuation.begin(curve.start(mode, options.from), start, 1)) {
    out.stopped = "no free motion was found at the amplitude " + number(options.from) + " m";
    return;
  }
  out.points.push_back(point_at(curve, continuation.here().x));
  while (static_cast<int>(out.points.size()) < options.max_points) {
    if (!continuation.advance()) {
      out.stopped = "no step leads on from " + in_hertz(out.points.back().frequency);
      return;
    }
    out.truncated |= curve.truncated();
    out.corrections = continuation.corrections();
    BackbonePoint point = point_at(curve, continuation.here().x);
    const double now = amplitude(point), before = amplitude(out.points.back());
    if (now < options.to) {
      out.points.push_back(std::move(point));
      continue;
    }
    const auto beyond = [&](double part) {
      BranchPlace place;
      return continuation.between(part, place) ? amplitude(point_at(curve, place.x)) / options.to - 1 : std::nan("");
    };
    const double part = root_between(before / options.to - 1, now / options.to - 1, beyond);
    if (BranchPlace place; continuation.between(part, place)) out.points.push_back(point_at(curve, place.x));
    out.complete = true;
    out.stopped = "reached the end of the range";
    return;
  }
  out.stopped = "max_points = " + std::to_string(options.max_points) + " were not enough";
}

}  // namespace

Backbone backbone(const System& system, std::span<const double> theta, const BackboneOptions& options) {
  validate(options);
  check_periodic("backbone", system, theta, {});
  const auto begin = std::chrono::steady_clock::now();
  const Dynamics& d = system.dynamics();
  check_balance("backbone", d, "");
  const auto pairs = displacement_pairs(d);
  const Mode mode = mode_of(d, theta, rest_of(system), options.mode, pairs);
  Backbone out;
  out.states = d.names;
  out.state = mode.state;
  BackboneCurve curve(d, theta, options, mode);
  follow(curve, mode, options, out);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace lunid
