// The grid of panels: aligned margins, equal plots, the shared legend, prefixes and colour bars.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

constexpr double between = 12.0;  // points, from panel to panel

struct Slot {
  std::size_t row = 0;
  std::size_t first = 0;  ///< column
  std::size_t last = 0;
};

/// Panels in reading order; one that does not fit its row starts the next.
std::vector<Slot> slots(const Figure& figure) {
  const auto columns = static_cast<std::size_t>(figure.columns);
  std::vector<Slot> result;
  std::size_t row = 0, column = 0;
  for (const Panel& panel : figure.panels) {
    const auto span = static_cast<std::size_t>(std::clamp(panel.column_span, 1, figure.columns));
    if (column + span > columns) {
      ++row;
      column = 0;
    }
    result.push_back({row, column, column + span - 1});
    column += span;
  }
  return result;
}

/// The height at which a plot of this width looks right.
double usual_height(const Panel& panel, double width, bool alone) {
  if (panel.bars) {
    const double sets = static_cast<double>(std::max<std::size_t>(1, panel.bars->set.size()));
    return std::max(60.0, (sets > 1.0 ? 6.0 + 13.0 * sets : 19.0) * static_cast<double>(panel.bars->name.size()));
  }
  if (panel.scene) return std::clamp(0.78 * width, 150.0, 340.0);
  if (panel.map) return std::clamp(0.8 * width, 110.0, 250.0);
  if (width > 300.0) return alone ? 190.0 : 118.0;
  return std::clamp(0.72 * width, 105.0, 170.0);
}

/// The legend that all panels with entries share, when there are several such panels; empty otherwise.
std::vector<LegendEntry> shared_entries(const Figure& figure) {
  std::vector<LegendEntry> shared;
  int with_entries = 0;
  for (const Panel& panel : figure.panels) {
    const std::vector<LegendEntry> entries = legend_entries(panel);
    if (entries.empty() || panel.legend == Legend::none) continue;
    if (panel.legend != Legend::automatic || (with_entries > 0 && entries != shared)) return {};
    shared = entries;
    ++with_entries;
  }
  return with_entries > 1 ? shared : std::vector<LegendEntry>{};
}

Hints prefix_hints(const std::vector<PanelPlan>& panels) {
  Hints hints;
  const auto take = [&](const Axis& axis, const Range& range) {
    double& largest = hints[{axis.name, axis.unit}];
    largest = std::max({largest, std::abs(range.low), std::abs(range.high)});
  };
  for (const PanelPlan& plan : panels) {
    const Panel& panel = *plan.panel;
    if (panel.scene) continue;
    take(panel.x, plan.x_reach);
    if (!panel.bars) take(panel.y, plan.y_reach);
    if (const Axis* colour = colour_axis(panel)) take(*colour, colour_range(panel));
  }
  return hints;
}

/// Whether two panels have the same colours, so that one bar does for both.
bool same_colours(const Panel& a, const Panel& b) {
  if (!colour_axis(a) || !colour_axis(b) || diverging_colours(a) != diverging_colours(b)) return false;
  const Axis &p = *colour_axis(a), &q = *colour_axis(b);
  const Range r = colour_range(a), s = colour_range(b);
  return p.name == q.name && p.unit == q.unit && p.scale == q.scale && r.low == s.low && r.high == s.high;
}

bool same_axis(const Axis& a, const Axis& b) {
  return a.name == b.name && a.unit == b.unit && a.scale == b.scale && a.names == b.names;
}

void raise(double& held, double value) { held = std::max(held, value); }

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

class Planner {
 public:
  Planner(TextMeter& meter, const Look& look, const Figure& figure)
      : meter_(meter),
        look_(look),
        figure_(figure),
        places_(slots(figure)),
        columns_(static_cast<std::size_t>(figure.columns)),
        rows_(std::max(static_cast<std::size_t>(std::max(0, figure.rows)), places_.back().row + 1)) {}

