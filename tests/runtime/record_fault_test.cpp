// The full text of what a faulty file is told.
#include <gtest/gtest.h>

#include "record_file.hpp"

namespace lunid {
namespace {

using test::complaint;
using test::message_of;
using test::rows;
using test::TextFile;

/// `rows` with one line (2 is the first row of numbers) replaced.
std::string spoiled(int line, const std::string& replacement, int count = 20) {
  std::string text = "t,F,y\n" + rows(count);
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, replacement);
}

const std::string mend = "; mend it, or set resample = true (--resample), which interpolates such rows as missing ones";
const std::string no_row = "; a line that is no row, such as one behind the table, has to go or to begin with #";
const std::string mend_time =
    "; delete the rows that are out of order, or where all are evenly spaced give their rate in place of the time: "
    "rate = HZ (--rate HZ)";
const std::string name_time = "or give the rows per second: rate = HZ (--rate HZ)";

TEST(Fault, MissingAndEmptyFiles) {
  const TextFile file("");
  EXPECT_EQ(message_of(file, [&] { read_csv(file.folder() / "none.csv"); }), "none.csv: no such file");
  EXPECT_EQ(message_of(file, [&] { read_csv(file.path()); }), "run3.csv: the file is empty");
  EXPECT_NE(message_of(file, [&] { read_csv(file.folder()); }).find("cannot read: Is a directory"), std::string::npos);
  EXPECT_EQ(complaint("# only\n\n"), "run3.csv: no header: the file holds no more than comments and blank lines");
  EXPECT_EQ(complaint(std::string("t\0,\0", 4)), "run3.csv: expected UTF-8 text, got UTF-16 or a binary file");
  EXPECT_EQ(complaint("\x1f\x8b\b"), "run3.csv: expected text, got a file that gzip has packed: unpack it (gunzip)");
  EXPECT_EQ(complaint("PK\x03\x04"), "run3.csv: expected text, got a workbook or an archive: export the table as CSV");
}

TEST(Fault, NoHeader) {
  EXPECT_EQ(complaint(rows(8)),
            "run3.csv:1: no header: expected the names of the columns, got numbers; put a line such as "
            "'t [s],F [N],y [m]' first, or say the columns by their numbers: columns = \"t=1,F=2 [N],y=3 [mm]\" "
            "(--columns)");
  EXPECT_EQ(complaint("# c\n0,1;2,5\n").substr(0, 22), "run3.csv:2: no header:");
}

TEST(Fault, CellsThatAreNoNumbers) {
  EXPECT_EQ(complaint(spoiled(9, "0.07,n/a,1")), "run3.csv:9: column 'F': expected a number, got 'n/a'" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,,1")), "run3.csv:9: column 'F': expected a number, got ''" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,1,nan")), "run3.csv:9: column 'y': expected a number, got 'nan'" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,1,-inf")), "run3.csv:9: column 'y': expected a number, got '-inf'" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,1e999,1")), "run3.csv:9: column 'F': expected a number, got '1e999'" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,1.5 N,1")), "run3.csv:9: column 'F': expected a number, got '1.5 N'" + mend);
}

TEST(Fault, ManySuchCellsAreCounted) {
  std::string text = "t,F,y [mm]\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(i) + ",1," + (i % 2 ? "NaN" : "0") + "\n";
  EXPECT_EQ(complaint(text),
            "run3.csv:3: column 'y [mm]': expected a number, got 'NaN'; 10 such cells, the first in lines 3, "
            "5, 7, 9" +
                mend);
}

TEST(Fault, DecimalCommas) {
  EXPECT_EQ(complaint("t,F,y\n0,00,1,5,2,5\n"),
            "run3.csv:2: expected 3 cells, got 6; the numbers seem to have decimal commas: export the file with "
            "decimal points, or with ; between the columns");
  EXPECT_EQ(
      complaint("t,F,y\n\"0,01\",\"1,5\",\"2,5\"\n"),
      "run3.csv:2: decimal comma in '0,01' between commas: export the file with decimal points, or with ; between "
      "the columns");
}

