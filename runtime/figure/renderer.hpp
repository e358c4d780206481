#pragma once
// The interface between the loader and the module that links VTK. No exception and no VTK type crosses it.
#include <cstdint>
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

/// The module's one function: a new renderer, or null when `interface` is not the module's own. It is the number
/// LUNID_FIGURE_INTERFACE, which CMake takes from the text of this header and of figure.hpp, so that a module of other
/// structs is refused and not run.
using RendererFactory = Renderer*(std::uint64_t interface);
inline constexpr const char* factory_name = "lunid_figure_renderer";

}  // namespace lunid::figure
