#include "regress/regress.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "expr/digits.hpp"
#include "expr/external.hpp"
#include "regress/account.hpp"
#include "regress/columns.hpp"
#include "regress/dispatch.hpp"
#include "regress/implicit.hpp"
#include "regress/lag.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

using Eigen::Index;

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

void validate_implicit(const ImplicitParameter& p, const RegressOptions& options) {
  if (!std::isfinite(p.min) || !std::isfinite(p.max) || !(p.min < p.max))
    throw InputError("regress: implicit parameter '" + p.name + "': expected finite bounds min < max, got " +
                     exact_number(p.min) + " and " + exact_number(p.max));
  if (!(p.value >= p.min && p.value <= p.max))
    throw InputError("regress: implicit parameter '" + p.name + "': expected a first guess in " + exact_number(p.min) +
                     ".." + exact_number(p.max) + ", got " + exact_number(p.value));
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

/// Its number among the features; `what` speaks of it.
int index_of(Expr feature, const RegressOptions& options, const char* what, const SourceSpan& where) {
  const auto found = std::find(options.features.begin(), options.features.end(), feature);
  if (found != options.features.end()) return static_cast<int>(found - options.features.begin());
  std::vector<std::string> names;
  for (const Expr& f : options.features) names.push_back(to_text(f));
  const std::string text = to_text(feature);
  throw InputError(
      std::string(what) + ": '" + text + "' is not among the features" + did_you_mean(nearest_word(text, names)),
      where);
}

std::vector<Constraint> by_feature(const RegressOptions& options) {
  std::vector<Constraint> out;
  for (const TermConstraint& c : options.constraints) {
    Constraint row{{}, c.lower, c.upper, c.where, {}};
    for (const auto& [feature, weight] : c.terms) {
      row.terms.emplace_back(index_of(feature, options, "constraint", c.where), weight);
    }
    out.push_back(std::move(row));
  }
  return out;
}

std::vector<detail::Choice> choices(const RegressOptions& options) {
  std::vector<detail::Choice> out;
  for (const TermGroup& group : options.groups) {
    if (group.features.empty()) throw InputError("group: expected at least one feature", group.where);
    if (group.at_most < 1)
      throw InputError("group: at_most: expected >= 1, got " + std::to_string(group.at_most), group.where);
    out.push_back({{}, group.at_most, group.where});
    for (const Expr& f : group.features) out.back().features.push_back(index_of(f, options, "group", group.where));
  }
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
                  std::span<const Constraint> constraints, std::span<const Stream> records,
                  std::span<const detail::TimeBlock> blocks, std::map<std::string, double>& values) {
  if (options.implicit.empty()) return 0;
  int passes = 0;
  result.implicit = detail::search({options.features, target, constraints, records, blocks, &options.values,
                                    options.threads, options.search, options.objective.mean_force},
                                   options.implicit, passes);
  for (const ImplicitParameter& p : result.implicit) values[p.name] = p.value;
  return passes;
}

/// The mass as a number, for the weak form.
double constant_mass(const RegressOptions& options) {
  if (!options.mass.valid()) return 0;
  Expr mass = options.mass;
  for (const Expr& s : symbols(mass)) {
    if (s.kind() != SymbolKind::parameter)
      throw InputError("weak_form: expected a mass that is a number, '" + to_text(mass) + "' depends on " + s.name());
    const std::pair<Expr, Expr> value[] = {{s, mass.pool().constant(options.values.at(s.name()))}};
    mass = substitute(mass, value);
  }
  return mass.value();
}

/// Rows of a block that a weak form or a lag cannot do without are counted in.
std::vector<detail::TimeBlock> blocks_of(std::span<const Stream> records, const RegressOptions& options, Expr target,
                                         double half_width) {
  std::vector<Expr> all = options.features;
  all.push_back(target);
  const Index lag = largest_lag(all);
  Index least = static_cast<Index>(options.features.size()) + 1;
  if (options.weak)
    for (const Stream& record : records) least = std::max<Index>(least, 8 * std::lround(half_width / record.dt()) + 1);
  return detail::time_blocks(records, options.blocks, least, lag);
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
                     exact_number(options.objective.mean_force));
  if (options.threads < 0) throw InputError("regress: threads: expected >= 0, got " + std::to_string(options.threads));
  for (const ImplicitParameter& p : options.implicit) validate_implicit(p, options);
  if (options.bootstrap != 0 && options.bootstrap < 20)
    throw InputError("regress: bootstrap: expected 20 replicates or more (or 0), got " +
                     std::to_string(options.bootstrap));
  if (!options.places.empty() && options.places.size() != options.features.size())
    throw InputError("regress: places: expected one for each feature");
  if (options.bootstrap != 0 && std::holds_alternative<InstrumentOptions>(options.solver))
    throw InputError(
        "regress: bootstrap: not with instrumental_variables, whose intervals come from blocks left out in turn: leave "
        "it out");
  if (options.passive) validate(*options.passive);
  if (options.weak) validate(*options.weak);
  std::visit(
      [](const auto& solver) {
        using Options = std::decay_t<decltype(solver)>;
        if constexpr (std::is_same_v<Options, TotalOptions> || std::is_same_v<Options, InstrumentOptions>)
          return;
        else if constexpr (std::is_constructible_v<StatisticSolver, const Options&>)
          validate(StatisticSolver(solver));
        else
          validate(solver);
      },
      options.solver);
}

