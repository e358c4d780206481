#include "statistics/agreement.hpp"

#include <algorithm>
#include <vector>

#include "statistics/bootstrap.hpp"
#include "statistics/checks.hpp"
#include "statistics/fit_measures.hpp"
#include "statistics/mutual_information.hpp"
#include "statistics/quantiles.hpp"
#include "statistics/rank_correlation.hpp"
#include "statistics/warping.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

bool varies(std::span<const double> x) {
  return std::any_of(x.begin(), x.end(), [&](double value) { return value != x[0]; });
}

VectorXd chosen(std::span<const double> x, std::span<const Index> rows) {
  return VectorXd::NullaryExpr(static_cast<Index>(rows.size()),
                               [&](Index i) { return x[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])]; });
}

void add_tests(const VectorXd& residual, const ComparedColumns& columns, int most_lags, Agreement& result) {
  if (!varies(span_of(residual))) return;
  const int lags = std::min(most_lags, static_cast<int>(residual.size() / 4));
  result.qqcc = quantile_correlation(normal_quantiles(span_of(residual)));
  result.white = whiteness(span_of(residual), lags);
  result.runs = runs_test(span_of(residual));
  if (!columns.input.empty() && varies(columns.input))
    result.follows = cross_correlation(span_of(residual), columns.input, lags);
}

void add_intervals(const VectorXd& residual, const ComparedColumns& columns, const AgreementOptions& options,
                   Agreement& result) {
  const bool orders = varies(columns.model);
  IntervalOptions how{options.level, options.draws, 1, options.seed, options.threads};
  // Ranks and R2 hang on the motion, whose colour is the stronger one as a rule.
  result.block_length = std::max(choose_block_length(span_of(residual)), choose_block_length(columns.measured));
  how.block_length = result.block_length;
  const auto rows = static_cast<Index>(columns.measured.size());
  const auto found = bootstrap_intervals(
      rows,
      [&](std::span<const Index> of) {
        const VectorXd a = chosen(columns.measured, of), b = chosen(columns.model, of);
        VectorXd values = VectorXd::Zero(6);
        values.head(4) << rmse(span_of(a), span_of(b)), nrmse(span_of(a), span_of(b)),
            r_squared(span_of(a), span_of(b)), fit_percent(span_of(a), span_of(b));
        if (orders)
          values.tail(2) << spearman(span_of(a), span_of(b)).coefficient, kendall(span_of(a), span_of(b)).coefficient;
        return values;
      },
      how);
  const char* names[] = {"rmse", "nrmse", "r2", "fit", "spearman", "kendall"};
  for (std::size_t i = 0; i < (orders ? 6 : 4); ++i) result.intervals[names[i]] = found[i];
  if (!orders) return;
  const NeighbourOptions near{options.neighbours, 1};
  result.intervals["mutual_information"] = jackknife_intervals(
      rows,
      [&](std::span<const Index> of) {
        const VectorXd a = chosen(columns.measured, of), b = chosen(columns.model, of);
        return VectorXd::Constant(1, mutual_information(span_of(b), span_of(a), near));
      },
      how)[0];
}

}  // namespace

Agreement agreement(const ComparedColumns& columns, const AgreementOptions& options) {
  check_columns("compare: measured", {columns.measured}, {.rows = 20});
  check_columns("compare: measured and model", {columns.measured, columns.model}, {.may_be_constant = true});
  Agreement result;
  result.rows = static_cast<Index>(columns.measured.size());
  result.rmse = rmse(columns.measured, columns.model);
  result.nrmse = nrmse(columns.measured, columns.model);
  result.r2 = r_squared(columns.measured, columns.model);
  result.fit = fit_percent(columns.measured, columns.model);
  if (varies(columns.model)) {
    result.mutual_information =
        mutual_information(columns.model, columns.measured, {options.neighbours, options.threads});
    result.spearman = spearman(columns.measured, columns.model);
    result.kendall = kendall(columns.measured, columns.model);
  }
  if (!columns.measured_rate.empty()) {
    result.band = options.band < 0 && result.rows > 10000 ? Index{50'000'000} / result.rows : options.band;
    result.dtw = phase_portrait_distance(columns.measured, columns.measured_rate, columns.model, columns.model_rate,
                                         result.band);
  }
  const VectorXd residual = VectorXd::NullaryExpr(result.rows, [&](Index i) {
    return columns.measured[static_cast<std::size_t>(i)] - columns.model[static_cast<std::size_t>(i)];
  });
  add_tests(residual, columns, options.lags, result);
  if (options.level > 0) add_intervals(residual, columns, options, result);
  return result;
}

}  // namespace lunid
