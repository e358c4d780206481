#include "regress/curve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "expr/digits.hpp"
#include "regress/curve_pass.hpp"
#include "regress/dense.hpp"
#include "regress/stopwatch.hpp"
#include "regress/trust_region.hpp"

namespace lunid {

using detail::CurvePass;
using detail::full_rank;
using detail::Tangent;
using detail::trust_step;
using detail::TrustStep;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kFine = 1e-9;  // residual over response below which extended precision tells more

/// A search from one first guess.
class Search {
 public:
  Search(CurvePass& pass, const CurveOptions& options) : pass_(pass), options_(options) {
    for (const CurveParameter& p : options.parameters) {
      min_.push_back(p.min);
      max_.push_back(p.max);
    }
  }

  void run(VectorXd start, double first_radius);
  bool better_than(const Search& other) const {
    const double least = other.at.rss(), rounding = 1e-9 * least;
    return at.rss() < least - rounding || (converged && !other.converged && at.rss() <= least + rounding);
  }

  VectorXd theta;
  Tangent at;
  std::vector<Index> free;  ///< parameters that no bound holds
  double offset = 0;
  int iterations = 0;
  bool converged = false;
  std::string stopped;

 private:
  void hold();
  void accept(VectorXd next, Tangent tangent);
  VectorXd within(VectorXd x) const;
  LongMatrix reduced(LongVector& z) const;
  bool finished();
  double predicted(const VectorXd& change) const;
  bool attempt(double& radius);
  void polish();
  void refine();

