// A record that is read block by block is the record that is read whole, to the last bit.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "message.hpp"
#include "record/stream.hpp"
#include "record_file.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::TextFile;

/// A noisy ringing in millimetres, of more rows than are read together; with comments, blank lines and a spare column.
std::string ringing(int rows, const std::string& header = "t [ms],F,y [mm],temperature") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::string text = "\xef\xbb\xbf# a comment\n" + header + "\n";
  for (int i = 0; i < rows; ++i) {
    char line[128];
    const double t = 1.25 * i;
    std::snprintf(line, sizeof line, "%.2f,%.6g,%.6g,%d\n", t, std::sin(0.03 * i) + std::sin(0.11 * i),
                  2 * std::sin(0.07 * i + 1) + 0.02 * normal(random), 20 + i % 3);
    text += line;
    if (i % 1000 == 7) text += "# half-way\n\n";
  }
  return text;
}

void expect_same_layout(const Stream& stream, const Record& record) {
  EXPECT_EQ(stream.rows(), record.rows());
  EXPECT_EQ(stream.dt(), record.dt());
  EXPECT_EQ(stream.start(), record.start());
  EXPECT_EQ(stream.warnings(), record.warnings());
  ASSERT_EQ(stream.channels().size(), record.channels().size());
  for (const Channel& whole : record.channels()) {
    const Channel& part = stream.channel(whole.name);
    EXPECT_EQ(part.unit, whole.unit) << whole.name;
    EXPECT_EQ(part.source, whole.source) << whole.name;
    EXPECT_EQ(part.noise, whole.noise) << whole.name;
    EXPECT_EQ(part.derived, whole.derived) << whole.name;
    EXPECT_EQ(part.derivation, whole.derivation) << whole.name;
  }
}

void expect_same_rows(const Stream& stream, const Record& record, Index first, Index count) {
  const Record part = stream.read(first, count);
  for (const Channel& channel : record.channels()) {
    const auto whole = record[channel.name], rows = part[channel.name];
    for (Index i = 0; i < count; ++i)
      ASSERT_EQ(rows[static_cast<std::size_t>(i)], whole[static_cast<std::size_t>(first + i)])
          << channel.name << " row " << first + i;
  }
}

TEST(Stream, OfACsvFileIsTheRecordToTheLastBit) {
  const TextFile file(ringing(40000));
  const Record record = read_csv(file.path());
  const Stream stream = open_stream(file.path());
  EXPECT_FALSE(stream.in_memory());
  expect_same_layout(stream, record);
  EXPECT_TRUE(stream.channel("v").derived);
  for (const auto& [first, count] :
       {std::pair<Index, Index>{0, 1}, {0, 17000}, {16380, 10}, {39999, 1}, {20000, 20000}})
    expect_same_rows(stream, record, first, count);
}

TEST(Stream, WindowsAreThoseOfTheRecord) {
  const TextFile file(ringing(20000));
  const Record record = read_csv(file.path()).window(2, 20);
  const Stream stream = open_stream(file.path()).window(2, 20);
  expect_same_layout(stream, record);
  EXPECT_EQ(stream.time(777), record.time(777));
  expect_same_rows(stream, record, 0, 50);
  expect_same_rows(stream, record, record.rows() - 50, 50);
  EXPECT_EQ(
      test::message_of(file, [&] { stream.window(100, 200); }),
      "run3.csv: window 100 to 200 s: expected at least 6 rows, the record has t = 2 to 20 s in steps of 0.00125 s");
}

TEST(Stream, BlocksFollowOneAnother) {
  const TextFile file(ringing(40000));
  const Stream stream = open_stream(file.path());
  Index next = 0;
  double sum = 0;
  stream.for_each_block([&](Index first, const Record& rows) {
    EXPECT_EQ(first, next);
    next += rows.rows();
    for (const double f : rows["F"]) sum += f;
  });
  EXPECT_EQ(next, 40000);
  const Record record = read_csv(file.path());
  double whole = 0;
  for (const double f : record["F"]) whole += f;
  EXPECT_EQ(sum, whole);
}

