// Treatments of a stream are those of the record read whole, wherever the blocks begin.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

#include "message.hpp"
#include "record/stream_treat.hpp"
#include "record_file.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::VectorXd;
using test::TextFile;

constexpr int rows = 40000;  // more than two blocks

/// An acceleration with an offset and a drift, a displacement, and a force, all with noise.
std::string drifting() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::string text = "t,F,y,a\n";
  for (int i = 0; i < rows; ++i) {
    const double t = 1e-3 * i;
    char line[128];
    std::snprintf(line, sizeof line, "%.4f,%.9g,%.9g,%.9g\n", t, 5 + std::sin(40 * t) + 0.1 * normal(random),
                  2 + 0.01 * t + std::sin(9 * t) + 0.3 * std::sin(700 * t),
                  0.4 - 0.02 * t + 30 * std::sin(25 * t) + 0.3 * normal(random));
    text += line;
  }
  return text;
}

/// All channels of all rows, read in blocks that begin at odd places, to so much of their deviation in the record;
/// `at_ends`: of the first and last thousand rows.
void expect_near(const Stream& stream, const Record& record, double tolerance, double at_ends = 0) {
  ASSERT_FALSE(stream.in_memory());
  ASSERT_EQ(stream.rows(), record.rows());
  EXPECT_EQ(stream.dt(), record.dt());
  EXPECT_EQ(stream.start(), record.start());
  EXPECT_EQ(stream.history(), record.history());
  ASSERT_EQ(stream.channels().size(), record.channels().size());
  for (std::size_t c = 0; c < record.channels().size(); ++c) {
    const Channel &part = stream.channels()[c], &whole = record.channels()[c];
    EXPECT_EQ(part.name, whole.name);
    EXPECT_EQ(part.unit, whole.unit) << whole.name;
    EXPECT_EQ(part.derived, whole.derived) << whole.name;
    EXPECT_EQ(part.derivation, whole.derivation) << whole.name;
    EXPECT_NEAR(part.noise, whole.noise, 1e-12 * whole.noise) << whole.name;
    const auto values = record[whole.name];
    const Map<const VectorXd> all(values.data(), record.rows());
    const double deviation = std::sqrt((all.array() - all.mean()).square().mean());
    VectorXd off(record.rows());
    for (Index first = 0; first < record.rows(); first += 7777) {
      const Index count = std::min<Index>(7777, record.rows() - first);
      const Record read = stream.read(first, count);
      off.segment(first, count) = Map<const VectorXd>(read[whole.name].data(), count) - all.segment(first, count);
    }
    const Index ends = at_ends > 0 ? 1000 : 0;
    EXPECT_LT(off.segment(ends, off.size() - 2 * ends).cwiseAbs().maxCoeff(), tolerance * deviation) << whole.name;
    if (ends > 0) {
      EXPECT_LT(off.cwiseAbs().maxCoeff(), at_ends * deviation) << whole.name;
    }
  }
}

class StreamTreatment : public testing::Test {
 protected:
  StreamTreatment() : file(drifting()), record(read_csv(file.path())), stream(open_stream(file.path())) {}
  TextFile file;
  Record record;
  Stream stream;
};

TEST_F(StreamTreatment, Filters) {
  for (const Band band : {Band{0, 20}, Band{1, 0}, Band{2, 60}, Band{2, 60, true}, Band{0, 300}})
    for (const int order : {1, 4}) {
      const FilterOptions options{band, order, {}};
      expect_near(filter(stream, options), filter(record, options), 1e-9);
    }
  const FilterOptions one{{0, 20}, 4, {"y"}};
  expect_near(filter(stream, one), filter(record, one), 1e-9);
}

TEST_F(StreamTreatment, TakesTrendsOff) {
  for (const int degree : {0, 1, 5, 12}) expect_near(detrend(stream, degree, {}), detrend(record, degree, {}), 1e-12);
  expect_near(detrend(stream, 2, {"a"}), detrend(record, 2, {"a"}), 1e-12);
}

TEST_F(StreamTreatment, ChangesTheRate) {
  for (const int factor : {1, 4}) expect_near(decimate(stream, factor), decimate(record, factor), 1e-11);
  for (const double rate : {333.3, 1700.0}) expect_near(resample(stream, rate), resample(record, rate), 1e-11);
}

TEST_F(StreamTreatment, Integrates) {
  for (const int degree : {0, 1, 3}) {
    const IntegrateOptions options{"a", degree, 0};
    expect_near(integrate(stream, options), integrate(record, options), 1e-11);
  }
  const IntegrateOptions high_pass{"a", 1, 1.5};
  expect_near(integrate(stream, high_pass), integrate(record, high_pass), 1e-9);
}