  CurvePass& pass_;
  const CurveOptions& options_;
  std::vector<double> min_, max_;
  VectorXd scale_;
};

VectorXd Search::within(VectorXd x) const {
  for (Index i = 0; i < x.size(); ++i)
    x[i] = std::clamp(x[i], min_[static_cast<std::size_t>(i)], max_[static_cast<std::size_t>(i)]);
  return x;
}

/// Finds the free parameters: all but those at a bound that the descent pushes against.
void Search::hold() {
  const VectorXd descent = (at.r().transpose() * at.z()).cast<double>();
  free.clear();
  for (Index i = 0; i < theta.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool held = (theta[i] <= min_[k] && descent[i] <= 0) || (theta[i] >= max_[k] && descent[i] >= 0);
    if (!held) free.push_back(i);
  }
}

/// The factor of the free parameters' columns, and what of the residual lies in them.
LongMatrix Search::reduced(LongVector& z) const {
  const Index k = static_cast<Index>(free.size());
  LongMatrix block(at.factor.rows(), k + 1), r = LongMatrix::Zero(k + 1, k + 1);
  for (Index j = 0; j < k; ++j) block.col(j) = at.factor.col(free[static_cast<std::size_t>(j)]);
  block.col(k) = at.factor.col(at.factor.cols() - 1);
  triangularise(r, block);
  z = r.col(k).head(k);
  return r.topLeftCorner(k, k);
}

void Search::accept(VectorXd next, Tangent tangent) {
  theta = std::move(next);
  at = std::move(tangent);
  for (Index i = 0; i < theta.size(); ++i) scale_[i] = std::max(scale_[i], static_cast<double>(at.r().col(i).norm()));
  hold();
}

/// True where the tangent plane explains no more of the residual.
bool Search::finished() {
  LongVector z;
  reduced(z);
  const double explained = static_cast<double>(z.squaredNorm()), left = at.rss() - explained;
  const double spent = static_cast<double>(free.size()), rows = static_cast<double>(pass_.rows());
  offset = explained == 0 ? 0 : std::sqrt(explained / std::max(1.0, spent));
  if (explained > 0) offset /= std::sqrt(std::max(left, 0.0) / std::max(1.0, rows - spent));
  if (free.empty()) {
    stopped = "every parameter is at a bound";
  } else if (at.rss() == 0) {
    stopped = "the residual is 0";
  } else if (offset <= options_.tolerance) {
    stopped = "relative offset <= " + exact_number(options_.tolerance);
  } else {
    return false;
  }
  return converged = true;
}

/// Drop of the sum of squares by a change, to first order of the formula.
double Search::predicted(const VectorXd& change) const {
  const LongVector left = at.z() - at.r() * change.cast<long double>();
  return static_cast<double>(at.z().squaredNorm() - left.squaredNorm());
}

/// One trial step; false where no further one can help.
bool Search::attempt(double& radius) {
  LongVector z;
  const LongMatrix r = reduced(z);
  VectorXd scale(static_cast<Index>(free.size()));
  for (Index j = 0; j < scale.size(); ++j) {
    scale[j] = scale_[free[static_cast<std::size_t>(j)]];
    if (!(scale[j] > 0)) scale[j] = 1;
  }
  const TrustStep step = trust_step(r, z, scale, radius);
  VectorXd next = theta;
  for (Index j = 0; j < scale.size(); ++j) next[free[static_cast<std::size_t>(j)]] += step.change[j];
  next = within(std::move(next));
  const VectorXd change = next - theta;
  const double promise = predicted(change), rss = at.rss();
  if ((change.array().abs() <= 2 * kEpsilon * theta.array().abs()).all()) {
    stopped = "the step is below rounding";
    converged = true;
    return false;
  }
  Tangent tangent = promise > 0 ? pass_.at(next) : Tangent{{}, false};
  const double drop = tangent.finite ? rss - tangent.rss() : -std::numeric_limits<double>::infinity();
  const double ratio = promise > 0 ? drop / promise : -1;
  if (promise > 0 && promise <= 4 * kEpsilon * rss && std::abs(drop) <= 4 * kEpsilon * rss) {
    if (drop >= 0) accept(std::move(next), std::move(tangent));
    stopped = "the sum of squares changes by rounding only";
    converged = true;
    return false;
  }
  if (!(ratio > 0.25)) {
    radius = std::min(radius, step.length) * (tangent.finite ? 0.4 : 0.1);
  } else if (ratio > 0.75 || step.inner) {
    radius = std::max(radius, 2 * step.length);
  }
  if (ratio > 1e-4) accept(std::move(next), std::move(tangent));
  return true;
}

/// Gauss-Newton steps that lower what the tangent plane explains, where the sum of squares itself is flat to rounding.
void Search::polish() {
  for (int i = 0; i < 20 && !free.empty() && offset > 0; ++i) {
    LongVector z;
    const LongMatrix r = reduced(z);
    if (!full_rank(r)) return;
    const LongVector change = r.triangularView<Eigen::Upper>().solve(z);
    VectorXd next = theta;
    for (std::size_t j = 0; j < free.size(); ++j) next[free[j]] += static_cast<double>(change[static_cast<Index>(j)]);
    next = within(std::move(next));
    Tangent tangent = pass_.at(next);
    if (!tangent.finite || !(tangent.rss() <= at.rss() * (1 + 1e-12))) return;
    const VectorXd before = theta;
    Tangent kept = at;
    const double reached = offset;
    const bool done = converged;
    const std::string said = stopped;
    accept(std::move(next), std::move(tangent));
    finished();
    converged = done;
    stopped = said;
    if (offset < reached) continue;
    theta = before;
    at = std::move(kept);
    hold();
    offset = reached;
    return;
  }
}

/// Residuals near the rounding of the response say little in double: Gauss-Newton steps with extended ones.
void Search::refine() {
  const double size = std::sqrt(pass_.total());
  if (!(size > 0) || free.empty() || std::sqrt(at.rss()) > kFine * size) return;
  for (int i = 0; i < 3; ++i) {
    Tangent tangent = pass_.refined(theta);
    if (!tangent.finite) return;
    accept(theta, std::move(tangent));
    LongVector z;
    const LongMatrix r = reduced(z);
    if (!full_rank(r)) return;
    const LongVector change = r.triangularView<Eigen::Upper>().solve(z);
    for (std::size_t j = 0; j < free.size(); ++j) theta[free[j]] += static_cast<double>(change[static_cast<Index>(j)]);
    theta = within(std::move(theta));
  }
  if (Tangent tangent = pass_.refined(theta); tangent.finite) accept(theta, std::move(tangent));
}

void Search::run(VectorXd start, double first_radius) {
  theta = within(std::move(start));
  at = pass_.at(theta);
  if (!at.finite) pass_.refuse(theta);
  scale_ = VectorXd::Zero(theta.size());
  iterations = 0;
  converged = false;
  accept(theta, at);
  const double size = scale_.cwiseProduct(theta).norm();
  double radius = first_radius * (size > 0 ? size : 1);
  stopped = "max_iterations reached";
  for (; iterations < options_.max_iterations && !finished(); ++iterations)
    if (!attempt(radius)) break;
  polish();
  refine();
}

void validate_parameter(const CurveParameter& p, const CurveOptions& options, Expr symbol) {
  const std::string where = "fit_curve: parameter '" + p.name + "'";
  if (!(p.min < p.max))
    throw InputError(where + ": expected min < max, got " + exact_number(p.min) + " and " + exact_number(p.max));
  if (!std::isfinite(p.value)) throw InputError(where + ": expected a first guess, got " + exact_number(p.value));
  if (!(p.value >= p.min && p.value <= p.max))
    throw InputError(where + ": expected a first guess in " + exact_number(p.min) + ".." + exact_number(p.max) +
                     ", got " + exact_number(p.value));
  if (!symbol.valid() || !depends_on(options.formula, symbol)) throw InputError(where + " is not in the formula");
  if (std::count_if(options.parameters.begin(), options.parameters.end(),
                    [&](const CurveParameter& other) { return other.name == p.name; }) > 1)
    throw InputError(where + " is given twice");
}

/// Values, covariance and scores of the best search.
void finish(CurveFit& fit, const Search& best, const CurvePass& pass) {
  const Index k = best.theta.size(), spent = static_cast<Index>(best.free.size());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const double rows = static_cast<double>(pass.rows());
  fit.rows = pass.rows();
  fit.rss = best.at.rss();
  fit.rmse = std::sqrt(fit.rss / rows);
  fit.r2 = pass.total() > 0 ? 1 - fit.rss / pass.total() : nan;
  fit.residual_std = fit.rows > spent ? std::sqrt(fit.rss / static_cast<double>(fit.rows - spent)) : nan;
  fit.covariance = MatrixXd::Constant(k, k, nan);
  for (Index i = 0; i < k; ++i) {
    CurveParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    p.value = best.theta[i];
    p.at_bound = std::find(best.free.begin(), best.free.end(), i) == best.free.end();
  }
  // A column at a time, so that one which the ones before it explain is left out by name.
  std::vector<Index> excited;
  LongMatrix r;
  for (const Index i : best.free) {
    std::vector<Index> tried = excited;
    tried.push_back(i);
    LongMatrix block(best.at.factor.rows(), static_cast<Index>(tried.size()));
    for (std::size_t j = 0; j < tried.size(); ++j) {
      block.col(static_cast<Index>(j)) = best.at.factor.col(tried[j]);
      const long double length = block.col(static_cast<Index>(j)).norm();
      if (length > 0) block.col(static_cast<Index>(j)) /= length;
    }
    LongMatrix next = LongMatrix::Zero(block.cols(), block.cols());
    triangularise(next, block);
    if (full_rank(next) && next(next.rows() - 1, next.rows() - 1) != 0) {
      excited = std::move(tried);
      r = std::move(next);
    } else {
      fit.parameters[static_cast<std::size_t>(i)].unexcited = true;
    }
  }
  if (excited.empty()) return;
  fit.condition = detail::condition_number(r.triangularView<Eigen::Upper>().toDenseMatrix().cast<double>());
  const LongMatrix inverse = r.triangularView<Eigen::Upper>().solve(LongMatrix::Identity(r.rows(), r.rows()));
  const LongMatrix unit = inverse * inverse.transpose();
  const auto length = [&](std::size_t j) { return best.at.factor.col(excited[j]).norm(); };
  const long double variance = static_cast<long double>(fit.residual_std) * fit.residual_std;
  for (std::size_t a = 0; a < excited.size(); ++a)
    for (std::size_t b = 0; b < excited.size(); ++b)
      fit.covariance(excited[a], excited[b]) =
          static_cast<double>(variance * unit(static_cast<Index>(a), static_cast<Index>(b)) / (length(a) * length(b)));
  for (const Index i : excited) fit.parameters[static_cast<std::size_t>(i)].std = std::sqrt(fit.covariance(i, i));
}

Expr with_values(const CurveOptions& options, const CurveFit& fit) {
  Pool& pool = options.formula.pool();
  std::vector<std::pair<Expr, Expr>> values;
  for (const CurveParameter& p : fit.parameters) values.emplace_back(pool.parameter(p.name), pool.constant(p.value));
  for (const auto& [name, value] : options.values) values.emplace_back(pool.parameter(name), pool.constant(value));
  return substitute(options.formula, values);
}

}  // namespace