TEST(Stream, SmoothsAndDifferentiatesAsARecord) {
  const TextFile file(ringing(20000));
  const Record record = read_csv(file.path());
  StreamOptions smooth;
  smooth.derivative = PolynomialWindow{21, 4};
  smooth.smooth = true;
  expect_same_rows(open_stream(file.path(), smooth),
                   derive(record, {PolynomialWindow{21, 4}, {"y", "v", "a"}, "", true}), 0, 20000);
  StreamOptions differences;
  differences.derivative = FiniteDifferences{6, 3};
  expect_same_rows(open_stream(file.path(), differences),
                   derive(record, {FiniteDifferences{6, 3}, {"v", "a"}, "", false}), 0, 20000);
}

TEST(Stream, ChoosesWindowsAsForARecord) {
  const TextFile file(ringing(17000));
  const Record record = read_csv(file.path());
  for (const DerivativeMethod& method :
       {DerivativeMethod(FiniteDifferences{}), DerivativeMethod(FiniteDifferences{4, 0}),
        DerivativeMethod(PolynomialWindow{0, 5}), DerivativeMethod(SmoothedDifferences{})}) {
    StreamOptions options;
    options.derivative = method;
    options.smooth = !std::holds_alternative<FiniteDifferences>(method);
    const Record derived = derive(record, {method, {}, "", options.smooth});
    const Stream stream = open_stream(file.path(), options);
    EXPECT_EQ(stream.channel("v").derivation, derived.channel("v").derivation);
    EXPECT_EQ(stream.channel("a").noise, derived.channel("a").noise);
    EXPECT_EQ(stream.channel("y").derivation, derived.channel("y").derivation);
    expect_same_rows(stream, derived, 0, 17000);
  }
}

/// Of all rows, read in blocks that begin at odd places: the channels of the record, to so much of their deviation.
void expect_near_rows(const Stream& stream, const Record& record, double tolerance) {
  for (const char* name : {"y", "v", "a"}) {
    const auto values = record[name];
    const Eigen::Map<const Eigen::VectorXd> whole(values.data(), record.rows());
    const double deviation = std::sqrt((whole.array() - whole.mean()).square().mean());
    double most = 0;
    for (Index first = 0; first < record.rows(); first += 1777) {
      const Index count = std::min<Index>(1777, record.rows() - first);
      const Record part = stream.read(first, count);
      most = std::max(most, (Eigen::Map<const Eigen::VectorXd>(part[name].data(), count) - whole.segment(first, count))
                                .cwiseAbs()
                                .maxCoeff());
    }
    EXPECT_LT(most, tolerance * deviation) << name;
  }
}

class StreamOverlap : public ::testing::TestWithParam<DerivativeMethod> {};
INSTANTIATE_TEST_SUITE_P(Methods, StreamOverlap,
                         ::testing::Values(SmoothingSpline{}, SmoothingSpline{3}, SmoothingSpline{5, {}, 1e-18},
                                           SmoothingSpline{5, SmoothingSpline::Choice::cross_validation},
                                           KalmanSmoother{}, KalmanSmoother{0, 3}, KalmanSmoother{1e4, 4}),
                         [](const auto& info) { return name_of(info.param) + std::to_string(info.index); });

/// A displacement, and a velocity where it is measured as well, with 1 % of noise each.
std::string swinging(int rows, bool with_velocity) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::string text = with_velocity ? "t,y,v\n" : "t,y\n";
  for (int i = 0; i < rows; ++i) {
    char line[96];
    const double t = 1.25e-3 * i;
    const int length = std::snprintf(line, sizeof line, "%.5f,%.7g", t, std::sin(50 * t) + 0.01 * normal(random));
    std::snprintf(line + length, sizeof line - length, with_velocity ? ",%.7g\n" : "\n",
                  50 * (std::cos(50 * t) + 0.01 * normal(random)));
    text += line;
  }
  return text;
}

TEST_P(StreamOverlap, GivesTheNumbersOfTheWholeRecord) {
  const bool joint = std::holds_alternative<KalmanSmoother>(GetParam());
  for (const bool with_velocity : {false, true}) {
    if (with_velocity && !joint) continue;
    const TextFile file(swinging(5000, with_velocity));
    StreamOptions options;
    options.derivative = GetParam();
    options.smooth = !with_velocity;
    const Stream stream = open_stream(file.path(), options);
    const Record record = derive(read_csv(file.path()), {GetParam(), {}, "", options.smooth});
    for (const char* name : {"y", "v", "a"}) {
      EXPECT_EQ(stream.channel(name).derivation, record.channel(name).derivation);
      EXPECT_EQ(stream.channel(name).derived, record.channel(name).derived);
      EXPECT_EQ(stream.channel(name).unit, record.channel(name).unit);
      EXPECT_NEAR(stream.channel(name).noise, record.channel(name).noise, 1e-6 * record.channel(name).noise);
    }
    expect_near_rows(stream, record, 1e-9);
  }
}

