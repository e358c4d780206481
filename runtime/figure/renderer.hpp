#pragma once
// The interface between the loader and the module that links VTK. No exception and no VTK type crosses it.
#include <string>

#include "figure/figure.hpp"

namespace lunid::figure {

/// A drawing's bytes, or why there are none.
struct Drawing {
  std::string bytes;
  std::string error;
};

/// `points`: the clouds of a scene alone, as .vtp.
enum class Format { png, svg, pdf, vts, vtp, vtu, points };

/// What the module does. The figures given are valid.
class Renderer {
 public:
  virtual ~Renderer() = default;
  virtual Drawing draw(const Figure& figure, Format format) = 0;
  virtual Drawing encode(const Scene& scene, Format format) = 0;
  /// `bytes` is a line of text: what draws here.
  virtual Drawing check() = 0;
};

/// Grows with every change of the structs or of Renderer, so that a stale module is refused and not run.
inline constexpr int module_version = 2;

/// The module's one function: a new renderer, or null when `version` is not the module's own.
using RendererFactory = Renderer*(int version);
inline constexpr const char* factory_name = "lunid_figure_renderer";

}  // namespace lunid::figure
