// The matrix of hidden effects: records of tests/truth, `lunid discover` as a process, its discovery.json
// against the truth. One line per run; the last line is the contract
//   named A/B nulls-false C/D pairs E/F outside G/H sensors I/J
//
//   lunid_discovery_matrix LUNID OUT_DIR [--full | --draw N | --short | --nulls N] [--rows N] [--seed N] [--check]
//                          [--only WORD]
// By default every case once: scales, excitations and levels of noise in turn. --full: at every scale, under every
// excitation, at 60, 40, 30 and 20 dB. --draw: N of the settings of --full, drawn at random. --short: one run each of
// a few cases. --nulls: N records in which nothing is missing, of each kind in turn. --rows: of a record (6400).
// --seed: of all that is random. --only: settings whose name (CASE-SCALE-EXCITATION-DB, the folder of its records)
// holds WORD: `--full --only -40` is all at 40 dB. --check: exit 1 unless all is as it should be.
//
// A name other than the truth's counts as its equivalent where its own best fit to the noise-free record differs from
// that record by less than the noise. That is asked here of fits to other data than the answer was given on, for the
// answer and for the confusers that the entry declares; the class is never taken from the answer.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "discovery_faults.hpp"
#include "truth/truth.hpp"

namespace {

using nlohmann::json;

struct Setting {
  const truth::Case* which;
  const truth::Scale* scale;
  double noise_db;
  truth::RecordOptions options;
  std::string kind;  ///< of a null, beside its case
  bool mass_known = true;
};

struct Outcome {
  std::string verdict = "failed", named;
  bool right = false, tie = false, equivalent = false;
  double share = NAN;  // rms of the hidden force over that of the restoring force
  int class_size = 0;
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

/// The baseline as arguments; one with a Bouc-Wen element is a file.
std::string baseline_arguments(const Setting& setting, const std::string& dir) {
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", setting.scale->mass);
  const std::string& text = setting.which->baseline;
  if (text.find("bouc_wen") == std::string::npos)
    return "--mass " + std::string(setting.mass_known ? mass : "m") + " --restoring '" + text + "'";
  std::ofstream file(dir + "/baseline.lua");
  file << "local lunid = require 'lunid'\nlocal y, v = lunid.displacement, lunid.velocity\n"
       << "local k, c = lunid.parameter { 'k', min = 0 }, lunid.parameter { 'c', min = 0 }\n";
  const double length = setting.scale->length, force = setting.scale->force();
  char line[300];
  std::snprintf(line, sizeof line,
                "local loop = lunid.effects.bouc_wen { k = lunid.parameter { 'kz', %.9g, min = 0 }, zy = "
                "lunid.parameter { 'zy', %.9g, min = 0 }, rho = 0.7, n = 1 }\n",
                0.4 * force / length, 1.2 * length);
  file << line << "return lunid.model { mass = " << mass << ", restoring = k*y + c*v + loop }\n";
  return "--baseline '" + dir + "/baseline.lua'";
}

/// Runs `lunid discover` on records that lie in `dir`; an empty value when it failed.
json discover(const std::string& lunid, const Setting& setting, const std::string& dir, const std::string& train) {
  const std::string command = "'" + lunid + "' discover " + train + " --test '" + dir + "/test.csv' " +
                              baseline_arguments(setting, dir) + " --out '" + dir + "/out' > '" + dir + "/log' 2>&1";
  if (std::system(command.c_str()) != 0) {
    std::fprintf(stderr, "%s\n%s", command.c_str(), read_text(dir + "/log").c_str());
    return {};
  }
  return json::parse(read_text(dir + "/out/discovery.json"), nullptr, false);
}

/// Writes the records of a setting, as measured and as they would be without noise; the training files.
std::string write_records(const Setting& setting, const std::string& dir, Outcome& outcome) {
  std::filesystem::create_directories(dir);
  const truth::Records records = truth::make_records(*setting.which, *setting.scale, setting.options);
  truth::write_csv(records.train, dir + "/train.csv");
  truth::write_csv(records.test, dir + "/test.csv");
  outcome.share = records.train.hidden_share;
  std::string list = "'" + dir + "/train.csv'";
  for (std::size_t i = 0; i < records.more.size(); ++i) {
    const std::string name = dir + "/train" + std::to_string(i + 2) + ".csv";
    truth::write_csv(records.more[i], name);
    list += " '" + name + "'";
  }
  truth::Columns clean = records.train;
  clean.y = clean.clean_y;
  clean.F = clean.clean_F;
  truth::write_csv(clean, dir + "/clean.csv");
  return list;
}

/// The gap that an entry's best fit leaves on the noise-free training record.
double fitted_gap(const std::string& lunid, const Setting& setting, const std::string& dir, const std::string& entry) {
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", setting.scale->mass);
  std::ofstream(dir + "/class.lua")
      << "local lunid = require 'lunid'\nlocal y, v = lunid.displacement, lunid.velocity\n"
      << "local k, c = lunid.parameter 'k', lunid.parameter 'c'\nlocal record = lunid.read '" << dir << "/clean.csv'\n"
      << "lunid.discover { model = lunid.model { mass = " << mass << ", restoring = " << setting.which->baseline
      << " }, train = record, test = record, catalogue = { '" << entry << "' }, max_effects = 1, out = '.' }\n";
  const std::string command =
      "'" + lunid + "' run '" + dir + "/class.lua' --out '" + dir + "/class' > '" + dir + "/class.log' 2>&1";
  if (std::system(command.c_str()) != 0) return NAN;
  const json found = json::parse(read_text(dir + "/class/discovery.json"), nullptr, false);
  if (!found.is_object()) return NAN;
  double gap = number(found.value("final", json::object()), "gap_train");
  for (const json& rival : found.value("rivals", json::array()))
    if (rival.value("name", "") == entry) gap = std::fmin(gap, number(rival, "gap"));
  return gap;
}

/// The entry's confusers, from its help.
std::vector<std::string> confusers_of(const std::string& lunid, const std::string& entry, const std::string& dir) {
  const std::string file = dir + "/confusers";
  const std::string study = dir + "/confusers.lua";
  std::ofstream(study) << "local lunid = require 'lunid'\nfor _, name in ipairs(lunid.effects." << entry
                       << ".confusers) do print(name) end\n";
  if (std::system(("'" + lunid + "' run '" + study + "' --out '" + dir + "/confusers_out' > '" + file + "'").c_str()))
    return {};
  std::ifstream lines(file);
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() && line.find(' ') == std::string::npos) names.push_back(line);
  return names;
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

/// Whether what was named instead of the one true effect is its equivalent on this record, and how many there are.
void compare_fits(const std::string& lunid, const Setting& setting, const json& result, const std::string& dir,
                  bool whole_class, Outcome& outcome) {
  if (setting.which->kind != truth::Kind::effect || !result.is_object()) return;
  const double noise = std::pow(10, -setting.noise_db / 20);
  std::set<std::string> asked;
  const json effects = result.value("effects", json::array());
  if (!outcome.right && effects.size() == 1) asked.insert(effects[0].value("name", ""));
  const std::set<std::string> answer = asked;
  if (whole_class)
    for (const auto& name : confusers_of(lunid, setting.which->effects.front(), dir)) asked.insert(name);
  outcome.class_size = 1;
  for (const auto& name : asked) {
    if (!(fitted_gap(lunid, setting, dir, name) < noise)) continue;
    ++outcome.class_size;
    if (answer.count(name)) outcome.equivalent = true;
  }
}

void print_head() {
  std::printf("%-28s %-6s %-9s %5s %5s  %-16s %-5s %-34s %12s  %8s %8s %8s  %6s\n", "effect", "scale", "excited",
              "noise", "share", "verdict", "right", "named", "parameters", "before", "after", "floor", "time");
}

void print_row(const Setting& setting, const Outcome& outcome) {
  char parameters[40] = "-";
  if (outcome.parameters > 0) {
    std::snprintf(parameters, sizeof parameters, "%d/%d %+.1f sd", outcome.inside, outcome.parameters, outcome.worst);
  }
  const std::string name = setting.which->name + (setting.kind.empty() ? "" : ", " + setting.kind);
  std::printf("%-28s %-6s %-9s %2.0f dB %4.0f%%  %-16s %-5s %-34s %12s  %8.4f %8.4f %8.4f  %4.1f s\n", name.c_str(),
              setting.scale->name.c_str(), to_string(setting.options.excited), setting.noise_db, 100 * outcome.share,
              outcome.verdict.c_str(),
              outcome.right        ? "yes"
              : outcome.tie        ? "tie"
              : outcome.equivalent ? "equal"
                                   : "NO",
              outcome.named.empty() ? "-" : outcome.named.c_str(), parameters, outcome.before, outcome.after,
              outcome.floor, outcome.seconds);
  std::fflush(stdout);
}

struct Plan {
  bool full = false, brief = false, check = false;
  int nulls = 0, rows = 6400, draw = 0;
  std::uint64_t seed = 1;
  std::string only;
};

Setting setting_of(const truth::Case& which, int scale, double db, truth::Excited excited, const Plan& plan) {
  Setting s{&which, &truth::scales()[static_cast<std::size_t>(scale)], db, {}, "", true};
  s.options.rows = plan.rows;
  s.options.noise_db = db;
  s.options.excited = excited;
  s.options.seed = plan.seed + static_cast<std::uint64_t>(db) + 100 * static_cast<std::uint64_t>(scale);
  return s;
}

constexpr truth::Excited excitations[] = {truth::Excited::multisine, truth::Excited::noise, truth::Excited::chirp,
                                          truth::Excited::tones, truth::Excited::decay};

/// Records in which nothing is missing: each known baseline, each kind of trouble, each scale and level in turn.
std::vector<Setting> null_settings(const Plan& plan) {
  const char* names[] = {"null_linear", "null_duffing", "null_friction", "null_hysteresis"};
  const double levels[] = {40, 30, 20, 60};
  std::vector<Setting> list;
  for (int i = 0; i < plan.nulls; ++i) {
    Plan own = plan;
    own.seed = plan.seed + 1000 + static_cast<std::uint64_t>(i);
    const auto excited = excitations[i % 3];
    Setting s = setting_of(truth::case_named(names[i % 4]), (i / 4) % 3, levels[(i / 3) % 4], excited, own);
    switch (i % 7) {
      case 1: s.options.colour = 0.9, s.kind = "coloured"; break;
      case 2: s.options.unknown = 0.05, s.kind = "process"; break;
      case 3: s.options.feedback = 0.2, s.kind = "closed loop"; break;
      case 4: s.mass_known = s.which->baseline.find("bouc_wen") != std::string::npos, s.kind = "mass"; break;
      case 5: s.options.rows = 200, s.kind = "200 rows"; break;
      case 6: s.options.force_noise_db = 30, s.kind = "noisy force"; break;
      default: break;
    }
    list.push_back(s);
  }
  return list;
}

std::vector<Setting> short_settings(const Plan& plan) {
  std::vector<Setting> list;
  const auto add = [&](const char* name, int scale, double db) {
    list.push_back(setting_of(truth::case_named(name), scale, db, truth::Excited::multisine, plan));
  };
  add("cubic_hardening", 0, 30);
  add("bouc_wen", 2, 40);
  add("bouc_wen_stiffening", 1, 40);
  add("coulomb_friction", 1, 40);
  add("one_sided_stop", 2, 30);
  add("null_linear", 2, 20);
  add("null_duffing", 1, 30);
  add("coulomb+constant", 0, 40);
  add("outside_v2y", 1, 40);
  return list;
}

std::string name_of(const Setting& setting) {
  return setting.which->name + "-" + setting.scale->name + "-" + to_string(setting.options.excited) + "-" +
         std::to_string(static_cast<int>(setting.noise_db));
}

std::vector<Setting> settings(const Plan& plan) {
  if (plan.nulls > 0) return null_settings(plan);
  if (plan.brief) return short_settings(plan);
  const double levels[] = {40, 30, 20, 60};
  std::vector<Setting> list;
  int index = 0;
  for (const truth::Case& each : truth::cases()) {
    ++index;
    for (int scale = 0; scale < 3; ++scale)
      for (int level = 0; level < 4; ++level)
        for (int kind = 0; kind < 5; ++kind) {
          const bool one = scale == index % 3 && level == index / 3 % 3 && kind == index % 3;
          if (!plan.full && plan.draw == 0 && !one) continue;
          Setting setting = setting_of(each, scale, levels[level], excitations[kind], plan);
          if (name_of(setting).find(plan.only) != std::string::npos) list.push_back(setting);
        }
  }
  if (plan.draw > 0 && static_cast<std::size_t>(plan.draw) < list.size()) {
    std::shuffle(list.begin(), list.end(), std::mt19937_64(plan.seed));
    list.resize(static_cast<std::size_t>(plan.draw));
  }
  return list;
}

/// Upper 95 % limit of a rate of which `count` of `all` were seen (Clopper and Pearson 1934): the root of the binomial
/// tail, by bisection.
double upper_limit(int count, int all) {
  if (all == 0 || count >= all) return 1;
  double low = 0, high = 1;
  for (int pass = 0; pass < 60; ++pass) {
    const double p = 0.5 * (low + high);
    double tail = 0, term = std::pow(1 - p, all);
    for (int i = 0; i <= count; ++i) {
      tail += term;
      term *= static_cast<double>(all - i) / (i + 1) * p / (1 - p);
    }
    (tail > 0.05 ? low : high) = p;
  }
  return high;
}

/// Right and all of each kind.
struct Tally {
  faults::FaultTally sensors;
  int right[4] = {}, all[4] = {};
  int parameters = 0, inside = 0, closed = 0, closable = 0, wild = 0, false_names = 0;
  int equal[4] = {}, classes = 0, members = 0;
  double longest = 0;
  std::map<double, std::pair<int, int>> levels;  // right or equal, and all, of one hidden effect at each level of noise

