// What the module writes, and how it fails.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <regex>
#include <sstream>

#include "expr/error.hpp"
#include "figure_samples.hpp"

namespace {

using namespace samples;
using lunid::InputError;

class FigureModuleTest : public testing::Test {
 protected:
  Folder folder;
  FigureModule module{module_file()};

  std::string message(const std::function<void()>& work) {
    try {
      work();
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  Figure line(std::vector<double> x, std::vector<double> y) {
    Figure figure;
    Panel p;
    p.x = {"time", "s"};
    p.y = {"y", "m"};
    p.series = {{"", std::move(x), std::move(y), Style::line, Role::first, 1.0}};
    figure.panels = {p};
    return figure;
  }
};

/// Width and height of a PNG: two big-endian words after the signature and the first chunk's head.
std::pair<unsigned, unsigned> png_size(const std::string& bytes) {
  const auto word = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes.at(at + k));
    return value;
  };
  return {word(16), word(20)};
}

TEST_F(FigureModuleTest, draws_every_kind_of_figure_in_every_format) {
  for (const auto& [name, figure] : {std::pair{"histories", histories()},
                                     {"maps", maps()},
                                     {"forces", forces()},
                                     {"rivals", rivals()},
                                     {"spectra", spectra()},
                                     {"kinds", kinds()},
                                     {"surface", surface()}}) {
    for (const std::string extension : {".png", ".svg", ".pdf"}) {
      const std::string path = folder / (name + extension);
      module.render(figure, path);
      EXPECT_GT(content(path).size(), 5000u) << path;
    }
    const std::string png = content(folder / (std::string(name) + ".png"));
    EXPECT_TRUE(png.starts_with("\x89PNG")) << name;
    EXPECT_EQ(png_size(png).first, 1575u) << name;  // 16 cm at 250 dots per inch
  }
  Figure dark = histories();
  dark.theme = Theme::dark;
  module.render(dark, folder / "dark.png");
  dark = surface();
  dark.theme = Theme::dark;
  dark.size = {10.0, 8.0, 254};
  module.render(dark, folder / "dark_surface.png");
  EXPECT_EQ(png_size(content(folder / "dark_surface.png")), (std::pair<unsigned, unsigned>{1000, 800}));
}

TEST_F(FigureModuleTest, the_same_figure_gives_the_same_bytes) {
  FigureModule another(module_file());
  for (const std::string extension : {".png", ".svg", ".pdf"}) {
    module.render(forces(), folder / ("a" + extension));
    another.render(forces(), folder / ("b" + extension));
    EXPECT_EQ(content(folder / ("a" + extension)), content(folder / ("b" + extension))) << extension;
  }
  module.render(surface(), folder / "a.png");
  another.render(surface(), folder / "b.png");
  EXPECT_EQ(content(folder / "a.png"), content(folder / "b.png"));
}

TEST_F(FigureModuleTest, what_was_drawn_before_leaves_no_trace) {
  module.render(forces(), folder / "first.png");
  Figure other = surface();
  other.theme = Theme::dark;
  other.size = {9.0, 14.0, 120};
  module.render(other, folder / "between.png");
  module.render(surface(), folder / "between.svg");
  module.render(forces(), folder / "again.png");
  EXPECT_EQ(content(folder / "first.png"), content(folder / "again.png"));
}

/// Points of the first polyline with this stroke and this number of points.
std::vector<std::pair<double, double>> polyline(const std::string& svg, const std::string& stroke, std::size_t count) {
  const std::regex element("<polyline stroke=\"" + stroke + "\"[^>]*points=\"([^\"]*)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), element), end; it != end; ++it) {
    std::istringstream text((*it)[1].str());
    std::vector<std::pair<double, double>> points;
    double x, y;
    char comma;
    while (text >> x >> comma >> y) points.emplace_back(x, y);
    if (points.size() == count) return points;
  }
  return {};
}

TEST_F(FigureModuleTest, a_curve_in_svg_has_the_proportions_of_its_data) {
  const std::vector<double> x{0.0, 1.0, 2.5, 3.0, 7.0}, y{0.0, 2e-3, -1e-3, 4e-3, 1e-3};
  module.render(line(x, y), folder / "curve.svg");
  const std::string svg = content(folder / "curve.svg");
  EXPECT_NE(svg.find("viewBox=\"0 0 "), std::string::npos);
  const auto points = polyline(svg, "#0072b2", x.size());
  ASSERT_EQ(points.size(), x.size());
  const double width = points[4].first - points[0].first, height = points[3].second - points[2].second;
  EXPECT_GT(width, 0.0);
  EXPECT_LT(height, 0.0);  // SVG counts downwards
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Coordinates are written with six digits.
    EXPECT_NEAR((points[i].first - points[0].first) / width, x[i] / 7.0, 1e-5);
    EXPECT_NEAR((points[i].second - points[2].second) / height, (y[i] - y[2]) / 5e-3, 1e-5);
  }
}

