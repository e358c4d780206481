// Even, rounded, jittering, gappy and uneven time.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "record_file.hpp"

namespace lunid {
namespace {

using test::complaint;
using test::TextFile;

/// A file with these stamps and y = sin(2 pi t).
std::string with_stamps(const std::vector<double>& t, const char* format) {
  std::string text = "t,y\n";
  for (double value : t) {
    char line[64];
    std::snprintf(line, sizeof line, format, value);
    text += line;
    std::snprintf(line, sizeof line, ",%.9f\n", std::sin(2 * M_PI * value));
    text += line;
  }
  return text;
}

std::vector<double> even(int count, double dt, double start = 0) {
  std::vector<double> t(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) t[static_cast<std::size_t>(i)] = start + dt * i;
  return t;
}

struct Rounded {
  double dt;
  const char* format;
  double start;
};

class RoundedTime : public testing::TestWithParam<Rounded> {};

TEST_P(RoundedTime, IsEvenTime) {
  const auto [dt, format, start] = GetParam();
  const TextFile file(with_stamps(even(4000, dt, start), format));
  const Record record = read_csv(file.path());
  EXPECT_EQ(record.rows(), 4000);
  // The step is one of few digits (or the inverse of one), so it is found to the last bit or two.
  EXPECT_NEAR(record.dt(), dt, 1e-15 * dt) << format;
  EXPECT_LE(record.warnings().size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Record, RoundedTime,
                         testing::Values(Rounded{0.00125, "%.3f", 0}, Rounded{0.00125, "%.4f", 2},
                                         Rounded{0.00125, "%.5f", 0}, Rounded{0.00125, "%.6g", 0},
                                         Rounded{0.00125, "%.6g", 97}, Rounded{1.0 / 256, "%.6f", 0.500977},
                                         Rounded{1.0 / 300, "%.4f", 0}, Rounded{0.0004, "%.3f", 0},
                                         Rounded{0.00101, "%.3f", 0}, Rounded{0.001, "%.3f", 0},
                                         Rounded{0.0016384, "%.8f", 0}, Rounded{2e-5, "%.9e", 0}));

TEST(Time, StepsOfManyDigitsAreKept) {
  const double dt = 1e-3 * M_PI;
  const TextFile file(with_stamps(even(500, dt, 0.25), "%.17g"));
  const Record record = read_csv(file.path());
  // A step is rounded to fewer digits only as far as no stamp moves by more than 1e-9 of it.
  EXPECT_NEAR(record.dt(), dt, 1e-11 * dt);
  EXPECT_NEAR(record.time(499), 0.25 + 499 * dt, 2e-9 * dt);
  EXPECT_TRUE(record.warnings().empty());
}

TEST(Time, AMissingRowIsAGapWithItsLine) {
  for (const auto& [dt, format] : {std::pair{0.001, "%.3f"}, {0.00125, "%.5f"}, {0.0033, "%.17g"}}) {
    std::vector<double> t = even(400, dt);
    t.erase(t.begin() + 200);
    EXPECT_EQ(complaint(with_stamps(t, format)).substr(0, 41), "run3.csv:202: gap: 1 row is missing befor") << format;
    t.erase(t.begin() + 300, t.begin() + 303);
    const std::string text = complaint(with_stamps(t, format));
    EXPECT_NE(
        text.find("gaps before lines 202, 302; set resample = true (--resample) to interpolate, or cut the file there"),
        text.npos)
        << text;
  }
}

TEST(Time, AGapAmongRoundedStampsIsFound) {
  std::vector<double> t = even(400, 0.00125);
  t.erase(t.begin() + 200, t.begin() + 205);
  EXPECT_EQ(complaint(with_stamps(t, "%.3f")).substr(0, 18), "run3.csv:202: gap:");
}

TEST(Time, AGapIsFilledWhenAsked) {
  std::vector<double> t = even(400, 0.01);
  t.erase(t.begin() + 200, t.begin() + 202);
  const TextFile file(with_stamps(t, "%.2f"));
  const Record record = read_csv(file.path(), {{}, true});
  ASSERT_EQ(record.rows(), 400);
  // Cubic through 4 points, the middle ones 3 steps apart: error below (2 pi)^4/4! * 4.0e-8 *
  // (1.5*1.5*2.5*2.5).
  for (Eigen::Index i = 0; i < 400; ++i)
    EXPECT_NEAR(record["y"][static_cast<std::size_t>(i)], std::sin(2 * M_PI * record.time(i)), 1.5e-5);
  ASSERT_EQ(record.warnings().size(), 1u);
  EXPECT_EQ(record.warnings()[0], "line 202: gap: 2 rows are missing before t = 2.02 s: interpolated");
}

/// The median of rounded steps is no step of the recorder: on its grid every row would lie between two of the file, and
/// be interpolated.
TEST(Time, RowsBesideGapsStayTheRowsOfTheFile) {
  for (const auto& [dt, format] : {std::pair{1.0 / 600, "%.6f"}, {1.0 / 600, "%.9f"}, {0.0016384, "%.6f"}}) {
    std::vector<double> t = even(4000, dt, 0.3);
    t.erase(t.begin() + 1700, t.begin() + 1740);
    t.erase(t.begin() + 900);
    const TextFile file(with_stamps(t, format));
    const Record record = read_csv(file.path(), {{}, true});
    EXPECT_EQ(record.rows(), 4000) << format;
    EXPECT_NEAR(record.dt(), dt, 1e-12 * dt) << format;
    EXPECT_NEAR(record.time(3999), 0.3 + 3999 * dt, 2e-6) << format;
    EXPECT_EQ(record.pieces().size(), 2u) << format;
  }
}

/// Rows 202 to 211, 230 and 240 to 399 are lost: between the gaps nothing is invented.
TEST(Time, PiecesOfARecordHoldNoRowThatWasMissing) {
  std::vector<double> t = even(600, 0.01);
  t.erase(t.begin() + 240, t.begin() + 400);
  t.erase(t.begin() + 230);  // one row is interpolated well
  t.erase(t.begin() + 202, t.begin() + 212);
  const TextFile file(with_stamps(t, "%.2f"));
  const Record record = read_csv(file.path(), {{}, true});
  ASSERT_EQ(record.rows(), 600);
  EXPECT_EQ(record.warnings().front(),
            "line 204: gap: 10 rows are missing before t = 2.12 s; gaps before lines 204, 222, 231: interpolated; free "
            "runs begin anew at t = 2.12 s, ... (2 places), where three rows or more are missing");
  const std::vector<Record> all = record.pieces(20);
  ASSERT_EQ(all.size(), 3u);
  const std::pair<double, Eigen::Index> expected[] = {{0, 202}, {2.12, 28}, {4, 200}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_NEAR(all[k].start(), expected[k].first, 1e-12);
    EXPECT_EQ(all[k].rows(), expected[k].second);
    for (Eigen::Index i = 0; i < all[k].rows(); ++i)
      EXPECT_NEAR(all[k]["y"][static_cast<std::size_t>(i)], std::sin(2 * M_PI * all[k].time(i)), 1.5e-5);
  }
  const std::vector<Record> long_ones = record.window(1, 5.99).pieces();
  ASSERT_EQ(long_ones.size(), 2u);
  EXPECT_NEAR(long_ones[0].start(), 1, 1e-12);
  EXPECT_EQ(long_ones[0].warnings().back(), "28 rows in parts of fewer than 50 rows between gaps are left out");
  EXPECT_EQ(long_ones[1].words_of_part(), ", part 2 of 2, from t = 4 s");  // of those that are left
  Channel force;
  force.name = "F", force.values = Eigen::VectorXd::Zero(long_ones[1].rows());
  EXPECT_EQ(long_ones[1].with(force).words_of_part(), ", part 2 of 2, from t = 4 s");
  EXPECT_TRUE(long_ones[1].warnings().empty());  // what reading found is said once
  EXPECT_EQ(record.window(0, 2).pieces().size(), 1u);
  EXPECT_THROW(record.pieces(300), InputError);
}

TEST(Time, SmallJitterIsEvenTimeWithAWarning) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.01);  // 1 % of the step, below the 2 % that are let pass
  std::vector<double> t = even(1000, 0.01);
  for (double& value : t) value += 0.01 * normal(random);
  const TextFile file(with_stamps(t, "%.9f"));
  const Record record = read_csv(file.path());
  EXPECT_NEAR(record.dt(), 0.01, 1e-6);
  ASSERT_EQ(record.warnings().size(), 1u);
  EXPECT_NE(record.warnings()[0].find("jitter"), std::string::npos);
}

TEST(Time, AClockThatDriftsIsEvenTimeWithAWarning) {
  std::vector<double> t;  // a ten-thousandth faster in the middle: half a step and more, stamps of 10 us
  for (int i = 0; i < 20000; ++i) t.push_back(0.01 * i + 0.006 * std::sin(2 * M_PI * i / 20000.0));
  const TextFile file(with_stamps(t, "%.5f"));
  const Record record = read_csv(file.path());
  EXPECT_EQ(record.rows(), 20000);
  EXPECT_NEAR(record.dt(), 0.01, 1e-6);
  ASSERT_EQ(record.warnings().size(), 1u);
  EXPECT_NE(record.warnings()[0].find("time stamps drift from even ones by up to 0.00"), std::string::npos)
      << record.warnings()[0];
}

TEST(Time, UnevenTimeIsAnErrorUnlessResampled) {
  std::vector<double> t;
  for (int i = 0; i < 500; ++i) t.push_back(0.01 * i + 0.004 * std::sin(0.05 * i));
  const std::string text = with_stamps(t, "%.9f");
  const std::string message = complaint(text);
  EXPECT_NE(message.find("time is uneven: steps from 0.0098"), message.npos) << message;
  EXPECT_NE(message.find("set resample = true"), message.npos);
  const TextFile file(text);
  const Record record = read_csv(file.path(), {{}, true});
  // Cubic on a grid of 0.01 s: (2 pi * 0.0102)^4 * 9/16/24 = 4e-7.
  for (Eigen::Index i = 0; i < record.rows(); ++i)
    EXPECT_NEAR(record["y"][static_cast<std::size_t>(i)], std::sin(2 * M_PI * record.time(i)), 5e-7);
  EXPECT_EQ(record.warnings().size(), 1u);
}

TEST(Time, AWildStampIsNotFilledUp) {
  std::vector<double> t = even(50, 0.01);
  t.push_back(1e18);
  EXPECT_EQ(complaint(with_stamps(t, "%.2f"), {{}, true}),
            "run3.csv: time has too few rows to resample: 1e+20 steps of 0.01 s between the first and the "
            "last stamp, "
            "but 51 rows");
  EXPECT_EQ(complaint(with_stamps(t, "%.2f")).substr(0, 17), "run3.csv:52: gap:");
}

}  // namespace
}  // namespace lunid
