#include "figure/module/chart.hpp"

#include <vtkContextActor.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPDFExporter.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSVGExporter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "figure/draw.hpp"
#include "figure/module/context_canvas.hpp"
#include "figure/module/font.hpp"
#include "figure/module/memory_file.hpp"

namespace lunid::figure {
namespace {

class FunctionItem : public vtkContextItem {
 public:
  static FunctionItem* New();
  vtkTypeMacro(FunctionItem, vtkContextItem);
  bool Paint(vtkContext2D* context) override {
    try {
      ContextCanvas canvas(*context, scale, raster);
      draw(canvas);
    } catch (const std::exception& e) {
      error = e.what();
    }
    return true;
  }
  std::function<void(Canvas&)> draw;
  double scale = 1.0;
  bool raster = true;
  std::string error;
};
vtkStandardNewMacro(FunctionItem);

/// Exporters draw in finer units than points: glyphs come out as paths on a grid of these.
constexpr double vector_units = 4.0;

/// Gives an exported SVG its size on paper and lets it scale.
std::string with_size(std::string svg, Point extent, int width, int height) {
  const std::size_t from = svg.find("width=\"");
  const std::size_t key = svg.find("height=\"", from);
  if (from == std::string::npos || key == std::string::npos) throw std::runtime_error("the SVG export has no size");
  const std::size_t to = svg.find('"', key + std::strlen("height=\"")) + 1;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "width=\"" << extent.x << "pt\" height=\"" << extent.y << "pt\" viewBox=\"0 0 " << width << " " << height
       << "\"";
  return svg.replace(from, to - from, text.str());
}

/// The exporters crash on an actor that was never rendered: renders it small and without its item.
void prepare_export(vtkRenderWindow& window, vtkContextActor& actor) {
  const int width = window.GetSize()[0], height = window.GetSize()[1];
  vtkAbstractContextItem* item = actor.GetScene()->GetItem(0);
  item->SetVisible(false);
  window.SetSize(16, 16);
  window.Render();
  item->SetVisible(true);
  window.SetSize(width, height);
}

std::string export_svg(vtkRenderWindow& window, const Figure& figure, Point extent) {
  const MemoryFile file;
  vtkNew<vtkSVGExporter> exporter;
  exporter->SetRenderWindow(&window);
  exporter->SetFileName(file.name().c_str());
  exporter->SetTitle(figure.title.empty() ? "Lunid" : figure.title.c_str());
  exporter->SetDescription("Drawn by Lunid");
  exporter->SetDrawBackground(false);
  exporter->Write();
  std::string svg = file.content();
  if (svg.find("<polyline") == std::string::npos) throw std::runtime_error("the SVG export came out empty");
  const int* size = window.GetSize();
  return with_size(std::move(svg), extent, size[0], size[1]);
}

std::string export_pdf(vtkRenderWindow& window, const Figure& figure) {
  const MemoryFile file;
  vtkNew<vtkPDFExporter> exporter;
  exporter->SetRenderWindow(&window);
  exporter->SetFileName(file.name().c_str());
  exporter->SetTitle(figure.title.empty() ? "Lunid" : figure.title.c_str());
  exporter->Write();
  std::string pdf = file.content();
  // An empty page of this exporter is under 1 kB.
  if (!pdf.starts_with("%PDF") || pdf.size() < 2000) throw std::runtime_error("the PDF export came out empty");
  return pdf;
}

/// Throws std::runtime_error when the picture is too large to draw.
int pixels(double points, int dpi) {
  constexpr int most = 8192;  // more needs gigabytes in a software renderer
  const int count = static_cast<int>(std::lround(points * dpi / 72.0));
  if (count > most)
    throw std::runtime_error("the picture would be " + std::to_string(count) + " pixels long, more than " +
                             std::to_string(most) + ": lower size or dpi");
  return count;
}

/// A renderer in a window, for as long as it lives: the window goes on to the next figure.
class Stage {
 public:
  Stage(vtkRenderWindow& window, const Look& look) : window_(window) {
    const Colour& paper = look.palette.background;
    renderer_->SetBackground(paper.red / 255.0, paper.green / 255.0, paper.blue / 255.0);
    window_.AddRenderer(renderer_);
  }
  ~Stage() { window_.RemoveRenderer(renderer_); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  vtkRenderer* operator->() { return renderer_; }

 private:
  vtkRenderWindow& window_;
  vtkNew<vtkRenderer> renderer_;
};

/// Throws std::runtime_error where all pixels are alike.
std::string window_as_png(vtkRenderWindow& window) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(&window);
  image->ReadFrontBufferOff();
  image->ShouldRerenderOff();
  image->Update();
  const auto* data = static_cast<const unsigned char*>(image->GetOutput()->GetScalarPointer());
  const vtkIdType count = data ? 3 * image->GetOutput()->GetNumberOfPoints() : 0;
  if (count == 0 || std::equal(data + 3, data + count, data)) throw std::runtime_error("the picture came out empty");
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (!bytes || bytes->GetNumberOfValues() == 0) throw std::runtime_error("the PNG writer gave nothing");
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)), static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

}  // namespace

std::string draw_chart(Display& display, const Figure& figure, Format format) {
  const bool raster = format == Format::png;
  const Look look = look_for(figure);
  FontMeter meter;
  const FigurePlan plan = plan_figure(meter, look, figure);
  const Point extent = plan.extent;
  const double scale = raster ? figure.size.dpi / 72.0 : vector_units;
  const int dpi = raster ? figure.size.dpi : static_cast<int>(72 * vector_units);
  const auto window = display.window(pixels(extent.x, dpi), pixels(extent.y, dpi));
  Stage stage(*window, look);
  vtkNew<FunctionItem> item;
  item->draw = [&](Canvas& canvas) {
    // The window has its colour already.
    if (!raster) canvas.rectangle({0.0, 0.0, extent.x, extent.y}, look.palette.background);
    draw_figure(canvas, meter, look, plan);
  };
  item->scale = scale;
  item->raster = raster;
  vtkNew<vtkContextActor> actor;
  actor->GetScene()->AddItem(item);
  stage->AddActor(actor);
  std::string bytes;
  if (raster) {
    window->Render();
  } else {
    prepare_export(*window, *actor);
    bytes = format == Format::svg ? export_svg(*window, figure, extent) : export_pdf(*window, figure);
  }
  if (!item->error.empty()) throw std::runtime_error(item->error);
  return raster ? window_as_png(*window) : bytes;
}

}  // namespace lunid::figure
