// Axes, curves and layout, drawn on paper that only remembers.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "figure/draw.hpp"
#include "figure/scene_view.hpp"
#include "figure_samples.hpp"

namespace {

using namespace samples;

/// Letters of one width; close to the real face, and the same on every machine.
class Typewriter : public TextMeter {
 public:
  double width(const std::string& text, double size, bool bold) override {
    const auto letters = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
    return static_cast<double>(letters) * size * (bold ? 0.62 : 0.56);
  }
};

struct Written {
  std::string text;
  Box box;
};

class Recorder : public Canvas {
 public:
  void polyline(std::span<const Point> points, Colour, double) override {
    lines.emplace_back(points.begin(), points.end());
  }
  void polygon(std::span<const Point> corners, Colour) override { areas.emplace_back(corners.begin(), corners.end()); }
  void discs(std::span<const Point> centres, double, Colour) override {
    dots.insert(dots.end(), centres.begin(), centres.end());
  }
  void text(Point anchor, const std::string& text, const TextStyle& style) override {
    if (text.empty()) return;
    double w = Typewriter().width(text, style.size, style.bold), h = 0.8 * style.size;
    if (style.vertical) std::swap(w, h);
    const double left = anchor.x - 0.5 * (style.across + 1) * w, bottom = anchor.y - 0.5 * (style.upward + 1) * h;
    texts.push_back({text, {left, bottom, left + w, bottom + h}});
  }
  std::vector<Stroke> lines, areas;
  std::vector<Point> dots;
  std::vector<Written> texts;
};

Recorder drawn(const Figure& figure) {
  const Look look = look_for(figure);
  Typewriter meter;
  Recorder recorder;
  draw_figure(recorder, meter, look, plan_figure(meter, look, figure));
  return recorder;
}

void expect_legible(const std::vector<Written>& texts, Point extent, const std::string& name) {
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const Box& a = texts[i].box;
    EXPECT_TRUE(a.left >= -0.5 && a.bottom >= -0.5 && a.right <= extent.x + 0.5 && a.top <= extent.y + 0.5)
        << name << ": '" << texts[i].text << "' leaves the page: " << a.left << " " << a.bottom << " " << a.right << " "
        << a.top;
    for (std::size_t j = 0; j < i; ++j) {
      const Box& b = texts[j].box;
      const bool overlap = a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
      EXPECT_FALSE(overlap) << name << ": '" << texts[i].text << "' covers '" << texts[j].text << "'";
    }
  }
}

std::vector<std::pair<std::string, Figure>> all_samples() {
  Figure mixed = histories(), narrow = rivals(), wordy = maps();
  for (Panel& panel : wordy.panels) panel.map->colour.name = "mean unexplained force";
  mixed.columns = 3;
  mixed.panels.push_back(maps().panels[0]);
  mixed.panels.push_back(spectra().panels[0]);
  narrow.size.width_cm = 8.0;
  narrow.panels[0].title = "A panel title that is rather long";
  narrow.panels[0].note = "gap 0.31 → 0.05";
  return {{"histories", histories()}, {"maps", maps()},      {"forces", forces()}, {"rivals", rivals()},
          {"spectra", spectra()},     {"mixed", mixed},      {"narrow", narrow},   {"wordy", wordy},
          {"kinds", kinds()},         {"surface", surface()}};
}

TEST(FigureLayout, no_text_covers_another_or_leaves_the_page) {
  for (const auto& [name, figure] : all_samples()) {
    Typewriter meter;
    expect_legible(drawn(figure).texts, plan_figure(meter, look_for(figure), figure).extent, name);
  }
}

TEST(FigureLayout, a_surface_keeps_its_labels_apart_from_every_side) {
  for (double azimuth = -180.0; azimuth < 180.0; azimuth += 25.0)
    for (const double width : {16.0, 8.0}) {
      Figure figure = surface();
      figure.panels[0].scene->azimuth = azimuth;
      figure.size.width_cm = width;
      Typewriter meter;
      expect_legible(drawn(figure).texts, plan_figure(meter, look_for(figure), figure).extent,
                     "azimuth " + std::to_string(azimuth) + ", " + std::to_string(width) + " cm");
    }
}

