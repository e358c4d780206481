// The module's one exported function, and the wall that no exception passes.
#include <vtkTextRenderer.h>

#include <memory>

#include "figure/module/chart.hpp"
#include "figure/module/errors.hpp"
#include "figure/module/surface_file.hpp"
#include "figure/renderer.hpp"

namespace lunid::figure {
namespace {

class VtkRenderer : public Renderer {
 public:
  Drawing draw(const Figure& figure, Format format) override {
    return guarded([&] { return draw_chart(display(), figure, format); });
  }

  Drawing encode(const Scene& scene, Format format) override {
    return guarded([&] {
      switch (format) {
        case Format::vts: return surface_as_vts(scene);
        case Format::vtu: return surface_as_vtu(scene);
        case Format::points: return points_as_vtp(scene);
        default: return surface_as_vtp(scene);
      }
    });
  }

  Drawing check() override {
    return guarded([&] { return display().describe(); });
  }

 private:
  /// The result of `work`, or its exception's text, or VTK's own complaint.
  template <class Work>
  Drawing guarded(Work work) {
    Drawing drawing;
    const CapturedErrors errors;
    try {
      drawing.bytes = work();
      drawing.error = errors.first();
    } catch (const std::exception& e) {
      const std::string cause = errors.first();
      drawing.error = e.what() + (cause.empty() ? cause : " (" + cause + ")");
    } catch (...) {
      drawing.error = "the drawing library failed without a reason";
    }
    return drawing;
  }

  Display& display() {
    if (!display_) {
      display_ = std::make_unique<Display>();
      // A dollar sign in a label is a dollar sign, not mathematics.
      vtkTextRenderer::GetInstance()->SetDefaultBackend(vtkTextRenderer::FreeType);
    }
    return *display_;
  }

  std::unique_ptr<Display> display_;
};

}  // namespace
}  // namespace lunid::figure

extern "C" __attribute__((visibility("default"))) lunid::figure::Renderer* lunid_figure_renderer(
    std::uint64_t interface) {
  return interface == LUNID_FIGURE_INTERFACE ? new lunid::figure::VtkRenderer : nullptr;
}
