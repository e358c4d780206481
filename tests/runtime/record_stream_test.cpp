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
  EXPECT_EQ(stream_complaint(with("20000.00,n/a,0,20")), where + "column 'F': expected a number, got 'n/a'");
  EXPECT_EQ(stream_complaint(with("20000.00,1")), where + "expected 4 cells, got 2");
  EXPECT_EQ(stream_complaint(with("19.00,1,1,20")), where + "time runs backwards: t = 0.019 s after t = 19.9988 s");
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
  options.derivative = KalmanSmoother{};
  const TextFile file(ringing(2000));
  EXPECT_EQ(
      message([&] { open_stream(file.path(), options); }),
      "stream: derivative: expected savitzky_golay or finite_differences, which need few rows at a time, got kalman, "
      "which needs the whole record: see lunid.read");
  options.derivative = FiniteDifferences{};
  EXPECT_EQ(
      message([&] { open_stream(file.path(), options); }),
      "stream: derivative: finite_differences: expected accuracy and step: from the noise they need the whole record");
  options.derivative = FiniteDifferences{2, 1};
  options.smooth = true;
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: smooth: expected the derivative savitzky_golay, got finite_differences");
  options = {};
  options.read.resample = true;
  EXPECT_EQ(message([&] { open_stream(file.path(), options); }),
            "stream: resample: a stream is not resampled: see lunid.read");
  const TextFile accelerations(ringing(2000, "t [ms],F,a,temperature"));
  EXPECT_EQ(
      test::message_of(accelerations, [&] { open_stream(accelerations.path()).channel("y"); }),
      "run3.csv: no channel 'y': the stream has F, a, temperature; it would be an integral, which needs the whole "
      "record: see lunid.read");
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