TEST(Stream, ChoosesAParameterOnPartsOfALongRecord) {
  const TextFile file(ringing(40000));
  StreamOptions options;
  options.derivative = SmoothingSpline{};
  const Stream stream = open_stream(file.path(), options);
  const std::string text = stream.channel("v").derivation;
  const std::string end = " s^5 by the noise, chosen on 4 parts of 8192 rows";
  ASSERT_GT(text.size(), end.size());
  EXPECT_EQ(text.substr(text.size() - end.size()), end) << text;
  // The weight itself is that of another part but for chance: so is the noise that it leaves.
  const TextFile part(ringing(10000));
  const Record record = derive(read_csv(part.path()), {SmoothingSpline{}, {"v"}, "", false});
  EXPECT_NEAR(stream.channel("v").noise, record.channel("v").noise, 0.05 * record.channel("v").noise);
}

TEST(Stream, WideWindowsDifferByRounding) {  // their sums are made by Fourier transforms, whose blocks differ
  const TextFile file(ringing(20000));
  StreamOptions wide;
  wide.derivative = PolynomialWindow{301, 5};
  const Record record = derive(read_csv(file.path()), {PolynomialWindow{301, 5}, {"v", "a"}, "", false});
  const Record part = open_stream(file.path(), wide).read(5000, 3000);
  for (std::size_t i = 0; i < 3000; ++i) EXPECT_NEAR(part["v"][i], record["v"][5000 + i], 1e-11);
}

TEST(Stream, TakesRoundedAndJitteringStampsAsEven) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const double jitter : {0.0, 0.005})
    for (const int decimals : {3, 4, 7}) {
      std::string text = "t,F\n";
      for (int i = 0; i < 30000; ++i) {
        char line[64];
        std::snprintf(line, sizeof line, "%.*f,%d\n", decimals, 5 + (i + jitter * normal(random)) / 300.0, i % 7);
        text += line;
      }
      const TextFile file(text);
      const Record record = read_csv(file.path());
      const Stream stream = open_stream(file.path());
      EXPECT_NEAR(stream.dt(), record.dt(), (jitter > 0 && decimals > 3 ? 1e-11 : 0)) << decimals << " " << jitter;
      EXPECT_NEAR(stream.start(), record.start(), (jitter > 0 && decimals > 3 ? 1e-8 : 0)) << decimals << " " << jitter;
      EXPECT_EQ(stream.warnings().size(), record.warnings().size());
    }
}

std::string stream_complaint(const std::string& text, const StreamOptions& options = {}) {
  const TextFile file(text);
  return test::message_of(file, [&] { open_stream(file.path(), options); });
}

TEST(Stream, FaultsNameTheLineHoweverFarDown) {
  std::string text = ringing(20000);
  const std::size_t at = text.find("\n20000.00,");  // row 16000, beyond the first block
  ASSERT_NE(at, text.npos);
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at) + 1, '\n') + 1;
  const std::string where = "run3.csv:" + std::to_string(line) + ": ";
  const auto with = [&](const std::string& row) { return std::string(text).insert(at + 1, row + "\n"); };
  EXPECT_EQ(stream_complaint(with("20000.00,n/a,0,20")),
            where +
                "column 'F': expected a number, got 'n/a'; mend it, or delete the line and use lunid.read, whose "
                "resample = true interpolates missing rows");
  EXPECT_EQ(stream_complaint(with("20000.00,1")),
            where +
                "expected 4 cells, got 2; a line that is no row, such as one behind the table, has to go or to "
                "begin with #");
  EXPECT_EQ(stream_complaint(with("19.00,1,1,20")),
            where +
                "time runs backwards: t = 0.019 s after t = 19.9988 s; delete the rows that are out of order, or "
                "where all are evenly spaced give their rate in place of the time: rate = HZ (--rate HZ)");
  const std::size_t end = text.find('\n', at + 1);
  std::string gap = text;
  gap.erase(at + 1, end - at);
  EXPECT_EQ(stream_complaint(gap),
            where +
                "time is uneven: steps from 0.00125 to 0.0025 s, median 0.00125 s; the largest ends here; a stream is "
                "not resampled: cut the file there, or read it whole with lunid.read and resample = true");
}

