// MAT files of versions 4, 5 (plain and compressed) and 7.3: what users of MATLAB hand over, and what is wrong with it.
#include <matio.h>

#include <algorithm>
#include <cmath>

#include "container_files.hpp"
#include "message.hpp"
#include "record/stream.hpp"

namespace lunid {
namespace {

using test::columns;

constexpr std::size_t rows = 50;

/// Writes variables by matio.
class MatWriter {
 public:
  MatWriter(const std::string& path, mat_ft version, matio_compression compression = MAT_COMPRESSION_NONE)
      : file_(Mat_CreateVer(path.c_str(), nullptr, version)), compression_(compression) {}
  ~MatWriter() { Mat_Close(file_); }

  template <class T>
  static matvar_t* make(const char* name, matio_classes kind, matio_types type, std::vector<T> values, std::size_t m,
                        std::size_t n) {
    std::size_t sides[] = {m, n};
    return Mat_VarCreate(name, kind, type, 2, sides, values.data(), 0);
  }
  static matvar_t* column(const char* name, const std::vector<double>& values) {
    return make(name, MAT_C_DOUBLE, MAT_T_DOUBLE, values, values.size(), 1);
  }
  void add(matvar_t* variable) {
    ASSERT_EQ(Mat_VarWrite(file_, variable, compression_), 0);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
  matio_compression compression_;
};

std::vector<double> wave(double amplitude, std::size_t count = rows) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = amplitude * std::sin(0.3 * static_cast<double>(i));
  return values;
}
std::vector<double> times(std::size_t count = rows) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = 2 + 0.001 * static_cast<double>(i);
  return values;
}

class MatFile : public test::ContainerTest {
 protected:
  /// t, qm, vir as columns; y as a row; a rate; a structure; and what no channel can be.
  void write(const std::string& name, mat_ft version, matio_compression compression = MAT_COMPRESSION_NONE) {
    MatWriter file(path(name), version, compression);
    file.add(MatWriter::column("t", times()));
    file.add(MatWriter::make("qm", MAT_C_DOUBLE, MAT_T_DOUBLE, wave(1e-3), 1, rows));
    file.add(MatWriter::column("vir", wave(5)));
    file.add(MatWriter::column("fs", {1000}));
    std::vector<float> single(rows);
    for (std::size_t i = 0; i < rows; ++i) single[i] = static_cast<float>(wave(3)[i]);
    file.add(MatWriter::make("load", MAT_C_SINGLE, MAT_T_SINGLE, single, rows, 1));
    std::vector<std::int16_t> counts(rows);
    for (std::size_t i = 0; i < rows; ++i) counts[i] = static_cast<std::int16_t>(10 * i);
    file.add(MatWriter::make("counts", MAT_C_INT16, MAT_T_INT16, counts, rows, 1));
    std::vector<double> both = wave(1e-3);
    for (const double v : wave(7)) both.push_back(v);
    file.add(MatWriter::make("data", MAT_C_DOUBLE, MAT_T_DOUBLE, both, rows, 2));
    file.add(MatWriter::make("note", MAT_C_CHAR, MAT_T_UINT8, std::vector<std::uint8_t>{'h', 'i'}, 1, 2));
    file.add(MatWriter::column("short", wave(1, 7)));
    std::vector<double> real = wave(1), imaginary = wave(2);
    mat_complex_split_t parts{real.data(), imaginary.data()};
    std::size_t sides[] = {rows, 1};
    file.add(Mat_VarCreate("spectrum", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sides, &parts, MAT_F_COMPLEX));
    const char* inner_names[] = {"y"};
    const char* names[] = {"F", "sensor"};
    std::size_t one[] = {1, 1};
    matvar_t* inner = Mat_VarCreateStruct("sensor", 2, one, inner_names, 1);
    Mat_VarSetStructFieldByName(inner, "y", 0, MatWriter::column("y", wave(4e-3)));
    matvar_t* outer = Mat_VarCreateStruct("run", 2, one, names, 2);
    Mat_VarSetStructFieldByName(outer, "F", 0, MatWriter::column("F", wave(9)));
    Mat_VarSetStructFieldByName(outer, "sensor", 0, inner);
    file.add(outer);
  }

