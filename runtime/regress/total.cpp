// Total least squares, generalised to errors of any covariance.
#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

#include "regress/reduce.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {
namespace {

using detail::Problem;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns [features, target] of a reduced problem as combinations of the data's: (n + 1) x (f + 1).
MatrixXd combinations(const Problem& p, int features) {
  const Index f = p.r.cols();
  MatrixXd t = MatrixXd::Zero(features + 1, f + 1);
  for (Index k = 0; k < f; ++k) t(p.columns[static_cast<std::size_t>(k)], k) = 1 / p.size[k];
  t.col(f).head(features) = -p.held;
  t(features, f) = 1;
  return t;
}

}  // namespace

Fit total_least_squares(const Statistic& data, const MatrixXd& noise, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  detail::only_fixed("total_least_squares", data, constraints);
  const int n = data.features();
  if (noise.cols() != n + 1)
    throw InputError("total_least_squares: noise: expected " + std::to_string(n + 1) + " columns, got " +
                     std::to_string(noise.cols()));
  const Problem p = detail::reduce(data, constraints);
  Fit fit = report(p, solve(p, data, constraints), data, constraints);
  fit.summary.solver = "total least squares";
  const Index f = p.r.cols();
  const MatrixXd t = combinations(p, n), d = noise * t;
  LongMatrix factor = LongMatrix::Zero(f + 1, f + 1);
  triangularise(factor, data.factor() * t.cast<long double>());
  const MatrixXd a = factor.cast<double>();
  const double target = a.col(f).norm();
  fit.summary.stopped = "an exact equation, as least squares";
  if (std::abs(a(f, f)) > 1e-14 * target && d.norm() > 0) {
    // min |a x|^2 / |d x|^2 is the largest singular value of d a^-1: no square of a condition, and d may be singular.
    const MatrixXd turned = a.transpose().triangularView<Eigen::Lower>().solve(d.transpose()).transpose();
    const Eigen::JacobiSVD<MatrixXd> svd(turned, Eigen::ComputeThinV);
    const VectorXd x = a.triangularView<Eigen::Upper>().solve(svd.matrixV().col(0));
    const bool generic = std::abs(x[f]) * target > 1e-10 * (a * x).norm() && std::isfinite(x.sum());
    fit.summary.converged = generic;
    fit.summary.stopped = generic ? "optimal"
                                  : "the least change leaves the target out: the features alone are nearly "
                                    "dependent, least squares is given instead";
    if (generic) {
      fit.coefficients = expand(p, -x.head(f) / x[f]);
      detail::rescore(fit, data);
      const double share = 1 / (svd.singularValues()[0] * svd.singularValues()[0]);
      const MatrixXd gram =
          a.leftCols(f).transpose() * a.leftCols(f) - share * d.leftCols(f).transpose() * d.leftCols(f);
      const Eigen::LLT<MatrixXd> root(gram);
      const bool definite = root.info() == Eigen::Success;
      detail::set_covariance(
          fit, p, definite ? MatrixXd(root.solve(MatrixXd::Identity(f, f))) : MatrixXd::Constant(f, f, std::nan("")));
    }
  }
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