TEST(Fault, PointsAndCommasInOneFile) {
  EXPECT_EQ(
      complaint("t;F;y\n0.00;1;2\n0.01;1,5;2\n0.02;1;2\n"),
      "run3.csv:3: column 'F': decimal comma in '1,5', but a decimal point in '0.00', line 2: export the file with "
      "decimal points throughout");
  EXPECT_EQ(
      complaint("t;F;y\n0,00;1;2\n0,01;1.5;2\n0,02;1;2\n"),
      "run3.csv:3: column 'F': decimal point in '1.5', but a decimal comma in '0,00', line 2: export the file with "
      "decimal points throughout");
  for (const std::string cell : {"1.234,5", "1,234.5", "-1.234.567,5", "1,234,567"})
    EXPECT_EQ(complaint("t;F;y\n0,0;" + cell + ";2\n0,1;1;2\n0,2;1;2\n"),
              "run3.csv:2: column 'F': thousands separators in '" + cell + "': export the file without them");
  std::string text = "t;F;y\n";  // a thousand times more or less: no cell tells
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ";1,234;2\n";
  EXPECT_EQ(complaint(text),
            "run3.csv:2: the comma in '1,234' may stand before decimals or thousands, and no number of the file tells: "
            "export it with decimal points");
}

TEST(Fault, NumbersThatAreNoMeasurement) {
  EXPECT_EQ(
      complaint(spoiled(9, "0.07,1,-1e300")),
      "run3.csv:9: column 'y': '-1e300' is no measurement: beyond 1e60 powers and sums of it are no numbers" + mend);
  EXPECT_EQ(complaint(spoiled(9, "0.07,1,1e59")), "");
}

TEST(Fault, TimeThatIsText) {
  std::string text = "time;F;y\n";
  for (int i = 0; i < 8; ++i) text += "12:00:0" + std::to_string(i) + ";1;2\n";
  EXPECT_EQ(
      complaint(text).substr(62),
      "8 such cells, the first in lines 2, 3, 4, 5; where the rows are evenly spaced, give their rate in its place: "
      "rate = HZ (--rate HZ)");
  ReadOptions options;
  options.interval = 0.01;
  EXPECT_EQ(complaint(text, options), "");
}

TEST(Fault, RowsOfAnotherLength) {
  EXPECT_EQ(complaint(spoiled(5, "0.03,1")), "run3.csv:5: expected 3 cells, got 2" + no_row);
  EXPECT_EQ(complaint(spoiled(5, "0.03,1,2.5,4")), "run3.csv:5: expected 3 cells, got 4" + no_row);
}

TEST(Fault, Columns) {
  EXPECT_EQ(complaint("t,F,F\n" + rows(8)), "run3.csv:1: two columns of one name: columns 2 and 3 are both 'F'");
  EXPECT_EQ(complaint("t,y [mm],y [V]\n" + rows(8)),
            "run3.csv:1: two columns of one name: columns 2 and 3 are both 'y'");
  EXPECT_EQ(complaint("t,force,Load [N]\n" + rows(8)),
            "run3.csv:1: both 'force' and 'Load [N]' may be channel 'F': choose with columns, such as "
            "\"F=Load [N]\"");
  EXPECT_EQ(complaint("clock,F,y\n" + rows(8)),
            "run3.csv:1: no time column: expected a column named 't' or 'time', the file has 'clock', 'F', "
            "'y'; name it "
            "with columns, such as \"t=clock\", " +
                name_time);
  EXPECT_EQ(complaint("F,clock,y\n" + rows(8)).substr(97), "; name it with columns, such as \"t=clock\", " + name_time);
  EXPECT_EQ(
      complaint("F,y\n1,2\n3,4\n"),
      "run3.csv:1: no time column: expected a column named 't' or 'time', the file has 'F', 'y'; give the rows per "
      "second: rate = HZ (--rate HZ)");
  EXPECT_EQ(complaint("t;F,,y\n" + rows(8)).substr(0, 31), "run3.csv:2: expected 2 cells, g");
  EXPECT_EQ(complaint("t,,y\n" + rows(8)), "run3.csv:1: column 2 has no name");
  EXPECT_EQ(
      complaint("t y F\n0 1 2\n"),
      "run3.csv:1: expected columns separated by , ; tab or blanks, got one column 't y F'; where it is one alone give "
      "the rows per second: rate = HZ (--rate HZ); where lines before the table are no part of it, delete them or "
      "begin "
      "them with #");
  EXPECT_EQ(
      complaint("t,F,y\n" + rows(8), {parse_columns("y=y [mm];F=F"), false}),
      "run3.csv:1: no column 'y [mm];F=F' for channel 'y'; the file has 't', 'F', 'y'; commas separate one column "
      "from the next");
  EXPECT_NE(complaint("t,F,y\n0,1,\"1,234.5\"\n" + rows(8)).find("thousands separators in '1,234.5'"),
            std::string::npos);
  EXPECT_EQ(complaint("t,F,y\n" + rows(8), {parse_columns("y=dips"), false}),
            "run3.csv:1: no column 'dips' for channel 'y'; the file has 't', 'F', 'y'");
  EXPECT_EQ(complaint("t,load,disp\n" + rows(8), {parse_columns("y=dips"), false}),
            "run3.csv:1: no column 'dips' for channel 'y'; the file has 't', 'load', 'disp'; did you mean 'disp'?");
  EXPECT_EQ(complaint("t,F,y\n" + rows(8), {parse_columns("y=F,F=F"), false}),
            "run3.csv:1: column 'F' is asked for twice, as 'y' and 'F'");
}

