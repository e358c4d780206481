#include "simulate/continuation.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Below this the solution of least length is taken: a rest that may lie anywhere (a mass on no spring, a slider that
/// never slips) leaves one direction open.
constexpr double least_condition = 1e-13;
/// A step may turn the branch by this angle [rad]; steps below `free_step` may turn as they like (kinks of branches of
/// non-smooth systems).
constexpr double most_turn = 0.35, wanted_turn = 0.15, free_step = 1e-4;
/// A correction that is larger than this part of the step leads to another branch.
constexpr double most_correction = 0.5;
/// A correction that no longer shrinks is rounding below this.
constexpr double rounding = 1e-7;

/// The rows of the scaled system made alike, then solved; false when that is impossible.
bool solve(MatrixXd& a, VectorXd& b, MatrixXd* more) {
  for (Index i = 0; i < a.rows(); ++i) {
    const double largest = a.row(i).cwiseAbs().maxCoeff();
    if (!(largest > 0) || !std::isfinite(largest)) continue;
    a.row(i) /= largest;
    b[i] /= largest;
    if (more) more->row(i) /= largest;
  }
  const Eigen::PartialPivLU<MatrixXd> lu(a);
  if (lu.rcond() > least_condition) {
    b = lu.solve(b).eval();
    if (more) *more = lu.solve(*more).eval();
  } else {
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod(a.rows(), a.cols());
    cod.setThreshold(1e-11);
    cod.compute(a);
    b = cod.solve(b).eval();
    if (more) *more = cod.solve(*more).eval();
  }
  return b.allFinite() && (!more || more->allFinite());
}

}  // namespace

/// Newton's method on the branch and the plane through `place` across `direction` (weighted, of any length); leaves the
/// tangent.
bool Continuation::newton(BranchPlace& place, const VectorXd& direction, double direction_lambda, int iterations) {
  const Index n = curve_.size();
  const VectorXd start = place.x;
  const double start_lambda = place.lambda;
  double before = INFINITY;
  for (last_iterations_ = 1; last_iterations_ <= iterations; ++last_iterations_) {
    ++corrections_;
    if (!curve_.evaluate(place.x, place.lambda, r_, &dx_, &dlambda_)) return false;
    matrix_.resize(n + 1, n + 1);
    matrix_.topLeftCorner(n, n) = dx_ * weights_.cwiseInverse().asDiagonal();
    matrix_.topRightCorner(n, 1) = dlambda_;
    matrix_.bottomLeftCorner(1, n) = direction.transpose();
    matrix_(n, n) = direction_lambda;
    VectorXd b(n + 1);
    b.head(n) = -r_;
    b[n] = -direction.dot(weights_.cwiseProduct(place.x - start)) - direction_lambda * (place.lambda - start_lambda);
    MatrixXd tangent = MatrixXd::Zero(n + 1, 1);
    tangent(n, 0) = 1;
    if (!solve(matrix_, b, &tangent)) return false;
    const double size = b.norm();
    if (last_iterations_ > 2 && size > std::max(2 * before, rounding)) return false;
    place.x += b.head(n).cwiseQuotient(weights_);
    place.lambda += b[n];
    if (size <= options_.tolerance || (size <= rounding && size > 0.2 * before)) {
      tangent /= tangent.norm();
      place.tangent = tangent.topRows(n).cwiseQuotient(weights_);
      place.tangent_lambda = tangent(n, 0);
      last_correction_ = std::hypot(weights_.cwiseProduct(place.x - start).norm(), place.lambda - start_lambda);
      return true;
    }
    before = size;
  }
  return false;
}

bool Continuation::solve_at(double lambda, VectorXd& x, int iterations) {
  VectorXd r;
  MatrixXd dx;
  VectorXd dlambda;
  double before = INFINITY;
  for (int i = 0; i < iterations; ++i) {
    ++corrections_;
    if (!curve_.evaluate(x, lambda, r, &dx, &dlambda)) return false;
    VectorXd w = curve_.weights(x, lambda);
    dx *= w.cwiseInverse().asDiagonal();
    VectorXd step = -r;
    if (!solve(dx, step, nullptr)) return false;
    x += step.cwiseQuotient(w);
    w = curve_.weights(x, lambda);
    const double size = step.norm();
    if (size <= options_.tolerance || (size <= rounding && size > 0.2 * before)) return true;
    before = size;
  }
  return false;
}

