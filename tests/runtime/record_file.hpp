#pragma once
// A text file that lives as long as the test that needs it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "record/record.hpp"

namespace lunid::test {

class TextFile {
 public:
  explicit TextFile(const std::string& text, const std::string& name = "run3.csv") {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("lunid_" + std::to_string(::getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::create_directories(folder_);
    path_ = folder_ / name;
    std::ofstream(path_, std::ios::binary) << text;
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  ~TextFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string path() const { return path_.string(); }
  std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
};

/// what() of the InputError of `action`, with the file's folder taken off; "" when nothing is thrown.
template <class Action>
std::string message_of(const TextFile& file, Action action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), Fault::data);
    std::string text = error.what();
    const std::string folder = file.folder().string() + "/";
    for (std::size_t at; (at = text.find(folder)) != text.npos;) text.erase(at, folder.size());
    return text;
  }
  return "";
}

/// What reading a text as run3.csv complains about.
inline std::string complaint(const std::string& text, const ReadOptions& options = {}) {
  const TextFile file(text);
  return message_of(file, [&] { read_csv(file.path(), options); });
}

/// Rows "t,value,value" for the default columns of a test; t = i * dt printed with `decimals`.
inline std::string rows(int count, double dt = 0.01, int decimals = 4, double start = 0) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    char line[96];
    std::snprintf(line, sizeof line, "%.*f,%d,%.6f\n", decimals, start + dt * i, i % 3, 0.001 * ((i * 7) % 5));
    text += line;
  }
  return text;
}

}  // namespace lunid::test
