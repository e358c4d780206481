// The module's one exported function, and the wall that no exception passes.
#include <hdf5.h>
#include <matio.h>

#include <stdexcept>

#include "record/module/files.hpp"

namespace lunid::container {
namespace {

/// The result of `work`; where it throws, an empty one, and the exception's text in `error`.
template <class Work>
auto guarded(std::string& error, Work work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    error = "out of memory";
  } catch (const std::exception& e) {
    error = e.what();
  } catch (...) {
    error = "the library that reads it failed without a reason";
  }
  return {};
}

class Module : public ContainerModule {
 public:
  Module() {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are told by our messages, not on stderr
    Mat_LogInitFunc("lunid", [](int, char*) {});
  }
  std::unique_ptr<Container> open_mat(const std::string& path, std::string& error) override {
    return guarded(error, [&] { return container::open_mat(path); });
  }
  std::unique_ptr<Container> open_hdf5(const std::string& path, std::string& error) override {
    return guarded(error, [&] { return container::open_hdf5(path); });
  }
  std::string encode_hdf5(const std::vector<StoredColumn>& columns, std::string& error) override {
    return guarded(error, [&] { return container::encode_hdf5(columns); });
  }
  void write_mat(const std::string& path, const std::vector<StoredColumn>& columns, MatVersion version,
                 std::string& error) override {
    guarded(error, [&] { return container::write_mat(path, columns, version), true; });
  }
};

}  // namespace
}  // namespace lunid::container

extern "C" __attribute__((visibility("default"))) lunid::ContainerModule* lunid_container_module(int version) {
  return version == lunid::container_version ? new lunid::container::Module : nullptr;
}