TEST(FigureLayout, surfaces_side_by_side_keep_their_labels_apart) {
  Figure figure = surface();
  figure.columns = 2;
  figure.size = {24.0, 21.0, 250};
  for (const double azimuth : {-40.0, 50.0, 140.0, 0.0, 87.0}) {
    figure.panels.push_back(figure.panels.front());
    figure.panels.back().scene->azimuth = azimuth;
  }
  Typewriter meter;
  expect_legible(drawn(figure).texts, plan_figure(meter, look_for(figure), figure).extent, "six surfaces");
}

SceneView seen(const Scene& scene) {
  Typewriter meter;
  return plan_scene(meter, Look(Theme::light), scene, {10.0, 10.0, 450.0, 330.0});
}

TEST(FigureScene, the_projection_is_orthonormal_and_the_box_fits) {
  const SceneView view = seen(scene());
  const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  // Products of cosines: a few units in the last place.
  EXPECT_NEAR(dot(view.right, view.up), 0.0, 1e-15);
  EXPECT_NEAR(dot(view.right, view.toward), 0.0, 1e-15);
  EXPECT_NEAR(dot(view.up, view.up), 1.0, 1e-15);
  for (const double y : {-3e-3, 3e-3})
    for (const double v : {-0.1, 0.1})
      for (const double f : {view.z.range.low, view.z.range.high})
        EXPECT_TRUE(view.room.holds(view.on_paper(view.in_box(y, v, f))));
}

/// A ridge across the middle of the plane that hides what is behind it.
Scene ridge(double azimuth) {
  Scene scene;
  for (int i = 0; i <= 20; ++i) {
    scene.grid_x.push_back(i);
    scene.grid_y.push_back(i);
  }
  scene.surface.setZero(21, 21);
  scene.surface.row(10).setConstant(10.0);
  scene.clouds = {{"", {10.0, 10.0, 10.0}, {4.5, 15.5, 15.5}, {0.5, 0.5, -0.5}, Role::measured}};
  scene.azimuth = azimuth;
  scene.elevation = 20.0;
  return scene;
}

/// Whether a facet that is drawn after the dot at `point` covers its centre.
bool covered(const std::vector<Facet>& facets, Point point) {
  const auto dot = std::find_if(facets.begin(), facets.end(), [&](const Facet& f) {
    Point middle;
    for (const Point& p : f.corners) middle = {middle.x + 0.1 * p.x, middle.y + 0.1 * p.y};
    return f.corners.size() == 10 && std::hypot(middle.x - point.x, middle.y - point.y) < 1e-6;
  });
  EXPECT_NE(dot, facets.end());
  return std::any_of(dot + 1, facets.end(), [&](const Facet& f) {
    if (f.corners.size() != 4) return false;
    int left = 0, right = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Point &a = f.corners[k], &b = f.corners[(k + 1) % 4];
      ((b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x) > 0.0 ? left : right) += 1;
    }
    return left == 4 || right == 4;
  });
}

TEST(FigureScene, what_is_nearer_covers_what_is_behind) {
  for (const double azimuth : {-90.0, 90.0}) {
    const Scene scene = ridge(azimuth);
    const SceneView view = seen(scene);
    const auto facets = scene_facets(Look(Theme::light), scene, view);
    const auto place = [&](std::size_t i) {
      return view.on_paper(view.in_box(scene.clouds[0].x[i], scene.clouds[0].y[i], scene.clouds[0].z[i]));
    };
    // From the side of small y the ridge hides the points beyond it, and the other way round.
    EXPECT_EQ(covered(facets, place(0)), azimuth > 0.0);
    EXPECT_EQ(covered(facets, place(1)), azimuth < 0.0);
    EXPECT_TRUE(covered(facets, place(2)));  // under the surface
  }
}

