// Restoring force surfaces.
#include "surface/lookup.hpp"
#include "surface/surface.hpp"

#include <cmath>

#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A surface as a study sees it: interpolated on a grid, where asked for, and its polynomial expansion.
struct ForceMap {
  std::string name;
  SurfacePoints points;
  std::shared_ptr<const GridSurface> grid;
  std::shared_ptr<const PolynomialSurface> polynomial;
  SurfaceScore score;    ///< of what is drawn, on blocks of time that its fit did not see
  FunctionPtr function;  ///< of y and v, where it is on a grid

  const ForceSurface& drawn() const {
    if (grid) return *grid;
    return *polynomial;
  }
};

template <>
struct Bound<ForceMap> {
  static constexpr const char* key = "lunid.surface";
  static constexpr const char* words = "a surface";
};

namespace {

PolynomialOptions polynomial_options(lua_State* L) {
  PolynomialOptions options;
  options.order_y = static_cast<int>(number_field(L, 2, "order_y").value_or(options.order_y));
  options.order_v = static_cast<int>(number_field(L, 2, "order_v").value_or(options.order_v));
  return options;
}

/// The grid's options on top of the stack.
GridOptions grid_options(lua_State* L) {
  GridOptions options;
  options.cells_y = static_cast<int>(number_field(L, -1, "cells_y").value_or(options.cells_y));
  options.cells_v = static_cast<int>(number_field(L, -1, "cells_v").value_or(options.cells_v));
  options.least_count = static_cast<int>(number_field(L, -1, "least_count").value_or(options.least_count));
  options.smoothness = number_field(L, -1, "smoothness").value_or(options.smoothness);
  return options;
}

/// rfs({records}, {mass=, order_y=, order_v=, grid = {cells_y=, ...}, blocks=})
int run(lua_State* L) {
  std::vector<Record> records;
  check_table(L, 1);
  for_each(L, 1, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
  check_table(L, 2);
  ForceMap map;
  map.name = records.front().name();
  map.points = restoring_points(records, field_value(L, 2, "mass").expr);
  const PolynomialOptions polynomial = polynomial_options(L);
  map.polynomial = std::make_shared<const PolynomialSurface>(fit_polynomial(map.points, polynomial));
  SurfaceFit again = [polynomial](const SurfacePoints& points) {
    return std::make_unique<PolynomialSurface>(fit_polynomial(points, polynomial));
  };
  with_field(L, 2, "grid", [&] {
    const GridOptions grid = grid_options(L);
    map.grid = std::make_shared<const GridSurface>(fit_grid(map.points, grid));
    again = [grid](const SurfacePoints& points) { return std::make_unique<GridSurface>(fit_grid(points, grid)); };
  });
  if (map.grid) {
    Pool& pool = *runtime(L).pool();
    map.function = lookup_of(*map.grid, pool.free_name(string_field(L, 2, "name").value_or("surface")));
    pool.add(map.function);
  }
  map.score = score_left_out(map.points, static_cast<int>(number_field(L, 2, "blocks").value_or(6)), again);
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
  const Value y = check_value(L, 2), v = check_value(L, 3);
  const std::pair<Expr, Expr> replacements[] = {{pool.channel("y"), y.expr}, {pool.channel("v"), v.expr}};
  const Expr result = substitute(map.polynomial->expression(pool), replacements);
  if (result.is_constant())
    lua_pushnumber(L, result.value());
  else
    push<Value>(L, {result, join(y.declared, v.declared)});
  return 1;
}

/// surface:at(y, v) -> force, whether there were data.
int value_at(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  const double y = check_number(L, 2), v = check_number(L, 3);
  lua_pushnumber(L, map.drawn().value(y, v));
  lua_pushboolean(L, map.drawn().has_data(y, v));
  return 2;
}

/// {y = column, v = column, f = {rows over v}, count = {rows over v}}
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

/// Fields name, kind, restoring, coefficients, r2, rmse, left_out, table, points; or a method.
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
  else if (key == "r2")
    lua_pushnumber(L, map.grid ? map.grid->r2 : map.polynomial->r2);
  else if (key == "rmse")
    lua_pushnumber(L, map.grid ? map.grid->rmse : map.polynomial->rmse);
  else if (key == "left_out")
    push_score(L, map.score);
  else if (key == "table")
    push_table(L, map);
  else if (key == "points")
    push_points(L, map.points);
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError(
          "a surface has no '" + key +
          "' (fields: name kind restoring coefficients r2 rmse left_out table points; methods: at export)");
    }
  }
  return 1;
}

int to_string(lua_State* L) {
  const ForceMap& map = check<ForceMap>(L, 1);
  char text[256];
  std::snprintf(
      text, sizeof text,
      "%s surface of %lld points: R2 %.4g on the data, %.4g on blocks of time left out (%.0f %% of their points "
      "lie where it has data)",
      map.drawn().name().c_str(), static_cast<long long>(map.points.size()),
      map.grid ? map.grid->r2 : map.polynomial->r2, map.score.r2, 100 * map.score.covered);
  push_text(L, text);
  return 1;
}

}  // namespace

void open_surfaces(lua_State* L) {
  static constexpr Entry methods[] = {{"at", guarded<value_at>}};
  static constexpr Entry meta[] = {
      {"__index", guarded<get>}, {"__call", guarded<call_surface>}, {"__tostring", guarded<to_string>}};
  make_type<ForceMap>(L, methods, meta);
  static constexpr Entry functions[] = {{"rfs", guarded<run>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
