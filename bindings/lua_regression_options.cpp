// What a study says of a regression: constraints, solvers, searches.
#include <cstdlib>

#include "regression.hpp"

namespace lunid::lua {

namespace {

/// "study.lua:7" as a span.
SourceSpan span_of(const std::string& place) {
  const auto colon = place.rfind(':');
  if (colon == std::string::npos) return {};
  return {place.substr(0, colon), std::atoi(place.c_str() + colon + 1), 0};
}

/// The constraint on top of the stack, as stdlib/constraints.lua made it: {terms = {{feature =, weight =}, ...}, lower
/// =, upper =, place =}.
TermConstraint read_constraint(lua_State* L) {
  TermConstraint constraint;
  with_field(L, -1, "terms", [&] {
    for_each(L, -1, [&](lua_Integer) {
      constraint.terms.emplace_back(field_value(L, -1, "feature").expr, number_field(L, -1, "weight").value_or(1));
    });
  });
  constraint.lower = number_field(L, -1, "lower").value_or(constraint.lower);
  constraint.upper = number_field(L, -1, "upper").value_or(constraint.upper);
  constraint.where = span_of(string_field(L, -1, "place").value_or(""));
  return constraint;
}

TermGroup read_group(lua_State* L) {
  TermGroup group;
  with_field(L, -1, "features",
             [&] { for_each(L, -1, [&](lua_Integer) { group.features.push_back(check_value(L, -1).expr); }); });
  group.at_most = static_cast<int>(number_field(L, -1, "at_most").value_or(1));
  group.where = span_of(string_field(L, -1, "place").value_or(""));
  return group;
}

/// Sets a field of the table on top of the stack where it is there.
template <class Number>
void read(lua_State* L, const char* field, Number& value) {
  if (const auto given = number_field(L, -1, field)) value = static_cast<Number>(*given);
}

PassiveOptions read_passive(lua_State* L) {
  PassiveOptions options;
  read(L, "points_y", options.points_y);
  read(L, "points_v", options.points_v);
  options.impose = boolean_field(L, -1, "impose", options.impose);
  options.where = span_of(string_field(L, -1, "place").value_or(""));
  return options;
}

WeakForm read_weak(lua_State* L) {
  WeakForm form;
  read(L, "half_width", form.half_width);
  read(L, "order", form.order);
  read(L, "spacing", form.spacing);
  return form;
}

Criterion read_criterion(lua_State* L) {
  return string_field(L, -1, "criterion").value_or("bic") == "bic" ? Criterion::bic : Criterion::aicc;
}

/// A lasso or an elastic net.
LassoOptions read_lasso(lua_State* L) {
  LassoOptions options;
  options.lambda = number_field(L, -1, "lambda_value");
  read(L, "mixture", options.mixture);
  read(L, "path", options.path);
  options.refit = boolean_field(L, -1, "refit", options.refit);
  return options;
}

/// The solver on top of the stack, as stdlib/solvers.lua made it; those that work on statistics.
StatisticSolver read_statistic_solver(lua_State* L, std::uint64_t seed) {
  const std::string kind = string_field(L, -1, "kind").value_or("least_squares");
  if (kind == "lasso" || kind == "elastic_net") return read_lasso(L);
  if (kind == "non_negative") return NonNegativeOptions{};
  if (kind == "ridge") {
    RidgeOptions options;
    read(L, "lambda", options.lambda);
    return options;
  }
  if (kind == "stlsq") {
    StlsqOptions options;
    read(L, "threshold", options.threshold);
    read(L, "ridge", options.ridge);
    read(L, "max_passes", options.max_passes);
    return options;
  }
  if (kind == "sr3") {
    Sr3Options options;
    read(L, "threshold", options.threshold);
    read(L, "relaxation", options.relaxation);
    options.absolute = boolean_field(L, -1, "absolute", options.absolute);
    options.refit = boolean_field(L, -1, "refit", options.refit);
    return options;
  }
  if (kind == "frols") {
    FrolsOptions options;
    read(L, "threshold", options.threshold);
    read(L, "max_terms", options.max_terms);
    return options;
  }
  if (kind == "stepwise") {
    StepwiseOptions options;
    options.criterion = read_criterion(L);
    read(L, "max_terms", options.max_terms);
    return options;
  }
  if (kind == "best_subset") {
    BestSubsetOptions options;
    options.criterion = read_criterion(L);
    read(L, "terms", options.terms);
    return options;
  }
  if (kind == "spike_slab") {
    SpikeSlabOptions options;
    read(L, "prior", options.prior);
    read(L, "cut", options.cut);
    read(L, "sweeps", options.sweeps);
    options.seed = seed;
    return options;
  }
  return LeastSquaresOptions{};
}

/// The search on top of the stack, as stdlib/regression.lua made it.
SearchOptions read_search(lua_State* L, std::uint64_t seed) {
  SearchOptions search;
  search.method = search_method(string_field(L, -1, "method").value_or("slsqp"));
  search.starts = static_cast<int>(number_field(L, -1, "starts").value_or(search.starts));
  search.evaluations = static_cast<int>(number_field(L, -1, "evaluations").value_or(search.evaluations));
  search.seed = static_cast<std::uint64_t>(number_field(L, -1, "seed").value_or(static_cast<double>(seed)));
  return search;
}

RegressionSolver read_solver(lua_State* L, std::uint64_t seed) {
  const std::string kind = string_field(L, -1, "kind").value_or("least_squares");
  if (kind == "huber") {
    HuberOptions options;
    read(L, "threshold", options.threshold);
    read(L, "outlier", options.outlier);
    return options;
  }
  if (kind == "total_least_squares") {
    TotalOptions options;
    with_field(L, -1, "noise", [&] {
      for (lua_pushnil(L); lua_next(L, -2) != 0; lua_pop(L, 1))
        options.noise[check_string(L, -2)] = check_number(L, -1);
    });
    return options;
  }
  if (kind == "instrumental_variables") {
    InstrumentOptions options;
    with_field(L, -1, "instruments",
               [&] { for_each(L, -1, [&](lua_Integer) { options.instruments.push_back(check_value(L, -1).expr); }); });
    return options;
  }
  if (kind == "ensemble_of") {
    BaggingOptions options;
    with_field(L, -1, "solver", [&] { options.solver = read_statistic_solver(L, seed); });
    read(L, "members", options.members);
    read(L, "features", options.features);
    read(L, "inclusion", options.inclusion);
    options.seed = seed;
    return options;
  }
  return std::visit([](const auto& solver) { return RegressionSolver(solver); }, read_statistic_solver(L, seed));
}

}  // namespace

void regress_options(lua_State* L, int index, RegressOptions& options) {
  with_field(L, index, "constraints",
             [&] { for_each(L, -1, [&](lua_Integer) { options.constraints.push_back(read_constraint(L)); }); });
  with_field(L, index, "groups",
             [&] { for_each(L, -1, [&](lua_Integer) { options.groups.push_back(read_group(L)); }); });
  with_field(L, index, "passive", [&] { options.passive = read_passive(L); });
  with_field(L, index, "form", [&] { options.weak = read_weak(L); });
  with_field(L, index, "solver", [&] { options.solver = read_solver(L, options.seed); });
  with_field(L, index, "objective",
             [&] { options.objective.mean_force = number_field(L, -1, "mean_force").value_or(0); });
  with_field(L, index, "search", [&] { options.search = read_search(L, options.seed); });
  for (const std::string& place : strings_field(L, index, "places")) options.places.push_back(span_of(place));
}

}  // namespace lunid::lua