  void expect_channel(const Record& record, const char* name, const std::vector<double>& expected) {
    ASSERT_EQ(static_cast<std::size_t>(record.rows()), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(record[name][i], expected[i]) << name << " " << i;
  }
};

class EveryVersion : public MatFile, public ::testing::WithParamInterface<int> {
 protected:
  void SetUp() override {
    MatFile::SetUp();
    const auto compression = GetParam() == 1 ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE;
    write("run.mat", GetParam() == 2 ? MAT_FT_MAT73 : MAT_FT_MAT5, compression);
  }
};

TEST_P(EveryVersion, columns_rows_and_other_numbers_are_channels) {
  const Record record = read_record(path("run.mat"), columns("t=t,y=qm [mm],F=vir"));
  EXPECT_EQ(record.start(), 2);
  EXPECT_EQ(record.dt(), 0.001);
  std::vector<double> metres = wave(1e-3);
  for (double& y : metres) y *= si_unit("mm")->factor;
  expect_channel(record, "y", metres);
  expect_channel(record, "F", wave(5));
  EXPECT_EQ(record["counts"][7], 70);
  EXPECT_EQ(record["load"][9], static_cast<double>(static_cast<float>(wave(3)[9])));
  EXPECT_TRUE(record.has("v") && record.channel("v").derived);
  for (const char* none : {"fs", "note", "short", "spectrum", "data"}) EXPECT_FALSE(record.has(none)) << none;
}

TEST_P(EveryVersion, fields_and_columns_of_arrays) {
  const Record record = read_record(path("run.mat"), columns("t=t,y=run.sensor.y,F=run/F,v=data:2"));
  expect_channel(record, "y", wave(4e-3));
  expect_channel(record, "F", wave(9));
  expect_channel(record, "v", wave(7));
}

TEST_P(EveryVersion, rows_come_in_blocks_from_version_7_3_alone) {
  StreamOptions options;
  options.read = columns("t=t,y=qm [mm],F=vir,v=data:2");
  if (GetParam() != 2) {
    EXPECT_EQ(
        message([&] { open_stream(path("run.mat"), options); }),
        path("run.mat") +
            ": variable 'qm': a MAT file gives its rows in blocks only where it is of version 7.3 and the variable "
            "is not inside a structure: save it with -v7.3, or read it whole with lunid.read");
    return;
  }
  const Record whole = read_record(path("run.mat"), options.read);
  const Stream stream = open_stream(path("run.mat"), options);
  EXPECT_EQ(stream.start(), 2);
  EXPECT_EQ(stream.dt(), 0.001);
  const Record part = stream.read(7, 20);
  for (const char* name : {"y", "F", "v", "a", "counts", "load"})
    for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(part[name][i], whole[name][7 + i]) << name;
  EXPECT_FALSE(stream.has("run.F"));
  EXPECT_EQ(std::count(stream.warnings().begin(), stream.warnings().end(),
                       "left out: variable 'run.F': it cannot be read in blocks"),
            1);
}

TEST_P(EveryVersion, a_rate_stands_for_the_time) {
  ReadOptions options = columns("y=qm,F=vir");
  for (const bool named : {false, true}) {
    options.interval = named ? 0 : 1 / 1000.0;
    options.rate_name = named ? "fs" : "";
    const Record record = read_record(path("run.mat"), options);
    EXPECT_EQ(record.start(), 0);
    EXPECT_EQ(record.dt(), 0.001);
    EXPECT_EQ(record.rows(), static_cast<Eigen::Index>(rows));
    EXPECT_EQ(record.warnings().at(0), "left out: the time 't', because a rate or interval is given");
  }
  options.rate_name = "qm";
  options.interval = 0;
  EXPECT_EQ(fault("run.mat", options), "run.mat: variable 'qm' as the rate: expected a number, got 1 x 50");
}

TEST_P(EveryVersion, what_was_asked_for_and_is_not_there) {
  const std::string list =
      "; the file has t (50 x 1), qm (1 x 50), vir (50 x 1), fs (a number), load (50 x 1), counts (50 x 1), data (50 x "
      "2), note (text), short (7 x 1), spectrum (complex numbers), run.F (50 x 1), run.sensor.y (50 x 1)";
  if (GetParam() < 2) {
    EXPECT_EQ(fault("run.mat", columns("y=qn")),
              "run.mat: no variable 'qn' for channel 'y'" + list + "; did you mean 'qm'?");
    EXPECT_EQ(fault("run.mat", columns("y=position")), "run.mat: no variable 'position' for channel 'y'" + list);
  } else {  // in the order of HDF5
    EXPECT_NE(fault("run.mat", columns("y=qn")).find("no variable 'qn' for channel 'y'; the file has "),
              std::string::npos);
  }
  EXPECT_EQ(fault("run.mat", columns("y=note")),
            "run.mat: variable 'note' for channel 'y': expected a vector of real numbers, got text");
  EXPECT_EQ(fault("run.mat", columns("y=spectrum")),
            "run.mat: variable 'spectrum' for channel 'y': expected a vector of real numbers, got complex numbers");
  EXPECT_EQ(fault("run.mat", columns("y=data")),
            "run.mat: variable 'data' for channel 'y': expected a vector of real numbers, got an array of 50 x 2; take "
            "one of its columns, such as 'data:1'");
  EXPECT_EQ(fault("run.mat", columns("y=data:3")),
            "run.mat: variable 'data:3' for channel 'y': 'data' is 50 x 2, which has no such column");
  EXPECT_EQ(fault("run.mat", columns("t=t,y=short")), "run.mat: variable 'short' has 7 values, 't' has 50");
  ReadOptions both = columns("t=t,y=qm");
  both.interval = 0.001;
  EXPECT_EQ(fault("run.mat", both),
            "run.mat: the time column and a rate or interval are both given: expected one of them");
}

TEST_P(EveryVersion, a_file_that_was_cut_short) {
  const auto whole = std::filesystem::file_size(path("run.mat"));
  for (const double part : {0.3, 0.6, 0.99}) {
    cut("run.mat", static_cast<std::uintmax_t>(part * static_cast<double>(whole)));
    const std::string said = fault("run.mat", columns("t=t,y=qm,F=vir"));
    EXPECT_NE(said, "no error") << part;
    if (GetParam() < 2) {
      EXPECT_NE(said.find("run.mat: cut short: a variable begins at byte "), std::string::npos) << said;
    }
    write("run.mat", GetParam() == 2 ? MAT_FT_MAT73 : MAT_FT_MAT5,
          GetParam() == 1 ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE);
  }
}

INSTANTIATE_TEST_SUITE_P(Mat, EveryVersion, ::testing::Values(0, 1, 2), [](const auto& info) {
  return std::string(info.param == 0 ? "v5" : info.param == 1 ? "v5_compressed" : "v7_3");
});

class Written : public MatFile, public ::testing::WithParamInterface<MatVersion> {};
INSTANTIATE_TEST_SUITE_P(Mat, Written, ::testing::Values(MatVersion::v5, MatVersion::v7_3),
                         [](const auto& info) { return info.param == MatVersion::v5 ? "v5" : "v7_3"; });

TEST_P(Written, reads_back_to_the_same_doubles_and_units) {
  const auto channel = [](const char* name, const char* unit, const std::vector<double>& values) {
    Channel made;
    made.name = name;
    made.unit = unit;
    made.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    return made;
  };
  const Record record("run", 2, 0.001,
                      {channel("F", "N", wave(5)), channel("y", "m", wave(1e-3)), channel("strain 1", "", wave(7))});
  write_mat(record, path("run.mat"), GetParam());
  const Record back = read_record(path("run.mat"));
  expect_channel(back, "F", wave(5));
  expect_channel(back, "y", wave(1e-3));
  expect_channel(back, "strain_1", wave(7));
  EXPECT_EQ(back.channel("F").unit, "N");
  EXPECT_EQ(back.channel("y").unit, "m");
  EXPECT_EQ(back.channel("strain_1").unit, "");
  EXPECT_NEAR(back.dt(), 0.001, 1e-16);
  EXPECT_EQ(back.start(), 2);
  EXPECT_TRUE(back.warnings().empty());
  // What MATLAB itself would see.
  mat_t* file = Mat_Open(path("run.mat").c_str(), MAT_ACC_RDONLY);
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(Mat_GetVersion(file), GetParam() == MatVersion::v5 ? MAT_FT_MAT5 : MAT_FT_MAT73);
  matvar_t* y = Mat_VarRead(file, "y");
  EXPECT_EQ(y->rank, 2);
  EXPECT_EQ(y->dims[0], rows);
  EXPECT_EQ(y->dims[1], 1u);
  Mat_VarFree(y);
  Mat_Close(file);
  if (GetParam() == MatVersion::v7_3) {
    const Stream stream = open_stream(path("run.mat"));
    EXPECT_EQ(stream.read(7, 1)["y"][0], wave(1e-3)[7]);
  }
}

TEST_P(Written, is_whole_or_not_there) {
  Channel first, second;
  first.name = "a 1", second.name = "a_1";
  first.values = second.values = Eigen::VectorXd::LinSpaced(10, 0, 1);
  std::ofstream(path("kept.mat")) << "what was there";
  const Record record("run", 0, 1, {first, second});
  EXPECT_EQ(message([&] { write_mat(record, path("kept.mat"), GetParam()); }),
            path("kept.mat") + ": the channels 'a 1' and 'a_1' would both be called 'a_1' in a MAT file");
  std::string text;
  std::getline(std::ifstream(path("kept.mat")), text);
  EXPECT_EQ(text, "what was there");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("")), {}), 1);
  EXPECT_EQ(message([&] { write_mat(record, path("none/run.mat"), GetParam()); }),
            path("none/run.mat") + ": cannot write: No such file or directory");
}

