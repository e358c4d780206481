#pragma once
// A folder of a test's own, and what a reader says of a file in it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "record/container.hpp"

namespace lunid::test {

class ContainerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("LUNID_CONTAINER_MODULE", LUNID_CONTAINER, 1);
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("lunid_" + std::to_string(::getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void cut(const std::string& name, std::uintmax_t bytes) const { std::filesystem::resize_file(path(name), bytes); }
  static std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// What reading says, without the folder.
  std::string fault(const std::string& name, const ReadOptions& options = {}) const {
    try {
      read_record(path(name), options);
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault(), Fault::data);
      std::string text = error.what();
      for (std::size_t at; (at = text.find(folder_.string() + "/")) != text.npos;)
        text.erase(at, folder_.string().size() + 1);
      return text;
    }
    return "no error";
  }

 private:
  std::filesystem::path folder_;
};

inline ReadOptions columns(const std::string& text) {
  ReadOptions options;
  options.columns = parse_columns(text);
  return options;
}

}  // namespace lunid::test
