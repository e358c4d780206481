// Instrumental variables: two-stage least squares on the triangular factor of features, instruments and target.
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "regress/reduce.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double dependent = 1e-10;  ///< what a column adds to those before it, of its length

/// The triangular factor of `columns`, without the first ones that are combinations of those before them.
MatrixXd factor_of_independent(LongMatrix columns, Index& first) {
  for (;;) {
    LongMatrix factor = LongMatrix::Zero(columns.cols(), columns.cols());
    LongMatrix work = columns;
    triangularise(factor, work);
    Index out = 0;
    while (out < first && std::abs(factor(out, out)) > dependent * factor.col(out).norm()) ++out;
    if (out == first) return factor.cast<double>();
    LongMatrix kept(columns.rows(), columns.cols() - 1);
    kept << columns.leftCols(out), columns.rightCols(columns.cols() - out - 1);
    columns = std::move(kept);
    --first;
  }
}

}  // namespace

Fit instrumental_variables(const Statistic& data, int features, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  const Statistic own = data.leading(features);
  detail::only_fixed("instrumental_variables", own, constraints);
  const detail::Problem p = detail::reduce(own, constraints);
  Fit fit = report(p, solve(p, own, constraints), own, constraints);
  const Index f = p.r.cols(), all = data.features();
  Index instruments = all - features;
  // [instruments, free features scaled, target less what is held], of the rows' factor
  MatrixXd columns = MatrixXd::Zero(all + 1, instruments + f + 1);
  columns.block(features, 0, instruments, instruments).setIdentity();
  for (Index k = 0; k < f; ++k) columns(p.columns[static_cast<std::size_t>(k)], instruments + k) = 1 / p.size[k];
  columns.col(instruments + f).head(features) = -p.held;
  columns(all, instruments + f) = 1;
  const MatrixXd r = factor_of_independent(data.factor() * columns.cast<long double>(), instruments);
  const MatrixXd projected = r.block(0, instruments, instruments, f);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(projected);
  qr.setThreshold(dependent);
  if (instruments < f || qr.rank() < f)
    throw InputError(
        "instrumental_variables: the instruments tell " + std::to_string(instruments < f ? instruments : qr.rank()) +
        " of " + std::to_string(f) +
        " coefficients apart: give further functions of what shook the system, one or more for each feature");
  fit.coefficients = expand(p, qr.solve(r.block(0, instruments + f, instruments, 1)));
  detail::rescore(fit, own);
  const MatrixXd gram = projected.transpose() * projected;
  detail::set_covariance(fit, p, gram.ldlt().solve(MatrixXd::Identity(f, f)));
  fit.summary.solver = "two-stage least squares, " + std::to_string(instruments) + " instruments";
  fit.summary.stopped = "optimal";
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
