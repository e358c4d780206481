#pragma once
// Figures like those of a report, made of formulas: what the tests draw.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "figure/module.hpp"

namespace samples {

using namespace lunid::figure;
inline const double missing = std::nan("");

/// A folder of this process, removed with it unless LUNID_KEEP_FIGURES names another to keep.
class Folder {
 public:
  Folder() {
    const char* kept = std::getenv("LUNID_KEEP_FIGURES");
    keep_ = kept && *kept;
    path_ = keep_ ? std::filesystem::path(kept)
                  : std::filesystem::temp_directory_path() / ("lunid_figure_" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    if (!keep_) std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool keep_ = false;
};

inline std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The module: in the build folder, from wherever below it the test's executable lies.
inline std::string module_file() {
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (; folder != folder.root_path(); folder = folder.parent_path())
    if (std::filesystem::exists(folder / "liblunid_figure.so")) return (folder / "liblunid_figure.so").string();
  return "";
}

/// A decaying vibration of some millimetres; `error` distorts it as a poor model would.
inline Series motion(const std::string& label, Role role, Style style, double error, double length = 8.0) {
  Series s{label, {}, {}, style, role, 1.0};
  for (double t = 0.0; t <= length; t += 1.0 / 800.0) {
    s.x.push_back(t);
    const double envelope = std::exp(-0.25 * t);
    s.y.push_back(3.1e-3 * envelope * std::sin(31.0 * t * (1.0 + error * envelope)) + 1e-4 * std::sin(7.0 * t));
  }
  return s;
}

/// Measured, baseline and final runs over the whole record, at the start and at the end.
inline Figure histories() {
  Figure figure;
  figure.title = "Free runs on the test record run4.csv";
  figure.columns = 2;
  for (int k = 0; k < 3; ++k) {
    Panel p;
    p.x = {"time", "s"};
    p.y = {"displacement y", "m"};
    p.series = {motion("measured", Role::measured, Style::line, 0.0),
                motion("baseline", Role::baseline, Style::dashed, 0.03),
                motion("final", Role::final, Style::dash_dot, 0.0005)};
    figure.panels.push_back(p);
  }
  figure.panels[0].column_span = 2;
  figure.panels[0].title = "Whole record";
  figure.panels[0].note = "gap 0.42 → 0.06";
  figure.panels[0].bands = {{"", 0.0, 0.4, Role::noise}, {"", 6.5, 7.5, Role::noise}};
  figure.panels[1].title = "Start";
  figure.panels[1].x.min = 0.0;
  figure.panels[1].x.max = 0.4;
  figure.panels[2].title = "Near the end";
  figure.panels[2].x.min = 6.5;
  figure.panels[2].x.max = 7.5;
  return figure;
}

/// Mean residual force over displacement and velocity; cells that the motion never visits are NaN.
inline HeatMap residual_map(double scale) {
  HeatMap map;
  const int nx = 36, ny = 28;
  for (int i = 0; i < nx; ++i) map.x.push_back(3.2e-3 * (2.0 * (i + 0.5) / nx - 1.0));
  for (int j = 0; j < ny; ++j) map.y.push_back(0.11 * (2.0 * (j + 0.5) / ny - 1.0));
  map.z.resize(ny, nx);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double y = map.x[static_cast<std::size_t>(i)] / 3.2e-3, v = map.y[static_cast<std::size_t>(j)] / 0.11;
      const double r = std::hypot(y, v);
      const bool visited = r < 0.97 && r > 0.22 && !(y > 0.3 && v > 0.45 && v < 0.6);
      map.z(j, i) = visited ? scale * (31.0 * y * y * y + 2.0 * std::sin(40.0 * y + 25.0 * v)) : missing;
    }
  map.colour = {"residual force", "N"};
  map.colour.min = -32.0;
  map.colour.max = 32.0;
  return map;
}

inline Figure maps() {
  Figure figure;
  figure.title = "Where model and data disagree";
  figure.columns = 2;
  for (int k = 0; k < 2; ++k) {
    Panel p;
    p.title = k == 0 ? "Baseline" : "Final model";
    p.x = {"y", "m"};
    p.y = {"v", "m/s"};
    p.map = residual_map(k == 0 ? 1.0 : 0.06);
    figure.panels.push_back(p);
  }
  return figure;
}

/// The named force against the residual, and the loops of force over displacement.
inline Figure forces() {
  Figure figure;
  figure.title = "cubic_stiffness: k3*y^3, k3 = 1.02(2)e6 N/m^3";
  figure.columns = 2;
  Panel scatter, loops;
  Series residual{"residual", {}, {}, Style::points, Role::residual, 1.0};
  Series force{"named force", {}, {}, Style::line, Role::effect, 1.4};
  Ribbon band{"± 1 standard deviation", {}, {}, {}, Role::noise};
  for (int i = 0; i < 1600; ++i) {
    const double y = 3.1e-3 * std::sin(0.37 * i) * std::exp(-0.0008 * i);
    residual.x.push_back(y);
    residual.y.push_back(1.02e9 * y * y * y + 2.2 * std::sin(12.9898 * i) * std::cos(78.233 * i));
  }
  for (double y = -3.1e-3; y <= 3.1e-3; y += 5e-5) {
    force.x.push_back(y);
    force.y.push_back(1.02e9 * y * y * y);
    band.x.push_back(y);
    band.low.push_back(force.y.back() - 2.2);
    band.high.push_back(force.y.back() + 2.2);
  }
  scatter.title = "Named force";
  scatter.x = {"displacement y", "m"};
  scatter.y = {"force", "N"};
  scatter.series = {residual, force};
  scatter.ribbons = {band};
  loops.title = "Loops";
  loops.x = {"displacement y", "m"};
  loops.y = {"restoring force", "N"};
  for (const auto& [label, role, style, reach] :
       {std::tuple{"measured", Role::measured, Style::line, 1.0}, {"final", Role::final, Style::dashed, 0.93}}) {
    Series s{label, {}, {}, style, role, 1.0};
    for (int i = 0; i <= 1000; ++i) {
      const double phase = 0.0062832 * 2.0 * i, y = 3e-3 * (0.8 + 0.0002 * i) * std::sin(phase);
      s.x.push_back(y * reach);
      s.y.push_back(2.1e4 * y + 9.0e8 * y * y * y + 9.0 * std::cos(phase));
    }
    loops.series.push_back(s);
  }
  figure.panels = {scatter, loops};
  return figure;
}

/// The gap of every rival, train and test.
inline Figure rivals() {
  Figure figure;
  figure.title = "Rivals, by the gap of free runs over left-out blocks";
  Panel p;
  p.x = {"gap", ""};
  Bars bars;
  bars.name = {"cubic_stiffness", "sinusoidal_stiffness", "clearance",
               "one_sided_stop",  "coulomb_friction",     "quadratic_drag"};
  bars.set = {
      {"train", {0.051, 0.078, 0.19, 0.22, 0.31, 0.305}, {0.002, 0.004, 0.02, 0.01, 0.012, 0.01}, Role::final},
      {"test", {0.062, 0.088, 0.24, missing, 0.42, 0.41}, {0.003, 0.005, 0.02, missing, 0.02, 0.01}, Role::baseline}};
  p.bars = bars;
  p.lines = {{"noise alone", 0.05, true, Style::dashed, Role::measured}};
  figure.panels = {p};
  return figure;
}

/// A spectrum on logarithmic axes, and a count on a sequential map.
inline Figure spectra() {
  Figure figure;
  figure.columns = 2;
  Panel p;
  p.title = "Residual spectrum";
  p.x = {"frequency", "Hz", missing, missing, Scale::log};
  p.y = {"force", "N/Hz^0.5", missing, missing, Scale::log};
  Series before{"baseline", {}, {}, Style::line, Role::baseline, 1.0},
      after{"final", {}, {}, Style::dashed, Role::final, 1.0};
  for (double f = 0.5; f < 400.0; f *= 1.03) {
    before.x.push_back(f);
    before.y.push_back(1e-2 / (1.0 + f / 90.0) + 2.0 / (1.0 + std::pow((f - 15.0) / 0.8, 2.0)));
    after.x.push_back(f);
    after.y.push_back(1e-2 / (1.0 + f / 90.0) * (1.0 + 0.3 * std::sin(9.0 * std::log(f))));
  }
  p.series = {before, after};
  Panel count;
  count.title = "Where there are data";
  count.x = {"y", "m"};
  count.y = {"v", "m/s"};
  count.map = residual_map(1.0);
  count.map->colour = {"samples", ""};
  count.map->diverging = false;
  count.map->z = count.map->z.array().square();
  figure.panels = {p, count};
  return figure;
}

/// A restoring force surface with a hole, and the samples near it.
inline Scene scene() {
  Scene figure;
  figure.x = {"y", "m"};
  figure.y = {"v", "m/s"};
  figure.z = {"restoring force", "N"};
  const int n = 41;
  const auto force = [](double y, double v) {
    return 2.0e4 * y + 1.5e9 * y * y * y + 120.0 * v + 12.0 * std::tanh(v / 0.01);
  };
  for (int i = 0; i < n; ++i) {
    figure.grid_x.push_back(3e-3 * (2.0 * i / (n - 1) - 1.0));
    figure.grid_y.push_back(0.1 * (2.0 * i / (n - 1) - 1.0));
  }
  figure.surface.resize(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double y = figure.grid_x[static_cast<std::size_t>(i)], v = figure.grid_y[static_cast<std::size_t>(j)];
      const double r = std::hypot(y / 3e-3, v / 0.1);
      figure.surface(j, i) = r > 1.12 ? missing : force(y, v);
    }
  Cloud cloud{"samples", {}, {}, {}, Role::measured};
  for (int i = 0; i < 700; ++i) {
    const double a = 1.0 - 0.0009 * i, y = 2.9e-3 * a * std::sin(0.31 * i), v = 0.095 * a * std::cos(0.31 * i);
    cloud.x.push_back(y);
    cloud.y.push_back(v);
    cloud.z.push_back(force(y, v) + 3.0 * std::sin(12.9898 * i) * std::cos(78.233 * i));
  }
  figure.clouds = {cloud};
  return figure;
}

inline Figure in_figure(Scene scene) {
  Figure figure;
  Panel p;
  p.title = "Restoring force surface";
  p.scene = std::move(scene);
  figure.panels = {p};
  return figure;
}

inline Figure surface() { return in_figure(scene()); }

/// Loops coloured by cycle, stems with bounds, a histogram, a matrix with names and numbers, contours, and a scene:
/// what the other samples lack. Axes of one column are shared.
inline Figure kinds() {
  Figure figure;
  figure.columns = 2;
  figure.share_x = true;
  Panel loops, stems, histogram, matrix, contours;
  loops.title = "Loops";
  loops.x = {"displacement", "m"};
  loops.y = {"force", "N"};
  loops.colour = {"cycle", ""};
  Series s{"", {}, {}, Style::line, Role::first, 1.0, {}};
  for (int i = 0; i < 4000; ++i) {
    s.x.push_back(1e-3 * std::exp(-2e-4 * i) * std::sin(0.0314 * i));
    s.y.push_back(50.0 * std::exp(-2e-4 * i) * std::sin(0.0314 * i + 0.4));
    s.colour.push_back(std::floor(i / 200.0));
  }
  loops.series = {s};
  stems.title = "Correlogram";
  stems.x = {"lag", ""};
  stems.y = {"autocorrelation", ""};
  stems.lines = {{"95 % bound", 0.2, false, Style::dashed, Role::baseline}};
  Series columns{"found", {}, {}, Style::columns, Role::first, 1.0, {}},
      lags{"", {}, {}, Style::stems, Role::first, 1.0, {}};
  for (int i = 1; i <= 30; ++i) {
    lags.x.push_back(i);
    lags.y.push_back(std::cos(0.5 * i) / i);
    columns.x.push_back(0.1 * i);
    columns.y.push_back(std::exp(-0.05 * (i - 15) * (i - 15)));
  }
  stems.series = {lags};
  histogram.title = "Histogram";
  histogram.x = {"residual", "N"};
  histogram.y = {"density", "1/N"};
  histogram.series = {columns};
  matrix.title = "Mutual information";
  matrix.x.names = {"displacement", "velocity", "a rather long feature"};
  matrix.y.names = {"a rather long feature", "velocity", "displacement"};
  matrix.map = HeatMap{{1, 2, 3}, {1, 2, 3}, Eigen::MatrixXd::Random(3, 3).cwiseAbs(), {"information", "nat"}, false,
                       true,      false};
  contours.title = "Contours";
  contours.x = {"y", "m"};
  contours.y = {"v", "m/s"};
  contours.map = residual_map(1.0);
  contours.map->contours = true;
  Panel space;
  space.title = "Surface";
  space.scene = scene();
  figure.panels = {loops, stems, histogram, matrix, contours, space};
  return figure;
}

}  // namespace samples