  void add(const Setting& setting, const Outcome& outcome) {
    const int kind = static_cast<int>(setting.which->kind);
    ++all[kind];
    right[kind] += outcome.right;
    equal[kind] += outcome.right || outcome.equivalent || outcome.tie;
    false_names += setting.which->kind == truth::Kind::null && !outcome.named.empty();
    classes += outcome.class_size > 0;
    members += outcome.class_size;
    if (setting.which->kind == truth::Kind::effect) {
      levels[setting.noise_db].first += outcome.right || outcome.equivalent || outcome.tie;
      ++levels[setting.noise_db].second;
    }
    longest = std::max(longest, outcome.seconds);
    if (!outcome.right || setting.which->effects.empty()) return;
    parameters += outcome.parameters;
    inside += outcome.inside;
    ++closable;
    closed += outcome.after <= 1.3 * outcome.floor;
    wild += !(std::abs(outcome.worst) < 4);  // of a few parameters, one beyond 4 sd means a wrong interval
  }
  bool clean() const {
    const int pair = static_cast<int>(truth::Kind::pair);
    for (int kind = 0; kind < 4; ++kind)
      if ((kind == pair ? equal : right)[kind] != all[kind]) return false;  // a tie of one of two is told
    return closed == closable && wild == 0;
  }
  void print() const {
    using truth::Kind;
    const auto at = [](Kind kind) { return static_cast<int>(kind); };
    std::printf(
        "where named right: parameters within their 95 %% interval %d/%d, test gap within 1.3 floors %d/%d; "
        "longest run %.1f s\n",
        inside, parameters, closed, closable, longest);
    if (sensors.all > 0)
      std::printf("faulty sensors and inputs: called physics %d of %d\n", sensors.physics, sensors.all);
    const int nulls = all[at(Kind::null)];
    if (classes > 0)
      std::printf(
          "named or its equivalent %d/%d; members of a class, of the truth, the answer and the confusers: %.2f\n",
          equal[at(Kind::effect)], all[at(Kind::effect)], static_cast<double>(members) / classes);
    for (const auto& [noise, count] : levels)
      std::printf("named or its equivalent at %.0f dB: %d/%d\n", noise, count.first, count.second);
    if (nulls > 0)
      std::printf("nulls: false names %d of %d, 95 %% limit of the rate %.3f\n", false_names, nulls,
                  upper_limit(false_names, nulls));
    std::printf("named %d/%d nulls-false %d/%d pairs %d/%d outside %d/%d sensors %d/%d\n", right[at(Kind::effect)],
                all[at(Kind::effect)], nulls - right[at(Kind::null)], nulls, equal[at(Kind::pair)], all[at(Kind::pair)],
                right[at(Kind::outside)], all[at(Kind::outside)], sensors.right, sensors.all);
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: lunid_discovery_matrix LUNID OUT_DIR [--full | --draw N | --short | --nulls N] [--rows N] "
                 "[--seed N] [--check] [--only WORD]\n");
    return 2;
  }
  Plan plan;
  for (int i = 3; i < argc; ++i) {
    const std::string option = argv[i];
    const auto next = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string("0"); };
    if (option == "--full")
      plan.full = true;
    else if (option == "--short")
      plan.brief = true;
    else if (option == "--check")
      plan.check = true;
    else if (option == "--only")
      plan.only = next();
    else if (option == "--draw")
      plan.draw = std::stoi(next());
    else if (option == "--nulls")
      plan.nulls = std::stoi(next());
    else if (option == "--rows")
      plan.rows = std::stoi(next());
    else if (option == "--seed")
      plan.seed = std::stoull(next());
    else {
      std::fprintf(stderr, "lunid_discovery_matrix: unknown option '%s'\n", argv[i]);
      return 2;
    }
  }
  Tally tally;
  print_head();
  int index = 0;
  for (const Setting& setting : settings(plan)) {
    std::string dir = std::string(argv[2]) + "/" + name_of(setting);
    if (plan.nulls > 0) dir += "-" + std::to_string(index);
    ++index;
    Outcome outcome;
    const std::string train = write_records(setting, dir, outcome);
    const auto start = std::chrono::steady_clock::now();
    const json result = discover(argv[1], setting, dir, train);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double share = outcome.share;
    outcome = judge(setting, result);
    outcome.share = share;
    outcome.seconds = seconds;
    if (!plan.brief) compare_fits(argv[1], setting, result, dir, plan.full, outcome);
    tally.add(setting, outcome);
    print_row(setting, outcome);
  }
  if (!plan.brief && plan.nulls == 0 && plan.draw == 0)
    tally.sensors = faults::run_all(argv[1], argv[2], plan.full, plan.rows > 0 ? plan.rows : 6400, plan.only);
  tally.print();
  return plan.check && !tally.clean() ? 1 : 0;
}