TEST_F(FigureModuleTest, odd_text_is_drawn_and_not_interpreted) {
  Figure figure = line({0, 1}, {0, 1});
  figure.title = "$\\frac{1}{2}$ | \xb5m \xff & <b>";
  figure.panels[0].series[0].label = "a $ b $";
  module.render(figure, folder / "odd.svg");
  module.render(figure, folder / "odd.png");
}

TEST_F(FigureModuleTest, empty_and_constant_data_give_axes) {
  module.render(line({0, 1, 2}, {missing, missing, missing}), folder / "nan.png");
  module.render(line({0, 1, 2}, {5, 5, 5}), folder / "flat.png");
  module.render(line({1, 1}, {0, 0}), folder / "dot.png");
  module.render(line({0, 1, 2}, {1e300, -1e300, 0.0}), folder / "huge.png");
  module.render(line({0, 1, 2}, {INFINITY, -INFINITY, 0.0}), folder / "infinite.png");
}

TEST_F(FigureModuleTest, a_failure_names_the_path_and_leaves_the_earlier_file) {
  const std::string nowhere = folder / "none/at/all.png";
  EXPECT_EQ(message([&] { module.render(forces(), nowhere); }), nowhere + ": cannot write: No such file or directory");
  std::ofstream(folder / "kept.png") << "earlier";
  Figure small = histories();
  small.size = {5.0, 3.0, 250};
  EXPECT_EQ(message([&] { module.render(small, folder / "kept.png"); }),
            (folder / "kept.png") +
                ": cannot draw: the figure is too small for its panels: raise size.width_cm or size.height_cm");
  EXPECT_EQ(content(folder / "kept.png"), "earlier");
  Figure large = histories();
  large.size = {100.0, 0.0, 600};
  EXPECT_EQ(message([&] { module.render(large, folder / "large.png"); }),
            (folder / "large.png") +
                ": cannot draw: the picture would be 23622 pixels long, more than 8192: lower size or dpi");
  EXPECT_FALSE(std::filesystem::exists(folder / "large.png"));
}

TEST_F(FigureModuleTest, a_full_disk_is_an_error) {
  const std::string path = folder / "full.png";
  std::filesystem::create_symlink("/dev/full", path);
  EXPECT_EQ(message([&] { module.render(forces(), path); }), path + ": cannot write: No space left on device");
  std::filesystem::remove(path);
}

TEST_F(FigureModuleTest, wrong_extensions_are_refused_before_anything_is_loaded) {
  FigureModule nowhere("/no/such/module.so");
  EXPECT_EQ(message([&] { nowhere.render(forces(), "a.jpg"); }),
            "a.jpg: expected a file name that ends in .png, .svg, .pdf, got 'a.jpg'");
  EXPECT_EQ(message([&] { nowhere.export_surface(surface(), "a.stl"); }),
            "a.stl: expected a file name that ends in .vts, .vtp, .vtu, .vtm, got 'a.stl'");
  EXPECT_EQ(message([&] { nowhere.export_surface(forces(), "a.vts"); }),
            "the figure has no surface: only its numbers can be written, as .csv");
  EXPECT_EQ(message([&] { nowhere.render(forces(), "a.png"); }),
            "figures: the drawing module is not there, looked for /no/such/module.so");
}