TEST(FigureScene, a_fine_grid_is_thinned_and_keeps_its_extremes) {
  Scene scene;
  for (int i = 0; i < 500; ++i) {
    scene.grid_x.push_back(i);
    scene.grid_y.push_back(i);
  }
  scene.surface.setZero(500, 500);
  scene.surface(333, 77) = 9.0;
  const SceneView view = seen(scene);
  const auto facets = scene_facets(Look(Theme::light), scene, view);
  EXPECT_LT(facets.size(), 60000u);
  double top = 0.0;
  for (const Facet& facet : facets)
    for (const Point& p : facet.corners) top = std::max(top, p.y);
  // The peak, not the thinned grid's plane: the tip of its cells is where 9 N stands.
  EXPECT_NEAR(top, view.on_paper(view.in_box(77, 333, 9.0)).y, 2.0);
}

TEST(FigureContour, lines_of_a_plane_and_of_a_cone_are_where_they_must_be) {
  HeatMap map;
  for (int i = -20; i <= 20; ++i) {
    map.x.push_back(0.1 * i);
    map.y.push_back(0.1 * i);
  }
  map.z.resize(41, 41);
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 41; ++c)
      map.z(r, c) = map.x[static_cast<std::size_t>(c)] + 2.0 * map.y[static_cast<std::size_t>(r)];
  auto lines = contour(map, 0.55);
  ASSERT_EQ(lines.size(), 1u);
  for (const Point& p : lines[0]) EXPECT_NEAR(p.x + 2.0 * p.y, 0.55, 1e-12);
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 41; ++c)
      map.z(r, c) = std::hypot(map.x[static_cast<std::size_t>(c)], map.y[static_cast<std::size_t>(r)]);
  lines = contour(map, 1.03);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front().x, lines[0].back().x);  // a ring
  EXPECT_EQ(lines[0].front().y, lines[0].back().y);
  // Straight chords between nodes 0.1 apart: off by at most 0.1^2 / (8 * 1.03).
  for (const Point& p : lines[0]) EXPECT_NEAR(std::hypot(p.x, p.y), 1.03, 0.0013);
  map.z(20, 31) = missing;  // on the ring: it is broken there
  lines = contour(map, 1.03);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_GT(std::hypot(lines[0].front().x - lines[0].back().x, lines[0].front().y - lines[0].back().y), 0.05);
}

TEST(FigureLayout, shared_axes_have_one_range_and_labels_once) {
  Figure figure;
  figure.columns = 2;
  figure.share_x = figure.share_y = true;
  for (const double end : {1.0, 2.0, 3.0, 4.0}) {
    Panel p;
    p.x = {"time", "s"};
    p.y = {"force", "N"};
    p.series = {{"", {0.0, end}, {0.0, end}, Style::line, Role::first, 1.0, {}}};
    figure.panels.push_back(p);
  }
  Typewriter meter;
  const FigurePlan plan = plan_figure(meter, look_for(figure), figure);
  EXPECT_EQ(plan.panels[0].x.range.high, 3.0);
  EXPECT_EQ(plan.panels[2].x.range.high, 3.0);
  EXPECT_EQ(plan.panels[1].x.range.high, 4.0);
  EXPECT_EQ(plan.panels[0].y.range.high, plan.panels[1].y.range.high);
  const Recorder recorder = drawn(figure);
  const auto titles = [&](const std::string& text) {
    return std::count_if(recorder.texts.begin(), recorder.texts.end(),
                         [&](const Written& w) { return w.text == text; });
  };
  EXPECT_EQ(titles("time [s]"), 2);
  EXPECT_EQ(titles("force [N]"), 2);
}

