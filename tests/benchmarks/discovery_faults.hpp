#pragma once
// The part of the matrix whose physics is known and whose sensors or input are at fault (tests/truth/faults.hpp).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "truth/faults.hpp"

namespace faults {

struct FaultTally {
  int all = 0;
  int right = 0;    ///< the fault itself named first, or in the class of what was
  int physics = 0;  ///< physics named first, without a word of the fault
};

/// One run; prints its line.
inline void run_one(const std::string& lunid, const std::string& out, const truth::Fault& fault,
                    const truth::Scale& scale, double noise_db, int rows, FaultTally& tally) {
  truth::RecordOptions options;
  options.rows = rows;
  options.noise_db = noise_db;
  options.seed = static_cast<std::uint64_t>(noise_db) + 7;
  const truth::FaultyRecords records = truth::make_faulty(fault, scale, options);
  const std::string dir = out + "/" + fault.name + "-" + scale.name + "-" + std::to_string(static_cast<int>(noise_db));
  std::filesystem::create_directories(dir);
  truth::write_csv(records.train, dir + "/train.csv");
  truth::write_csv(records.test, dir + "/test.csv");
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", scale.mass);
  const std::string command = "'" + lunid + "' discover '" + dir + "/train.csv' --test '" + dir + "/test.csv' --mass " +
                              mass + " --restoring '" + records.baseline + "' --out '" + dir + "/out' > '" + dir +
                              "/log' 2>&1";
  ++tally.all;
  std::string said = "failed", verdict = "failed";
  bool right = false, physics = false;
  if (std::system(command.c_str()) == 0) {
    std::ifstream file(dir + "/out/discovery.json");
    const auto found = nlohmann::json::parse(file, nullptr, false);
    verdict = found.value("verdict", "none");
    said.clear();
    for (const auto& effect : found.value("effects", nlohmann::json::array())) {
      std::vector<std::string> names = effect.value("indistinguishable", std::vector<std::string>{});
      names.insert(names.begin(), effect.value("name", ""));
      for (const auto& name : names) right = right || name == fault.effect;
      physics = physics || (said.empty() && effect.value("is", "physics") == "physics");
      for (const auto& name : names) said += (said.empty() ? "" : name == names[0] ? " + " : " ~ ") + name;
    }
  }
  physics = physics && !right;
  tally.right += right;
  tally.physics += physics;
  std::printf("%-26s %-6s %2.0f dB  %-16s %-5s %s\n", ("fault " + fault.name).c_str(), scale.name.c_str(), noise_db,
              verdict.c_str(),
              right     ? "yes"
              : physics ? "NO"
                        : "no",
              said.empty() ? "-" : said.c_str());
  std::fflush(stdout);
}

/// Every fault at every scale, each scale at one level of noise in turn; `full`: at 40, 30 and 20 dB.
inline FaultTally run_all(const std::string& lunid, const std::string& out, bool full, int rows,
                          const std::string& only) {
  const double levels[] = {40, 30, 20};
  FaultTally tally;
  int index = 0;
  for (const truth::Fault& fault : truth::faults()) {
    ++index;
    if (("fault " + fault.name).find(only) == std::string::npos) continue;
    for (int scale = 0; scale < 3; ++scale)
      for (int level = 0; level < 3; ++level)
        if (full || level == (index + scale) % 3)
          run_one(lunid, out, fault, truth::scales()[static_cast<std::size_t>(scale)], levels[level], rows, tally);
  }
  return tally;
}

}  // namespace faults
