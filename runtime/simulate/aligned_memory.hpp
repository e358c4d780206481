#pragma once
// Zeros that begin on a line of the cache: no vector lies across two. Internal to this room.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace lunid {

class AlignedMemory {
 public:
  void resize(std::size_t values) {
    memory_.reset(static_cast<double*>(::operator new[](sizeof(double) * values, alignment)));
    std::fill_n(memory_.get(), values, 0.0);
  }
  double* data() const { return memory_.get(); }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Delete {
    void operator()(double* p) const { ::operator delete[](p, alignment); }
  };
  std::unique_ptr<double, Delete> memory_;
};

}  // namespace lunid
