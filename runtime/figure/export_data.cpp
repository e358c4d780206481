#include <charconv>
#include <cmath>

#include "figure/figure.hpp"
#include "record/atomic_file.hpp"

namespace lunid::figure {
namespace {

constexpr double absent = std::numeric_limits<double>::infinity();  // no such column for this kind

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r#") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

/// One line of a comment: a title with a line break must not end it.
std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

std::string axis_text(const Axis& axis) { return axis.name + (axis.unit.empty() ? "" : " [" + axis.unit + "]"); }

/// Long-form rows of a figure.
class Table {
 public:
  void comment(const std::string& text) { text_ += "# " + one_line(text) + "\n"; }
  void header() { text_ += "panel,kind,label,name,x,y,z\n"; }

  void row(std::size_t panel, const char* kind, const std::string& label, double x, double y = absent,
           double z = absent, const std::string& name = {}) {
    text_ += std::to_string(panel) + "," + kind + "," + field(label) + "," + field(name);
    for (const double value : {x, y, z}) number(value);
    text_ += '\n';
  }

  const std::string& text() const { return text_; }

 private:
  /// The shortest digits that read back to the same double; infinities of data cannot be drawn and become
  /// nan.
  void number(double value) {
    text_ += ',';
    if (value == absent) return;
    if (!std::isfinite(value)) {
      text_ += "nan";
      return;
    }
    char buffer[40];
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  }

  std::string text_;
};

/// Data are finite or missing.
double shown(double value) { return std::isfinite(value) ? value : std::nan(""); }

void add_curves(Table& table, std::size_t n, const Panel& panel) {
  for (const Series& s : panel.series)
    for (std::size_t i = 0; i < s.x.size(); ++i)
      table.row(n, "curve", s.label, shown(s.x[i]), shown(s.y[i]), s.colour.empty() ? absent : shown(s.colour[i]));
  for (const Ribbon& r : panel.ribbons)
    for (std::size_t i = 0; i < r.x.size(); ++i)
      table.row(n, "ribbon", r.label, shown(r.x[i]), shown(r.low[i]), shown(r.high[i]));
}

void add_scene(Table& table, std::size_t n, const Scene& scene) {
  for (std::size_t row = 0; row < scene.grid_y.size(); ++row)
    for (std::size_t column = 0; column < scene.grid_x.size(); ++column)
      table.row(n, "surface", scene.z.name, scene.grid_x[column], scene.grid_y[row],
                shown(scene.surface(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column))));
  for (const Cloud& cloud : scene.clouds)
    for (std::size_t i = 0; i < cloud.x.size(); ++i)
      table.row(n, "cloud", cloud.label, shown(cloud.x[i]), shown(cloud.y[i]), shown(cloud.z[i]));
}

void add_panel(Table& table, std::size_t n, const Panel& panel) {
  if (panel.scene) add_scene(table, n, *panel.scene);
  add_curves(table, n, panel);
  if (panel.map)
    for (std::size_t row = 0; row < panel.map->y.size(); ++row)
      for (std::size_t column = 0; column < panel.map->x.size(); ++column)
        table.row(n, "map", panel.map->colour.name, panel.map->x[column], panel.map->y[row],
                  shown(panel.map->z(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column))));
  if (panel.bars)
    for (const BarSet& set : panel.bars->set)
      for (std::size_t i = 0; i < set.value.size(); ++i)
        table.row(n, "bar", set.label, shown(set.value[i]), set.error.empty() ? absent : shown(set.error[i]), absent,
                  panel.bars->name[i]);
  for (const Band& band : panel.bands) table.row(n, "band", band.label, shown(band.from), shown(band.to));
  for (const ReferenceLine& line : panel.lines) {
    if (line.vertical)
      table.row(n, "vertical", line.label, shown(line.value));
    else
      table.row(n, "horizontal", line.label, absent, shown(line.value));
  }
}

}  // namespace

void export_data(const Figure& figure, const std::string& path) {
  validate(figure);
  Table table;
  if (!figure.title.empty()) table.comment(figure.title);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    const Axis &x = panel.scene ? panel.scene->x : panel.x, &y = panel.scene ? panel.scene->y : panel.y;
    std::string text = "panel " + std::to_string(i + 1) + ": " + panel.title + "; x: " + axis_text(x);
    if (!panel.bars) text += "; y: " + axis_text(y);
    if (panel.scene) text += "; z: " + axis_text(panel.scene->z);
    if (panel.map) text += "; z: " + axis_text(panel.map->colour);
    if (!panel.map && !panel.colour.name.empty()) text += "; z: " + axis_text(panel.colour);
    table.comment(text);
  }
  table.header();
  for (std::size_t i = 0; i < figure.panels.size(); ++i) add_panel(table, i + 1, figure.panels[i]);
  write_file_atomically(path, table.text());
}

}  // namespace lunid::figure
