// Lines of progress in a log.
#include "progress.hpp"

#include <gtest/gtest.h>

namespace lunid::lua {
namespace {

std::string logged(double seconds) {
  std::FILE* file = std::tmpfile();
  ProgressLog log(seconds, file);
  for (const double fraction : {0.1, 0.431, 1.0}) log.show("look through big.csv", fraction);
  std::rewind(file);
  char text[256] = {};
  const std::size_t size = std::fread(text, 1, sizeof text, file);
  std::fclose(file);
  return {text, size};
}

TEST(ProgressLog, WritesALineNowAndThen) {
  EXPECT_EQ(logged(0), " 10 %  look through big.csv\n 43 %  look through big.csv\n100 %  look through big.csv\n");
  EXPECT_EQ(logged(3600), "");  // short work leaves none
}

}  // namespace
}  // namespace lunid::lua