TEST(FigureCurve, a_long_loop_is_drawn_once_and_completely) {
  Panel p;
  Series s{"", {}, {}, Style::line, Role::first, 1.0, {}};
  for (int i = 0; i < 400000; ++i) {
    s.x.push_back(std::cos(2.0 * 3.14159265358979 * i / 1000.0));
    s.y.push_back(std::sin(2.0 * 3.14159265358979 * i / 1000.0));
  }
  p.series = {s};
  Figure figure;
  figure.panels = {p};
  Typewriter meter;
  const FigurePlan plan = plan_figure(meter, look_for(figure), figure);
  std::size_t points = 0;
  double length = 0.0;
  for (const Stroke& stroke : series_strokes(plan.panels[0], s.x, s.y)) {
    points += stroke.size();
    for (std::size_t i = 1; i < stroke.size(); ++i)
      length += std::hypot(stroke[i].x - stroke[i - 1].x, stroke[i].y - stroke[i - 1].y);
  }
  EXPECT_LT(points, 10000u);
  const Box& plot = plan.panels[0].plot;
  // At least once round the ellipse (Ramanujan), and not four hundred times.
  const double a = 0.5 * plot.width() / 1.08, b = 0.5 * plot.height() / 1.12;
  const double round = 3.14159265 * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
  EXPECT_GT(length, 0.98 * round);
  EXPECT_LT(length, 4.0 * round);
}

TEST(FigureLayout, plots_of_a_column_and_of_a_row_are_in_line) {
  Typewriter meter;
  const Figure figure = histories();
  const FigurePlan plan = plan_figure(meter, Look(figure.theme), figure);
  ASSERT_EQ(plan.panels.size(), 3u);
  EXPECT_EQ(plan.panels[0].plot.left, plan.panels[1].plot.left);
  EXPECT_EQ(plan.panels[1].plot.bottom, plan.panels[2].plot.bottom);
  EXPECT_NEAR(plan.panels[1].plot.width(), plan.panels[2].plot.width(), 1e-9);
  EXPECT_NEAR(plan.panels[0].plot.right, plan.panels[2].plot.right, 1e-9);
}

TEST(FigureLayout, a_title_stays_by_its_labels_where_another_panel_of_the_column_has_long_names) {
  Figure figure = rivals();
  figure.panels.push_back(histories().panels[1]);
  Typewriter meter;
  const Look look = look_for(figure);
  const FigurePlan plan = plan_figure(meter, look, figure);
  for (const Written& w : drawn(figure).texts) {
    if (w.text.starts_with("displacement")) EXPECT_LT(plan.panels[1].plot.left - w.box.left, 6.0 * look.axis_text);
  }
  EXPECT_GT(plan.panels[1].plot.left - plan.panels[1].cell.left, 10.0 * look.axis_text);
}

TEST(FigureLayout, a_number_beyond_its_bar_stands_on_paper_of_its_own) {
  Figure figure = rivals();
  figure.panels[0].bars->set.resize(1);
  const Recorder recorder = drawn(figure);
  const auto number =
      std::find_if(recorder.texts.begin(), recorder.texts.end(), [](const Written& w) { return w.text == "0.051"; });
  ASSERT_NE(number, recorder.texts.end());
  const Point middle{0.5 * (number->box.left + number->box.right), 0.5 * (number->box.bottom + number->box.top)};
  // The line at 0.05, which the number would be crossed by, lies below.
  EXPECT_TRUE(std::any_of(recorder.areas.begin(), recorder.areas.end(), [&](const Stroke& area) {
    const double width = std::abs(area[2].x - area[0].x), height = std::abs(area[2].y - area[0].y);
    const Box box{std::min(area[0].x, area[2].x), std::min(area[0].y, area[2].y), std::max(area[0].x, area[2].x),
                  std::max(area[0].y, area[2].y)};
    return box.holds(middle) && width >= number->box.width() && width < 2.0 * number->box.width() && height < 20.0;
  }));
}

TEST(FigureLayout, a_panel_without_anything_to_show_says_why) {
  const auto said = [](std::vector<double> x, std::vector<double> y, Scale scale) {
    Figure figure;
    figure.panels.resize(1);
    figure.panels[0].y.scale = scale;
    figure.panels[0].series = {{"", std::move(x), std::move(y)}};
    std::string text;
    for (const Written& w : drawn(figure).texts)
      if (w.text.starts_with("no ")) text += w.text;
    return text;
  };
  EXPECT_EQ(said({}, {}, Scale::linear), "no data");
  EXPECT_EQ(said({1.0, 2.0}, {missing, missing}, Scale::linear), "no data");
  EXPECT_EQ(said({1.0, 2.0}, {-3.0, 0.0}, Scale::log), "no values above 0");
  EXPECT_EQ(said({1.0, 2.0}, {-3.0, 0.0}, Scale::linear), "");
  EXPECT_EQ(said({1.0, 2.0}, {-3.0, 1.0}, Scale::log), "");
}