TEST_F(FigureModuleTest, a_module_of_another_version_is_refused_and_not_run) {
  FigureModule stale(LUNID_STALE_MODULE), other(LUNID_OTHER_MODULE);
  EXPECT_EQ(message([&] { stale.render(forces(), folder / "a.png"); }),
            "figures: the drawing module belongs to another version of Lunid: build or install both together");
  EXPECT_EQ(message([&] { other.render(forces(), folder / "a.png"); }),
            "figures: " LUNID_OTHER_MODULE " belongs to another version of Lunid: build or install both together");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST_F(FigureModuleTest, wrong_figures_are_refused_with_their_place) {
  Figure figure = forces();
  figure.panels[1].series[0].x.pop_back();
  EXPECT_EQ(message([&] { module.render(figure, "a.png"); }),
            "figure: panel 2: curve 'measured': x and y: expected the same length, got 1000 and 1001");
  EXPECT_EQ(message([&] { module.render(Figure{}, "a.png"); }), "figure: panels: expected at least one, got none");
  figure = maps();
  figure.panels[0].map->x[3] = 0.0;
  EXPECT_EQ(message([&] { module.render(figure, "a.png"); }),
            "figure: panel 1: map: x: expected finite values that increase, got something else at position 5");
  Figure bad = surface();
  bad.panels[0].scene->surface.conservativeResize(40, 41);
  EXPECT_EQ(message([&] { module.render(bad, "a.png"); }),
            "figure: panel 1: surface: rows and grid_y: expected the same length, got 40 and 41");
  bad = kinds();
  bad.panels[0].series[0].colour.pop_back();
  EXPECT_EQ(message([&] { module.render(bad, "a.png"); }),
            "figure: panel 1: curve without label: x and colour: expected the same length, got 4000 and 3999");
}

TEST_F(FigureModuleTest, a_page_has_the_data_and_long_series_thinned_with_their_extremes) {
  Figure figure = line({0.0, 1.0, 2.5}, {0.0, missing, 4e-3});
  EXPECT_EQ(
      page_data(figure),
      R"({"columns":1,"faint":"#e2e2e2","hatch":"#bcbcbc","ink":"#1e1e1e","no_data":"#e8e8e8","panels":[{"note":"",)"
      R"("series":[{"colour":"#0072b2","label":"","style":"line","width":1.0,"x":[0.0,1.0,2.5],"y":[0.0,null,0.004]}],)"
      R"("span":1,"title":"","x":{"factor":1.0,"max":2.5,"min":0.0,"title":"time [s]"},)"
      R"("y":{"factor":0.001,"max":0.00424,"min":-0.00024,"title":"y [mm]"}}],"paper":"#ffffff","title":""})");
  std::vector<double> x, y;
  for (int i = 0; i < 1000000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(0.1 * i) + (i == 777777 ? 3.5 : 0.0));
  }
  const std::string data = page_data(line(x, y));
  EXPECT_LT(data.size(), 500000u);
  EXPECT_NE(data.find("\"thinned\":1000000"), std::string::npos);
  double most = 0.0;
  std::istringstream text(data.substr(data.find("\"y\":[") + 5));
  for (std::string cell; std::getline(text, cell, ',') && cell.find(']') == std::string::npos;)
    if (cell != "null") most = std::max(most, std::strtod(cell.c_str(), nullptr));
  EXPECT_NEAR(most, std::sin(0.1 * 777777) + 3.5, 1e-4);
  EXPECT_NE(page_data(surface()).find("\"clouds\":[{\"colour\""), std::string::npos);
}

TEST_F(FigureModuleTest, exported_numbers_read_back_bit_for_bit) {
  const std::vector<double> x{0.1, 1.0 / 3.0, 5e-324, 1.7976931348623157e308}, y{-0.0, 2e-3, missing, 6.02214076e23};
  Figure figure = line(x, y);
  figure.panels[0].series[0].label = "a, \"b\"";
  export_data(figure, folder / "data.csv");
  std::istringstream text(content(folder / "data.csv"));
  std::string row;
  std::getline(text, row);
  EXPECT_EQ(row, "# panel 1: ; x: time [s]; y: y [m]");
  std::getline(text, row);
  EXPECT_EQ(row, "panel,kind,label,name,x,y,z");
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::getline(text, row);
    const std::string head = "1,curve,\"a, \"\"b\"\"\",,";
    ASSERT_TRUE(row.starts_with(head)) << row;
    char* rest;
    const double got_x = std::strtod(row.c_str() + head.size(), &rest);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(got_x), std::bit_cast<std::uint64_t>(x[i]));
    const double got_y = std::strtod(rest + 1, &rest);
    if (std::isnan(y[i]))
      EXPECT_TRUE(std::isnan(got_y));
    else
      EXPECT_EQ(std::bit_cast<std::uint64_t>(got_y), std::bit_cast<std::uint64_t>(y[i]));
    EXPECT_EQ(std::string(rest), ",");  // no z
  }
  EXPECT_FALSE(std::getline(text, row));
}

TEST_F(FigureModuleTest, exported_maps_and_surfaces_have_a_row_for_each_cell) {
  export_data(maps(), folder / "maps.csv");
  export_data(surface(), folder / "surface.csv");
  const auto rows = [](const std::string& text, const std::string& kind) {
    std::size_t count = 0;
    for (std::size_t at = text.find(kind); at != std::string::npos; at = text.find(kind, at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(rows(content(folder / "maps.csv"), ",map,"), 2u * 36u * 28u);
  EXPECT_EQ(rows(content(folder / "surface.csv"), ",surface,"), 41u * 41u);
  EXPECT_EQ(rows(content(folder / "surface.csv"), ",cloud,"), 700u);
}

}  // namespace
