#pragma once
// The drawing module: a shared library of its own, the only thing that links VTK, opened at the first figure.
#include <memory>
#include <string>

#include "figure/figure.hpp"

namespace lunid::figure {

class Renderer;

/// Opens `liblunid_figure.so` on first use and draws with it. Files are written whole or not at all.
/// Constructing one costs nothing. Not for use from two threads at once.
class FigureModule {
 public:
  /// `path`: the module's file; "" looks at the environment's LUNID_FIGURE_MODULE, then beside the
  /// executable, then in
  /// ../lib/lunid/ from there.
  explicit FigureModule(std::string path = {});
  ~FigureModule();
  FigureModule(const FigureModule&) = delete;
  FigureModule& operator=(const FigureModule&) = delete;

  /// Draws to `path`: .png, .svg or .pdf by its extension. Throws InputError that names the path: bad
  /// extension, bad figure, no display, unwritable place, full disk.
  void render(const Figure& figure, const std::string& path);

  /// Writes the numbers of the figure's first surface to `path`: .vts (structured grid, no-data points blanked), .vtp
  /// (the cells with data, and the clouds as vertices), .vtu (the same as an unstructured grid) or .vtm (grid and
  /// clouds as files in a folder of the same name). Arrays are doubles, named with their units. Needs no display.
  void export_surface(const Figure& figure, const std::string& path);

  /// For `lunid doctor`: one line that says how figures are drawn here (display, VTK and OpenGL versions), or
  /// throws InputError with what is missing and which package holds it.
  std::string check();

 private:
  void export_blocks(const Scene& scene, const std::string& path);
  Renderer& renderer();
  std::string path_;
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace lunid::figure