TEST_F(MatFile, units_beside_the_variables) {
  {
    MatWriter file(path("units.mat"), MAT_FT_MAT5);
    file.add(MatWriter::column("t", times()));
    file.add(MatWriter::column("y", wave(1)));
    const char* names[] = {"y"};
    std::size_t one[] = {1, 1};
    matvar_t* units = Mat_VarCreateStruct("units", 2, one, names, 1);
    Mat_VarSetStructFieldByName(
        units, "y", 0, MatWriter::make("y", MAT_C_CHAR, MAT_T_UINT8, std::vector<std::uint8_t>{'m', 'm'}, 1, 2));
    file.add(units);
  }
  const Record record = read_record(path("units.mat"));
  EXPECT_EQ(record["y"][3], wave(1)[3] * 1e-3);
  EXPECT_EQ(record.channel("y").source_unit, "mm");
  EXPECT_EQ(read_record(path("units.mat"), columns("t=t,y=y [cm]"))["y"][3], wave(1)[3] * 1e-2);  // said by the user
}

TEST_F(MatFile, version_4) {
  {
    MatWriter file(path("old.mat"), MAT_FT_MAT4);
    file.add(MatWriter::column("t", times()));
    file.add(MatWriter::column("y", wave(1e-3)));
  }
  expect_channel(read_record(path("old.mat")), "y", wave(1e-3));
}