void validate(const CurveOptions& options) {
  if (!options.formula.valid() || !options.response.valid())
    throw InputError("fit_curve: expected a formula and a response");
  if (options.parameters.empty()) throw InputError("fit_curve: the formula has no parameter to fit");
  for (const CurveParameter& p : options.parameters)
    validate_parameter(p, options, options.formula.pool().find(p.name));
  if (options.max_iterations < 1)
    throw InputError("fit_curve: max_iterations: expected >= 1, got " + std::to_string(options.max_iterations));
  if (!(options.tolerance > 0) || std::isinf(options.tolerance))
    throw InputError("fit_curve: tolerance: expected > 0, got " + exact_number(options.tolerance));
  for (const Expr part : {options.response, options.weight}) {
    if (!part.valid()) continue;
    const std::vector<Expr> found = symbols(part, SymbolKind::parameter);
    if (!found.empty())
      throw InputError("fit_curve: expected no parameter in the response and the weight, got '" + found.front().name() +
                       "'");
  }
  for (const Expr& s : symbols(options.formula, SymbolKind::parameter)) {
    const bool fitted = std::any_of(options.parameters.begin(), options.parameters.end(),
                                    [&](const CurveParameter& p) { return p.name == s.name(); });
    if (fitted == (options.values.count(s.name()) > 0))
      throw InputError("fit_curve: parameter '" + s.name() + "': expected either a first guess or a fixed value");
  }
}

