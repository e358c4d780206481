// Restoring force surfaces.
#include <cmath>

#include "runtime.hpp"
#include "surface/interpolation.hpp"
#include "surface/lookup.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A surface as a study sees it: the kinds that were asked for, the best first, and the polynomial expansion.
struct ForceMap {
  std::string name;
  SurfacePoints points;
  std::vector<SurfaceRival> rivals;
  std::shared_ptr<const PolynomialSurface> polynomial;
  double truncation = 0;  ///< rms of what the polynomial leaves of what is drawn, where there are data [N]
  double continued = 0;   ///< part of the quadrature's nodes without data
  FunctionPtr function;   ///< of y and v; a polynomial is an expression already

  const SurfaceRival& best() const { return rivals.front(); }
  const ForceSurface& drawn() const { return *best().fit.surface; }
};

template <>
struct Bound<ForceMap> {
  static constexpr const char* key = "lunid.surface";
  static constexpr const char* words = "a surface";
};

namespace {

int integer_field(lua_State* L, const char* field, int otherwise) {
  return static_cast<int>(number_field(L, -1, field).value_or(otherwise));
}

GridOptions grid_options(lua_State* L) {
  const GridOptions d;
  return {integer_field(L, "cells_y", d.cells_y), integer_field(L, "cells_v", d.cells_v),
          integer_field(L, "least_count", d.least_count), number_field(L, -1, "smoothness").value_or(d.smoothness),
          between_from(string_field(L, -1, "between").value_or("linear"))};
}

MlpOptions mlp_options(lua_State* L) {
  MlpOptions o;
  with_field(L, -1, "hidden", [&] {
    o.hidden.clear();
    for_each(L, -1, [&](lua_Integer) { o.hidden.push_back(static_cast<int>(check_integer(L, -1))); });
  });
  o.penalty = number_field(L, -1, "penalty").value_or(o.penalty);
  o.evaluations = integer_field(L, "evaluations", o.evaluations);
  o.seed = static_cast<std::uint64_t>(number_field(L, -1, "seed").value_or(1));
  return o;
}

SupportVectorOptions support_vector_options(lua_State* L) {
  SupportVectorOptions o;
  o.cost = number_field(L, -1, "cost").value_or(o.cost);
  o.epsilon = number_field(L, -1, "epsilon").value_or(o.epsilon);
  o.width = number_field(L, -1, "width");
  o.centres = integer_field(L, "centres", o.centres);
  return o;
}

ForestOptions forest_options(lua_State* L) {
  ForestOptions o;
  o.trees = integer_field(L, "trees", o.trees);
  o.least_leaf = integer_field(L, "least_leaf", o.least_leaf);
  o.seed = static_cast<std::uint64_t>(number_field(L, -1, "seed").value_or(1));
  return o;
}

/// The interpolator on top of the stack.
Interpolator interpolator(lua_State* L) {
  const std::string kind = string_field(L, -1, "kind").value_or("");
  if (kind == "grid") return grid_options(L);
  if (kind == "polynomial")
    return PolynomialOptions{.order_y = integer_field(L, "order_y", 4), .order_v = integer_field(L, "order_v", 4)};
  if (kind == "nearest") return NearestOptions{integer_field(L, "neighbours", NearestOptions{}.neighbours)};
  if (kind == "triangulation") return TriangulationOptions{integer_field(L, "cells", TriangulationOptions{}.cells)};
  if (kind == "mlp") return mlp_options(L);
  if (kind == "gaussian_process") return GaussianProcessOptions{integer_field(L, "centres", 600)};
  if (kind == "support_vectors") return support_vector_options(L);
  if (kind == "random_forest") return forest_options(L);
  throw InputError("rfs: interpolate: unknown kind '" + kind + "'");
}

/// The expansion of what is drawn: by regression on the points, or by quadrature of the surface.
void expand(lua_State* L, ForceMap& map) {
  const int order_y = static_cast<int>(number_field(L, 2, "order_y").value_or(4));
  const int order_v = static_cast<int>(number_field(L, 2, "order_v").value_or(4));
  if (string_field(L, 2, "expand") == "quadrature") {
    Expansion expansion = expand_by_quadrature(map.drawn(), order_y, order_v);
    map.truncation = expansion.truncation;
    map.continued = expansion.continued;
    map.polynomial = std::make_shared<const PolynomialSurface>(std::move(expansion.polynomial));
  } else {
    map.polynomial = std::make_shared<const PolynomialSurface>(
        fit_polynomial(map.points, PolynomialOptions{.order_y = order_y, .order_v = order_v}));
    map.truncation = truncation(*map.polynomial, map.drawn());
  }
}

/// rfs({records}, {mass=, order_y=, order_v=, kinds = {{kind = "grid", ...}, ...}, blocks=, expand=, name=, between=})
int run(lua_State* L) {
  std::vector<Record> records;
  check_table(L, 1);
  for_each(L, 1, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
  check_table(L, 2);
  ForceMap map;
  map.name = records.front().name();
  map.points = restoring_points(records, field_value(L, 2, "mass").expr);
  std::vector<Interpolator> kinds;
  with_field(L, 2, "kinds", [&] { for_each(L, -1, [&](lua_Integer) { kinds.push_back(interpolator(L)); }); });
  map.rivals = compare_surfaces(map.points, kinds, static_cast<int>(number_field(L, 2, "blocks").value_or(6)));
  expand(L, map);
  if (!std::holds_alternative<PolynomialOptions>(map.best().how)) {
    Pool& pool = *runtime(L).pool();
    const Between natural = is_smooth(map.best().how) ? Between::cubic : Between::linear;
    map.function = lookup_of(map.drawn(), pool.free_name(string_field(L, 2, "name").value_or("surface")),
                             between_from(string_field(L, 2, "between").value_or(to_string(natural))));
    pool.add(map.function);
  }
  push<ForceMap>(L, std::move(map));
  return 1;
}

/// surface(y, v): the surface as a function of the language. A polynomial is one already.
int call_surface(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  if (lua_gettop(L) != 3)
    throw InputError("a surface takes 2 arguments, y and v, got " + std::to_string(lua_gettop(L) - 1));
  if (map.function) return call_external(L, map.function, 2);
  Pool& pool = *runtime(L).pool();
  const auto& drawn = dynamic_cast<const PolynomialSurface&>(map.drawn());
  const Value y = check_value(L, 2), v = check_value(L, 3);
  const std::pair<Expr, Expr> replacements[] = {{pool.channel("y"), y.expr}, {pool.channel("v"), v.expr}};
  const Expr result = substitute(drawn.expression(pool), replacements);
  if (result.is_constant())
    lua_pushnumber(L, result.value());
  else
    push<Value>(L, {result, join(y.declared, v.declared)});
  return 1;
}

/// surface:at(y, v) -> force, whether there were data, standard deviation where the kind gives one (else nil).
int value_at(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  const double y = check_number(L, 2), v = check_number(L, 3);
  lua_pushnumber(L, map.drawn().value(y, v));
  lua_pushboolean(L, map.drawn().has_data(y, v));
  const double std = map.drawn().std(y, v);
  if (std::isnan(std))
    lua_pushnil(L);
  else
    lua_pushnumber(L, std);
  return 3;
}

/// surface_section(surface, {y=} or {v=}, count=, half_width=) -> {place=, f=, std=, points_place=, points_f=,
/// half_width=}
int cut(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  check_table(L, 2);
  const auto y = number_field(L, 2, "y"), v = number_field(L, 2, "v");
  const SurfaceSection s = section(map.drawn(), map.points, !y, y ? *y : v.value_or(0),
                                   static_cast<int>(number_field(L, 2, "count").value_or(200)),
                                   number_field(L, 2, "half_width").value_or(0));
  lua_newtable(L);
  for (const auto& [field, column] : {std::pair{"place", &s.place}, std::pair{"f", &s.f}, std::pair{"std", &s.std},
                                      std::pair{"points_place", &s.points_place}, std::pair{"points_f", &s.points_f}}) {
    push_column(L, *column);
    lua_setfield(L, -2, field);
  }
  lua_pushnumber(L, s.half_width);
  lua_setfield(L, -2, "half_width");
  return 1;
}

/// {y = column, v = column, f = {rows over v}, std = {rows over v}}
void push_table(lua_State* L, const ForceMap& map) {
  const SurfaceTable table = tabulate(map.drawn());
  lua_newtable(L);
  push_column(L, table.y);
  lua_setfield(L, -2, "y");
  push_column(L, table.v);
  lua_setfield(L, -2, "v");
  lua_newtable(L);
  for (Eigen::Index j = 0; j < table.f.cols(); ++j) {
    push_column(L, table.f.col(j));
    lua_rawseti(L, -2, j + 1);
  }
  lua_setfield(L, -2, "f");
  lua_newtable(L);
  for (Eigen::Index j = 0; j < map.best().std.cols(); ++j) {
    push_column(L, map.best().std.col(j));
    lua_rawseti(L, -2, j + 1);
  }
  lua_setfield(L, -2, "std");
}

void push_points(lua_State* L, const SurfacePoints& points) {
  lua_newtable(L);
  push_column(L, points.y);
  lua_setfield(L, -2, "y");
  push_column(L, points.v);
  lua_setfield(L, -2, "v");
  push_column(L, points.f);
  lua_setfield(L, -2, "f");
}

/// M[i + 1][j + 1], the coefficient of y^i v^j.
void push_coefficients(lua_State* L, const Eigen::MatrixXd& monomials) {
  lua_newtable(L);
  for (Eigen::Index i = 0; i < monomials.rows(); ++i) {
    push_column(L, monomials.row(i).transpose());
    lua_rawseti(L, -2, i + 1);
  }
}

void push_score(lua_State* L, const SurfaceScore& score) {
  lua_newtable(L);
  for (const auto& [field, value] :
       {std::pair{"r2", score.r2}, std::pair{"rmse", score.rmse}, std::pair{"covered", score.covered}}) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, field);
  }
}

