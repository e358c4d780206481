#include "figure/draw.hpp"

namespace lunid::figure {

void draw_figure(Canvas& canvas, TextMeter& meter, const Look& look, const FigurePlan& plan) {
  double y = plan.extent.y - look.margin;
  for (const std::string& line : plan.heading) {
    canvas.text({look.margin, y}, line,
                {.size = look.heading_text, .bold = true, .colour = look.palette.ink, .across = -1, .upward = 1});
    y -= line_height(look.heading_text);
  }
  draw_strip(canvas, meter, look, plan.legend, look.margin, y);
  for (const PanelPlan& panel : plan.panels) draw_panel(canvas, meter, look, panel);
}

}  // namespace lunid::figure
