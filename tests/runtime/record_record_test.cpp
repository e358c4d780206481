// The record as a value, its windows, and writing.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <random>

#include "record/atomic_file.hpp"
#include "record_file.hpp"

namespace lunid {
namespace {

using test::TextFile;

Channel channel(std::string name, int rows, double start = 0) {
  Channel result;
  result.name = std::move(name);
  result.values = Eigen::VectorXd::LinSpaced(rows, start, start + rows - 1);
  return result;
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Record, ChecksItsChannels) {
  EXPECT_THROW(Record("x", 0, 1, {}), InputError);
  EXPECT_THROW(Record("x", 0, 1, {channel("y", 0)}), InputError);
  EXPECT_THROW(Record("x", 0, 1, {channel("y", 3), channel("F", 4)}), InputError);
  EXPECT_THROW(Record("x", 0, 1, {channel("y", 3), channel("y", 3)}), InputError);
  EXPECT_THROW(Record("x", 0, 0, {channel("y", 3)}), InputError);
  EXPECT_NO_THROW(Record("x", 0, 1, {channel("y", 3), channel("F", 3)}));
  EXPECT_FALSE(Record().has("y"));
  EXPECT_THROW(Record()["y"], InputError);
}

TEST(Record, WindowsShareTheColumnsAndKeepTheClock) {
  const Record record("x", 5, 0.1, {channel("y", 101)});
  const Record part = record.window(6, 8);
  EXPECT_EQ(part.rows(), 21);  // both ends, in spite of 0.1 being no binary fraction
  EXPECT_DOUBLE_EQ(part.start(), 6);
  EXPECT_DOUBLE_EQ(part.duration(), 2);
  EXPECT_EQ(part["y"].data(), record["y"].data() + 10);
  const Record inner = part.window(6.5, 7.05);
  EXPECT_EQ(inner.rows(), 6);
  EXPECT_EQ(inner["y"][0], 15);
  EXPECT_EQ(record.window(-10, 99).rows(), 101);
  EXPECT_EQ(part.slice(1, 2)["y"][0], 11);
}

TEST(Record, WithAddsOrReplacesWithinTheWindow) {
  const Record part = Record("x", 0, 1, {channel("y", 50), channel("F", 50)}).slice(10, 20);
  const Record more = part.with(channel("v", 20)).with(channel("F", 20, 100));
  EXPECT_EQ(more.rows(), 20);
  EXPECT_EQ(more.start(), 10);
  EXPECT_EQ(more["y"][0], 10);
  EXPECT_EQ(more["F"][0], 100);
  EXPECT_EQ(more.channels().size(), 3u);
  EXPECT_EQ(more.channels()[1].name, "F");
  EXPECT_THROW(part.with(channel("v", 50)), InputError);
}

TEST(WriteCsv, ReadsBackToTheSameDoubles) {
  const TextFile file("");
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<Channel> channels{channel("y", 300), channel("F", 300), channel("ref, \"old\"", 300)};
  channels[0].unit = "m";
  channels[1].unit = "N";
  for (Channel& c : channels)
    for (double& value : c.values) value = normal(random) * std::pow(10.0, 15 * normal(random));
  for (const double dt : {0.00125, 1.0 / 300, 1e-3 * M_PI}) {
    const Record record("x", 0.7, dt, channels);
    write_csv(record, file.path());
    const Record back = read_csv(file.path());
    ASSERT_EQ(back.rows(), record.rows());
    for (const Channel& c : channels)
      for (std::size_t i = 0; i < 300; ++i) ASSERT_EQ(back[c.name][i], record[c.name][i]) << c.name << ' ' << i;
    EXPECT_EQ(back.channel("F").unit, "N");
    EXPECT_NEAR(back.dt(), dt, 1e-11 * dt);
    EXPECT_NEAR(back.start(), 0.7, 1e-15);
  }
}

TEST(WriteCsv, WritesTheWindowOnly) {
  const TextFile file("");
  write_csv(Record("x", 0, 1, {channel("y", 50)}).slice(10, 6), file.path());
  EXPECT_EQ(content(file.path()), "t [s],y\n10,10\n11,11\n12,12\n13,13\n14,14\n15,15\n");
}

TEST(WriteFileAtomically, ReplacesTheWholeAndKeepsTheMode) {
  const TextFile file("old");
  ASSERT_EQ(::chmod(file.path().c_str(), 0640), 0);
  write_file_atomically(file.path(), "new content");
  EXPECT_EQ(content(file.path()), "new content");
  struct stat info {};
  ::stat(file.path().c_str(), &info);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.folder()), {}),
            1);  // no temporary file stays
}

TEST(WriteFileAtomically, NamesThePathAndTheReason) {
  const TextFile file("old");
  const std::string nowhere = file.folder() / "none" / "x.csv";
  EXPECT_EQ(test::message_of(file, [&] { write_file_atomically(nowhere, "x"); }),
            "none/x.csv: cannot write: No such file or directory");
  EXPECT_EQ(test::message_of(file, [&] { write_file_atomically(file.folder(), "x"); }).empty(), false);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.folder()), {}), 1);
}

TEST(WriteFileAtomically, AFullDiskIsAnInputError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TextFile file("");
  EXPECT_EQ(test::message_of(file, [] { write_file_atomically("/dev/full", "x"); }),
            "/dev/full: cannot write: No space left on device");
}

[[noreturn]] void write_beyond_limit(const std::string& path) {
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{1000, 1000};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  try {
    write_file_atomically(path, std::string(5000, 'x'));
  } catch (const InputError& error) {
    ::_exit(error.message() == "cannot write: File too large" ? 7 : 8);
  }
  ::_exit(9);
}

TEST(WriteFileAtomically, ALimitOnFileSizeLeavesTheEarlierFile) {
  // A write that fails half-way, as on a full disk: the file size is limited in a child process.
  const TextFile file("old");
  EXPECT_EXIT(write_beyond_limit(file.path()), testing::ExitedWithCode(7), "");
  EXPECT_EQ(content(file.path()), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.folder()), {}), 1);
}

TEST(SharedData, ReadsTheMeasuredRecords) {
  const std::string shared = LUNID_SHARED_DATA;
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << "no measured data at " << shared;
  const Record emps = read_csv(shared + "/emps/emps.csv");
  EXPECT_EQ(emps.rows(), 24841);
  EXPECT_EQ(emps.dt(), 1e-3);
  EXPECT_TRUE(emps.has("y_reference"));
  const Record box = read_csv(shared + "/silverbox/snls80mv.csv");
  EXPECT_EQ(box.rows(), 131072);
  EXPECT_EQ(box.dt(), 0.0016384);
  EXPECT_EQ(box.window(70, 84).rows(), 8545);  // floor(84/dt) - ceil(70/dt) + 1
  const Record damper = read_csv(shared + "/friction_damper/train_0.5Hz_1in.csv");
  EXPECT_EQ(damper.dt(), 1.0 / 256);
  EXPECT_FALSE(damper.channel("v").derived);
}

}  // namespace
}  // namespace lunid
