// The grid of panels: sizes, aligned margins, the shared legend.
#include <algorithm>
#include <stdexcept>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

struct Slot {
  int row = 0;
  int column = 0;
  int span = 1;
};

/// Panels in reading order; one that does not fit its row starts the next.
std::vector<Slot> slots(const Figure& figure) {
  std::vector<Slot> result;
  int row = 0, column = 0;
  for (const Panel& panel : figure.panels) {
    const int span = std::clamp(panel.column_span, 1, figure.columns);
    if (column + span > figure.columns) {
      ++row;
      column = 0;
    }
    result.push_back({row, column, span});
    column += span;
  }
  return result;
}

/// Height in points at which a panel of this width looks right.
double usual_height(const Panel& panel, double width, bool alone) {
  if (panel.bars) {
    const double rows = static_cast<double>(panel.bars->name.size() * std::max<std::size_t>(1, panel.bars->set.size()));
    return std::max(120.0, 75.0 + (panel.bars->set.size() > 1 ? 14.0 : 19.0) * rows);
  }
  if (panel.map) return std::clamp(0.72 * width, 170.0, 290.0);
  return width > 300.0 ? (alone ? 250.0 : 165.0) : std::clamp(0.85 * width, 160.0, 220.0);
}

int row_count(const Figure& figure, const std::vector<Slot>& places) {
  return std::max(figure.rows, places.empty() ? 1 : places.back().row + 1);
}

std::vector<double> row_heights(const Figure& figure, const std::vector<Slot>& places, double column_width) {
  std::vector<double> heights(static_cast<std::size_t>(row_count(figure, places)), 60.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    double& height = heights[static_cast<std::size_t>(places[i].row)];
    height = std::max(height, usual_height(figure.panels[i], column_width * places[i].span, figure.panels.size() == 1));
  }
  return heights;
}

double points(double centimetres) { return centimetres / 2.54 * 72.0; }

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

/// The margins that keep the plots of a row and of a column in line.
class AlignedMargins {
 public:
  AlignedMargins(std::size_t rows, std::size_t columns) : top_(rows), bottom_(rows), left_(columns), right_(columns) {}

  void take(const Slot& slot, const Margins& m) {
    raise(top_, slot.row, m.top);
    raise(bottom_, slot.row, m.bottom);
    raise(left_, slot.column, m.left);
    raise(right_, slot.column + slot.span - 1, m.right);
  }

  Box inner(const Slot& slot, const Box& cell) const {
    return {cell.left + at(left_, slot.column), cell.bottom + at(bottom_, slot.row),
            cell.right - at(right_, slot.column + slot.span - 1), cell.top - at(top_, slot.row)};
  }

 private:
  static double at(const std::vector<double>& values, int i) { return values[static_cast<std::size_t>(i)]; }
  static void raise(std::vector<double>& values, int i, double value) {
    double& held = values[static_cast<std::size_t>(i)];
    held = std::max(held, value);
  }
  std::vector<double> top_, bottom_, left_, right_;
};

class Planner {
 public:
  Planner(Canvas& canvas, const Look& look, const Figure& figure)
      : canvas_(canvas), look_(look), figure_(figure), places_(slots(figure)) {}

  FigurePlan plan() {
    const Point extent = figure_extent(figure_);
    const double width = extent.x - 2.0 * look_.margin;
    plan_.heading = wrapped(canvas_, figure_.title, look_.heading_text, true, width);
    const std::vector<LegendEntry> shared = shared_entries(figure_);
    plan_.legend = legend_rows(canvas_, look_, shared, width);
    shares_ = !shared.empty();
    set_cells(extent);
    align();   // a first guess of the plots, without legends
    align();   // titles and ticks now know their true room
    for (PanelPlan& p : plan_.panels)
      if (!shares_) place_legend(canvas_, look_, p, p.panel->legend);
    align();   // strips above panels take their room
    return std::move(plan_);
  }