TEST(FigureLayout, panels_with_one_legend_show_it_once) {
  const Recorder recorder = drawn(histories());
  const auto count = [&](const std::string& text) {
    return std::count_if(recorder.texts.begin(), recorder.texts.end(),
                         [&](const Written& w) { return w.text == text; });
  };
  EXPECT_EQ(count("measured"), 1);
  EXPECT_EQ(count("final"), 1);
}

TEST(FigureLayout, a_legend_is_not_repeated_by_later_panels) {
  Figure figure = histories();
  figure.panels.push_back(spectra().panels[0]);
  Typewriter meter;
  const FigurePlan plan = plan_figure(meter, look_for(figure), figure);
  EXPECT_NE(plan.panels[0].legend.place, Legend::none);
  EXPECT_EQ(plan.panels[1].legend.place, Legend::none);
  EXPECT_EQ(plan.panels[2].legend.place, Legend::none);
  EXPECT_NE(plan.panels[3].legend.place, Legend::none);
}

TEST(FigureLayout, maps_with_the_same_colours_share_one_bar) {
  const Recorder recorder = drawn(maps());
  const auto bars = std::count_if(recorder.texts.begin(), recorder.texts.end(),
                                  [](const Written& w) { return w.text.ends_with("force [N]"); });
  EXPECT_EQ(bars, 1);
}

TEST(FigureLayout, a_legend_stands_where_no_curve_goes) {
  Figure figure;
  Panel p;
  p.series = {{"parabola", {}, {}, Style::line, Role::first, 1.0}};
  for (int i = 0; i <= 100; ++i) {
    p.series[0].x.push_back(i);
    p.series[0].y.push_back((i - 50.0) * (i - 50.0));
  }
  figure.panels = {p};
  Typewriter meter;
  const Look look(figure.theme);
  const FigurePlan plan = plan_figure(meter, look, figure);
  const PanelPlan& panel = plan.panels[0];
  // Both upper corners hold an arm of the parabola.
  ASSERT_TRUE(panel.legend.place == Legend::bottom_right || panel.legend.place == Legend::bottom_left);
  for (const Stroke& stroke : series_strokes(panel, p.series[0].x, p.series[0].y))
    EXPECT_TRUE(clip(stroke, panel.legend.box).empty());
  figure.panels[0].series[0].y.assign(101, 0.0);
  for (std::size_t i = 0; i < 101; ++i) figure.panels[0].series[0].y[i] = i % 2 ? 1.0 : -1.0;
  EXPECT_EQ(plan_figure(meter, look, figure).panels[0].legend.place, Legend::above);
}

TEST(FigureLayout, a_zoom_scales_to_what_it_shows) {
  Typewriter meter;
  const Figure figure = histories();
  const FigurePlan plan = plan_figure(meter, Look(figure.theme), figure);
  EXPECT_LT(plan.panels[2].y.range.high, 1e-3);  // the envelope there is under 0.7 mm
  EXPECT_GT(plan.panels[0].y.range.high, 3e-3);
  // One prefix for one quantity in all of a figure.
  EXPECT_EQ(plan.panels[2].y.title, "displacement y [mm]");
}

TEST(FigureLayout, too_small_a_page_is_refused) {
  Typewriter meter;
  Figure figure = histories();
  figure.size = {5.0, 3.0, 250};
  EXPECT_THROW(plan_figure(meter, Look(figure.theme), figure), std::invalid_argument);
}

