// Figures: the time that a picture may take, and what is drawn of many points beside the same picture of points that
// were thinned by hand.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "benchmarks/work.hpp"
#include "figure/module.hpp"

namespace bench {
namespace {

using namespace lunid::figure;

Panel panel() {
  Panel p;
  p.x = {"time", "s"};
  p.y = {"displacement", "m"};
  return p;
}

/// A decaying vibration, measured and run.
Figure history(int panels) {
  Figure figure;
  figure.columns = panels > 1 ? 2 : 1;
  for (int k = 0; k < panels; ++k) {
    Panel p = panel();
    for (const double off : {0.0, 0.02}) {
      Series s{off > 0.0 ? "model" : "measured", {}, {}, off > 0.0 ? Style::dashed : Style::line};
      for (int i = 0; i < 4000; ++i) {
        const double t = i / 800.0;
        s.x.push_back(t);
        s.y.push_back(3e-3 * std::exp(-0.25 * t) * std::sin((40.0 + k) * t * (1.0 + off)));
      }
      p.series.push_back(std::move(s));
    }
    figure.panels.push_back(std::move(p));
  }
  return figure;
}

/// A million points of a sweep.
Figure long_line() {
  Series s;
  for (int i = 0; i < 1000000; ++i) {
    const double t = 1e-3 * i;
    s.x.push_back(t);
    s.y.push_back(std::sin(2.0 * std::numbers::pi * (0.1 + 0.45e-3 * t) * t));
  }
  Figure figure;
  figure.panels = {panel()};
  figure.panels[0].series = {std::move(s)};
  return figure;
}

/// The least and the largest value of each pixel's width.
Figure thinned_line(const Figure& figure) {
  constexpr std::size_t pixels = 1500;
  const Series& all = figure.panels[0].series[0];
  Series few;
  const std::size_t width = all.x.size() / pixels;
  for (std::size_t from = 0; from + width <= all.x.size(); from += width) {
    const auto [least, most] = std::minmax_element(all.y.begin() + static_cast<std::ptrdiff_t>(from),
                                                   all.y.begin() + static_cast<std::ptrdiff_t>(from + width));
    for (const auto& at : {std::min(least, most), std::max(least, most)}) {
      few.x.push_back(all.x[static_cast<std::size_t>(at - all.y.begin())]);
      few.y.push_back(*at);
    }
  }
  Figure thin;
  thin.panels = {panel()};
  thin.panels[0].series = {std::move(few)};
  return thin;
}

Figure ripple(int lines) {
  Scene scene;
  scene.x = {"x", "m"};
  scene.y = {"y", "m"};
  scene.z = {"z", "m"};
  scene.surface.resize(lines, lines);
  for (int i = 0; i < lines; ++i) {
    scene.grid_x.push_back(20.0 * i / lines - 10.0);
    scene.grid_y.push_back(20.0 * i / lines - 10.0);
  }
  for (int i = 0; i < lines; ++i)
    for (int j = 0; j < lines; ++j) scene.surface(i, j) = std::sin(std::hypot(scene.grid_y[i] + 0.1, scene.grid_x[j]));
  Figure figure;
  figure.panels.resize(1);
  figure.panels[0].scene = std::move(scene);
  return figure;
}

}  // namespace

std::vector<Work> figure_works(const std::string& lunid) {
  const std::string name = "lunid-bench-" + std::to_string(getpid()) + ".png";
  const std::shared_ptr<std::string> file(new std::string(std::filesystem::temp_directory_path() / name),
                                          [](std::string* path) {
                                            std::filesystem::remove(*path);
                                            delete path;
                                          });
  const auto module = std::make_shared<FigureModule>(std::filesystem::path(lunid).parent_path() / "liblunid_figure.so");
  const auto drawn = [=](Figure figure) {
    return [=, shared = std::make_shared<Figure>(std::move(figure))] { module->render(*shared, *file); };
  };
  const auto line = std::make_shared<Figure>(long_line());
  return {{"figure-next", 1, drawn(history(1)), {}, 0.2, 5},
          {"figure-four-panels", 1, drawn(history(4)), {}, 0.2, 5},
          {"figure-line-1e6", 1, [=] { module->render(*line, *file); }, {}, 1, 3},
          {"figure-surface-500", 1, drawn(ripple(500)), {}, 1, 3},
          {"figure-line-thinned", 2, [=] { module->render(*line, *file); },
           [=] { module->render(thinned_line(*line), *file); }, 0, 3},
          {"figure-surface-thinned", 2, drawn(ripple(500)), drawn(ripple(125)), 0, 3}};
}

}  // namespace bench