TEST_F(StreamTreatment, IntegratesWhatWasNotMeasured) {
  const TextFile accelerations([] {
    std::string text = drifting();
    text.replace(0, text.find('\n'), "t,F,w,a");
    return text;
  }());
  const Stream long_one = open_stream(accelerations.path());
  EXPECT_FALSE(long_one.has("y"));
  const Stream moved = integrate(long_one, {"a", 1, 1.5});
  const Record whole = integrate(read_csv(accelerations.path()), {"a", 1, 1.5});
  EXPECT_EQ(moved.channels().back().name, "y");
  for (const char* name : {"v", "y"}) {
    const Record part = moved.read(20000, 100);
    for (std::size_t i = 0; i < 100; ++i) EXPECT_NEAR(part[name][i], whole[name][20000 + i], 1e-9);
  }
}

TEST_F(StreamTreatment, FollowOneAnotherAndKeepToWindows) {
  const FilterOptions below{{0, 40}, 4, {}};
  const Stream part = decimate(filter(stream.window(3, 33), below), 5);
  // The continuation of a signal that was filtered magnifies rounding: its model is all but singular.
  expect_near(part, decimate(filter(record.window(3, 33), below), 5), 1e-9, 1e-4);
  EXPECT_NEAR(part.window(10, 20).read(0, 1)["F"][0],
              decimate(filter(record.window(3, 33), below), 5).window(10, 20)["F"][0], 1e-8);
}

TEST_F(StreamTreatment, OfARecordInMemoryIsThatOfTheRecord) {
  const Stream memory = decimate(detrend(Stream(record), 1, {}), 2);
  ASSERT_TRUE(memory.in_memory());
  const Record whole = decimate(detrend(record, 1, {}), 2);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(memory.record()["y"][i], whole["y"][i]);
}

TEST_F(StreamTreatment, FaultsAreThoseOfTheRecord) {
  const auto same = [&](const auto& treat) {
    const std::string text = message([&] { treat(record); });
    EXPECT_EQ(message([&] { treat(stream); }), text);
    EXPECT_NE(text, "no error");
  };
  same([](const auto& r) { filter(r, FilterOptions{{0, 600}, 4, {}}); });
  same([](const auto& r) { filter(r, FilterOptions{{0, 20}, 4, {"yy"}}); });
  same([](const auto& r) { detrend(r, 13, {}); });
  same([](const auto& r) { decimate(r, 10000); });
  same([](const auto& r) { resample(r, 1e-3); });
  same([](const auto& r) { integrate(r, IntegrateOptions{"F", 1, 0}); });
  same([](const auto& r) { integrate(r, IntegrateOptions{"a", 11, 0}); });
  EXPECT_EQ(
      message([&] {
        filter(stream, {{0.005, 0}, 4, {}});
      }),
      "filter: its response lasts over 262144 rows, the most of a stream: decimate it first, or read the record by "
      "lunid.read");
}

TEST(StreamIntegral, RefusesAConstant) {
  std::string text = "t,F,a\n";
  for (int i = 0; i < 3000; ++i) text += std::to_string(1e-3 * i) + "," + std::to_string(i % 7) + ",9.81\n";
  const TextFile file(text);
  EXPECT_EQ(message([&] {
              integrate(open_stream(file.path()), {"a", 1, 0});
            }),
            "integrate: channel 'a' is constant, 9.81: there is no motion in it");
}

TEST(PolynomialOfARecord, IsTheLeastSquaresOne) {
  // Against normal equations in Chebyshev polynomials of long double, on rows few and many.
  for (const Index n : {7, 30, 20000}) {
    const int degree = n < 10 ? 3 : 12;
    VectorXd x(n);
    for (Index i = 0; i < n; ++i) x[i] = std::exp(2.0 * static_cast<double>(i) / static_cast<double>(n)) + (i % 5);
    using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix basis(n, degree + 1);
    for (Index i = 0; i < n; ++i) {
      const long double s = -1 + 2.0L * i / (n - 1);
      for (int k = 0; k <= degree; ++k)
        basis(i, k) = k == 0 ? 1 : k == 1 ? s : 2 * s * basis(i, k - 1) - basis(i, k - 2);
    }
    const auto wide = x.cast<long double>().eval();
    const VectorXd expected = (wide - basis * basis.householderQr().solve(wide)).template cast<double>();
    const VectorXd rest = without_polynomial({x.data(), static_cast<std::size_t>(n)}, degree);
    EXPECT_LT((rest - expected).cwiseAbs().maxCoeff(), 1e-12) << n;
  }
}

}  // namespace
}  // namespace lunid
