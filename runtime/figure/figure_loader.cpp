#include <filesystem>

#include "expr/error.hpp"
#include "expr/joined.hpp"
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
    append_item(names, name);
  }
  throw InputError("expected a file name that ends in " + names + ", got '" + fs::path(path).filename().string() + "'",
                   {path});
}

void write(const Drawing& drawing, const std::string& path) {
  if (!drawing.error.empty()) throw InputError("cannot draw: " + drawing.error, {path});
  write_file_atomically(path, drawing.bytes);
}

std::string in_xml(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

std::string block(int index, const std::string& name, const std::string& file) {
  return "    <DataSet index=\"" + std::to_string(index) + "\" name=\"" + name + "\" file=\"" + in_xml(file) + "\"/>\n";
}

}  // namespace

FigureModule::FigureModule(std::string path) : path_(std::move(path)) {}

FigureModule::~FigureModule() {
  renderer_.reset();
  // The library stays: VTK's own clean-up at exit lives in it.
}

Renderer& FigureModule::renderer() {
  if (renderer_) return *renderer_;
  renderer_.reset(reinterpret_cast<RendererFactory*>(open_module(module_file, path_))(LUNID_FIGURE_INTERFACE));
  if (!renderer_)
    throw InputError("figures: the drawing module belongs to another version of Lunid: build or install both together");
  return *renderer_;
}

void FigureModule::render(const Figure& figure, const std::string& path) {
  validate(figure);
  const Format format = format_of(path, {{".png", Format::png}, {".svg", Format::svg}, {".pdf", Format::pdf}});
  write(renderer().draw(figure, format), path);
}

void FigureModule::export_surface(const Figure& figure, const std::string& path) {
  validate(figure);
  const Format format =
      format_of(path, {{".vts", Format::vts}, {".vtp", Format::vtp}, {".vtu", Format::vtu}, {".vtm", Format::points}});
  const Scene& scene = scene_of(figure);
  if (path.ends_with(".vtm")) return export_blocks(scene, path);
  write(renderer().encode(scene, format), path);
}

/// The surface and its points as files in a folder of the same name, and the list of them, which comes last: a reader
/// never sees a list of files that are not there.
void FigureModule::export_blocks(const Scene& scene, const std::string& path) {
  const fs::path folder = fs::path(path).replace_extension();
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw InputError("cannot write: " + failed.message(), {path});
  const std::string name = folder.filename().string();
  std::string blocks = block(0, "surface", name + "/surface.vts");
  write(renderer().encode(scene, Format::vts), (folder / "surface.vts").string());
  if (!scene.clouds.empty()) {
    write(renderer().encode(scene, Format::points), (folder / "points.vtp").string());
    blocks += block(1, "points", name + "/points.vtp");
  }
  write_file_atomically(path,
                        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n"
                        "  <vtkMultiBlockDataSet>\n" +
                            blocks + "  </vtkMultiBlockDataSet>\n</VTKFile>\n");
}

std::string FigureModule::check() {
  const Drawing line = renderer().check();
  if (!line.error.empty()) throw InputError("figures: " + line.error);
  return line.bytes;
}

}  // namespace lunid::figure