TEST_F(MatFile, files_that_are_none) {
  EXPECT_EQ(fault("none.mat"), "none.mat: no such file");
  std::ofstream(path("empty.mat")).close();
  EXPECT_EQ(fault("empty.mat"), "empty.mat: the file is empty");
  std::ofstream(path("text.mat")) << "t,y\n0,1\n1,2\nand so on, as if it were a table of numbers\n";
  EXPECT_EQ(fault("text.mat"), "text.mat: this is no MAT file that can be read");
  std::ofstream(path("tiny.mat")) << "MATLAB 5.0";
  EXPECT_EQ(fault("tiny.mat"), "tiny.mat: cut short: it holds no more than a part of its header");
}

TEST_F(MatFile, a_value_that_is_no_number) {
  {
    MatWriter file(path("gap.mat"), MAT_FT_MAT5);
    std::vector<double> y = wave(1e-3), extra = wave(1);
    y[11] = std::nan("");
    extra[3] = INFINITY;
    file.add(MatWriter::column("t", times()));
    file.add(MatWriter::column("y", y));
    file.add(MatWriter::column("F", wave(2)));
    file.add(MatWriter::column("extra", extra));
  }
  EXPECT_EQ(fault("gap.mat"), "gap.mat: variable 'y': row 12: expected a finite number, got NaN");
  {
    MatWriter file(path("huge.mat"), MAT_FT_MAT5);
    std::vector<double> y = wave(1e-3);
    y[11] = -1e300;
    file.add(MatWriter::column("t", times()));
    file.add(MatWriter::column("y", y));
  }
  EXPECT_EQ(fault("huge.mat"), "huge.mat: variable 'y': row 12: expected a finite number, got -1e+300, beyond 1e60");
  {
    MatWriter file(path("late.mat"), MAT_FT_MAT5);
    std::vector<double> extra = wave(1);
    extra[3] = INFINITY;
    file.add(MatWriter::column("y", wave(1e-3)));
    file.add(MatWriter::column("extra", extra));
  }
  EXPECT_EQ(fault("late.mat"),
            "late.mat: no time: expected a variable named 't' or 'time'; the file has 'y', 'extra'; name it as time = "
            "\"...\" (--columns \"t=...\"), or give rate or interval (--rate)");
  ReadOptions options;
  options.interval = 0.01;
  const Record record = read_record(path("late.mat"), options);
  EXPECT_FALSE(record.has("extra"));
  EXPECT_EQ(record.warnings().at(0), "left out: variable 'extra': row 4: expected a finite number, got infinity");
}

TEST_F(MatFile, emps_is_the_record_of_its_csv) {
  const std::string folder = LUNID_SHARED_DATA "/emps/";
  if (!std::filesystem::exists(folder + "DATA_EMPS.mat")) GTEST_SKIP() << "no measured records at " << folder;
  const Record mat = read_record(folder + "DATA_EMPS.mat", columns("t=t,y=qm,F=vir"));
  const Record csv = read_record(folder + "emps.csv");
  ASSERT_EQ(mat.rows(), csv.rows());
  EXPECT_NEAR(mat.dt(), csv.dt(), 1e-15);  // its stamps are off even time by up to 32 ns
  const auto file = open_container(folder + "DATA_EMPS.mat");
  const double gain = read_choice(*file, folder, choose_variable(*file, folder, "gtau", "as a gain"))[0];
  for (Eigen::Index i = 0; i < mat.rows(); ++i) {  // the CSV holds 9 digits, and the force where the MAT has volts
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(mat["y"][at], csv["y"][at], 1e-9 * std::abs(csv["y"][at]) + 1e-12);
    EXPECT_NEAR(gain * mat["F"][at], csv["F"][at], 1e-8 * std::abs(csv["F"][at]) + 1e-7);
  }
}

}  // namespace
}  // namespace lunid
