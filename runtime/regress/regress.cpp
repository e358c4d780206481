#include "regress/regress.hpp"

#include <algorithm>
#include <cmath>

#include "expr/external.hpp"
#include "regress/columns.hpp"
#include "regress/implicit.hpp"
#include "regress/number.hpp"
#include "regress/reduce.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

using detail::number;
using Eigen::Index;
using Eigen::VectorXd;

TermConstraint at_least(Expr feature, double bound) {
  TermConstraint c;
  c.terms = {{feature, 1.0}};
  c.lower = bound;
  return c;
}

TermConstraint at_most(Expr feature, double bound) {
  TermConstraint c;
  c.terms = {{feature, 1.0}};
  c.upper = bound;
  return c;
}

TermConstraint at_most(Expr smaller, Expr larger) {
  TermConstraint c;
  c.terms = {{larger, 1.0}, {smaller, -1.0}};
  c.lower = 0;
  return c;
}

TermConstraint between(Expr feature, double lower, double upper) {
  TermConstraint c = at_least(feature, lower);
  c.upper = upper;
  return c;
}

TermConstraint fixed(Expr feature, double value) { return between(feature, value, value); }

namespace {

struct ValidateSolver {
  void operator()(const LeastSquaresOptions&) const {}
  template <class Options>
  void operator()(const Options& options) const {
    validate(options);
  }
};

void validate_implicit(const ImplicitParameter& p, const RegressOptions& options) {
  if (!std::isfinite(p.min) || !std::isfinite(p.max) || !(p.min < p.max))
    throw InputError("regress: implicit parameter '" + p.name + "': expected finite bounds min < max, got " +
                     number(p.min) + " and " + number(p.max));
  if (!(p.value >= p.min && p.value <= p.max))
    throw InputError("regress: implicit parameter '" + p.name + "': expected a first guess in " + number(p.min) + ".." +
                     number(p.max) + ", got " + number(p.value));
  if (options.values.count(p.name))
    throw InputError("regress: parameter '" + p.name + "' has a value and is implicit too: expected one of both");
}

/// F - m*a - known
Expr target_of(const RegressOptions& options) {
  Pool& pool = options.features.front().pool();
  Expr target = pool.channel("F");
  if (options.mass.valid() && !options.mass.is_constant(0)) target = target - options.mass * pool.channel("a");
  if (options.known.valid()) target = target - options.known;
  return target;
}

/// Every parameter must have a value; those in mass and known must not be searched for.
void check_parameters(const RegressOptions& options, Expr target) {
  const auto implicit = [&](const std::string& name) {
    return std::any_of(options.implicit.begin(), options.implicit.end(), [&](const auto& p) { return p.name == name; });
  };
  for (const Expr& s : symbols(target, SymbolKind::parameter))
    if (!options.values.count(s.name()))
      throw InputError("regress: parameter '" + s.name() +
                       "' in the mass or the known part has no value: give one, or fit it as the coefficient of a "
                       "feature (for a mass: mass 0 and the feature a)");
  for (const Expr& f : options.features)
    for (const Expr& s : symbols(f, SymbolKind::parameter))
      if (!options.values.count(s.name()) && !implicit(s.name()))
        throw InputError("regress: parameter '" + s.name() + "' in feature '" + to_text(f) +
                         "' has no value: fix it, or give it min and max to have it searched for");
}

std::vector<Constraint> by_feature(const RegressOptions& options) {
  std::vector<std::string> names;
  for (const Expr& f : options.features) names.push_back(to_text(f));
  std::vector<Constraint> out;
  for (const TermConstraint& c : options.constraints) {
    Constraint row{{}, c.lower, c.upper, c.where};
    for (const auto& [feature, weight] : c.terms) {
      const auto found = std::find(options.features.begin(), options.features.end(), feature);
      if (found == options.features.end()) {
        const std::string text = to_text(feature), near = nearest_word(text, names);
        throw InputError("constraint: '" + text + "' is not among the features" +
                             (near.empty() ? "" : ", did you mean '" + near + "'?"),
                         c.where);
      }
      row.terms.emplace_back(static_cast<int>(found - options.features.begin()), weight);
    }
    out.push_back(std::move(row));
  }
  return out;
}

Fit solve(const RegressionSolver& solver, std::span<const Statistic> blocks, std::span<const Constraint> constraints,
          std::vector<PathPoint>& path) {
  if (const auto* o = std::get_if<LassoOptions>(&solver))
    return lasso(blocks, *o, constraints, o->lambda ? nullptr : &path);
  const Statistic data = merged(blocks);
  if (const auto* o = std::get_if<RidgeOptions>(&solver)) return ridge(data, *o, constraints);
  if (const auto* o = std::get_if<StlsqOptions>(&solver)) return stlsq(data, *o, constraints);
  return least_squares(data, constraints);
}

/// Spread of the coefficients when each block of time is left out in turn (Efron & Stein 1981, Ann. Stat. 9, 586), by
/// least squares on the selected features. NaN with fewer than 3 blocks, or where a block alone excites a feature.
VectorXd block_deviations(std::span<const Statistic> blocks, std::span<const Constraint> constraints, const Fit& fit) {
  const Index n = fit.coefficients.size(), count = static_cast<Index>(blocks.size());
  const VectorXd none = VectorXd::Constant(n, std::nan(""));
  if (count < 3) return none;
  std::vector<bool> zero(static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j) zero[static_cast<std::size_t>(j)] = fit.coefficients[j] == 0;
  Eigen::MatrixXd left(n, count);
  for (Index k = 0; k < count; ++k) {
    Statistic rest(fit.features);
    for (Index i = 0; i < count; ++i)
      if (i != k) rest.merge(blocks[static_cast<std::size_t>(i)]);
    const VectorXd rms = rest.rms();
    for (Index j = 0; j < n; ++j)
      if (rms[j] == 0 && fit.coefficients[j] != 0) return none;
    const detail::Problem problem = detail::reduce(rest, constraints, zero);
    left.col(k) = detail::expand(problem, detail::solve(problem, rest, constraints).u);
  }
  const VectorXd mean = left.rowwise().mean();
  const double k = static_cast<double>(count);
  return ((left.colwise() - mean).rowwise().squaredNorm() * ((k - 1) / k)).cwiseSqrt();
}

std::string describe(const Record& record) {
  return record.name() + ", " + number(record.start(), 6) + " to " + number(record.start() + record.duration(), 6) +
         " s, " + std::to_string(record.rows()) + " rows";
}

/// Two things that no solver can see from the result alone.
std::vector<std::string> warnings(const Fit& fit, std::span<const Record> records, const RegressOptions& options) {
  std::vector<std::string> out;
  for (const Unexcited& u : fit.unexcited)
    out.push_back(u.text + ": they cannot be told apart, '" + fit.features[static_cast<std::size_t>(u.feature)] +
                  "' is left at 0");
  if (fit.condition > 1e8)
    out.push_back("the features are nearly one another's combinations (condition " + number(fit.condition, 2) +
                  "): few digits of the coefficients mean anything");
  Pool& pool = options.features.front().pool();
  const Expr y = pool.channel("y"), a = pool.channel("a");
  const bool spring = std::find(options.features.begin(), options.features.end(), y) != options.features.end();
  const bool inertia = options.mass.valid() && !options.mass.is_constant(0);
  if (!spring || !inertia) return out;
  const auto blocks = detail::time_blocks(records, 1, 1);
  const Statistic data = merged(detail::statistics(detail::Columns({y}, a), records, blocks, {}, options.threads));
  if (data.rms()[0] == 0) return out;
  const Fit one = least_squares(data);
  if (one.r2 > 0.999)
    out.push_back("on these data a = " + number(one.coefficients[0], 4) + "*y (R2 " + number(one.r2, 6) +
                  "): one frequency, so that an error of the mass appears in the coefficient of y");
  return out;
}

Expr restoring_of(const Regression& result, const RegressOptions& options) {
  Pool& pool = options.features.front().pool();
  std::vector<std::pair<Expr, Expr>> values;
  for (const ImplicitParameter& p : result.implicit)
    values.emplace_back(pool.parameter(p.name), pool.constant(p.value));
  Expr sum = options.known;
  for (const Term& term : result.terms) {
    if (term.coefficient == 0) continue;
    const Expr part = term.coefficient * substitute(term.feature, values);
    sum = sum.valid() ? sum + part : part;
  }
  return sum.valid() ? sum : pool.constant(0);
}

/// The search for implicit parameters; `values` then holds theirs. Counts the passes over the data.
int find_implicit(Regression& result, const RegressOptions& options, Expr target,
                  std::span<const Constraint> constraints, std::span<const Record> records,
                  std::span<const detail::TimeBlock> blocks, std::map<std::string, double>& values) {
  if (options.implicit.empty()) return 0;
  int passes = 0;
  result.implicit = detail::search({options.features, target, constraints, records, blocks, &options.values,
                                    options.threads, options.search, options.objective.mean_force},
                                   options.implicit, passes);
  for (const ImplicitParameter& p : result.implicit) values[p.name] = p.value;
  return passes;
}

void add_terms(Regression& result, const RegressOptions& options, const VectorXd& block_std) {
  for (std::size_t j = 0; j < options.features.size(); ++j) {
    const Index i = static_cast<Index>(j);
    result.terms.push_back(
        {options.features[j], result.fit.coefficients[i], result.fit.std[i], block_std[i], result.fit.contribution[i]});
  }
}

}  // namespace