TEST(FigureTicks, the_prefix_follows_the_values) {
  const auto title = [](const std::string& unit, double largest) { return scaled_unit(unit, largest).unit; };
  EXPECT_EQ(title("m", 3e-3), "mm");
  EXPECT_EQ(title("m", 3e-6), "µm");
  EXPECT_EQ(title("m", 0.5), "m");
  EXPECT_EQ(title("N", 2.1e4), "kN");
  EXPECT_EQ(title("N/m", 2.1e6), "MN/m");
  EXPECT_EQ(title("N s/m", 2.1e4), "kN s/m");
  EXPECT_EQ(title("m/s", 2e-3), "mm/s");
  EXPECT_EQ(title("s", 5e4), "s");           // no kiloseconds
  EXPECT_EQ(title("m^2", 3e-7), "10⁻⁹ m²");  // a prefix would be squared
  EXPECT_EQ(title("N/m^3", 1e9), "GN/m³");
  EXPECT_EQ(title("", 0.05), "");
  EXPECT_EQ(title("", 3e7), "10⁶");
  EXPECT_EQ(title("mm", 0.02), "mm");
}

TEST(FigureTicks, labels_are_values_over_the_factor) {
  const AxisPlan plan = plan_axis({"y", "m"}, {-3.1e-3, 3.1e-3}, 4);
  EXPECT_EQ(plan.title, "y [mm]");
  ASSERT_GE(plan.ticks.size(), 2u);
  for (const Tick& tick : plan.ticks) {
    std::string label = tick.label;
    if (label.starts_with("−")) label.replace(0, std::string("−").size(), "-");
    EXPECT_NEAR(std::stod(label) * 1e-3, tick.value, 1e-15);
    EXPECT_GE(plan.place(tick.value), 0.0);
    EXPECT_LE(plan.place(tick.value), 1.0);
  }
}

TEST(FigureTicks, every_axis_has_two_labels_or_more) {
  for (double low = -1.0; low < 1.0; low += 0.0737)
    for (const double length : {1e-9, 0.013, 1.0, 64.0, 3e5})
      for (const int wanted : {1, 2, 3, 8}) {
        const AxisPlan plan = plan_axis({"q", ""}, {low * length, (low + 1.0) * length}, wanted);
        EXPECT_GE(plan.ticks.size(), 2u) << low << " " << length << " " << wanted;
        EXPECT_LE(plan.ticks.size(), 22u) << low << " " << length << " " << wanted;
      }
}

TEST(FigureTicks, a_small_range_far_from_zero_has_distinct_labels) {
  const AxisPlan plan = plan_axis({"t", "s"}, {1000.0, 1000.004}, 4);
  for (std::size_t i = 1; i < plan.ticks.size(); ++i) EXPECT_NE(plan.ticks[i].label, plan.ticks[i - 1].label);
}

TEST(FigureTicks, log_axes_label_decades) {
  const AxisPlan plan = plan_axis({"f", "Hz", missing, missing, Scale::log}, {0.5, 400.0}, 4);
  std::vector<std::string> labels;
  for (const Tick& tick : plan.ticks)
    if (!tick.label.empty()) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"10⁰", "10¹", "10²"}));
  EXPECT_TRUE(std::isnan(plan.place(-1.0)));
}

TEST(FigureCurve, thinning_keeps_the_extremes_and_the_ends) {
  Stroke stroke;
  for (int i = 0; i < 100000; ++i) stroke.push_back({i * 1e-3, std::sin(0.7 * i) + (i == 54321 ? 5.0 : 0.0)});
  const Stroke thinned = thin(stroke, 0.25);
  // At most four points in each of the 400 columns.
  EXPECT_LE(thinned.size(), 1600u);
  const auto higher = [](Point a, Point b) { return a.y < b.y; };
  EXPECT_EQ(std::max_element(thinned.begin(), thinned.end(), higher)->y,
            std::max_element(stroke.begin(), stroke.end(), higher)->y);
  EXPECT_EQ(std::min_element(thinned.begin(), thinned.end(), higher)->y,
            std::min_element(stroke.begin(), stroke.end(), higher)->y);
  EXPECT_EQ(thinned.front().x, stroke.front().x);
  EXPECT_EQ(thinned.back().x, stroke.back().x);
  EXPECT_TRUE(std::is_sorted(thinned.begin(), thinned.end(), [](Point a, Point b) { return a.x < b.x; }));
}

