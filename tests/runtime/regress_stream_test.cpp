// Regressions on records larger than memory: the same numbers, in a few megabytes.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>

#include "message.hpp"
#include "record/parallel.hpp"
#include "record/stream_treat.hpp"
#include "record_file.hpp"
#include "regress/lag.hpp"
#include "regress/regress.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using test::TextFile;

/// A Duffing oscillator's motion (a sum of sines with a little noise) and the force that it takes, y alone measured.
std::string duffing(int rows, double outliers = 0) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::string text = "t,F,y [mm]\n";
  for (int i = 0; i < rows; ++i) {
    const double t = i / 800.0;
    double y = 0, v = 0, a = 0;
    for (const double hertz : {2.1, 3.3, 5.7}) {
      const double w = 2 * M_PI * hertz;
      y += 2e-3 * std::sin(w * t + hertz);
      v += 2e-3 * w * std::cos(w * t + hertz);
      a -= 2e-3 * w * w * std::sin(w * t + hertz);
    }
    const double kick = outliers > 0 && i % 997 == 3 ? outliers : 0;
    char line[96];
    std::snprintf(line, sizeof line, "%.5f,%.7g,%.7g\n", t, 49 * a + 2e4 * y + 100 * v + 1e9 * y * y * y + kick,
                  1e3 * y + 1e-4 * normal(random));
    text += line;
  }
  return text;
}

struct Study {
  Pool pool;
  Expr y = pool.channel("y"), v = pool.channel("v");
  RegressOptions options;
  Study() {
    options.features = {y, v, pow(y, 3), y * v, pool.channel("t") * y};
    options.mass = pool.constant(49);
  }
};

void expect_same(const Regression& a, const Regression& b) {
  ASSERT_EQ(a.terms.size(), b.terms.size());
  EXPECT_EQ(a.fit.rows, b.fit.rows);
  EXPECT_EQ(a.rmse, b.rmse);
  for (std::size_t j = 0; j < a.terms.size(); ++j) {
    EXPECT_EQ(a.terms[j].coefficient, b.terms[j].coefficient) << to_text(a.terms[j].feature);
    EXPECT_EQ(a.terms[j].std, b.terms[j].std);
    EXPECT_EQ(a.terms[j].block_std, b.terms[j].block_std);
    EXPECT_EQ(a.terms[j].unit, b.terms[j].unit);
  }
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.windows, b.windows);
}

class StreamedRegression : public testing::Test {
 protected:
  void compare(const RegressOptions& options) {
    const Record record = read_csv(file.path());
    const Stream stream = open_stream(file.path());
    const Record records[] = {record.window(3, 50), record};
    const Stream streams[] = {stream.window(3, 50), stream};
    const Regression whole = regress(records, options), part = regress(streams, options);
    expect_same(part, whole);
    EXPECT_NEAR(whole.terms[0].coefficient, 2e4, 600);
    if (!whole.implicit.empty()) {
      EXPECT_EQ(part.implicit[0].value, whole.implicit[0].value);
    }
  }
  TextFile file{duffing(50000)};
  Study study;
};

TEST_F(StreamedRegression, GivesTheSameBits) {
  study.options.threads = 2;
  compare(study.options);
}

TEST_F(StreamedRegression, MixesFilesAndMemory) {
  const Record record = read_csv(file.path());
  const Record records[] = {record, record};
  const Stream both[] = {record, open_stream(file.path())};
  expect_same(regress(both, study.options), regress(records, study.options));
}

TEST_F(StreamedRegression, GivesTheSameBitsWithLags) {
  study.options.features.push_back(lag(study.pool.channel("F"), 3));
  study.options.features.push_back(lag(study.y, 7));
  const Record record = read_csv(file.path());
  const Stream stream = open_stream(file.path());
  expect_same(regress(std::span(&stream, 1), study.options), regress(std::span(&record, 1), study.options));
}

TEST_F(StreamedRegression, GivesTheSameBitsInEachPassOfASearch) {
  study.options.features.push_back(study.pool.apply(Op::tanh, {study.pool.parameter("p") * study.v}));
  study.options.implicit = {{"p", 10, 1, 100}};
  study.options.search.starts = 1;
  compare(study.options);
}

TEST_F(StreamedRegression, GivesTheSameBitsWhereRowsAreWeighed) {
  study.options.solver = HuberOptions{};
  compare(study.options);
}

