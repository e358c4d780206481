// HDF5: a record goes out and comes back to the same bits; files of others; broken ones.
#include <hdf5.h>

#include <cmath>
#include <random>

#include "container_files.hpp"
#include "message.hpp"
#include "record/stream.hpp"

namespace lunid {
namespace {

using test::columns;

Record noise_record(double t0, double dt) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Channel> channels;
  for (const auto& [name, unit] : {std::pair{"F", "N"}, std::pair{"y", "m"}, std::pair{"v", "m/s"},
                                   std::pair{"a", "m/s^2"}, std::pair{"strain", ""}}) {
    Channel channel;
    channel.name = channel.source = name;
    channel.unit = unit;
    channel.values = Eigen::VectorXd::NullaryExpr(200, [&] { return normal(random) * 1e-3; });
    channels.push_back(std::move(channel));
  }
  return Record("run", t0, dt, std::move(channels));
}

class Hdf5File : public test::ContainerTest {};

TEST_F(Hdf5File, a_record_comes_back_to_the_same_bits) {
  for (const double dt : {1e-3, 1.0 / 3 * 1e-3, 0.1 + 1e-9}) {
    const Record out = noise_record(-0.7, dt).slice(3, 150);
    write_hdf5(out, path("run.h5"));
    const Record in = read_record(path("run.h5"));
    ASSERT_EQ(in.rows(), out.rows());
    EXPECT_EQ(in.start(), out.start());
    EXPECT_EQ(in.dt(), out.dt());
    ASSERT_EQ(in.channels().size(), out.channels().size());
    for (std::size_t c = 0; c < out.channels().size(); ++c) {  // in the same order
      const Channel& channel = out.channels()[c];
      EXPECT_EQ(in.channels()[c].name, channel.name);
      EXPECT_EQ(in.channels()[c].unit, channel.unit);
      for (std::size_t i = 0; i < 150; ++i) EXPECT_EQ(in[channel.name][i], out[channel.name][i]);
    }
    const std::string bytes = bytes_of(path("run.h5"));
    write_hdf5(out, path("again.h5"));
    EXPECT_EQ(bytes, bytes_of(path("again.h5")));
  }
}

TEST_F(Hdf5File, is_streamed_to_the_same_bits) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  Channel force, y;
  force.name = "F", y.name = "y";
  force.unit = "N", y.unit = "m";
  force.values = Eigen::VectorXd::NullaryExpr(40000, [&] { return normal(random); });
  y.values = Eigen::VectorXd::NullaryExpr(
      40000, [&](Eigen::Index i) { return std::sin(0.05 * static_cast<double>(i)) + 0.01 * normal(random); });
  write_hdf5(Record("run", 2, 1.0 / 3e3, {force, y}), path("run.h5"));
  const Record whole = read_record(path("run.h5"));
  const Stream stream = open_stream(path("run.h5"));
  EXPECT_EQ(stream.rows(), whole.rows());
  EXPECT_EQ(stream.start(), whole.start());
  EXPECT_EQ(stream.dt(), whole.dt());
  const Record part = stream.read(16000, 1000);
  for (const Channel& channel : whole.channels()) {
    EXPECT_EQ(stream.channel(channel.name).noise, channel.noise);
    EXPECT_EQ(stream.channel(channel.name).derivation, channel.derivation);
    for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(part[channel.name][i], whole[channel.name][16000 + i]);
  }
}

/// Files as other programs write them.
class ForeignFile {
 public:
  explicit ForeignFile(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~ForeignFile() { H5Fclose(file_); }
  void group(const char* name) { H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }
  void add(const char* name, hid_t type, std::vector<hsize_t> sides, const std::vector<double>& values,
           const char* unit = nullptr) {
    const hid_t space = H5Screate_simple(static_cast<int>(sides.size()), sides.data(), nullptr);
    const hid_t data = H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (unit) {  // of variable length, as h5py writes it
      const hid_t text = H5Tcopy(H5T_C_S1), one = H5Screate(H5S_SCALAR);
      H5Tset_size(text, H5T_VARIABLE);
      const hid_t attribute = H5Acreate2(data, "units", text, one, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, text, &unit);
      H5Aclose(attribute);
      H5Sclose(one);
      H5Tclose(text);
    }
    H5Dclose(data);
    H5Sclose(space);
  }

 private:
  hid_t file_;
};

std::vector<double> line(double slope, int count = 40) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values[static_cast<std::size_t>(i)] = slope * i + std::sin(i);
  return values;
}