namespace {

/// Gives the mean residual of each block its share of the objective.
void weigh_means(const RegressOptions& options, std::vector<Statistic>& parts) {
  const auto of_statistics = [](const auto& solver) {
    return std::is_constructible_v<StatisticSolver, decltype(solver)>;
  };
  if (options.weak || !std::visit(of_statistics, options.solver))
    throw InputError(
        "regress: objective: mean_force: not with a weak form, total_least_squares, instrumental_variables, huber or "
        "ensemble_of");
  for (Statistic& part : parts) part.weigh_mean(options.objective.mean_force);
}

/// What passivity is checked on, and what it asks of the coefficients where it is imposed.
std::optional<detail::Dissipation> dissipation_of(const RegressOptions& options,
                                                  const std::map<std::string, double>& known,
                                                  std::span<const Stream> records,
                                                  std::vector<Constraint>& constraints) {
  if (!options.passive) return std::nullopt;
  detail::Dissipation dissipation(options.features, options.known, known, options.passive->where);
  if (options.passive->impose)
    for (Constraint& c : detail::passive_constraints(dissipation, detail::motion_range(records), *options.passive))
      constraints.push_back(std::move(c));
  return dissipation;
}

/// Errors, windows and the words on how the fit was found. `whole`: the data without weights.
void add_account(Regression& result, const RegressOptions& options, const Statistic& whole,
                 std::span<const Stream> records) {
  if (options.objective.mean_force > 0)
    result.fit.rmse = std::sqrt(whole.residual_sum(result.fit.coefficients) / static_cast<double>(whole.rows()));
  const double spread = whole.deviation()[whole.features()];
  result.rmse = result.fit.rmse;
  result.r2 = spread > 0 ? 1 - result.rmse * result.rmse / (spread * spread) : std::nan("");
  for (const Stream& record : records) result.windows.push_back(detail::describe(record));
  result.warnings = detail::warnings(result, records, options, whole.constant_feature());
  result.restoring = restoring_of(result, options);
  if (result.passes > 0)
    result.fit.summary.solver += ", around " + to_text(options.search.method) + " on " +
                                 std::to_string(options.implicit.size()) + " implicit parameters (" +
                                 std::to_string(result.passes) + " passes)";
}

}  // namespace

Regression regress(std::span<const Record> records, const RegressOptions& options) {
  return regress(std::vector<Stream>(records.begin(), records.end()), options);
}

Regression regress(std::span<const Stream> records, const RegressOptions& options) {
  const detail::Stopwatch watch;
  validate(options);
  if (records.empty()) throw InputError("regress: expected at least one record");
  const ExternalWatch externals(options.features.front().pool());
  const Expr target = target_of(options);
  check_parameters(options, target);
  std::vector<Expr> all = options.features;
  all.push_back(target);
  detail::check_units(records, all);
  std::vector<Constraint> constraints = by_feature(options);
  const std::vector<detail::Choice> groups = choices(options);

  Regression result;
  result.mode = "equation error, train";
  std::optional<detail::WeakProblem> weak;
  if (options.weak)
    weak = detail::weak_problem(options.features, constant_mass(options), options.known, records, *options.weak);
  const auto blocks = blocks_of(records, options, target, weak ? weak->half_width : 0);
  std::map<std::string, double> known = options.values;
  result.passes = find_implicit(result, options, target, constraints, records, blocks, known);
  const auto dissipation = dissipation_of(options, known, records, constraints);

  const detail::Columns columns(options.features, target);
  const std::vector<double> values = columns.values(known);
  std::vector<Statistic> parts =
      weak ? detail::weak_statistics(*weak, columns.names(), *options.weak, known, records, blocks, options.threads)
           : detail::statistics(columns, records, blocks, values, options.threads);
  const Statistic whole = merged(parts);
  if (options.objective.mean_force > 0) weigh_means(options, parts);
  const detail::Data data{
      {columns, records, blocks, values, options.threads}, parts, options.features, target, &known, weak.has_value()};
  detail::Solved solved = detail::solve(options.solver, data, constraints, groups);
  result.fit = solved.fit;
  result.path = std::move(solved.path);
  result.outliers = std::move(solved.outliers);
  detail::add_terms(result, options, solved, records);
  add_account(result, options, whole, records);
  if (weak) {
    result.form = weak->text;
    result.warnings.insert(result.warnings.end(), weak->warnings.begin(), weak->warnings.end());
  }
  if (dissipation)
    result.passivity = detail::look_at(*dissipation, detail::motion_range(records), *options.passive,
                                       {result.fit.coefficients.data(), options.features.size()});
  result.fit.summary.seconds = watch.seconds();
  for (std::string& note : externals.notes()) result.warnings.push_back(std::move(note));
  return result;
}

}  // namespace lunid
