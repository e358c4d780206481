#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "expr/error.hpp"
#include "figure/module.hpp"
#include "figure/renderer.hpp"
#include "record/atomic_file.hpp"

namespace lunid::figure {
namespace {

namespace fs = std::filesystem;
constexpr const char* file_name = "liblunid_figure.so";

/// The places to look at, in order: what the caller names, what the environment names, then the build tree
/// and the installed tree as seen from the executable.
std::vector<fs::path> candidates(const std::string& given) {
  if (!given.empty()) return {given};
  if (const char* named = std::getenv("LUNID_FIGURE_MODULE"); named && *named) return {named};
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {folder / file_name, folder / ".." / "lib" / "lunid" / file_name};
}

std::string module_path(const std::string& given) {
  std::string tried;
  for (const fs::path& path : candidates(given)) {
    std::error_code ignored;
    if (fs::exists(path, ignored)) return path.string();
    tried += (tried.empty() ? "" : ", ") + path.string();
  }
  throw InputError("figures: the drawing module is not there, looked for " + tried);
}

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
  const std::string path = module_path(path_);
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!library) throw InputError("figures: cannot load the drawing module: " + std::string(dlerror()));
  const auto factory = reinterpret_cast<RendererFactory*>(dlsym(library, factory_name));
  renderer_.reset(factory ? factory(module_version) : nullptr);
  if (!renderer_) throw InputError("figures: " + path + " belongs to another version of Lunid");
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