TEST(Fault, Units) {
  const std::string text = complaint("t,F,y [furlong]\n" + rows(8));
  EXPECT_EQ(text.substr(0, 66), "run3.csv:1: column 'y [furlong]': unknown unit 'furlong'; known ar");
  EXPECT_NE(text.find(" mil "), std::string::npos);
  EXPECT_EQ(complaint("t,F,y [Inches]\n" + rows(8)),
            "run3.csv:1: column 'y [Inches]': unknown unit 'Inches', did you mean 'in'?");
  EXPECT_EQ(complaint("t [mm],F,y\n" + rows(8)),
            "run3.csv:1: column 't [mm]': 'mm' is no unit of channel 't', expected s, ms, us or min");
  EXPECT_EQ(complaint("t,F,y\n" + rows(8), {parse_columns("y=y [kN]"), false}),
            "run3.csv:1: column 'y': 'kN' is no unit of channel 'y', expected one of the kind of m, rad, V, C");
  EXPECT_EQ(
      complaint("t,F,y [kN]\n" + rows(8)),
      "run3.csv:1: column 'y [kN]': 'kN' is no unit of channel 'y', expected one of the kind of m, rad, V, C; say "
      "it with columns, such as \"y=y [m]\", or where it is another quantity give it another name, \"other=y\" "
      "(--columns)");
  EXPECT_EQ(
      complaint("t,F [nm],y [rad]\n" + rows(8)),
      "run3.csv:1: column 'F [nm]': 'nm' is no unit of channel 'F', expected one of the kind of N, N m, V, A, Pa, "
      "did you mean 'Nm'? Say it with columns, such as \"F=F [Nm]\", or where it is another quantity give it "
      "another name, \"other=F\" (--columns)");
  EXPECT_EQ(complaint("t,F,y [kN]\n" + rows(8), {parse_columns("other=y"), false}), "");
  // A set point and numbered coordinates are of the kind of their motion where they are asked for.
  EXPECT_EQ(
      complaint("t,F,y\n" + rows(8), {parse_columns("y_reference=F [N]"), false}),
      "run3.csv:1: column 'F': 'N' is no unit of channel 'y_reference', expected one of the kind of m, rad, V, C");
  EXPECT_NE(complaint("t,F,y\n" + rows(8), {parse_columns("y1=F [N]"), false}), "");
  EXPECT_EQ(complaint("t,F,y,a1 [A]\n0,1,2,3\n1,1,2,3\n2,1,2,3\n3,1,2,3\n4,1,2,3\n5,1,2,3\n"), "");
}

