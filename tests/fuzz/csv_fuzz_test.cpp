// Whatever a file holds is a record or an error that names the file.
#include <algorithm>
#include <cmath>

#include "../runtime/record_file.hpp"
#include "mutate.hpp"

namespace lunid::test {
namespace {

TEST(Fuzz, files_are_read_or_refused) {
  const std::string plain = "t,F,y\n" + rows(12);
  std::string units = "\xef\xbb\xbft [s];F [kN];y [mm]\r\n" + rows(12), tabs = "# made by hand\nt\tF\ty\n" + rows(12);
  std::replace(units.begin(), units.end(), ',', ';');
  std::replace(tabs.begin(), tabs.end(), ',', '\t');
  std::string logger = "Logger;3\nt;F;y\ns;kN;\xb5m\n" + rows(12);
  std::replace(logger.begin(), logger.end(), ',', ';');
  std::replace(logger.begin(), logger.end(), '.', ',');
  Mutator texts({plain, units, tabs, logger},
                {",", ";", "\n", "\r", "\"", "nan", "inf", "1e999", "-", std::string(1, '\0'), "t", "\n\n"}, 11);
  int read = 0, refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string text = texts.next();
    const TextFile file(text);
    try {
      const Record record = read_csv(file.path());
      ++read;
      EXPECT_GT(record.rows(), 0) << text;
      EXPECT_GT(record.dt(), 0) << text;
      EXPECT_TRUE(std::isfinite(record.start()) && std::isfinite(record.dt())) << text;
      for (const double value : record["y"]) EXPECT_FALSE(std::isinf(value)) << text;
    } catch (const InputError& error) {
      ++refused;
      EXPECT_EQ(error.fault(), Fault::data) << text;
      EXPECT_NE(std::string(error.what()).find("run3.csv"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(read, 50);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace lunid::test
