// What a CSV file may look like, and what becomes of it.
#include <gtest/gtest.h>

#include <numbers>

#include "record_file.hpp"

namespace lunid {
namespace {

using test::rows;
using test::TextFile;

Record read(const std::string& text, const ReadOptions& options = {}) {
  const TextFile file(text);
  return read_csv(file.path(), options);
}

TEST(Csv, ReadsDefaultColumnsAndDerivesTheMotion) {
  const Record record = read("t,F,y\n" + rows(20));
  EXPECT_EQ(record.rows(), 20);
  EXPECT_EQ(record.dt(), 0.01);
  EXPECT_EQ(record.start(), 0);
  EXPECT_EQ(record["F"][5], 2);
  EXPECT_EQ(record["y"][3], 0.001);
  EXPECT_TRUE(record.channel("v").derived);
  EXPECT_TRUE(record.channel("a").derived);
  EXPECT_EQ(record.channel("v").unit, "m/s");
  EXPECT_TRUE(record.warnings().empty());
}

TEST(Csv, ConvertsUnitsOfEveryHeaderForm) {
  const Record record = read(
      "time/ms,\"Load (kN)\",disp [mm],A (g),y_reference [in],temperature\n"
      "0,1,2,3,4,20\n1,1,2,3,4,21\n2,1,2,3,4,22\n3,1,2,3,4,20\n4,1,2,3,4,20\n5,-1,-2,-3,-4,20\n");
  EXPECT_DOUBLE_EQ(record.dt(), 1e-3);
  EXPECT_DOUBLE_EQ(record["F"][0], 1000);
  EXPECT_DOUBLE_EQ(record["y"][5], -2e-3);
  EXPECT_DOUBLE_EQ(record["a"][0], 3 * 9.80665);
  EXPECT_DOUBLE_EQ(record["y_reference"][0], 4 * 0.0254);
  EXPECT_EQ(record["temperature"][1], 21);
  EXPECT_EQ(record.channel("F").source, "Load (kN)");
  EXPECT_EQ(record.channel("F").source_unit, "kN");
  EXPECT_EQ(record.channel("F").unit, "N");
  EXPECT_EQ(record.channel("a").unit, "m/s^2");
  EXPECT_FALSE(record.channel("a").derived);
}

TEST(Csv, ChargesAndVoltagesAreColumnsAsMotionsAndForces) {
  const Record record = read("t,charge,source\n0,1,2\n1,1,2\n2,1,2\n3,1,2\n4,1,2\n5,-1,-2\n",
                             {parse_columns("t=t [us],y=charge [nC],F=source [mV]"), false});
  EXPECT_DOUBLE_EQ(record.dt(), 1e-6);
  EXPECT_DOUBLE_EQ(record["y"][5], -1e-9);
  EXPECT_EQ(record.channel("y").unit, "C");
  EXPECT_EQ(record.channel("F").unit, "V");
}

TEST(Csv, UnderscoreIsPartOfTheName) {
  const Record record = read("t,F,y,disp_mm\n0,1,2,3\n1,1,2,3\n2,1,2,3\n3,1,2,3\n4,1,2,3\n5,1,2,3\n");
  EXPECT_EQ(record["disp_mm"][0], 3);
}

TEST(Csv, AcceptsSeparatorsMarksCommentsAndLineEndings) {
  for (const char separator : {',', ';', '\t'}) {
    for (const std::string ending : {"\n", "\r\n", "\r"}) {
      std::string text = "\xef\xbb\xbf# a comment, with; separators" + ending + ending + "t,F,y" + ending;
      for (int i = 0; i < 8; ++i) {
        text += std::to_string(i) + ", +1.5 ,\"-2e-1\"" + ending;
        if (i == 3) text += "# half-way" + ending;
      }
      text += ending + "  " + ending;
      for (std::size_t at = text.find("t,"); at < text.size(); ++at)
        if (text[at] == ',') text[at] = separator;
      const Record record = read(text);
      ASSERT_EQ(record.rows(), 8) << separator;
      EXPECT_EQ(record["F"][7], 1.5);
      EXPECT_EQ(record["y"][0], -0.2);
    }
  }
}

TEST(Csv, AcceptsASeparatorAtTheEndOfEachLine) {
  const Record record = read("t,F,y,\n0,1,2,\n1,1,2,\n2,1,2,\n3,1,2,\n4,1,2,\n5,1,2,\n");
  EXPECT_EQ(record.rows(), 6);
  EXPECT_EQ(record["y"][5], 2);
}

TEST(Csv, MapsColumnsByName) {
  ReadOptions options;
  options.columns = parse_columns("t=clock,y=laser [mm], F=cell 2 (kN)");
  std::string text = "clock,laser,cell 2,y\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",5,7,9\n";
  const Record record = read(text, options);
  EXPECT_DOUBLE_EQ(record["y"][0], 5e-3);
  EXPECT_DOUBLE_EQ(record["F"][0], 7e3);
  EXPECT_DOUBLE_EQ(record["column y"][0], 9);  // the file's own y must not pass for the channel
}

TEST(Csv, ANumberInPlaceOfAHeaderIsAConstantChannel) {
  const TextFile file("t,y [rad],2\n" + rows(8));
  const auto with = [&](const std::string& columns) {
    ReadOptions options;
    options.columns = parse_columns(columns);
    return read_record(file.path(), options);
  };
  const Record free = with("F=0");
  ASSERT_TRUE(free.has("F"));
  EXPECT_EQ(free["F"][0], 0);
  EXPECT_EQ(free["F"][7], 0);
  EXPECT_EQ(free.channel("F").unit, "N m");  // beside an angle
  EXPECT_DOUBLE_EQ(with("F=1.5 [kN m]")["F"][3], 1500);
  EXPECT_EQ(with("F=2")["F"][3], with("v=2")["v"][3]);  // a column of that name goes before
  EXPECT_NE(with("F=2")["F"][3], 2);
  const TextFile driven("t,y [rad],F,ab\n0,1,2,3\n1,1,2,3\n2,1,2,3\n3,1,2,3\n4,1,2,3\n5,1,2,3\n",
                        "driven.csv");  // goes before the file's
  const Record still = read_record(driven.path(), {parse_columns("F=0 [N m], ab=0"), false});
  EXPECT_EQ(still["F"][3], 0);
  EXPECT_EQ(still["ab"][3], 0);
  EXPECT_EQ(still.warnings().front(), "left out: the column 'F', because F=0 is given");
  const TextFile idle("t,y,load [mV],force [%]\n0,1,2,3\n1,1,2,3\n2,1,2,3\n3,1,2,3\n4,1,2,3\n5,1,2,3\n", "idle.csv");
  const Record beside = read_record(idle.path(), {parse_columns("F=0"), false});  // which of both need not be said
  EXPECT_EQ(beside["F"][3], 0);
  EXPECT_EQ(beside["load"][3], 2e-3);
  EXPECT_EQ(test::message_of(file, [&] { with("F=3"); }),
            "run3.csv: no column '3' for channel 'F': a column is named by its header; a channel that is the same in "
            "every row has its unit beside the number, as F=3 [N]");
  EXPECT_THROW(with("F=0 [mm]"), InputError);
  EXPECT_THROW(with("t=0"), InputError);  // no time stands still
}

TEST(Csv, HeaderOfAMapMayBeTheWholeCell) {
  ReadOptions options;
  options.columns = {{"y", "laser [mm]", ""}};
  std::string text = "t,laser [mm]\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",5\n";
  EXPECT_DOUBLE_EQ(read(text, options)["y"][0], 5e-3);
}

TEST(Csv, TheOwnNameIsStrongerThanALikeness) {
  std::string text = "t,v,V [V],x,y\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",1,2,3,4\n";
  const Record record = read(text);
  EXPECT_EQ(record["v"][0], 1);
  EXPECT_EQ(record["V"][0], 2);
  EXPECT_EQ(record["x"][0], 3);
  EXPECT_EQ(record["y"][0], 4);
}

TEST(Csv, AGermanLoggersHeadersAreKnown) {
  std::string text = "Messung 3\nZeit [s];Kraft [kN];Weg [mm];Beschleunigung [m/s^2]\n";
  for (int i = 0; i < 8; ++i) text += "0,0" + std::to_string(i) + ";0,5;-2,5;7\n";
  const Record record = read(text);
  EXPECT_DOUBLE_EQ(record["F"][0], 500);
  EXPECT_DOUBLE_EQ(record["y"][0], -2.5e-3);
  EXPECT_FALSE(record.channel("a").derived);
  EXPECT_DOUBLE_EQ(record.dt(), 0.01);
}

TEST(Csv, AnAngleBesideATorqueIsTheMotion) {
  const auto with = [](std::string header) {
    for (int i = 0; i < 8; ++i) header += std::to_string(i) + ",180,3\n";
    return read(header);
  };
  const Record turning = with("t,Angle [deg],torque\n");
  EXPECT_DOUBLE_EQ(turning["y"][0], std::numbers::pi);
  EXPECT_EQ(turning.channel("y").unit, "rad");
  EXPECT_EQ(turning.channel("F").unit, "N m");
  EXPECT_EQ(turning["F"][0], 3);
  EXPECT_EQ(with("t,angle,torque\n").channel("y").unit, "rad");
  EXPECT_EQ(with("t,v [rad/s],torque\n").channel("F").unit, "N m") << "a speed in rad/s tells of it too";
  EXPECT_EQ(with("t,angle,acc [rad/s^2]\n").channel("y").unit, "rad");
  EXPECT_FALSE(with("t,y [mm],torque\n").has("F")) << "a torque beside what moves in a line may be of anything";
  const Record shaft = with("t,angle,y\n");  // of a shaft, beside what moves
  EXPECT_EQ(shaft["angle"][0], 180);
  EXPECT_EQ(shaft["y"][0], 3);
}

TEST(Csv, AnAngleBesideNothingButTheTimeIsThatOfWhatSwingsFreely) {
  std::string text = "time [s],angle [deg]\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",180\n";
  EXPECT_DOUBLE_EQ(read(text)["y"][0], std::numbers::pi);
}

TEST(Csv, AVoltageIsNoVelocity) {
  std::string text = "t,V [mV],X\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",2,3\n";
  const Record record = read(text);
  EXPECT_DOUBLE_EQ(record["V"][0], 2e-3);
  EXPECT_TRUE(record.channel("v").derived);
  EXPECT_EQ(record["y"][0], 3);
}

TEST(Csv, AnExtraColumnThatIsNoNumberIsLeftOut) {
  std::string text = "t,y,status\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",1,ok\n";
  const Record record = read(text);
  EXPECT_FALSE(record.has("status"));
  ASSERT_EQ(record.warnings().size(), 1u);
  EXPECT_EQ(record.warnings()[0],
            "left out: line 2: column 'status': expected a number, got 'ok'; 8 such cells, the first in "
            "lines 2, 3, 4, 5");
}

TEST(Csv, AnUnknownUnitOfAnExtraColumnIsKept) {
  std::string text = "t,y,temperature [degC]\n";
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",1,21\n";
  const Record record = read(text);
  EXPECT_EQ(record["temperature"][0], 21);
  EXPECT_EQ(record.channel("temperature").unit, "degC");
  ASSERT_EQ(record.warnings().size(), 1u);
}

TEST(Columns, AreReadFromText) {
  const auto maps = parse_columns("t=time,y=disp [mm],F=load (kN), y_reference=ref");
  ASSERT_EQ(maps.size(), 4u);
  EXPECT_EQ(maps[0].channel, "t");
  EXPECT_EQ(maps[0].unit, "");
  EXPECT_EQ(maps[1].header, "disp");
  EXPECT_EQ(maps[1].unit, "mm");
  EXPECT_EQ(maps[2].channel, "F");
  EXPECT_EQ(maps[2].unit, "kN");
  EXPECT_EQ(maps[3].channel, "y_reference");
  EXPECT_EQ(parse_column("displacement", "y [mm]").channel, "y");
}

TEST(Columns, FaultsAreFaultsOfUsage) {
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"t=time,disp", "columns: expected channel=header, such as \"t=time,y=disp [mm]\", got 'disp'"},
           {"", "columns: expected channel=header, such as \"t=time,y=disp [mm]\", got ''"},
           {"y=a,y=b", "columns: channel 'y' is given twice"}}) {
    try {
      parse_columns(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault(), Fault::usage);
      EXPECT_EQ(std::string(error.what()), message);
    }
  }
}