TEST(Fault, AUnitInOtherLettersOrInFullIsSuggested) {
  for (const auto& [unit, meant] : std::vector<std::pair<std::string, std::string>>{
           {"KN", "kN"}, {"Newton", "N"}, {"kp", "kgf"}, {"KN M", "kN m"}, {"lbs", "lbf"}, {"Pounds*Inch", "lbf*in"}})
    EXPECT_EQ(complaint("t,F [" + unit + "],y\n" + rows(8)),
              "run3.csv:1: column 'F [" + unit + "]': unknown unit '" + unit + "', did you mean '" + meant + "'?");
  for (const auto& [unit, meant] :
       std::vector<std::pair<std::string, std::string>>{{"MM", "mm"}, {"\"", "in"}, {"micron", "um"}})
    EXPECT_EQ(complaint("t,F,y [" + unit + "]\n" + rows(8)),
              "run3.csv:1: column 'y [" + unit + "]': unknown unit '" + unit + "', did you mean '" + meant + "'?");
  EXPECT_EQ(complaint("t,F,a [G]\n" + rows(8)), "run3.csv:1: column 'a [G]': unknown unit 'G', did you mean 'g'?");
  EXPECT_EQ(complaint("t [Sec],F,y\n" + rows(8)),
            "run3.csv:1: column 't [Sec]': unknown unit 'Sec', did you mean 'sec'?");
}

TEST(Fault, AMassWhereAForceIsMeant) {
  const std::string end = "', it holds a mass: as a force it is written ";
  EXPECT_EQ(complaint("t,load [lb],y\n" + rows(8)),
            "run3.csv:1: column 'load [lb]': 'lb' is no unit of channel 'F" + end + "lbf");
  EXPECT_EQ(complaint("t,load [oz in],y\n" + rows(8)),
            "run3.csv:1: column 'load [oz in]': 'oz in' is no unit of channel 'F" + end + "ozf in");
  EXPECT_EQ(complaint("t,F,y\n" + rows(8), {parse_columns("F=F [kg]"), false}),
            "run3.csv:1: column 'F': 'kg' is no unit of channel 'F" + end + "kgf");
  EXPECT_EQ(complaint("t,F2 [t],y1\n" + rows(8)),
            "run3.csv:1: column 'F2 [t]': 't' is no unit of channel 'F2" + end + "tf");
  EXPECT_EQ(complaint("t,F [ft lb],y [deg]\n" + rows(8)),
            "run3.csv:1: column 'F [ft lb]': 'ft lb' is no unit of channel 'F" + end + "ft lbf");
  EXPECT_EQ(complaint("t,F,y,m [lb],F1 [kg/s]\n0,1,2,3,4\n1,1,2,3,4\n2,1,2,3,4\n3,1,2,3,4\n4,1,2,3,4\n5,1,2,3,4\n"),
            "");
}

TEST(Fault, Rows) {
  EXPECT_EQ(complaint("t,F,y\n" + rows(5)), "run3.csv: expected at least 6 rows, got 5");
  EXPECT_EQ(complaint("t,F,y\n"), "run3.csv: expected at least 6 rows, got 0");
}

TEST(Fault, TimeThatRunsBackwardsOrStands) {
  EXPECT_EQ(complaint(spoiled(9, "0.03,1,1")),
            "run3.csv:9: time runs backwards: t = 0.03 s after t = 0.06 s" + mend_time);
  EXPECT_EQ(complaint(spoiled(9, "0.06,1,1")), "run3.csv:9: time is repeated: t = 0.06 s after t = 0.06 s" + mend_time);
  EXPECT_EQ(complaint("t,F,y\n1,1,1\n1,1,1\n1,1,1\n1,1,1\n1,1,1\n1,1,1\n1,1,1\n"),
            "run3.csv:3: time is repeated: t = 1 s after t = 1 s" + mend_time);
}

TEST(Fault, AWindowOutsideTheRecord) {
  const TextFile file("t,F,y\n" + rows(20));
  const Record record = read_csv(file.path());
  EXPECT_EQ(message_of(file, [&] { record.window(0.1, 0.14); }),
            "run3.csv: window 0.1 to 0.14 s: expected at least 6 rows, the record has t = 0 to 0.19 s in "
            "steps of 0.01 s");
  EXPECT_NE(message_of(file, [&] { record.window(3, 2); }), "");
  EXPECT_EQ(message_of(file, [&] { record["z"]; }), "run3.csv: no channel 'z': the record has F, y, v, a");
  EXPECT_EQ(message_of(file, [&] { record.slice(15, 6); }),
            "run3.csv: slice: rows 16 to 21 are outside the record, which has 20 rows");
}

}  // namespace
}  // namespace lunid