/// One row for each kind that was tried, the best first.
void push_rivals(lua_State* L, const std::vector<SurfaceRival>& rivals) {
  lua_newtable(L);
  lua_Integer place = 0;
  for (const SurfaceRival& rival : rivals) {
    lua_newtable(L);
    const auto text = [&](const char* field, const std::string& value) {
      if (value.empty()) return;
      push_text(L, value);
      lua_setfield(L, -2, field);
    };
    text("kind", name_of(rival.how));
    text("fault", rival.fault);
    text("stopped", rival.fit.stopped);
    if (rival.fault.empty()) {
      for (const auto& [field, value] : {std::pair{"r2", rival.fit.r2}, std::pair{"rmse", rival.fit.rmse},
                                         std::pair{"seconds", rival.fit.seconds}}) {
        lua_pushnumber(L, value);
        lua_setfield(L, -2, field);
      }
      lua_pushboolean(L, rival.fit.converged);
      lua_setfield(L, -2, "converged");
      push_score(L, rival.left_out);
      lua_setfield(L, -2, "left_out");
    }
    lua_rawseti(L, -2, ++place);
  }
}

/// A field of a surface, or a method.
int get(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "name")
    push_text(L, map.name);
  else if (key == "kind")
    push_text(L, map.drawn().name());
  else if (key == "restoring")
    push<Value>(L, {map.polynomial->expression(*runtime(L).pool()), nullptr});
  else if (key == "coefficients")
    push_coefficients(L, map.polynomial->monomials());
  else if (key == "chebyshev")
    push_coefficients(L, map.polynomial->chebyshev());
  else if (key == "truncation")
    lua_pushnumber(L, map.truncation);
  else if (key == "continued")
    lua_pushnumber(L, map.continued);
  else if (key == "r2")
    lua_pushnumber(L, map.best().fit.r2);
  else if (key == "rmse")
    lua_pushnumber(L, map.best().fit.rmse);
  else if (key == "left_out")
    push_score(L, map.best().left_out);
  else if (key == "rivals")
    push_rivals(L, map.rivals);
  else if (key == "table")
    push_table(L, map);
  else if (key == "points")
    push_points(L, map.points);
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError("a surface has no '" + key +
                       "' (fields: name kind restoring coefficients chebyshev truncation continued r2 rmse left_out "
                       "rivals table points; methods: at export)");
    }
  }
  return 1;
}

