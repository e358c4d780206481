#include "ranks.hpp"

#include <cstdlib>
#include <numeric>

#include "expr/error.hpp"
#include "record/module_file.hpp"

namespace lunid::lua {

namespace {

// for all: the plug-ins of MPI look for its symbols
constexpr ModuleFile module_file{.who = "ranks",
                                 .what = "the module for MPI",
                                 .file = "liblunid_ranks.so",
                                 .variable = nullptr,
                                 .symbol = ranks_symbol,
                                 .for_all = true};

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
  module_ = static_cast<const RanksModule*>(open_module(module_file));
  if (module_->version != ranks_version)
    throw InputError("ranks: the module for MPI belongs to another version of Lunid");
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
