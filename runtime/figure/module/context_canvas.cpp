#include "figure/module/context_canvas.hpp"

#include <vtkAbstractMapper.h>
#include <vtkBrush.h>
#include <vtkCellArray.h>
#include <vtkContext2D.h>
#include <vtkContextDevice2D.h>
#include <vtkNew.h>
#include <vtkPen.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "figure/look.hpp"
#include "figure/module/font.hpp"

namespace lunid::figure {

std::vector<float> ContextCanvas::scaled(std::span<const Point> points) const {
  std::vector<float> values;
  values.reserve(2 * points.size());
  for (const Point& p : points) {
    values.push_back(static_cast<float>(p.x * scale_));
    values.push_back(static_cast<float>(p.y * scale_));
  }
  return values;
}

void ContextCanvas::polyline(std::span<const Point> points, Colour colour, double width) {
  vtkPen* pen = context_.GetPen();
  pen->SetLineType(vtkPen::SOLID_LINE);
  pen->SetColor(colour.red, colour.green, colour.blue, colour.alpha);
  pen->SetWidth(static_cast<float>(width * scale_));
  std::vector<float> values = scaled(points);
  context_.DrawPoly(values.data(), static_cast<int>(points.size()));
}

void ContextCanvas::polygon(std::span<const Point> corners, Colour colour) {
  context_.GetBrush()->SetColor(colour.red, colour.green, colour.blue, colour.alpha);
  std::vector<float> values = scaled(corners);
  // By the device: the context would add an outline that the exporters write even where the pen is off.
  context_.GetDevice()->DrawPolygon(values.data(), static_cast<int>(corners.size()));
}

namespace {

/// Discs as polygons of so many corners that no pixel tells.
std::vector<Facet> rings(std::span<const Point> centres, double radius, Colour colour) {
  constexpr int corners = 12;
  constexpr double turn = 6.283185307179586;
  std::vector<Facet> facets;
  facets.reserve(centres.size());
  for (const Point& c : centres) {
    Facet& facet = facets.emplace_back(Facet{{}, colour});
    for (int k = 0; k < corners; ++k)
      facet.corners.push_back(
          {c.x + radius * std::cos(turn * k / corners), c.y + radius * std::sin(turn * k / corners)});
  }
  return facets;
}

}  // namespace

void ContextCanvas::facets(std::span<const Facet> facets) {
  if (!batch_ || facets.empty()) return Canvas::facets(facets);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(4);
  std::vector<vtkIdType> ids;
  for (const Facet& facet : facets) {
    ids.clear();
    for (const Point& p : facet.corners) ids.push_back(points->InsertNextPoint(p.x * scale_, p.y * scale_, 0.0));
    cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
    const unsigned char colour[] = {facet.colour.red, facet.colour.green, facet.colour.blue, facet.colour.alpha};
    colours->InsertNextTypedTuple(colour);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  context_.DrawPolyData(0.0f, 0.0f, data, colours, VTK_SCALAR_MODE_USE_CELL_DATA);
}

void ContextCanvas::discs(std::span<const Point> centres, double radius, Colour colour) {
  constexpr std::size_t many = 200;
  if (batch_ && centres.size() > many) return facets(rings(centres, radius, colour));
  context_.GetBrush()->SetColor(colour.red, colour.green, colour.blue, colour.alpha);
  const auto r = static_cast<float>(radius * scale_);
  for (const Point& c : centres)
    context_.GetDevice()->DrawEllipseWedge(static_cast<float>(c.x * scale_), static_cast<float>(c.y * scale_), r, r, 0,
                                           0, 0, 360);
}

void ContextCanvas::text(Point anchor, const std::string& text, const TextStyle& style) {
  if (text.empty()) return;
  vtkTextProperty* property = context_.GetTextProp();
  set_font(*property, style.bold);
  property->SetFontSize(static_cast<int>(std::lround(style.size * scale_)));
  property->SetColor(style.colour.red / 255.0, style.colour.green / 255.0, style.colour.blue / 255.0);
  property->SetOpacity(style.colour.alpha / 255.0);
  property->SetOrientation(style.vertical ? 90.0 : 0.0);
  // VTK justifies before it turns: a turned text's "up" is then to the left.
  const int along = style.vertical ? style.upward : style.across;
  const int beside = style.vertical ? -style.across : style.upward;
  property->SetJustification(along + 1);
  property->SetVerticalJustification(beside + 1);
  context_.DrawString(static_cast<float>(std::round(anchor.x * scale_)),
                      static_cast<float>(std::round(anchor.y * scale_)), typeset(text).c_str());
}

}  // namespace lunid::figure