  FigurePlan plan() {
    plan_.extent.x = figure_.size.width_cm / 2.54 * 72.0;
    const double width = plan_.extent.x - 2.0 * look_.margin;
    plan_.heading = wrapped(meter_, figure_.title, look_.heading_text, true, width);
    const std::vector<LegendEntry> shared = shared_entries(figure_);
    plan_.legend = legend_rows(meter_, look_, shared, width);
    start(!shared.empty());
    // Margins depend on ticks and ticks on the plots' sizes: the third round has nothing left to change.
    for (int round = 0; round < 3; ++round) arrange();
    for (PanelPlan& p : plan_.panels) place_legend(meter_, look_, p, p.panel->legend);
    arrange();
    for (PanelPlan& p : plan_.panels) {
      settle_legend(meter_, look_, p);
      // A scene has its labels within its room, which is all of its cell.
      if (const auto& scene = p.panel->scene)
        p.view = plan_scene(meter_, look_, *scene, {p.cell.left, p.cell.bottom, p.cell.right, p.plot.top});
    }
    return std::move(plan_);
  }

 private:
  void start(bool shared) {
    const double guess = (plan_.extent.x - 2.0 * look_.margin) / static_cast<double>(columns_) - 60.0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PanelPlan p;
      p.panel = &figure_.panels[i];
      if (!shared && !said_before(i)) p.legend.entries = legend_entries(*p.panel);
      p.plot = {0.0, 0.0, std::max(40.0, guess), 100.0};
      p.colour_bar = colour_axis(*p.panel) != nullptr;
      p.no_data = p.panel->map && p.panel->map->z.hasNaN();
      if (i > 0 && places_[i - 1].row == places_[i].row && same_colours(figure_.panels[i - 1], *p.panel)) {
        plan_.panels.back().colour_bar = false;
        p.no_data = p.no_data || plan_.panels.back().no_data;
      }
      plan_.panels.push_back(std::move(p));
    }
    set_reaches();
    hints_ = prefix_hints(plan_.panels);
  }

  void set_reaches() {
    std::vector<PanelPlan>& panels = plan_.panels;
    for (PanelPlan& p : panels)
      if (!p.panel->scene) p.x_reach = x_range(*p.panel);
    if (figure_.share_x)
      share(&Panel::x, &PanelPlan::x_reach, [&](std::size_t i, std::size_t j) {
        return places_[i].first == places_[j].first && places_[i].last == places_[j].last && flat(i) && flat(j);
      });
    for (PanelPlan& p : panels)
      if (!p.panel->scene) p.y_reach = y_range(*p.panel, p.x_reach);
    if (figure_.share_y)
      share(&Panel::y, &PanelPlan::y_reach, [&](std::size_t i, std::size_t j) {
        return places_[i].row == places_[j].row && flat(i) && flat(j) && !panels[i].panel->bars &&
               !panels[j].panel->bars;
      });
    for (std::size_t i = 0; i < panels.size(); ++i)
      for (std::size_t j = i + 1; j < panels.size(); ++j) {
        if (!flat(i) || !flat(j)) continue;
        if (figure_.share_x && places_[i].first == places_[j].first && places_[i].last == places_[j].last &&
            places_[j].row == places_[i].row + 1 && same_axis(panels[i].panel->x, panels[j].panel->x))
          panels[i].bare_x = true;
        if (figure_.share_y && places_[i].row == places_[j].row && places_[j].first == places_[i].last + 1 &&
            same_axis(panels[i].panel->y, panels[j].panel->y) && !panels[j].panel->bars)
          panels[j].bare_y = true;
      }
  }

  bool flat(std::size_t i) const { return !figure_.panels[i].scene; }

  /// Gives panels that show the same quantity, where `together` says so, one range.
  template <class Together>
  void share(Axis Panel::*axis, Range PanelPlan::*reach, Together together) {
    std::vector<PanelPlan>& panels = plan_.panels;
    std::vector<Range> own;
    for (const PanelPlan& p : panels) own.push_back(p.*reach);
    for (std::size_t i = 0; i < panels.size(); ++i)
      for (std::size_t j = 0; j < panels.size(); ++j) {
        if (!together(i, j) || !same_axis(panels[i].panel->*axis, panels[j].panel->*axis)) continue;
        (panels[i].*reach).low = std::min((panels[i].*reach).low, own[j].low);
        (panels[i].*reach).high = std::max((panels[i].*reach).high, own[j].high);
      }
  }

  /// Whether an earlier panel has the same legend.
  bool said_before(std::size_t i) const {
    const std::vector<LegendEntry> entries = legend_entries(figure_.panels[i]);
    if (figure_.panels[i].legend != Legend::automatic) return false;
    return std::any_of(figure_.panels.begin(), figure_.panels.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const Panel& p) { return p.legend != Legend::none && legend_entries(p) == entries; });
  }

  void arrange() {
    left_.assign(columns_, 0.0);
    right_.assign(columns_, 0.0);
    top_.assign(rows_, 0.0);
    bottom_.assign(rows_, 0.0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PanelPlan& p = plan_.panels[i];
      plan_content(meter_, look_, p, hints_);
      const Margins m = needed_margins(meter_, look_, p);
      raise(left_[places_[i].first], m.left);
      raise(right_[places_[i].last], m.right);
      raise(top_[places_[i].row], m.top);
      raise(bottom_[places_[i].row], m.bottom);
    }
    set_across();
    set_down();
  }

  /// Equal plots for all columns.
  void set_across() {
    const double n = static_cast<double>(columns_);
    const double room = plan_.extent.x - 2.0 * look_.margin - (n - 1.0) * between - sum(left_) - sum(right_);
    const double width = room / n;
    check(width);
    std::vector<double> starts(columns_ + 1, look_.margin);
    for (std::size_t c = 0; c < columns_; ++c) starts[c + 1] = starts[c] + left_[c] + width + right_[c] + between;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PanelPlan& p = plan_.panels[i];
      p.cell.left = starts[places_[i].first];
      p.cell.right = starts[places_[i].last + 1] - between;
      p.plot.left = p.cell.left + left_[places_[i].first];
      p.plot.right = p.cell.right - right_[places_[i].last];
    }
  }

  void set_down() {
    std::vector<double> heights(rows_, 40.0);
    for (std::size_t i = 0; i < places_.size(); ++i)
      raise(heights[places_[i].row],
            usual_height(figure_.panels[i], plan_.panels[i].plot.width(), places_.size() == 1));
    const double rest =
        2.0 * look_.margin + header() + static_cast<double>(rows_ - 1) * between + sum(top_) + sum(bottom_);
    if (figure_.size.height_cm > 0.0) {
      plan_.extent.y = figure_.size.height_cm / 2.54 * 72.0;
      const double share = (plan_.extent.y - rest) / sum(heights);
      for (double& height : heights) height *= share;
    } else {
      plan_.extent.y = std::ceil(rest + sum(heights));
    }
    double y = plan_.extent.y - look_.margin - header();
    for (std::size_t row = 0; row < rows_; ++row) {
      check(heights[row]);
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (places_[i].row != row) continue;
        PanelPlan& p = plan_.panels[i];
        p.cell.top = y;
        p.plot.top = y - top_[row];
        p.plot.bottom = p.plot.top - heights[row];
        p.cell.bottom = p.plot.bottom - bottom_[row];
      }
      y -= top_[row] + heights[row] + bottom_[row] + between;
    }
  }

  double header() const {
    return static_cast<double>(plan_.heading.size()) * line_height(look_.heading_text) +
           (plan_.heading.empty() ? 0.0 : look_.gap) + strip_height(look_, plan_.legend.size());
  }

  static void check(double length) {
    if (!(length >= 20.0))
      throw std::invalid_argument("the figure is too small for its panels: raise size.width_cm or size.height_cm");
  }

  TextMeter& meter_;
  const Look& look_;
  const Figure& figure_;
  std::vector<Slot> places_;
  Hints hints_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<double> left_, right_, top_, bottom_;
  FigurePlan plan_;
};

}  // namespace

Look look_for(const Figure& figure) {
  const double column = figure.size.width_cm / 2.54 * 72.0 / figure.columns;
  return Look(figure.theme, std::clamp(column / 200.0, 0.75, 1.0));
}

FigurePlan plan_figure(TextMeter& meter, const Look& look, const Figure& figure) {
  return Planner(meter, look, figure).plan();
}

}  // namespace lunid::figure