TEST(Stream, LeavesASpareColumnOutThatIsNoNumber) {
  std::string text = ringing(3000);
  text.replace(text.find(",20\n", 40000), 4, ",warm\n");
  const TextFile file(text);
  const Stream stream = open_stream(file.path());
  EXPECT_FALSE(stream.has("temperature"));
  EXPECT_EQ(stream.warnings(), read_csv(file.path()).warnings());
}

TEST(Stream, RefusesWhatNeedsTheWholeRecord) {
  StreamOptions options;
  const TextFile file(ringing(2000));
  const std::string instead =
      ": take savitzky_golay, spline or kalman, which a stream makes block by block, or the whole record by lunid.read";
  options.derivative = FourierFilter{};
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: derivative: fourier: its weights have no end" + instead);
  options.derivative = TotalVariation{};
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: derivative: total_variation: each of its pieces depends on all rows" + instead);
  options.derivative = SmoothingSpline{5, {}, 1e9};
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: derivative: spline: smooths over 7.971e+05 rows on either side, expected at most 262144: take a "
            "smaller weight or a larger density, or the whole record by lunid.read");
  // The integral of a velocity without noise tells less and less of where the motion began.
  std::string exact = "t,y,v\n";
  for (int i = 0; i < 3000; ++i)
    exact +=
        std::to_string(1e-3 * i) + "," + std::to_string(i * 7 % 10) + "," + std::to_string(std::sin(0.05 * i)) + "\n";
  const TextFile drifting(exact);
  options.derivative = KalmanSmoother{};
  EXPECT_NE(message([&] { open_stream(drifting.path(), options); }).find("stream: derivative: kalman: smooths over "),
            std::string::npos);
  options.derivative = FiniteDifferences{2, 1};
  options.smooth = true;
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: smooth: expected a derivative that smooths, got finite_differences");
  options = {};
  options.read.resample = true;
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: resample: a stream is not resampled: see lunid.read");
  options = {};
  options.read.columns = parse_columns("Fb=0");
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: Fb=0: a stream has the columns of its file, which has no '0': see lunid.read");
  const TextFile accelerations(ringing(2000, "t [ms],F,a,temperature"));
  EXPECT_EQ(test::message_of(accelerations, [&] { open_stream(accelerations.path()).channel("y"); }),
            "run3.csv: no channel 'y': the stream has F, a, temperature; it would be an integral: see "
            "stream:integrate");
}

TEST(Stream, OfAChannelAtRestIsAtRest) {
  std::string text = "t,F,y\n";
  for (int i = 0; i < 3000; ++i) text += std::to_string(1e-3 * i) + "," + std::to_string(i % 7) + ",0.1\n";
  const TextFile file(text);
  const Record record = read_csv(file.path());
  const Stream stream = open_stream(file.path());
  expect_same_layout(stream, record);
  expect_same_rows(stream, record, 0, 3000);
  for (const char* name : {"v", "a"}) {
    EXPECT_EQ(record.channel(name).derivation, "of y, which is constant");
    for (const double value : record[name]) ASSERT_EQ(value, 0);
  }
  StreamOptions options;
  options.derivative = KalmanSmoother{};
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: derivative: kalman: channel 'y' is constant: there is no motion in it");
}

TEST(Stream, SaysWhenTheFileChanged) {
  const TextFile file(ringing(20000));
  const Stream stream = open_stream(file.path());
  std::filesystem::resize_file(file.path(), 100000);
  EXPECT_EQ(test::message_of(file, [&] { stream.read(15000, 100); }), "run3.csv: the file became shorter");
}

TEST(Stream, ProgressRisesToTheEndAndMayEndIt) {
  const TextFile file(ringing(40000));
  std::vector<double> seen;
  StreamOptions options;
  options.progress = [&](double fraction) { seen.push_back(fraction); };
  Index read = 0;
  options.reading = [&](Index rows) { read += rows; };
  const Stream stream = open_stream(file.path(), options);
  EXPECT_GT(seen.size(), 10u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GT(seen.back(), 0.5);
  EXPECT_LE(seen.back(), 1);
  stream.for_each_block([](Index, const Record&) {});
  EXPECT_EQ(read, 40000);
  options.progress = [&](double) { throw InputError("interrupted", {}, Fault::interrupted); };
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }), "interrupted");
}

}  // namespace
}  // namespace lunid