TEST(Units, AreConvertedToSi) {
  EXPECT_EQ(si_unit("mm")->factor, 1e-3);
  EXPECT_EQ(si_unit("\u00b5m")->factor, 1e-6);
  EXPECT_EQ(si_unit("\u03bcm")->unit, "m");
  EXPECT_EQ(si_unit("in")->factor, 0.0254);                // exact by definition (1959)
  EXPECT_EQ(si_unit("lbf")->factor, 4.4482216152605);      // exact: 0.45359237 kg times 9.80665 m/s^2
  EXPECT_EQ(si_unit("lb")->factor, 0.45359237);            // the same
  EXPECT_NEAR(si_unit("slug")->factor, 14.5939029, 1e-7);  // lbf s^2/ft
  EXPECT_EQ(si_unit("g")->factor, 9.80665);
  EXPECT_EQ(si_unit("g")->unit, "m/s^2");
  EXPECT_EQ(si_unit("N*m")->unit, "N m");
  EXPECT_EQ(si_unit("ft lbf")->unit, "N m");  // as F of a shaft has it, in either order
  EXPECT_EQ(si_unit("min")->factor, 60);
  EXPECT_FALSE(si_unit("furlong"));
  EXPECT_FALSE(si_unit(""));
}

TEST(Units, PrefixesProductsAndQuotientsOfTheTablesNames) {
  const struct {
    const char* unit;
    double factor;
    const char* si;
  } known[] = {{"um/s^2", 1e-6, "m/s^2"},
               {"\u00b5m/s", 1e-6, "m/s"},
               {"mm/s\u00b2", 1e-3, "m/s^2"},
               {"mm/s/s", 1e-3, "m/s^2"},
               {"mm s^-2", 1e-3, "m/s^2"},
               {"ms^-2", 1, "m/s^2"},
               {"ft/s2", 0.3048, "m/s^2"},
               {"mg", 9.80665e-3, "m/s^2"},
               {"nm", 1e-9, "m"},
               {"kN/mm", 1e6, "N/m"},
               {"kNm", 1e3, "N m"},
               {"kN\u00b7m", 1e3, "N m"},
               {"N*s/m", 1, "N s/m"},
               {"mrad/s", 1e-3, "rad/s"},
               {"mm^2", 1e-6, "m^2"},
               {"kHz", 1e3, "Hz"},
               {"1/s", 1, "1/s"},
               {"uV", 1e-6, "V"},
               {"mH", 1e-3, "V s/A"},
               {"lbf*ft", 1.3558179483314004, "N m"},
               {"N.m", 1, "N m"},
               {"m.s-2", 1, "m/s^2"},
               {"cN m", 1e-2, "N m"},
               {"Ncm", 1e-2, "N m"},
               {"daN", 10, "N"},
               {"mGal", 1e-5, "m/s^2"},
               {"psi", 6894.757293168361, "Pa"},  // lbf/in^2
               {"mmHg", 133.322387415, "Pa"},     // by definition
               {"ozf in", 0.007061551814226044, "N m"}};
  for (const auto& k : known) {
    const auto si = si_unit(k.unit);
    ASSERT_TRUE(si) << k.unit;
    EXPECT_NEAR(si->factor / k.factor, 1, 1e-15) << k.unit;
    EXPECT_EQ(si->unit, k.si) << k.unit;
  }
  for (const char* unknown : {"mmm", "Mdeg", "m//s", "/s", "m/", "furlong/s", "kkg", "m^", "2", "s-"})
    EXPECT_FALSE(si_unit(unknown)) << unknown;
}

}  // namespace
}  // namespace lunid