bool Continuation::begin(const VectorXd& x, double lambda, int direction) {
  here_.x = x;
  here_.lambda = lambda;
  step_ = options_.first_step;
  if (!solve_at(lambda, here_.x, 4 * options_.iterations)) return false;
  for (int round = 0;; ++round) {
    weights_ = curve_.weights(here_.x, lambda);
    if (!newton(here_, VectorXd::Zero(curve_.size()), 1, 2 * options_.iterations)) return false;
    if (round == 20 || !curve_.adapt(here_.x, lambda, {&here_.x, &here_.tangent})) break;
  }
  here_.tangent *= direction;
  here_.tangent_lambda *= direction;
  previous_ = here_;
  return true;
}

/// Lets the curve change its unknowns and corrects the present place.
bool Continuation::adapt() {
  for (int round = 0; round < 20; ++round) {
    if (!curve_.adapt(here_.x, here_.lambda, {&here_.x, &here_.tangent, &previous_.x, &previous_.tangent})) return true;
    weights_ = curve_.weights(here_.x, here_.lambda);
    const VectorXd direction = weights_.cwiseProduct(here_.tangent);
    if (!newton(here_, direction, here_.tangent_lambda, options_.iterations)) return false;
  }
  return true;
}

/// A step of the present length from here.
bool Continuation::take_step(BranchPlace& next) {
  const VectorXd direction = weights_.cwiseProduct(here_.tangent);
  next = here_;
  next.x += step_ * here_.tangent;
  next.lambda += step_ * here_.tangent_lambda;
  if (!newton(next, direction, here_.tangent_lambda, options_.iterations)) return false;
  const double cosine = direction.dot(weights_.cwiseProduct(next.tangent)) + here_.tangent_lambda * next.tangent_lambda;
  const double turn = std::acos(std::min(1.0, cosine));
  if (step_ > free_step && (turn > most_turn || last_correction_ > most_correction * step_)) return false;
  const double by_turn = turn > 0 ? std::clamp(wanted_turn / turn, 0.5, 1.6) : 1.6;
  const double by_newton = last_iterations_ <= 4 ? 1.6 : last_iterations_ <= 6 ? 1 : 0.6;
  step_ = std::min(options_.max_step, step_ * std::min(by_turn, by_newton));
  return true;
}

bool Continuation::advance() {
  weights_ = curve_.weights(here_.x, here_.lambda);
  const double length = std::hypot(weights_.cwiseProduct(here_.tangent).norm(), here_.tangent_lambda);
  here_.tangent /= length;
  here_.tangent_lambda /= length;
  BranchPlace next;
  while (!take_step(next)) {
    step_ *= 0.4;
    if (step_ < options_.min_step) return false;
  }
  previous_ = std::move(here_);
  here_ = std::move(next);
  return adapt();
}

/// On the cubic through the last two places along their tangents: near a branch point only a close start stays on the
/// branch.
bool Continuation::between(double part, BranchPlace& place) {
  const VectorXd chord = weights_.cwiseProduct(here_.x - previous_.x);
  const double chord_lambda = here_.lambda - previous_.lambda, length = std::hypot(chord.norm(), chord_lambda);
  const double rest = 1 - part, a = rest * rest * (1 + 2 * part), b = part * part * (3 - 2 * part);
  const double c = length * part * rest * rest, d = -length * part * part * rest;
  place.x = a * previous_.x + b * here_.x + c * previous_.tangent + d * here_.tangent;
  place.lambda = a * previous_.lambda + b * here_.lambda + c * previous_.tangent_lambda + d * here_.tangent_lambda;
  return newton(place, chord / length, chord_lambda / length, options_.iterations);
}

bool Continuation::between_at(double lambda, BranchPlace& place) {
  const double part = (lambda - previous_.lambda) / (here_.lambda - previous_.lambda);
  place.x = previous_.x + part * (here_.x - previous_.x);
  place.lambda = lambda;
  if (!newton(place, VectorXd::Zero(curve_.size()), 1, options_.iterations)) return false;
  const double direction = here_.lambda > previous_.lambda ? 1 : -1;
  place.tangent *= direction;
  place.tangent_lambda *= direction;
  return true;
}

double root_between(double f0, double f1, const std::function<double(double)>& f) {
  double low = 0, high = 1;
  int side = 0;
  for (int i = 0; i < 60 && high - low > 1e-10; ++i) {
    double at = (low * f1 - high * f0) / (f1 - f0);
    if (!(at > low && at < high)) at = 0.5 * (low + high);
    const double value = f(at);
    if (value == 0 || !std::isfinite(value)) return at;
    if ((value > 0) == (f1 > 0)) {
      high = at;
      f1 = value;
      if (side == 1) f0 *= 0.5;
      side = 1;
    } else {
      low = at;
      f0 = value;
      if (side == -1) f1 *= 0.5;
      side = -1;
    }
    if (std::abs(value) < 1e-12) return at;
  }
  return 0.5 * (low + high);
}

}  // namespace lunid
