// Opening the module and a file in it, and finding variables.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "record/container.hpp"
#include "record/module_file.hpp"

namespace lunid {
namespace {

namespace fs = std::filesystem;
constexpr ModuleFile module_file{.who = "files",
                                 .what = "the module that reads HDF5 and MAT files",
                                 .file = "liblunid_container.so",
                                 .variable = "LUNID_CONTAINER_MODULE",
                                 .symbol = container_factory_name};

ContainerModule& load() {
  ContainerModule* module = reinterpret_cast<ContainerFactory*>(open_module(module_file))(container_version);
  if (!module) throw InputError("files: the module that reads HDF5 and MAT files belongs to another version of Lunid");
  return *module;
}

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw InputError(message, {path}, Fault::data);
}

bool begins_with(const std::string& path, std::string_view signature) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(signature.size(), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return in.gcount() == static_cast<std::streamsize>(bytes.size()) && bytes == signature;
}

std::string list(const Container& file) {
  constexpr std::size_t shown = 20;
  std::string text;
  const auto& all = file.variables();
  for (std::size_t i = 0; i < std::min(shown, all.size()); ++i)
    text += (i ? ", " : "") + all[i].name + " (" + (all[i].is_number() ? all[i].shape_text() : all[i].kind) + ")";
  if (all.size() > shown) text += ", ... (" + std::to_string(all.size()) + " variables)";
  return text.empty() ? "no variables" : text;
}

/// "run1/y" and "run1.y" are the same place.
std::string same_separators(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

const Variable* find(const Container& file, const std::string& name) {
  for (const Variable& variable : file.variables())
    if (same_separators(variable.name) == same_separators(name)) return &variable;
  return nullptr;
}

}  // namespace

std::size_t Variable::size() const {
  std::size_t product = 1;
  for (const std::size_t side : shape) product *= side;
  return product;
}

bool Variable::is_vector() const {
  return std::count_if(shape.begin(), shape.end(), [](std::size_t side) { return side != 1; }) <= 1;
}

std::string Variable::shape_text() const {
  if (size() == 1) return "a number";
  std::string text;
  for (const std::size_t side : shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  return shape.size() == 1 ? text + " values" : text;
}

ContainerModule& container_module() {
  static ContainerModule& module = load();
  return module;
}

bool is_container(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  return extension == ".mat" || extension == ".h5" || extension == ".hdf5" || begins_with(path, "\x89HDF\r\n\x1a\n");
}

std::unique_ptr<Container> open_container(const std::string& path) {
  std::error_code code;
  if (!fs::exists(path, code)) fail(path, "no such file");
  if (fs::is_directory(path, code)) fail(path, "cannot read: it is a directory");
  if (fs::file_size(path, code) == 0) fail(path, "the file is empty");
  std::string error;
  const bool mat = fs::path(path).extension() == ".mat";
  auto file = mat ? container_module().open_mat(path, error) : container_module().open_hdf5(path, error);
  if (!file) fail(path, error);
  return file;
}

ContainerChoice choose_variable(const Container& file, const std::string& path, const std::string& name,
                                const std::string& asked_for) {
  const Variable* found = find(file, name);
  int column = -1;
  if (const auto colon = name.rfind(':'); !found && colon != std::string::npos) {
    found = find(file, name.substr(0, colon));
    column = std::atoi(name.c_str() + colon + 1) - 1;
    if (found && (found->shape.size() != 2 || column < 0 || column >= static_cast<int>(found->shape[1])))
      fail(path, "variable '" + name + "' " + asked_for + ": '" + found->name + "' is " + found->shape_text() +
                     ", which has no such column");
  }
  if (!found) {
    std::vector<std::string> names;
    for (const Variable& variable : file.variables()) names.push_back(variable.name);
    fail(path, "no variable '" + name + "' " + asked_for + "; the file has " + list(file) +
                   did_you_mean(nearest_word(name, names), ';'));
  }
  const std::string what = "variable '" + found->name + "' " + asked_for + ": expected a vector of real numbers, got ";
  if (!found->is_number()) fail(path, what + found->kind);
  if (column < 0 && !found->is_vector())
    fail(path, what + "an array of " + found->shape_text() +
                   (found->shape.size() == 2 ? "; take one of its columns, such as '" + found->name + ":1'" : ""));
  return {static_cast<std::size_t>(found - file.variables().data()), column,
          column < 0 ? found->size() : found->shape[0]};
}

Eigen::VectorXd read_choice(Container& file, const std::string& path, const ContainerChoice& choice, std::size_t first,
                            std::size_t count) {
  count = std::min(count, choice.rows - first);
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  const std::string error = file.read(choice.variable, choice.column, first, count, values.data());
  if (!error.empty()) fail(path, "variable '" + file.variables()[choice.variable].name + "': " + error);
  return values;
}

}  // namespace lunid
