#pragma once
// MPI ranks that run one study together. MPI lives in a module of its own, opened only under a launcher (mpirun): a
// plain run neither loads nor waits for it.
#include <memory>
#include <string>
#include <vector>

namespace lunid::lua {

struct RanksModule;

/// The ranks of this run; without a launcher there is one.
class Ranks {
 public:
  /// True when a launcher started this process beside others.
  static bool launched();
  /// Opens MPI. Throws InputError when the module is missing or cannot be loaded.
  void open();
  int rank() const { return rank_; }
  int size() const { return size_; }
  /// What every rank gives, in the order of the ranks. All ranks must call it.
  std::vector<std::string> gather(const std::string& mine) const;
  /// Ends all ranks with this exit code.
  [[noreturn]] void abort(int code) const;
  /// Ends MPI in this process; to be called by all ranks.
  void finish();

 private:
  int rank_ = 0, size_ = 1;
  const RanksModule* module_ = nullptr;
};

/// The interface of the module: plain C, so that no exception and no allocator crosses it.
struct RanksModule {
  int version;
  int (*start)(int* rank, int* size);
  /// sizes: of each rank's data, `size` entries; then the data one after another into `all`.
  int (*gather_sizes)(long mine, long* sizes);
  int (*gather)(const char* mine, const long* sizes, char* all);
  void (*abort)(int code);
  int (*finish)();
};
constexpr int ranks_version = 1;
constexpr const char* ranks_symbol = "lunid_ranks";

}  // namespace lunid::lua
