// The matrix of hidden effects: records of tests/truth, `lunid discover` as a process, its discovery.json
// against the truth. One line per run; the last line is the contract
//   named A/B nulls-false C/D pairs E/F outside G/H sensors I/J
//
//   lunid_discovery_matrix LUNID OUT_DIR [--full | --short] [--check] [--only WORD]
// By default every case at every scale, each scale at one level of noise, in turn; --full: at 40, 30 and 20
// dB; --short: one run each of a few cases. --only: cases whose name holds WORD. --check: exit 1 unless all
// is as it should be.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "truth/truth.hpp"

namespace {

using nlohmann::json;

struct Setting {
  const truth::Case* which;
  const truth::Scale* scale;
  double noise_db;
};

struct Outcome {
  std::string verdict = "failed", named;
  bool right = false, tie = false;
  int parameters = 0, inside = 0;
  double worst = 0;  // error of the worst parameter in its stated standard deviations
  double before = NAN, after = NAN, floor = NAN, seconds = 0;
};

double number(const json& object, const char* field) {
  return object.contains(field) && object[field].is_number() ? object[field].get<double>() : NAN;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs `lunid discover` on the records of a setting; an empty value when it failed.
json discover(const std::string& lunid, const Setting& setting, const std::string& dir, double& seconds) {
  std::filesystem::create_directories(dir);
  truth::RecordOptions options;
  options.noise_db = setting.noise_db;
  options.seed = static_cast<std::uint64_t>(setting.noise_db) + 100 * (setting.scale - truth::scales().data());
  const truth::Records records = truth::make_records(*setting.which, *setting.scale, options);
  truth::write_csv(records.train, dir + "/train.csv");
  truth::write_csv(records.test, dir + "/test.csv");
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", setting.scale->mass);
  const std::string command = "'" + lunid + "' discover '" + dir + "/train.csv' --test '" + dir + "/test.csv' --mass " +
                              mass + " --restoring '" + setting.which->baseline + "' --out '" + dir + "/out' > '" +
                              dir + "/log' 2>&1";
  const auto start = std::chrono::steady_clock::now();
  const int status = std::system(command.c_str());
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (status != 0) {
    std::fprintf(stderr, "%s\n%s", command.c_str(), read_text(dir + "/log").c_str());
    return {};
  }
  return json::parse(read_text(dir + "/out/discovery.json"), nullptr, false);
}

void compare_parameters(const Setting& setting, const json& effects, Outcome& outcome) {
  for (const truth::TrueParameter& truth : setting.which->parameters) {
    for (const json& effect : effects) {
      if (effect.value("name", "") != truth.effect || !effect["parameters"].contains(truth.name)) continue;
      const json& found = effect["parameters"][truth.name];
      const double wanted = truth.in(*setting.scale), off = number(found, "value") - wanted;
      // No deviation is stated for a parameter at its bound: it must then be the truth.
      const double std = number(found, "std");
      const double error = std > 0 ? off / std : std::abs(off) <= 1e-6 * std::abs(wanted) ? 0 : INFINITY;
      ++outcome.parameters;
      outcome.inside += std::abs(error) <= 1.96;
      if (!(std::abs(error) <= std::abs(outcome.worst))) outcome.worst = error;
    }
  }
}

Outcome judge(const Setting& setting, const json& result) {
  Outcome outcome;
  if (!result.is_object()) return outcome;
  outcome.verdict = result.value("verdict", "none");
  const json effects = result.value("effects", json::array());
  std::multiset<std::string> names, class_names;
  for (const json& effect : effects) {
    names.insert(effect.value("name", ""));
    class_names.insert(effect.value("name", ""));
    for (const json& other : effect.value("indistinguishable", json::array())) class_names.insert(other);
    outcome.named += (outcome.named.empty() ? "" : "+") + effect.value("name", "");
  }
  const std::multiset<std::string> wanted(setting.which->effects.begin(), setting.which->effects.end());
  switch (setting.which->kind) {
    case truth::Kind::null: outcome.right = outcome.verdict == "nothing-missing"; break;
    case truth::Kind::outside: outcome.right = outcome.verdict == "unknown-effect"; break;
    default:
      outcome.right = names == wanted;
      outcome.tie = !outcome.right && effects.size() == wanted.size() &&
                    std::includes(class_names.begin(), class_names.end(), wanted.begin(), wanted.end());
  }
  compare_parameters(setting, effects, outcome);
  outcome.before = number(result.value("baseline", json::object()), "gap_test");
  outcome.after = number(result.value("final", json::object()), "gap_test");
  outcome.floor = number(result.value("noise_floor", json::object()), "gap_test");
  return outcome;
}

void print_head() {
  std::printf("%-20s %-6s %5s  %-16s %-5s %-34s %12s  %8s %8s %8s  %6s\n", "effect", "scale", "noise", "verdict",
              "right", "named", "parameters", "before", "after", "floor", "time");
}

void print_row(const Setting& setting, const Outcome& outcome) {
  char parameters[40] = "-";
  if (outcome.parameters > 0) {
    std::snprintf(parameters, sizeof parameters, "%d/%d %+.1f sd", outcome.inside, outcome.parameters, outcome.worst);
  }
  std::printf("%-20s %-6s %2.0f dB  %-16s %-5s %-34s %12s  %8.4f %8.4f %8.4f  %4.1f s\n", setting.which->name.c_str(),
              setting.scale->name.c_str(), setting.noise_db, outcome.verdict.c_str(),
              outcome.right ? "yes"
              : outcome.tie ? "tie"
                            : "NO",
              outcome.named.empty() ? "-" : outcome.named.c_str(), parameters, outcome.before, outcome.after,
              outcome.floor, outcome.seconds);
  std::fflush(stdout);
}

std::vector<Setting> settings(bool full, bool brief, const std::string& only) {
  const double levels[] = {40, 30, 20};
  std::vector<Setting> list;
  const auto& scales = truth::scales();
  int index = 0;
  for (const truth::Case& each : truth::cases()) {
    ++index;
    if (each.name.find(only) == std::string::npos) continue;
    for (int scale = 0; scale < 3; ++scale) {
      for (int level = 0; level < 3; ++level) {
        if (full || level == (index + scale) % 3) list.push_back({&each, &scales[scale], levels[level]});
      }
    }
  }
  if (brief) {
    list.clear();
    const auto add = [&](const char* name, int scale, double db) {
      list.push_back({&truth::case_named(name), &scales[scale], db});
    };
    add("cubic_hardening", 0, 30);
    add("bouc_wen", 2, 40);
    add("coulomb_friction", 1, 40);
    add("one_sided_stop", 2, 30);
    add("null_linear", 2, 20);
    add("null_duffing", 1, 30);
    add("coulomb+constant", 0, 40);
    add("outside_v2y", 1, 40);
  }
  return list;
}

/// Right and all of each kind.
struct Tally {
  int right[4] = {}, all[4] = {};
  int parameters = 0, inside = 0, closed = 0, closable = 0, wild = 0;
  double longest = 0;

  void add(const Setting& setting, const Outcome& outcome) {
    const int kind = static_cast<int>(setting.which->kind);
    ++all[kind];
    right[kind] += outcome.right;
    longest = std::max(longest, outcome.seconds);
    if (!outcome.right || setting.which->effects.empty()) return;
    parameters += outcome.parameters;
    inside += outcome.inside;
    ++closable;
    closed += outcome.after <= 1.3 * outcome.floor;
    wild += !(std::abs(outcome.worst) < 4);  // of a few parameters, one beyond 4 sd means a wrong interval
  }
  bool clean() const {
    for (int kind = 0; kind < 4; ++kind) {
      if (right[kind] != all[kind]) return false;
    }
    return closed == closable && wild == 0;
  }
  void print() const {
    using truth::Kind;
    const auto at = [](Kind kind) { return static_cast<int>(kind); };
    std::printf(
        "where named right: parameters within their 95 %% interval %d/%d, test gap within 1.3 floors %d/%d; "
        "longest run %.1f s\n",
        inside, parameters, closed, closable, longest);
    std::printf("named %d/%d nulls-false %d/%d pairs %d/%d outside %d/%d sensors 0/0\n", right[at(Kind::effect)],
                all[at(Kind::effect)], all[at(Kind::null)] - right[at(Kind::null)], all[at(Kind::null)],
                right[at(Kind::pair)], all[at(Kind::pair)], right[at(Kind::outside)], all[at(Kind::outside)]);
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: lunid_discovery_matrix LUNID OUT_DIR [--full | --short] [--check] [--only WORD]\n");
    return 2;
  }
  bool full = false, brief = false, check = false;
  std::string only;
  for (int i = 3; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--full")
      full = true;
    else if (option == "--short")
      brief = true;
    else if (option == "--check")
      check = true;
    else if (option == "--only" && i + 1 < argc)
      only = argv[++i];
    else {
      std::fprintf(stderr, "lunid_discovery_matrix: unknown option '%s'\n", argv[i]);
      return 2;
    }
  }
  Tally tally;
  print_head();
  for (const Setting& setting : settings(full, brief, only)) {
    const std::string dir = std::string(argv[2]) + "/" + setting.which->name + "-" + setting.scale->name + "-" +
                            std::to_string(static_cast<int>(setting.noise_db));
    double seconds = 0;
    const json result = discover(argv[1], setting, dir, seconds);
    Outcome outcome = judge(setting, result);
    outcome.seconds = seconds;
    tally.add(setting, outcome);
    print_row(setting, outcome);
  }
  tally.print();
  return check && !tally.clean() ? 1 : 0;
}
