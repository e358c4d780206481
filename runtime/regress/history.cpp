#include "regress/history.hpp"

#include <algorithm>
#include <cmath>

#include "regress/fit.hpp"
#include "regress/history_rows.hpp"

namespace lunid {

using detail::HistoryRows;
using detail::HistorySignals;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr std::size_t kMostTerms = 400;

/// A monomial as what its factors before the last symbol make, the last symbol, and the power of that.
struct Monomial {
  Expr before;  // empty: 1
  std::size_t last = 0;
  int power = 1;

  Expr value(const std::vector<Expr>& symbols) const {
    const Expr end = power == 1 ? symbols[last] : pow(symbols[last], power);
    return before.valid() ? before * end : end;
  }
};

/// All monomials of the symbols up to a degree, in order of degree.
std::vector<Expr> monomials(const std::vector<Expr>& symbols, int degree) {
  std::vector<Monomial> terms;
  std::vector<Expr> all;
  for (std::size_t i = 0; i < symbols.size(); ++i) terms.push_back({{}, i, 1});
  for (int sum = 1; sum <= degree; ++sum) {
    std::vector<Monomial> next;
    for (const Monomial& term : terms) {
      all.push_back(term.value(symbols));
      if (sum == degree) continue;
      next.push_back({term.before, term.last, term.power + 1});
      for (std::size_t i = term.last + 1; i < symbols.size(); ++i) next.push_back({term.value(symbols), i, 1});
    }
    terms = std::move(next);
    if (all.size() + terms.size() > kMostTerms)
      throw InputError("history model: more than 400 terms: fewer lags, or a lower degree");
  }
  return all;
}

std::vector<Expr> features_of(Pool& pool, const HistoryOptions& options) {
  if (!options.features.empty()) return options.features;
  std::vector<Expr> lagged, all;
  for (int i = 1; i <= options.output_lags; ++i)
    lagged.push_back(pool.channel(options.output + "_" + std::to_string(i)));
  for (int i = 0; i < options.input_lags; ++i)
    lagged.push_back(pool.channel(options.input + "_" + std::to_string(options.input_delay + i)));
  all = monomials(lagged, options.degree);
  if (options.constant) all.insert(all.begin(), pool.constant(1));
  for (int i = 1; i <= options.noise_lags; ++i) all.push_back(pool.channel("e_" + std::to_string(i)));
  return all;
}

bool holds_errors(const std::vector<Expr>& features) {
  for (const Expr& f : features)
    for (const Expr& s : symbols(f))
      if (s.name().rfind("e_", 0) == 0) return true;
  return false;
}

/// The statistic of all records' rows from `from` on.
Statistic statistic(const HistoryRows& rows, const std::vector<HistorySignals>& signals,
                    const std::vector<VectorXd>& errors, Index from) {
  Statistic sum(rows.names());
  for (std::size_t r = 0; r < signals.size(); ++r)
    sum.add(rows.all(signals[r].y, signals[r].u, errors[r], from), signals[r].y.tail(signals[r].y.size() - from));
  return sum;
}

/// Prediction errors of coefficients over all records, and their sum of squares from `from` on.
double predict_all(HistoryRows& rows, const VectorXd& coefficients, const std::vector<HistorySignals>& signals,
                   Index from, std::vector<VectorXd>& errors) {
  double sum = 0;
  for (std::size_t r = 0; r < signals.size(); ++r) {
    errors[r] = detail::innovations(rows, coefficients, signals[r]);
    sum += errors[r].tail(errors[r].size() - from).squaredNorm();
  }
  return sum;
}

/// Least squares, and with errors among the features again with those of the fit before, until the coefficients rest. A
/// step that raises the prediction error is halved: the errors of a model whose noise part is unstable grow without
/// bound.
Fit solve(HistoryRows& rows, const std::vector<HistorySignals>& signals, std::vector<VectorXd>& errors, bool extended,
          Index from, HistoryModel& model) {
  constexpr double rest = 1e-8;  // relative change of the coefficients, over their sizes
  constexpr int halvings = 12;
  Fit fit = least_squares(statistic(rows, signals, errors, from));
  VectorXd at = fit.coefficients;
  std::vector<VectorXd> tried = errors;
  double least = predict_all(rows, at, signals, from, tried);
  if (extended && !std::isfinite(least)) {  // without the noise part the errors are finite
    for (Index j = 0; j < at.size(); ++j)
      if (rows.names()[static_cast<std::size_t>(j)].find("e_") != std::string::npos) at[j] = 0;
    least = predict_all(rows, at, signals, from, tried);
  }
  errors = tried;
  model.stopped = extended ? "max_passes reached" : "least squares";
  model.converged = !extended;
  for (model.passes = 1; extended && model.passes < model.options.max_passes && !model.converged; ++model.passes) {
    fit = least_squares(statistic(rows, signals, errors, from));
    const VectorXd step = fit.coefficients - at;
    double part = 1;
    bool lower = false;
    for (int i = 0; i < halvings && !lower; ++i, part *= 0.5) {
      const double sum = predict_all(rows, at + part * step, signals, from, tried);
      lower = sum < least;
      if (!lower) continue;
      at += part * step;
      least = sum;
      errors = tried;
    }
    model.converged = !lower || part * step.norm() <= rest * at.norm();
    if (model.converged) model.stopped = lower ? "the coefficients rest" : "no step lowers the prediction error";
  }
  fit.coefficients = at;
  const double n = static_cast<double>(fit.rows);
  fit.rmse = std::sqrt(least / n);
  fit.residual_std = std::sqrt(least / (n - fit.free));
  return fit;
}

/// Errors to begin with: those of a long ARX model, which whitens what the noise lags are to describe (Durbin 1960).
void first_errors(Pool& pool, const HistoryOptions& options, const std::vector<HistorySignals>& signals,
                  std::vector<VectorXd>& errors) {
  HistoryOptions longer = options;
  longer.features.clear();
  longer.noise_lags = 0;
  longer.degree = 1;
  longer.output_lags = 2 * (options.output_lags + options.noise_lags) + 5;
  longer.input_lags = longer.output_lags;
  HistoryRows rows(features_of(pool, longer), longer);
  for (const HistorySignals& s : signals)
    if (s.y.size() < 2 * rows.first() + rows.features()) return;  // too short for it: begin with no errors
  const Fit fit = least_squares(statistic(rows, signals, errors, rows.first()));
  for (std::size_t r = 0; r < signals.size(); ++r) errors[r] = detail::innovations(rows, fit.coefficients, signals[r]);
}

HistoryModel fit_from(Pool& pool, std::span<const Record> records, const HistoryOptions& options, Index from) {
  HistoryModel model;
  model.options = options;
  model.dt = records.front().dt();
  model.between = records.front().channel(options.input).between;
  const std::vector<Expr> features = features_of(pool, options);
  if (features.empty()) throw InputError("history model: expected at least one lag or feature");
  HistoryRows rows(features, options);
  std::vector<HistorySignals> signals;
  std::vector<VectorXd> errors;
  for (const Record& record : records) {
    if (std::abs(record.dt() / model.dt - 1) > 1e-9)
      throw InputError("history model: the records have different sampling times: resample them", {}, Fault::data);
    signals.push_back(detail::signals_of(record, options));
    errors.push_back(VectorXd::Zero(record.rows()));
    if (record.rows() <= 3 * std::max(from, rows.first()))
      throw InputError("history model: " + record.name() + " has " + std::to_string(record.rows()) +
                           " rows: expected more than three times the longest lag",
                       {}, Fault::data);
  }
  const bool extended = holds_errors(features);
  if (extended) first_errors(pool, options, signals, errors);
  const Fit fit = solve(rows, signals, errors, extended, std::max(from, rows.first()), model);
  for (std::size_t j = 0; j < features.size(); ++j)
    model.terms.push_back({features[j], fit.coefficients[static_cast<Index>(j)], fit.std[static_cast<Index>(j)]});
  model.covariance = fit.covariance;
  model.rows = fit.rows;
  model.residual_std = fit.residual_std;
  const double n = static_cast<double>(fit.rows), k = static_cast<double>(fit.free);
  const double likelihood = n * std::log(fit.rmse * fit.rmse);
  model.aic = likelihood + 2 * k;
  model.bic = likelihood + std::log(n) * k;
  model.residual = std::move(errors);
  return model;
}

void check_count(const char* field, int value, int least, int most) {
  if (value < least || value > most)
    throw InputError(std::string("history model: ") + field + ": expected " + std::to_string(least) + " to " +
                     std::to_string(most) + ", got " + std::to_string(value));
}

}  // namespace