TEST(FigureCurve, a_spiral_of_many_turns_is_covered_everywhere) {
  SeenSegments seen({0, 0, 200, 200}, 0.5);
  Stroke spiral;
  for (int i = 0; i < 500000; ++i) {
    const double radius = 95.0 * std::exp(-2e-6 * i), angle = 0.01 * i;
    spiral.push_back({100.0 + radius * std::cos(angle), 100.0 + radius * std::sin(angle)});
  }
  const std::vector<Stroke> drawn = seen.fresh(spiral);
  std::size_t count = 0;
  for (const Stroke& stroke : drawn) count += stroke.size();
  EXPECT_LT(count, 100000u);
  // No turn is farther from ink than a cell and its neighbour: lines there are 1.25 wide.
  for (std::size_t i = 0; i < spiral.size(); i += 2503) {
    double nearest = 1e9;
    for (const Stroke& stroke : drawn)
      for (std::size_t k = 1; k < stroke.size(); ++k) {
        const Point a = stroke[k - 1], b = stroke[k], p = spiral[i];
        const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
        const double t = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy));
      }
    EXPECT_LT(nearest, 1.0) << i;
  }
}

TEST(FigureCurve, noise_over_noise_leaves_no_hole_and_is_not_drawn_twice) {
  SeenSegments seen({0, 0, 100, 100}, 0.5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  Stroke noise;
  for (int i = 0; i < 60000; ++i) noise.push_back({place(random), place(random)});
  std::size_t drawn = 0;
  for (const Stroke& stroke : seen.fresh(noise)) drawn += stroke.size();
  EXPECT_GT(drawn, 200u);
  EXPECT_LT(drawn, 10000u);
  // The plane is inked by now, up to its edges: hardly anything is new, wherever it runs.
  std::size_t again = 0;
  for (const Stroke& stroke : seen.fresh(noise)) again += stroke.size();
  EXPECT_LT(again, drawn / 20);
}

TEST(FigureCurve, a_coloured_noise_keeps_its_extremes_in_few_strokes) {
  Panel p;
  Series s{"", {}, {}, Style::line, Role::first, 1.0, {}};
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  for (int i = 0; i < 200000; ++i) {
    s.x.push_back(i);
    s.y.push_back(noise(random));
    s.colour.push_back(i % 7);
  }
  p.series = {s};
  p.colour = {.name = "cycle", .unit = ""};
  Figure figure;
  figure.panels = {p};
  Typewriter meter;
  const FigurePlan plan = plan_figure(meter, look_for(figure), figure);
  const auto strokes = coloured_strokes(plan.panels[0], s);
  EXPECT_LT(strokes.size(), 10000u);
  double top = 0.0;
  for (const ColouredStroke& stroke : strokes)
    for (const Point& point : stroke.stroke) top = std::max(top, point.y);
  EXPECT_NEAR(top, plan.panels[0].at(0.0, *std::max_element(s.y.begin(), s.y.end())).y, 1e-9);
}

TEST(FigureCurve, nan_breaks_a_line) {
  Figure figure;
  Panel p;
  p.series = {{"", {0, 1, 2, 3, 4, 5}, {0, 1, missing, 3, 4, 5}, Style::line, Role::first, 1.0}};
  figure.panels = {p};
  Typewriter meter;
  const FigurePlan plan = plan_figure(meter, Look(figure.theme), figure);
  const auto strokes = series_strokes(plan.panels[0], p.series[0].x, p.series[0].y);
  ASSERT_EQ(strokes.size(), 2u);
  EXPECT_EQ(strokes[0].size(), 2u);
  EXPECT_EQ(strokes[1].size(), 3u);
}

TEST(FigureCurve, clipping_cuts_at_the_frame) {
  const Box box{0, 0, 10, 10};
  const auto parts = clip({{-5, 5}, {5, 5}, {5, 20}, {8, 20}, {8, 5}}, box);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].front().x, 0.0);
  EXPECT_EQ(parts[0].back().y, 10.0);
  EXPECT_EQ(parts[1].front().y, 10.0);
  EXPECT_EQ(parts[1].back().y, 5.0);
  EXPECT_TRUE(clip({{20, 20}, {30, 30}}, box).empty());
}

