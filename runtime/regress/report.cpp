// Scores, covariance and active bounds of a solved problem.
#include <algorithm>
#include <cmath>
#include <limits>

#include "regress/dense.hpp"
#include "regress/reduce.hpp"
#include "regress/triangle.hpp"

namespace lunid::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Orthonormal basis of the directions that the active rows leave free.
MatrixXd free_directions(const Problem& p, const Point& point) {
  const Index n = p.r.cols(), q = static_cast<Index>(point.active.size());
  if (q == 0) return MatrixXd::Identity(n, n);
  LongMatrix rows(n, q);
  for (Index k = 0; k < q; ++k)
    rows.col(k) = p.c.row(point.active[static_cast<std::size_t>(k)]).transpose().cast<long double>();
  return full_qr(rows).q.rightCols(n - q).cast<double>();
}

/// Covariance over the variance of the residual, in the scaled variables; `freedom` becomes the number of parameters
/// that the fit spends (with a penalty: its trace).
MatrixXd unit_covariance(const Problem& p, const MatrixXd& free, const MatrixXd* unpenalised, double& freedom) {
  const Index f = free.cols();
  freedom = static_cast<double>(f);
  if (f == 0) return MatrixXd::Zero(p.r.cols(), p.r.cols());
  LongMatrix triangle = LongMatrix::Zero(f, f);
  triangularise(triangle, p.exact.topLeftCorner(p.r.cols(), p.r.cols()) * free.cast<long double>());
  const MatrixXd inverse = triangle.triangularView<Eigen::Upper>().solve(LongMatrix::Identity(f, f)).cast<double>();
  MatrixXd root = free * inverse;
  if (!unpenalised) return root * root.transpose();
  const MatrixXd hat = (*unpenalised) * root;  // trace(hat' hat): effective parameters of a ridge
  freedom = hat.squaredNorm();
  return root * (hat.transpose() * hat) * root.transpose();
}

void add_active_bounds(Fit& fit, const Problem& p, const Point& point, const Statistic& data,
                       std::span<const Constraint> constraints) {
  const Triangle t = data.triangle();
  const VectorXd gradient = t.r.transpose() * (t.r * fit.coefficients - t.z);
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Constraint& c = constraints[i];
    if (c.equality() && c.terms.size() == 1)
      fit.active.push_back(
          {static_cast<int>(i), false, gradient[c.terms[0].first] / c.terms[0].second, to_text(c, data.names())});
  }
  for (int row : point.active) {
    if (row >= static_cast<int>(p.sides.size())) continue;
    const Side& side = p.sides[static_cast<std::size_t>(row)];
    fit.active.push_back({side.constraint, side.upper, point.multipliers[row] / side.size,
                          to_text(constraints[static_cast<std::size_t>(side.constraint)], data.names())});
  }
  std::stable_sort(fit.active.begin(), fit.active.end(),
                   [](const ActiveBound& a, const ActiveBound& b) { return a.constraint < b.constraint; });
}

void add_scores(Fit& fit, const Statistic& data, double freedom) {
  const int n = data.features();
  const double rss = data.residual_sum(fit.coefficients), rows = static_cast<double>(fit.rows);
  const VectorXd rms = data.rms(), deviation = data.deviation();
  fit.rmse = std::sqrt(rss / rows);
  fit.residual_std = rows > freedom ? std::sqrt(rss / (rows - freedom)) : kNan;
  const double total = data.constant_feature() >= 0 ? deviation[n] : rms[n];
  fit.r2 = total > 0 ? 1 - rss / (rows * total * total) : kNan;
  fit.contribution = fit.coefficients.cwiseAbs().cwiseProduct(rms.head(n));
  if (rms[n] > 0) fit.contribution /= rms[n];
}

/// 1 / (1 - R^2) of each free feature on the others.
void add_inflation(Fit& fit, const Problem& p, const MatrixXd& r, const Statistic& data) {
  const Index f = r.cols();
  const int constant = data.constant_feature();
  const VectorXd deviation = data.deviation();
  const MatrixXd inverse = r.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(f, f));
  const bool centred = std::find(p.columns.begin(), p.columns.end(), constant) != p.columns.end();
  fit.vif = VectorXd::Constant(data.features(), kNan);
  for (Index k = 0; k < f; ++k) {
    const int j = p.columns[static_cast<std::size_t>(k)];
    if (j == constant) continue;
    const double share = centred ? static_cast<double>(fit.rows) * std::pow(deviation[j] / p.size[k], 2) : 1;
    fit.vif[j] = inverse.row(k).squaredNorm() * share;
  }
}

}  // namespace

void set_covariance(Fit& fit, const Problem& p, const MatrixXd& unit) {
  const Index n = static_cast<Index>(fit.features.size()), f = p.r.cols();
  const double variance = fit.residual_std * fit.residual_std;
  fit.covariance = MatrixXd::Zero(n, n);
  for (Index k = 0; k < f; ++k)
    for (Index l = 0; l < f; ++l)
      fit.covariance(p.columns[static_cast<std::size_t>(k)], p.columns[static_cast<std::size_t>(l)]) =
          variance * unit(k, l) / (p.size[k] * p.size[l]);
  for (const Unexcited& u : p.unexcited) {
    fit.covariance.row(u.feature).setConstant(kNan);
    fit.covariance.col(u.feature).setConstant(kNan);
  }
  fit.std = fit.covariance.diagonal().cwiseSqrt();
}

void rescore(Fit& fit, const Statistic& data) { add_scores(fit, data, static_cast<double>(fit.free)); }

Fit report(const Problem& p, const Point& point, const Statistic& data, std::span<const Constraint> constraints,
           const MatrixXd* unpenalised) {
  Fit fit;
  fit.features = data.names();
  fit.rows = data.rows();
  fit.coefficients = expand(p, point.u);
  fit.unexcited = p.unexcited;
  const MatrixXd free = free_directions(p, point);
  fit.free = static_cast<int>(free.cols());
  double freedom = 0;
  const MatrixXd unit = unit_covariance(p, free, unpenalised, freedom);
  fit.condition = condition_number(unpenalised ? *unpenalised : p.r);
  add_scores(fit, data, freedom);
  add_inflation(fit, p, unpenalised ? *unpenalised : p.r, data);
  set_covariance(fit, p, unit);
  add_active_bounds(fit, p, point, data, constraints);
  fit.summary.iterations = point.iterations;
  fit.summary.converged = point.finished;
  fit.summary.stopped = point.finished ? "optimal" : "limit of iterations reached";
  fit.summary.kkt = point.kkt;
  return fit;
}

}  // namespace lunid::detail