std::string rival_line(const SurfaceRival& rival) {
  char text[256];
  const std::string kind = name_of(rival.how);
  if (!rival.fault.empty()) return "  " + kind + ": " + rival.fault;
  std::snprintf(text, sizeof text, "  %-18s  %9.4g  %13.4g  %15.4g  %8.2f", kind.c_str(), rival.fit.r2,
                rival.left_out.r2, rival.left_out.rmse, rival.fit.seconds);
  return text + (rival.fit.converged ? std::string() : "  " + rival.fit.stopped);
}

int to_string(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  const SurfaceRival& best = map.best();
  char text[256];
  std::snprintf(
      text, sizeof text,
      "%s surface of %lld points: R2 %.4g on the data, %.4g on blocks of time left out (%.0f %% of their points "
      "lie where it has data)",
      map.drawn().name().c_str(), static_cast<long long>(map.points.size()), best.fit.r2, best.left_out.r2,
      100 * best.left_out.covered);
  std::string all = text;
  if (map.rivals.size() == 1 && !best.fit.converged) all += "\n  not converged: " + best.fit.stopped;
  if (map.rivals.size() > 1) {
    all += "\n  kind                  R2 data    R2 left out    rmse left out  time [s]";
    for (const SurfaceRival& rival : map.rivals) all += "\n" + rival_line(rival);
  }
  push_text(L, all);
  return 1;
}

}  // namespace

void open_surfaces(lua_State* L) {
  static constexpr Entry methods[] = {{"at", guarded<value_at>}};
  static constexpr Entry meta[] = {
      {"__index", guarded<get>}, {"__call", guarded<call_surface>}, {"__tostring", guarded<to_string>}};
  make_type<ForceMap>(L, methods, meta);
  static constexpr Entry functions[] = {{"rfs", guarded<run>}, {"surface_section", guarded<cut>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
