#pragma once
// Handles of HDF5 that close themselves.
#include <hdf5.h>

#include <stdexcept>
#include <utility>

namespace lunid::container {

class Handle {
 public:
  Handle() = default;
  /// Throws std::runtime_error with `failure` when the library gave no handle.
  Handle(hid_t id, herr_t (*close)(hid_t), const char* failure) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error(failure);
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

}  // namespace lunid::container