TEST(FigureCurve, dashes_lie_on_the_line_and_leave_gaps) {
  const Stroke line{{0, 0}, {30, 40}, {60, 0}};
  for (const Style style : {Style::dashed, Style::dotted, Style::dash_dot}) {
    double ink = 0.0;
    for (const Stroke& part : dash({line}, style, 1.0))
      for (std::size_t i = 1; i < part.size(); ++i) {
        ink += std::hypot(part[i].x - part[i - 1].x, part[i].y - part[i - 1].y);
        const double expected = part[i].x <= 30.0 ? part[i].x * 4.0 / 3.0 : (60.0 - part[i].x) * 4.0 / 3.0;
        EXPECT_NEAR(part[i].y, expected, 1e-9);
      }
    EXPECT_GT(ink, 30.0);
    EXPECT_LT(ink, 80.0);  // the line is 100 long
  }
  EXPECT_EQ(dash({line}, Style::line, 1.0).size(), 1u);
}

TEST(FigureCurve, points_are_dropped_only_where_another_stands) {
  const std::vector<Point> points{{1, 1}, {1.01, 1.01}, {5, 5}, {50, 5}};
  const auto kept = thin_cloud(points, {0, 0, 10, 10}, 0.5);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[1].x, 5.0);
}

TEST(FigureColours, the_maps_run_from_one_end_to_the_other) {
  EXPECT_EQ(map_colour(0.0, true).blue, 77);
  EXPECT_EQ(map_colour(0.5, true).red, map_colour(0.5, true).blue);  // neutral middle
  EXPECT_EQ(map_colour(7.0, false).red, 253);
  // Light sequential end: luminance grows all along.
  double before = -1.0;
  for (double p = 0.0; p <= 1.0; p += 0.05) {
    const Colour c = map_colour(p, false);
    const double light = 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
    EXPECT_GT(light, before);
    before = light;
  }
}

TEST(FigureText, latex_is_shown_where_single_characters_can) {
  EXPECT_EQ(typeset("k_3*y^3"), "k₃*y³");
  EXPECT_EQ(typeset("\\omega_0 [rad/s]"), "ω₀ [rad/s]");
  EXPECT_EQ(typeset("\\dot y, \\ddot{y}"), "ẏ, ÿ");
  EXPECT_EQ(typeset("m s^{-2}, 10^-3"), "m s⁻², 10⁻³");
  EXPECT_EQ(typeset("y_{max}"), "yₘₐₓ");
  for (const char* same :
       {"run_2.csv", "cubic_stiffness", "a^b", "y^2.5", "x_", "\\frac{1}{2}", "^", "y^{2", "_1", "k_3a"})
    EXPECT_EQ(typeset(same), same);
}

TEST(FigureText, a_text_that_is_too_long_ends_in_dots_after_few_looks) {
  class Counting : public Typewriter {
   public:
    double width(const std::string& text, double size, bool bold) override {
      ++count;
      return Typewriter::width(text, size, bold);
    }
    int count = 0;
  } meter;
  std::string formula;
  for (int i = 0; i < 4000; ++i) formula += i % 2 ? "π" : "y";
  const std::string cut = shortened(meter, formula, 10.0, false, 100.0);
  EXPECT_LT(meter.count, 20);
  EXPECT_TRUE(cut.ends_with("…"));
  EXPECT_EQ(printable(cut), cut);  // no half character
  EXPECT_LE(meter.width(cut, 10.0, false), 100.0);
  EXPECT_GT(meter.width(cut + "yy", 10.0, false), 100.0);
  EXPECT_EQ(shortened(meter, "short", 10.0, false, 100.0), "short");
}

TEST(FigureText, bad_bytes_become_question_marks) {
  EXPECT_EQ(printable("y [\xb5m]"), "y [?m]");
  EXPECT_EQ(printable("y [µm] \xe2\x82"), "y [µm] ??");
  EXPECT_EQ(printable("two\nlines"), "two lines");
  EXPECT_EQ(printable("\xed\xa0\x80"), "???");  // a lone surrogate
}

}  // namespace