TEST_F(StreamedRegression, GivesTheSameBitsOfTheWeakFormAndOfPassivity) {
  study.options.weak = WeakForm{};
  study.options.passive = PassiveOptions{};
  study.options.features = {study.y, study.v, pow(study.y, 3)};
  study.options.weak->half_width = 0.05;
  compare(study.options);
  study.options.weak->half_width = 0;
  const Stream stream = open_stream(file.path());
  const std::string text = message([&] { regress(std::span(&stream, 1), study.options); });
  EXPECT_EQ(text, "weak_form: half_width: 0 takes it from the whole of a record, and " + file.path() +
                      " is a stream: expected a width in seconds");
}

TEST_F(StreamedRegression, NamesTheRowOfTheFile) {
  study.options.features.push_back(study.pool.apply(Op::log, {60 - study.pool.channel("t")}));
  const Record record = read_csv(file.path()).window(39, 61);
  const Stream stream = open_stream(file.path()).window(39, 61);
  const std::string whole = message([&] { regress(std::span(&record, 1), study.options); });
  EXPECT_NE(whole.find("t = 60 s (row 16801 of "), whole.npos) << whole;
  EXPECT_EQ(message([&] { regress(std::span(&stream, 1), study.options); }), whole);
}

TEST(Parallel, ThrowsTheFaultOfTheLeastJob) {
  for (int repeat = 0; repeat < 50; ++repeat)
    EXPECT_EQ(message([] {
                parallel_for(40, 4, [](int i) {
                  if (i % 10 == 7) throw InputError("job " + std::to_string(i));
                });
              }),
              "job 7");
}

/// Runs an action in a process of its own that may take `bytes` more address space than it has; gives its exit code:
/// what the action gives, or 99 when memory ran out.
template <class Action>
int limited(rlim_t bytes, Action action) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::ifstream status("/proc/self/statm");
    rlim_t pages = 0;
    status >> pages;
    const rlim_t size = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + bytes;
    const rlimit limit{size, size};
    ::setrlimit(RLIMIT_AS, &limit);
    try {
      ::_exit(action());
    } catch (const std::bad_alloc&) {
      ::_exit(99);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      ::_exit(98);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(StreamedMemory, AFileTwentyTimesTheLimitIsRegressed) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer's own memory is beyond any limit";
#endif
  constexpr rlim_t limit = 3 << 20;
  // Periods of 40000 rows: only the time differs.
  const TextFile file("");
  {
    const std::string text = duffing(40000);
    std::ofstream out(file.path(), std::ios::binary);
    out << "t,F,y [mm]\n";
    std::string piece;
    for (int repeat = 0; repeat < 60; ++repeat) {
      piece.clear();
      int row = 40000 * repeat;
      for (std::size_t at = text.find('\n') + 1; at < text.size();) {
        const std::size_t comma = text.find(',', at), end = text.find('\n', at) + 1;
        char stamp[32];
        std::snprintf(stamp, sizeof stamp, "%.5f", row++ / 800.0);
        piece += stamp;
        piece.append(text, comma, end - comma);
        at = end;
      }
      out << piece;
    }
  }
  ASSERT_GT(std::filesystem::file_size(file.path()), 20 * limit);
  Study study;
  study.options.threads = 1;
  study.options.features.pop_back();
  EXPECT_EQ(limited(limit,
                    [&] {
                      const Stream stream = open_stream(file.path());
                      const Regression result = regress(std::span(&stream, 1), study.options);
                      return std::abs(result.terms[0].coefficient - 2e4) < 400 && result.fit.rows == 2400000 ? 7 : 8;
                    }),
            7);
  // A quarter of it filtered, rid of its trend and at half the rate: the kernel and the overlaps of the blocks beside
  // it.
  EXPECT_EQ(limited(2 * limit,
                    [&] {
                      study.options.features = {study.y};
                      const Stream stream = decimate(
                          detrend(filter(open_stream(file.path()).window(0, 750), {{0, 40}, 4, {}}), 1, {"y"}), 2);
                      return regress(std::span(&stream, 1), study.options).fit.rows == 300001 ? 7 : 8;
                    }),
            7);
  EXPECT_EQ(limited(limit, [&] { return read_csv(file.path()).rows() > 0 ? 7 : 8; }), 99);
}

}  // namespace
}  // namespace lunid