void validate(const HistoryOptions& options) {
  check_count("output_lags", options.output_lags, 0, 200);
  check_count("input_lags", options.input_lags, 0, 200);
  check_count("input_delay", options.input_delay, 0, 1000);
  check_count("noise_lags", options.noise_lags, 0, 50);
  check_count("degree", options.degree, 1, 5);
  check_count("max_passes", options.max_passes, 1, 100000);
}

HistoryModel fit_history(Pool& pool, std::span<const Record> records, const HistoryOptions& options) {
  validate(options);
  if (records.empty()) throw InputError("history model: expected at least one record");
  return fit_from(pool, records, options, 0);
}

std::vector<HistoryOrder> history_orders(Pool& pool, std::span<const Record> records, const HistoryOptions& options) {
  validate(options);
  if (records.empty()) throw InputError("history model: expected at least one record");
  const Index from = std::max(options.output_lags, options.input_delay + options.input_lags - 1);
  std::vector<HistoryOrder> out;
  for (int outputs = 1; outputs <= options.output_lags; ++outputs)
    for (int inputs = 1; inputs <= options.input_lags; ++inputs) {
      HistoryOptions tried = options;
      tried.output_lags = outputs;
      tried.input_lags = inputs;
      const HistoryModel model = fit_from(pool, records, tried, from);
      out.push_back({outputs, inputs, model.residual_std, model.aic, model.bic});
    }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.bic < b.bic; });
  return out;
}

}  // namespace lunid
