// Figures: plain tables of the standard library become the figure room's plain values.
#include <array>

#include "expr/joined.hpp"
#include "figure/module.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

using namespace lunid::figure;

constexpr Eigen::Index most_points = 20'000'000;

/// Looks before anything is copied: a hundred million points are gigabytes on their way to a picture.
void check_points(lua_State* L) {
  const Column* column = test<Column>(L, -1);
  if (!column || column->values->size() <= most_points) return;
  throw InputError("figure: a curve of " + std::to_string(column->values->size()) + " points, at most " +
                   std::to_string(most_points) + " can be drawn: show a part of it (record:window), or every n-th " +
                   "point (column:every)");
}

std::vector<double> numbers(lua_State* L, const char* field) {
  std::vector<double> result;
  with_field(L, -1, field, [&] {
    check_points(L);
    const Eigen::VectorXd values = check_column(L, -1);
    result.assign(values.begin(), values.end());
  });
  return result;
}

std::string text(lua_State* L, const char* field) { return string_field(L, -1, field).value_or(""); }

template <class T, std::size_t N>
T choice(lua_State* L, const char* field, const std::array<std::pair<const char*, T>, N>& choices, T otherwise) {
  const auto given = string_field(L, -1, field);
  if (!given) return otherwise;
  std::string known;
  for (const auto& [name, value] : choices) {
    if (*given == name) return value;
    append_item(known, name);
  }
  throw InputError(std::string(field) + ": expected one of " + known + ", got '" + *given + "'");
}

Role role(lua_State* L, Role otherwise) {
  static constexpr std::array<std::pair<const char*, Role>, 12> roles = {{{"measured", Role::measured},
                                                                          {"baseline", Role::baseline},
                                                                          {"final", Role::final},
                                                                          {"residual", Role::residual},
                                                                          {"effect", Role::effect},
                                                                          {"noise", Role::noise},
                                                                          {"first", Role::first},
                                                                          {"second", Role::second},
                                                                          {"third", Role::third},
                                                                          {"fourth", Role::fourth},
                                                                          {"fifth", Role::fifth},
                                                                          {"sixth", Role::sixth}}};
  return choice(L, "role", roles, otherwise);
}

Style style(lua_State* L, Style otherwise) {
  static constexpr std::array<std::pair<const char*, Style>, 8> styles = {{{"line", Style::line},
                                                                           {"dashed", Style::dashed},
                                                                           {"dotted", Style::dotted},
                                                                           {"dash_dot", Style::dash_dot},
                                                                           {"points", Style::points},
                                                                           {"line_points", Style::line_points},
                                                                           {"stems", Style::stems},
                                                                           {"columns", Style::columns}}};
  return choice(L, "style", styles, otherwise);
}

Theme theme(lua_State* L) {
  static constexpr std::array<std::pair<const char*, Theme>, 2> themes = {
      {{"light", Theme::light}, {"dark", Theme::dark}}};
  return choice(L, "theme", themes, Theme::light);
}

Legend legend(lua_State* L) {
  static constexpr std::array<std::pair<const char*, Legend>, 7> places = {{{"automatic", Legend::automatic},
                                                                            {"top_left", Legend::top_left},
                                                                            {"top_right", Legend::top_right},
                                                                            {"bottom_left", Legend::bottom_left},
                                                                            {"bottom_right", Legend::bottom_right},
                                                                            {"above", Legend::above},
                                                                            {"none", Legend::none}}};
  return choice(L, "legend", places, Legend::automatic);
}

Axis axis(lua_State* L, const char* field) {
  Axis axis;
  with_field(L, -1, field, [&] {
    axis.name = text(L, "name");
    axis.unit = text(L, "unit");
    axis.min = number_field(L, -1, "min").value_or(no_limit);
    axis.max = number_field(L, -1, "max").value_or(no_limit);
    axis.scale = text(L, "scale") == "log" ? Scale::log : Scale::linear;
    axis.names = strings_field(L, -1, "names");
  });
  return axis;
}

/// A list of rows `z[row][column]`, each a column or a list of numbers.
Eigen::MatrixXd matrix(lua_State* L, const char* field) {
  std::vector<Eigen::VectorXd> rows;
  with_field(L, -1, field, [&] { for_each(L, -1, [&](lua_Integer) { rows.push_back(check_column(L, -1)); }); });
  Eigen::MatrixXd z(static_cast<Eigen::Index>(rows.size()), rows.empty() ? 0 : rows.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != z.cols()) {
      throw InputError(std::string(field) + ": row " + std::to_string(i + 1) + " has " +
                       std::to_string(rows[i].size()) + " numbers, the first has " + std::to_string(z.cols()));
    }
    z.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
  return z;
}

Size size(lua_State* L, Size otherwise) {
  otherwise.width_cm = number_field(L, -1, "width_cm").value_or(otherwise.width_cm);
  otherwise.height_cm = number_field(L, -1, "height_cm").value_or(otherwise.height_cm);
  otherwise.dpi = static_cast<int>(number_field(L, -1, "dpi").value_or(otherwise.dpi));
  return otherwise;
}

