#include <filesystem>

#include "expr/error.hpp"
#include "figure/module.hpp"
#include "figure/renderer.hpp"
#include "record/atomic_file.hpp"
#include "record/module_file.hpp"

namespace lunid::figure {
namespace {

namespace fs = std::filesystem;

constexpr ModuleFile module_file{"figures", "the drawing module", "liblunid_figure.so", "LUNID_FIGURE_MODULE",
                                 factory_name};

Format format_of(const std::string& path, std::initializer_list<std::pair<const char*, Format>> allowed) {
  const std::string extension = fs::path(path).extension().string();
  std::string names;
  for (const auto& [name, format] : allowed) {
    if (extension == name) return format;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  throw InputError("expected a file name that ends in " + names + ", got '" + fs::path(path).filename().string() + "'",
                   {path});
}

void write(const Drawing& drawing, const std::string& path) {
  if (!drawing.error.empty()) throw InputError("cannot draw: " + drawing.error, {path});
  write_file_atomically(path, drawing.bytes);
}

}  // namespace

FigureModule::FigureModule(std::string path) : path_(std::move(path)) {}

FigureModule::~FigureModule() {
  renderer_.reset();
  // The library stays: VTK's own clean-up at exit lives in it.
}

Renderer& FigureModule::renderer() {
  if (renderer_) return *renderer_;
  renderer_.reset(reinterpret_cast<RendererFactory*>(open_module(module_file, path_))(module_version));
  if (!renderer_) throw InputError("figures: the drawing module belongs to another version of Lunid");
  return *renderer_;
}

void FigureModule::render(const Figure& figure, const std::string& path) {
  validate(figure);
  const Format format = format_of(path, {{".png", Format::png}, {".svg", Format::svg}, {".pdf", Format::pdf}});
  write(renderer().draw(figure, format), path);
}

void FigureModule::render(const SurfaceFigure& figure, const std::string& path) {
  validate(figure);
  format_of(path, {{".png", Format::png}});
  write(renderer().draw(figure), path);
}

void FigureModule::export_surface(const SurfaceFigure& figure, const std::string& path) {
  validate(figure);
  const Format format = format_of(path, {{".vts", Format::vts}, {".vtp", Format::vtp}});
  write(renderer().encode(figure, format), path);
}

std::string FigureModule::check() {
  const Drawing line = renderer().check();
  if (!line.error.empty()) throw InputError("figures: " + line.error);
  return line.bytes;
}

}  // namespace lunid::figure