void validate(const RegressOptions& options) {
  if (options.features.empty()) throw InputError("regress: features: expected at least one");
  for (const Expr& f : options.features)
    if (!f.valid() || &f.pool() != &options.features.front().pool())
      throw InputError("regress: features: expected expressions of one pool");
  if (options.blocks < 1 || options.blocks > 1000)
    throw InputError("regress: blocks: expected 1 to 1000, got " + std::to_string(options.blocks));
  validate(options.search);
  if (!(options.objective.mean_force >= 0 && options.objective.mean_force < 1))
    throw InputError("regress: objective: mean_force: expected >= 0 and < 1, got " +
                     number(options.objective.mean_force));
  if (options.threads < 0) throw InputError("regress: threads: expected >= 0, got " + std::to_string(options.threads));
  for (const ImplicitParameter& p : options.implicit) validate_implicit(p, options);
  std::visit(ValidateSolver{}, options.solver);
}

Regression regress(std::span<const Record> records, const RegressOptions& options) {
  const detail::Stopwatch watch;
  validate(options);
  if (records.empty()) throw InputError("regress: expected at least one record");
  const ExternalWatch externals(options.features.front().pool());
  const Expr target = target_of(options);
  check_parameters(options, target);
  const std::vector<Constraint> constraints = by_feature(options);
  const auto blocks = detail::time_blocks(records, options.blocks, static_cast<Index>(options.features.size()) + 1);

  Regression result;
  result.mode = "equation error, train";
  std::map<std::string, double> known = options.values;
  result.passes = find_implicit(result, options, target, constraints, records, blocks, known);
  const detail::Columns columns(options.features, target);
  std::vector<double> values;
  for (const std::string& name : columns.parameters()) values.push_back(known.at(name));
  std::vector<Statistic> parts = detail::statistics(columns, records, blocks, values, options.threads);
  const Statistic all = merged(parts);
  if (options.objective.mean_force > 0)
    for (Statistic& part : parts) part.weigh_mean(options.objective.mean_force);
  result.fit = solve(options.solver, parts, constraints, result.path);
  result.fit.rmse = std::sqrt(all.residual_sum(result.fit.coefficients) / static_cast<double>(all.rows()));
  add_terms(result, options, block_deviations(parts, constraints, result.fit));
  const double spread = all.deviation()[all.features()];
  result.rmse = result.fit.rmse;
  result.r2 = spread > 0 ? 1 - result.rmse * result.rmse / (spread * spread) : std::nan("");
  for (const Record& record : records) result.windows.push_back(describe(record));
  result.warnings = warnings(result.fit, records, options);
  result.restoring = restoring_of(result, options);
  if (result.passes > 0)
    result.fit.summary.solver += ", around " + to_text(options.search.method) + " on " +
                                 std::to_string(options.implicit.size()) + " implicit parameters (" +
                                 std::to_string(result.passes) + " passes)";
  result.fit.summary.seconds = watch.seconds();
  for (std::string& note : externals.notes(result.fit.summary.seconds)) result.warnings.push_back(std::move(note));
  return result;
}

}  // namespace lunid