/// Appends what `make` builds from each entry of a list field, the entry on top of the stack.
template <class T, class Make>
void collect_list(lua_State* L, const char* field, std::vector<T>& into, Make make) {
  with_field(L, -1, field, [&] {
    check_table(L, -1);
    for_each(L, -1, [&](lua_Integer) { into.push_back(make()); });
  });
}

Bars bars(lua_State* L) {
  Bars bars;
  bars.name = strings_field(L, -1, "names");
  collect_list(L, "sets", bars.set, [&] {
    return BarSet{text(L, "label"), numbers(L, "value"), numbers(L, "error"), role(L, Role::first)};
  });
  return bars;
}

Scene scene(lua_State* L) {
  Scene scene;
  scene.x = axis(L, "x");
  scene.y = axis(L, "y");
  scene.z = axis(L, "z");
  scene.grid_x = numbers(L, "grid_x");
  scene.grid_y = numbers(L, "grid_y");
  scene.surface = matrix(L, "surface");
  collect_list(L, "clouds", scene.clouds, [&] {
    return Cloud{text(L, "label"), numbers(L, "x"), numbers(L, "y"), numbers(L, "z"), role(L, Role::measured)};
  });
  scene.diverging = boolean_field(L, -1, "diverging", true);
  scene.azimuth = number_field(L, -1, "azimuth").value_or(scene.azimuth);
  scene.elevation = number_field(L, -1, "elevation").value_or(scene.elevation);
  return scene;
}

Panel panel(lua_State* L) {
  Panel panel;
  panel.title = text(L, "title");
  panel.note = text(L, "note");
  panel.x = axis(L, "x");
  panel.y = axis(L, "y");
  panel.legend = legend(L);
  panel.column_span = static_cast<int>(number_field(L, -1, "column_span").value_or(1));
  collect_list(L, "series", panel.series, [&] {
    return Series{text(L, "label"),      numbers(L, "x"),      numbers(L, "y"),
                  style(L, Style::line), role(L, Role::first), number_field(L, -1, "width").value_or(1),
                  numbers(L, "colour")};
  });
  collect_list(L, "ribbons", panel.ribbons, [&] {
    return Ribbon{text(L, "label"), numbers(L, "x"), numbers(L, "low"), numbers(L, "high"), role(L, Role::noise)};
  });
  collect_list(L, "bands", panel.bands, [&] {
    return Band{text(L, "label"), number_field(L, -1, "from").value_or(0), number_field(L, -1, "to").value_or(0),
                role(L, Role::noise)};
  });
  collect_list(L, "lines", panel.lines, [&] {
    return ReferenceLine{text(L, "label"), number_field(L, -1, "value").value_or(0),
                         boolean_field(L, -1, "vertical", false), style(L, Style::dashed), role(L, Role::noise)};
  });
  with_field(L, -1, "map", [&] {
    panel.map = HeatMap{numbers(L, "x"),
                        numbers(L, "y"),
                        matrix(L, "z"),
                        axis(L, "colour"),
                        boolean_field(L, -1, "diverging", true),
                        boolean_field(L, -1, "numbers", false),
                        boolean_field(L, -1, "contours", false),
                        string_field(L, -1, "missing").value_or("no data")};
  });
  panel.colour = axis(L, "colour");
  with_field(L, -1, "bars", [&] { panel.bars = bars(L); });
  with_field(L, -1, "scene", [&] { panel.scene = scene(L); });
  return panel;
}

Figure figure_of(lua_State* L) {
  Figure figure;
  figure.title = text(L, "title");
  figure.columns = static_cast<int>(number_field(L, -1, "columns").value_or(1));
  figure.rows = static_cast<int>(number_field(L, -1, "rows").value_or(0));
  figure.size = size(L, figure.size);
  figure.theme = theme(L);
  figure.share_x = boolean_field(L, -1, "share_x", false);
  figure.share_y = boolean_field(L, -1, "share_y", false);
  collect_list(L, "panels", figure.panels, [&] { return panel(L); });
  return figure;
}

/// render_figure(figure, path): .png, .svg, .pdf
int render(lua_State* L) {
  check_table(L, 1);
  const std::string path = check_string(L, 2);
  lua_settop(L, 1);
  runtime(L).figures().render(figure_of(L), path);
  return 0;
}

/// export_figure(figure, path): .csv of what is drawn; a surface also as .vts, .vtp, .vtu or .vtm
int export_numbers(lua_State* L) {
  check_table(L, 1);
  const std::string path = check_string(L, 2);
  lua_settop(L, 1);
  if (path.ends_with(".csv")) {
    export_data(figure_of(L), path);
  } else {
    runtime(L).figures().export_surface(figure_of(L), path);
  }
  return 0;
}

/// page_data(figure) -> JSON for stdlib/web/figure.js
int make_page_data(lua_State* L) {
  check_table(L, 1);
  lua_settop(L, 1);
  push_text(L, page_data(figure_of(L)));
  return 1;
}

/// One line on how figures are drawn here; raises with what is missing.
int check_figures(lua_State* L) {
  push_text(L, runtime(L).figures().check());
  return 1;
}

}  // namespace

void open_figures(lua_State* L) {
  static constexpr Entry functions[] = {{"render_figure", guarded<render>},
                                        {"export_figure", guarded<export_numbers>},
                                        {"page_data", guarded<make_page_data>},
                                        {"check_figures", guarded<check_figures>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
