// How the CSV files of loggers are laid out: decimal commas, lines of units, lines before the header, Latin-1.
#include <gtest/gtest.h>

#include <algorithm>

#include "record/columns.hpp"
#include "record/stream.hpp"
#include "record_file.hpp"

namespace lunid {
namespace {

using test::complaint;
using test::rows;
using test::TextFile;

Record read(const std::string& text, const ReadOptions& options = {}) {
  const TextFile file(text);
  return read_csv(file.path(), options);
}

/// Rows as test::rows prints them, between ; and with decimal commas.
std::string german(int count) {
  std::string text = rows(count);
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

/// Expects the numbers of a file of 20 rows and default columns, y in units of `unit` [m].
void expect_rows(const Record& record, double unit = 1) {
  ASSERT_EQ(record.rows(), 20);
  EXPECT_DOUBLE_EQ(record.dt(), 0.01);
  EXPECT_EQ(record["F"][5], 2);
  EXPECT_DOUBLE_EQ(record["y"][3], 0.001 * unit);
}

TEST(Layout, DecimalCommasBetweenSemicolonsOrTabs) {
  expect_rows(read("t;F;y\n" + german(20)));
  std::string tabs = "t\tF\ty\n" + german(20);
  std::replace(tabs.begin(), tabs.end(), ';', '\t');
  expect_rows(read(tabs));
  const Record record = read("t;F;y\n0;+1,5;-2,5E-3\n1;1;2\n2;1;2\n3;1;2\n4;\"1,25\";2\n5;1;2\n");
  EXPECT_EQ(record["F"][0], 1.5);
  EXPECT_EQ(record["y"][0], -2.5e-3);
  EXPECT_EQ(record["F"][4], 1.25);
  EXPECT_TRUE(record.warnings().empty());
}

TEST(Layout, RoundingOfTimeWithDecimalCommas) {  // stamps of three decimals at 3 kHz are even time
  std::string text = "t;F;y\n";
  for (int i = 0; i < 600; ++i) {
    char line[40];
    std::snprintf(line, sizeof line, "%.3f;%d;%d\n", i / 300.0, i % 3, i % 5);
    text += line;
  }
  std::replace(text.begin(), text.end(), '.', ',');
  EXPECT_DOUBLE_EQ(read(text).dt(), 1 / 300.0);
}

TEST(Layout, AStreamReadsDecimalCommasInEachOfItsPieces) {
  std::string text = "Logger 3\n\nt;F;y\ns;kN;mm\n";
  for (int i = 0; i < 20000; ++i)
    text += std::to_string(i) + ";" + std::to_string(i % 7) + ",5;" + std::to_string(i % 5) + "\n";
  const TextFile file(text);
  const Record whole = read_csv(file.path());
  const Stream stream = open_stream(file.path(), {});
  EXPECT_EQ(stream.rows(), whole.rows());
  const Record part = stream.window(15000, 15100).read(0, 101);
  EXPECT_EQ(part["F"][3], whole["F"][15003]);
  EXPECT_EQ(whole["F"][15003], 1000 * (15003 % 7 + 0.5));
}

TEST(Layout, ALineOfUnitsBelowTheHeader) {
  for (const std::string units : {"s;N;mm", "[s];[N];[mm]", "(s); ;(mm);"}) {
    const Record record = read("t;F;y\n" + units + "\n" + german(20));
    expect_rows(record, 1e-3);
    EXPECT_EQ(record.channel("y").source_unit, "mm");
  }
  EXPECT_EQ(
      complaint("t,F,y [m]\ns,N,mm\n" + rows(20)),
      "run3.csv:2: column 'y [m]': its unit is 'm' in the header and 'mm' in the line of units: expected one of them");
  expect_rows(read("t,F,y [mm]\ns,N,mm\n" + rows(20)), 1e-3);
  // The whole line or none of it: a word that is no unit makes it a row that is no numbers.
  EXPECT_EQ(
      complaint("t,F,y\ns,N,furlong\n" + rows(20)),
      "run3.csv:2: column 't': expected a number, got 's'; where this is a line of units, 'furlong' is none that is "
      "known: write them into the header, as 'y [mm]', and delete it");
}

TEST(Layout, LinesBeforeTheHeaderAreSkippedWithAWarning) {
  const Record record = read("Logger X200, serial 17\nDate: 2024-03-01\nRate,100\n\nt,F,y\n" + rows(20));
  expect_rows(record);
  ASSERT_EQ(record.warnings().size(), 1u);
  EXPECT_EQ(
      record.warnings()[0],
      "3 lines before the header in line 5 are no part of the table and skipped, the first: 'Logger X200, serial 17'");
  const Record units = read(
      "Pr\xfc"
      "fstand;3\nKanal;1;2;3\nt;F;y\ns;N;mm\n" +
      german(20));
  expect_rows(units, 1e-3);
  EXPECT_EQ(units.warnings()[0],
            "2 lines before the header in line 3 are no part of the table and skipped, the first: 'Pr\u00fcfstand;3'");
}

TEST(Layout, CommentsOfThreeKindsAreSkippedEverywhere) {
  std::string text = "% one\n// two, 2\n# three\n t,F,y\n" + rows(20) + "% the end\n";
  text.insert(text.find("0.0500"), "// half-way\n");
  const Record record = read(text);
  expect_rows(record);
  EXPECT_TRUE(record.warnings().empty());
}

TEST(Layout, AHeaderBehindTheMarkOfAComment) {
  for (const std::string mark : {"#", "# ", "% ", "//"})
    expect_rows(read("# made by a script\n" + mark + "t,F,y [mm]\n" + rows(20)), 1e-3);
  EXPECT_EQ(complaint("# made, by hand\n" + rows(20)).substr(0, 50),
            "run3.csv:2: no header: expected the names of the c");
}

TEST(Layout, WhereNoHeaderIsFoundTheErrorSaysWhatToDo) {
  EXPECT_EQ(
      complaint("Logger,X200\nt,F,y\n0,1\n1,2\n"),
      "run3.csv:1: no time column: expected a column named 't' or 'time', the file has 'Logger', 'X200'; name it with "
      "columns, such as \"t=Logger\", or give the rows per second: rate = HZ (--rate HZ); where lines before the table "
      "are no part of it, delete them or begin them with #");
  EXPECT_EQ(
      complaint("t,y\n0.5,1,2\n1,2,3\n"),
      "run3.csv:2: expected 2 cells, got 3; where lines before the table are no part of it, delete them or begin them "
      "with #");
}

TEST(Layout, Latin1IsReadAsSuch) {
  const Record record = read(
      "t;F [N];y [\xb5m];angle [\xb0];a "
      "[mm/s\xb2]\n0;1;2;180;4\n1;1;2;3;4\n2;1;2;3;4\n3;1;2;3;4\n4;1;2;3;4\n5;1;2;3;4\n");
  EXPECT_DOUBLE_EQ(record["y"][0], 2e-6);
  EXPECT_DOUBLE_EQ(record["a"][0], 4e-3);
  EXPECT_NEAR(record["angle"][0], 3.14159265, 1e-8);
  EXPECT_EQ(record.channel("y").source, "y [\u00b5m]");
  EXPECT_EQ(complaint("t;F;y\n0;5\xb0;1\n1;2;3\n").substr(0, 58),
            "run3.csv:2: column 'F': expected a number, got '5\u00b0'; mend");
}

TEST(Layout, AnAbbreviatedNameIsThatOfItsChannel) {
  const std::string text = "Time (s),Disp. (mm),Load. (kN)\n" + [] {
    std::string out;
    for (int i = 0; i < 8; ++i) out += std::to_string(i) + ",5,7\n";
    return out;
  }();
  EXPECT_DOUBLE_EQ(read(text)["y"][0], 5e-3);
  EXPECT_DOUBLE_EQ(read(text)["F"][0], 7e3);
  for (const char* columns : {"a=Disp. (mm/s^2)", "a=Disp. [mm/s^2]"})
    EXPECT_DOUBLE_EQ(read(text, {parse_columns(columns), false})["a"][0], 5e-3);
  EXPECT_DOUBLE_EQ(read(text, {parse_columns("other=Disp."), false})["other"][0], 5e-3);
}

TEST(Layout, ColumnsBetweenBlanks) {
  for (const std::string header :
       {"t F y\n", "  t   F\ty  \n", "# t F y\n", "Logger 3\nt F y\n", "t [s]  F [N] y [m]\n"}) {
    std::string text = rows(20);
    std::replace(text.begin(), text.end(), ',', ' ');
    expect_rows(read(header + text));
    std::string wide;
    for (const char c : text) wide += c == ' ' ? "    " : c == '\n' ? "\n   " : std::string(1, c);
    expect_rows(read(header + "   " + wide));
  }
  const Record record = read("t [s] F [kN m] y (mm)\n0 1 2\n1 1 2\n2 1 2\n3 1 2\n4 1 2\n5 1 2\n");
  EXPECT_EQ(record["F"][0], 1000);
  EXPECT_EQ(record.channel("F").unit, "N m");
  EXPECT_DOUBLE_EQ(record["y"][0], 2e-3);
  // Commas go before, where names and words hold blanks.
  EXPECT_EQ(read("t, F, pile head, remark\n0, 1, 2, at rest\n1, 1, 2, ok\n2, 1, 2, ok\n3, 1, 2, ok\n4, 1, 2, ok\n5, 1, "
                 "2, ok\n")["pile head"][0],
            2);
}

TEST(Layout, ATableWithoutNamesIsReadByItsNumbers) {
  const ReadOptions options{parse_columns("t=1, F=2 [kN], y=3"), false};
  const Record record = read(rows(20), options);
  EXPECT_EQ(record.rows(), 20);
  EXPECT_EQ(record["F"][5], 2000);
  std::string blanks = "# saved\n" + rows(20);
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  EXPECT_EQ(read(blanks, options)["F"][5], 2000);
  const TextFile file(rows(20));
  const Record free = read_record(file.path(), {parse_columns("t=1, F=0, y=3"), false});
  EXPECT_EQ(free["F"][5], 0);
  EXPECT_EQ(free["2"][5], 2);
  EXPECT_EQ(test::message_of(file,
                             [&] {
                               read_record(file.path(), {parse_columns("t=1, y=4"), false});
                             }),
            "run3.csv: no column '4' for channel 'y': a column is named by its header; a channel that is the same in "
            "every row has its unit beside the number, as y=4 [m]");
}

TEST(Layout, OneColumnAloneHasARate) {
  ReadOptions options;
  options.interval = 0.01;
  const Record record = read("v [mm/s]\n1\n2\n3\n4\n3\n2\n1\n", options);
  EXPECT_EQ(record.rows(), 7);
  EXPECT_DOUBLE_EQ(record["v"][2], 3e-3);
  EXPECT_EQ(complaint("t\n1\n2\n3\n4\n5\n6\n", options), "run3.csv:1: expected a column of numbers beside the time");
}

TEST(Layout, Utf16IsRead) {
  const std::string text = "t,F,y [\u00b5m]\n" + rows(20);
  std::string wide = "\xff\xfe";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool micro = text[i] == '\xc2';
    wide += micro ? text[++i] : text[i];
    wide += '\0';
  }
  expect_rows(read(wide), 1e-6);
  const TextFile file(wide);
  EXPECT_EQ(test::message_of(file, [&] { open_stream(file.path(), {}); }),
            "run3.csv: expected UTF-8 text, got UTF-16: save it as UTF-8, or read it whole with lunid.read");
}

TEST(Layout, QuotesRoundACellProtectCommasAndOthersAreSigns) {
  const std::string body = "0,1,2\n1,1,2\n2,1,2\n3,1,2\n4,1,2\n5,1,2\n";
  EXPECT_EQ(read("t,\"Force, N\",y\n" + body, {parse_columns("F=\"Force, N\" [kN],y=y"), false})["F"][0], 1000);
  EXPECT_EQ(read("t,y [\"],F\n" + body, {parse_columns("y=y [in]"), false})["y"][0], 0.0254);
}

TEST(Layout, ExponentsOfFortranAndATypographersMinus) {
  const Record record = read("t,F,y\n0,1.5D+03,\u22122d-3\n1,1,2\n2,1,2\n3,1,2\n4,1,2\n5,1,2\n");
  EXPECT_EQ(record["F"][0], 1500);
  EXPECT_EQ(record["y"][0], -2e-3);
}

TEST(Layout, RowsWithACellThatIsNoNumberAreMissingOnesWhereThatIsAskedFor) {
  std::string text = rows(20);
  const std::size_t row = text.find("0.0500");
  const std::string without = std::string(text).erase(row, text.find('\n', row) + 1 - row);
  text.replace(row, text.find('\n', row) - row, "0.0500,OVL,1");
  ReadOptions options;
  options.resample = true;
  const Record record = read("t,F,y\n" + text, options), deleted = read("t,F,y\n" + without, options);
  ASSERT_EQ(record.rows(), 20);
  EXPECT_EQ(record["F"][5], deleted["F"][5]);
  EXPECT_EQ(record["y"][5], deleted["y"][5]);
  EXPECT_EQ(record.warnings()[0],
            "line 7: column 'F': expected a number, got 'OVL': what stands there is taken for a missing row");
  options.interval = 0.01;  // rows count there
  EXPECT_EQ(complaint("t,F,y\n" + text, options),
            "run3.csv:7: column 'F': expected a number, got 'OVL'; mend it: beside a rate no row may be missing");
}

TEST(Layout, ATimeThatIsLeftOutIsHeldAgainstTheRate) {
  ReadOptions options;
  options.interval = 0.005;
  EXPECT_EQ(read("t,F,y\n" + rows(20), options).warnings().back(),
            "the time 't' has 100 rows per second, the rate that is given 200");
  options.interval = 0.01;
  EXPECT_EQ(read("t,F,y\n" + rows(20), options).warnings().size(), 1u);
  const Record clock =
      read("time,F,y\n12:00:00,1,2\n12:00:01,1,2\n12:00:02,1,2\n12:00:03,1,2\n12:00:04,1,2\n12:00:05,1,2\n", options);
  EXPECT_EQ(clock.warnings().size(), 1u);  // said once
}

TEST(Layout, ATimeWithoutAUnitIsKnownAsSuch) {
  EXPECT_TRUE(read("t,F,y\n" + rows(20)).window(0.05, 0.15).time_without_unit());
  EXPECT_FALSE(read("t [s],F,y\n" + rows(20)).time_without_unit());
  EXPECT_FALSE(read("t,F,y\n" + rows(20), {parse_columns("t=t [s]"), false}).time_without_unit());
}

TEST(Layout, AUnitMaySpeakForOneChannelAlone) {
  for (const auto& [unit, channel] : std::vector<std::pair<std::string, char>>{
           {"m", 'y'}, {"rad", 'y'}, {"C", 'y'}, {"rad/s", 'v'}, {"m/s^2", 'a'}, {"N m", 'F'}, {"Pa", 'F'}})
    EXPECT_EQ(channel_of_unit(unit), channel) << unit;
  for (const char* unit : {"V", "A", "s", "kg", ""}) EXPECT_EQ(channel_of_unit(unit), 0) << unit;
}

}  // namespace
}  // namespace lunid
