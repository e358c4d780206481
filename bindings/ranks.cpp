#include "ranks.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "expr/error.hpp"

namespace lunid::lua {

namespace {

namespace fs = std::filesystem;
constexpr const char* file_name = "liblunid_ranks.so";

std::string module_path() {
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::string tried;
  for (const fs::path& path : {folder / file_name, folder / ".." / "lib" / "lunid" / file_name}) {
    if (fs::exists(path, ignored)) return path.string();
    tried += (tried.empty() ? "" : ", ") + path.string();
  }
  throw InputError("ranks: started by mpirun, but the module for MPI is not there, looked for " + tried);
}

void check(int code, const char* call) {
  if (code != 0) throw InputError(std::string("ranks: ") + call + " failed with code " + std::to_string(code));
}

}  // namespace

bool Ranks::launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* size = std::getenv(name); size && std::atoi(size) > 1) return true;
  return false;
}

void Ranks::open() {
  const std::string path = module_path();
  // global: the plug-ins of MPI look for its symbols
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
  if (!library) throw InputError("ranks: cannot load the module for MPI: " + std::string(dlerror()));
  module_ = static_cast<const RanksModule*>(dlsym(library, ranks_symbol));
  if (!module_ || module_->version != ranks_version)
    throw InputError("ranks: " + path + " belongs to another version of Lunid");
  check(module_->start(&rank_, &size_), "MPI_Init");
}

std::vector<std::string> Ranks::gather(const std::string& mine) const {
  if (!module_) return {mine};
  std::vector<long> sizes(static_cast<std::size_t>(size_));
  check(module_->gather_sizes(static_cast<long>(mine.size()), sizes.data()), "MPI_Allgather");
  std::string all(static_cast<std::size_t>(std::accumulate(sizes.begin(), sizes.end(), 0L)), '\0');
  check(module_->gather(mine.data(), sizes.data(), all.data()), "MPI_Allgatherv");
  std::vector<std::string> parts;
  std::size_t at = 0;
  for (const long size : sizes) {
    parts.push_back(all.substr(at, static_cast<std::size_t>(size)));
    at += static_cast<std::size_t>(size);
  }
  return parts;
}

void Ranks::abort(int code) const {
  if (module_) module_->abort(code);
  std::_Exit(code);
}

void Ranks::finish() {
  if (module_) module_->finish();
  module_ = nullptr;
}

}  // namespace lunid::lua
