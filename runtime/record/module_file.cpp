#include "record/module_file.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "expr/error.hpp"
#include "expr/joined.hpp"

namespace lunid {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> candidates(const ModuleFile& module, const std::string& given) {
  if (!given.empty()) return {given};
  if (const char* named = module.variable ? std::getenv(module.variable) : nullptr; named && *named) return {named};
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {folder / module.file, folder / ".." / "lib" / "lunid" / module.file};
}

std::string path_of(const ModuleFile& module, const std::string& given) {
  std::string tried;
  for (const fs::path& path : candidates(module, given)) {
    std::error_code ignored;
    if (fs::exists(path, ignored)) return path.string();
    append_item(tried, path.string());
  }
  throw InputError(std::string(module.who) + ": " + module.what + " is not there, looked for " + tried);
}

}  // namespace

void* open_module(const ModuleFile& module, const std::string& given) {
  const std::string path = path_of(module, given);
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_NODELETE | (module.for_all ? RTLD_GLOBAL : RTLD_LOCAL));
  if (!library)
    throw InputError(std::string(module.who) + ": cannot load " + module.what + ": " + std::string(dlerror()));
  void* symbol = dlsym(library, module.symbol);
  if (!symbol)
    throw InputError(std::string(module.who) + ": " + path +
                     " belongs to another version of Lunid: build or install both together");
  return symbol;
}

}  // namespace lunid