CurveFit fit_curve(std::span<const Record> records, const CurveOptions& options) {
  const detail::Stopwatch watch;
  validate(options);
  if (records.empty()) throw InputError("fit_curve: expected at least one record");
  CurvePass pass(records, options);
  const auto k = static_cast<Index>(options.parameters.size());
  if (pass.rows() < k)
    throw InputError("fit_curve: " + std::to_string(pass.rows()) + " rows for " + std::to_string(k) +
                         " parameters: expected at least as many rows",
                     {}, Fault::data);
  VectorXd start(k);
  for (Index i = 0; i < k; ++i) start[i] = options.parameters[static_cast<std::size_t>(i)].value;

  CurveFit fit;
  fit.parameters = options.parameters;
  constexpr double radii[] = {10, 0.1, 1e-3};  // of the first trust region, over the size of the start
  std::optional<Search> best;
  for (const double radius : radii) {
    Search search(pass, options);
    search.run(start, radius);
    fit.iterations += search.iterations;
    if (!best || search.better_than(*best)) best.emplace(std::move(search));
  }
  fit.offset = best->offset;
  fit.converged = best->converged;
  fit.stopped = best->stopped;
  fit.evaluations = pass.evaluations();
  finish(fit, *best, pass);
  fit.formula = with_values(options, fit);
  fit.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