TEST_F(Hdf5File, groups_units_arrays_and_single_numbers) {
  {
    ForeignFile file(path("lab.h5"));
    file.group("run1");
    std::vector<double> t = line(0), array;
    for (int i = 0; i < 40; ++i) t[static_cast<std::size_t>(i)] = 0.5 * i;
    for (int i = 0; i < 40; ++i) array.insert(array.end(), {1.0 * i, -3.0 * i * i, 0.5});
    file.add("run1/clock", H5T_IEEE_F64LE, {40}, t, "ms");
    file.add("run1/y", H5T_IEEE_F64BE, {40, 1}, line(1), "mm");
    file.add("run1/array", H5T_IEEE_F64LE, {40, 3}, array);
    file.add("fs", H5T_IEEE_F64LE, {1}, {2000});
  }
  const Record record = read_record(path("lab.h5"), columns("t=run1/clock,y=run1.y,F=run1/array:2"));
  EXPECT_EQ(record.dt(), 0.0005);
  EXPECT_EQ(record["y"][3], line(1)[3] * 1e-3);
  EXPECT_EQ(record["F"][5], -75);
  ReadOptions rate = columns("y=run1/y");
  rate.rate_name = "fs";
  EXPECT_EQ(read_record(path("lab.h5"), rate).dt(), 0.0005);
  EXPECT_EQ(fault("lab.h5", columns("y=run2/y")),
            "lab.h5: no variable 'run2/y' for channel 'y'; the file has fs (a number), run1/array (40 x 3), run1/clock "
            "(40 values), run1/y (40 x 1); did you mean 'run1/y'?");
  // A window of rows, as a reader of large files takes it.
  const auto file = open_container(path("lab.h5"));
  const ContainerChoice choice = choose_variable(*file, path("lab.h5"), "run1/array:1", "here");
  EXPECT_EQ(read_choice(*file, path("lab.h5"), choice, 10, 5), Eigen::VectorXd::LinSpaced(5, 10, 14));
}

TEST_F(Hdf5File, a_clock_in_single_precision_is_even) {
  {
    ForeignFile file(path("single.h5"));
    std::vector<double> t(5000);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = 0.001 * static_cast<double>(i);
    file.add("t", H5T_IEEE_F32LE, {5000}, t);
    file.add("y", H5T_IEEE_F32LE, {5000}, line(1, 5000));
  }
  const Record record = read_record(path("single.h5"));
  EXPECT_EQ(record.dt(), 0.001);
  EXPECT_EQ(record.start(), 0);
}

TEST_F(Hdf5File, broken_files) {
  write_hdf5(noise_record(0, 1e-3), path("run.h5"));
  cut("run.h5", 3000);
  EXPECT_EQ(fault("run.h5"), "run.h5: this is no HDF5 file that can be read: cut short, damaged, or of another kind");
  std::ofstream(path("text.h5")) << "t,y\n";
  EXPECT_EQ(fault("text.h5"), "text.h5: this is no HDF5 file that can be read: cut short, damaged, or of another kind");
  { ForeignFile file(path("bare.h5")); }
  EXPECT_EQ(fault("bare.h5"),
            "bare.h5: no time: expected a variable named 't' or 'time'; the file has no vectors of numbers; name it as "
            "time = \"...\" (--columns \"t=...\"), or give rate or interval (--rate)");
  EXPECT_EQ(fault("bare.h5", columns("y=y")), "bare.h5: no variable 'y' for channel 'y'; the file has no variables");
}

TEST_F(Hdf5File, a_csv_file_has_a_rate_too) {
  std::ofstream(path("run.csv")) << "F,y\n1,2\n2,3\n3,5\n4,6\n5,1\n6,9\n7,8\n";
  ReadOptions options;
  options.interval = 0.25;
  const Record record = read_record(path("run.csv"), options);
  EXPECT_EQ(record.dt(), 0.25);
  EXPECT_EQ(record["y"][6], 8);
  options.interval = 0;
  options.rate_name = "fs";
  EXPECT_EQ(fault("run.csv", options),
            "run.csv: rate and interval: expected a number for a CSV file, got the name 'fs'");
}

}  // namespace
}  // namespace lunid