 private:
  void set_cells(Point extent) {
    const double header = static_cast<double>(plan_.heading.size()) * line_height(look_.heading_text) +
                          (plan_.heading.empty() ? 0.0 : look_.gap) + strip_height(look_, plan_.legend.size());
    const double between = 12.0;
    const double width = (extent.x - 2.0 * look_.margin - between * (figure_.columns - 1)) / figure_.columns;
    std::vector<double> heights = row_heights(figure_, places_, width);
    const double room = extent.y - 2.0 * look_.margin - header - between * (static_cast<double>(heights.size()) - 1.0);
    double total = 0.0;
    for (const double height : heights) total += height;
    for (double& height : heights) height *= room / total;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Slot& slot = places_[i];
      PanelPlan p;
      p.panel = &figure_.panels[i];
      p.legend.entries = shares_ ? std::vector<LegendEntry>{} : legend_entries(*p.panel);
      p.cell.left = look_.margin + slot.column * (width + between);
      p.cell.right = p.cell.left + slot.span * width + (slot.span - 1) * between;
      p.cell.top = extent.y - look_.margin - header;
      for (int row = 0; row < slot.row; ++row) p.cell.top -= heights[static_cast<std::size_t>(row)] + between;
      p.cell.bottom = p.cell.top - heights[static_cast<std::size_t>(slot.row)];
      p.plot = {p.cell.left + 50.0, p.cell.bottom + 35.0, p.cell.right - 10.0, p.cell.top - 20.0};
      plan_.panels.push_back(std::move(p));
    }
  }

  void align() {
    AlignedMargins margins(static_cast<std::size_t>(row_count(figure_, places_)), static_cast<std::size_t>(figure_.columns));
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PanelPlan& p = plan_.panels[i];
      plan_content(canvas_, look_, p, p.plot.width(), p.plot.height());
      margins.take(places_[i], needed_margins(canvas_, look_, p));
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PanelPlan& p = plan_.panels[i];
      const Box before = p.plot;
      p.plot = margins.inner(places_[i], p.cell);
      if (p.plot.width() < 20.0 || p.plot.height() < 20.0)
        throw std::invalid_argument("the figure is too small for its panels: raise size.width_cm or size.height_cm");
      follow(p.legend, before, p.plot);
    }
  }

  /// A corner's legend stays in its corner when the plot moves.
  static void follow(LegendPlan& legend, const Box& before, const Box& now) {
    const bool left = legend.place == Legend::top_left || legend.place == Legend::bottom_left;
    const bool top = legend.place == Legend::top_left || legend.place == Legend::top_right;
    const double dx = left ? now.left - before.left : now.right - before.right;
    const double dy = top ? now.top - before.top : now.bottom - before.bottom;
    legend.box = {legend.box.left + dx, legend.box.bottom + dy, legend.box.right + dx, legend.box.top + dy};
  }

  Canvas& canvas_;
  const Look& look_;
  const Figure& figure_;
  std::vector<Slot> places_;
  FigurePlan plan_;
  bool shares_ = false;
};

}  // namespace

Point figure_extent(const Figure& figure) {
  const double width = points(figure.size.width_cm);
  if (figure.size.height_cm > 0.0) return {width, points(figure.size.height_cm)};
  const std::vector<Slot> places = slots(figure);
  double height = (figure.title.empty() ? 0.0 : 22.0) + (shared_entries(figure).empty() ? 0.0 : 18.0) + 14.0;
  for (const double row : row_heights(figure, places, width / figure.columns)) height += row + 10.0;
  return {width, height};
}

FigurePlan plan_figure(Canvas& canvas, const Look& look, const Figure& figure) {
  return Planner(canvas, look, figure).plan();
}

void draw_figure(Canvas& canvas, const Figure& figure) {
  const Look look(figure.theme);
  const Point extent = figure_extent(figure);
  canvas.rectangle({0.0, 0.0, extent.x, extent.y}, look.palette.background);
  const FigurePlan plan = plan_figure(canvas, look, figure);
  double y = extent.y - look.margin;
  for (const std::string& line : plan.heading) {
    canvas.text({look.margin, y}, line,
                {.size = look.heading_text, .bold = true, .colour = look.palette.ink, .across = -1, .upward = 1});
    y -= line_height(look.heading_text);
  }
  draw_strip(canvas, look, plan.legend, look.margin, y);
  for (const PanelPlan& panel : plan.panels) draw_panel(canvas, look, panel);
}

}  // namespace lunid::figure
