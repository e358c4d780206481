// The matrix of hidden effects: records of tests/truth, `lunid discover` as a process, its discovery.json
// against the truth. One line per run, tables of what each entry, level of noise and excitation came to, and the
// contract's last line
//   named A/B nulls-false C/D pairs E/F outside G/H sensors I/J
//
//   lunid_discovery_matrix LUNID OUT_DIR [--full | --draw N | --short | --nulls N] [--rows N] [--seed N] [--seeds N]
//                          [--alpha P] [--only WORD] [--resume] [--check]
// By default every case once, faulty sensors and inputs at each scale: excitations and levels of noise in turn. --full:
// at every scale, under every excitation, at 60, 40, 30 and 20 dB. --draw: N of the settings of --full, drawn at
// random.
// --short: one run each of a few cases. --nulls: N records in which nothing is missing, of each kind in turn. --rows:
// of a record (6400). --seed: of all that is random. --seeds: so many records of each setting. --alpha: of lunid
// discover.
// --only: settings whose name (CASE-SCALE-EXCITATION-DB, the folder of its records) holds WORD: `--full --only -40` is
// all at 40 dB. --resume: takes what earlier runs with the same rows, seed and alpha left in OUT_DIR, and does the rest
// (a draw of more settings begins with those of a draw of fewer). --check: exit 1 unless all is as it should be.
//
// A name other than the truth's counts as its equivalent where its own best fit to the noise-free record differs from
// that record by less than the noise. That is asked here of fits to other data than the answer was given on, for the
// answer and for the confusers that the entry declares; the class is never taken from the answer. A record cannot tell
// two where the best fit of one to the other without noise differs by so little that no test could see it.
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

#include "discovery_tally.hpp"

namespace {

using matrix::Outcome;
using matrix::Setting;
using nlohmann::json;

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The baseline as arguments; one with a Bouc-Wen element is a file.
std::string baseline_arguments(const Setting& setting, const std::string& dir) {
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", setting.scale->mass);
  const std::string text = setting.baseline();
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
json discover(const std::string& lunid, const Setting& setting, const std::string& dir, const std::string& train,
              const std::string& alpha) {
  const std::string command = "'" + lunid + "' discover " + train + " --test '" + dir + "/test.csv' " +
                              baseline_arguments(setting, dir) + " --alpha " + alpha + " --out '" + dir + "/out' > '" +
                              dir + "/log' 2>&1";
  if (std::system(command.c_str()) != 0) {
    std::fprintf(stderr, "%s\n%s", command.c_str(), read_text(dir + "/log").c_str());
    return {};
  }
  return json::parse(read_text(dir + "/out/discovery.json"), nullptr, false);
}

/// Writes train.csv, train2.csv ... and test.csv; the names of the training files.
template <class Records>
std::string write_all(const Records& records, const std::string& dir) {
  write_csv(records.train, dir + "/train.csv");
  write_csv(records.test, dir + "/test.csv");
  std::string list = "'" + dir + "/train.csv'";
  for (std::size_t i = 0; i < records.more.size(); ++i) {
    const std::string name = dir + "/train" + std::to_string(i + 2) + ".csv";
    write_csv(records.more[i], name);
    list += " '" + name + "'";
  }
  return list;
}

/// The gap of a run of the truth: of the noise alone, over the rows behind the lead-in (two periods or 5 % of the
/// rows).
double noise_gap(const truth::Columns& record, const truth::Scale& scale) {
  const std::size_t rows = record.y.size(),
                    lead = std::max<std::size_t>(
                        5, std::min<std::size_t>(rows / 20, static_cast<std::size_t>(2 * scale.samples)));
  double noise = 0, mean = 0, square = 0;
  for (std::size_t i = lead; i < rows; ++i) {
    noise += std::pow(record.y[i] - record.clean_y[i], 2);
    mean += record.y[i];
    square += record.y[i] * record.y[i];
  }
  return std::sqrt(noise / (square - mean * mean / static_cast<double>(rows - lead)));
}

/// Writes the records of a setting, as measured and as they would be without noise; the training files.
std::string write_records(const Setting& setting, const std::string& dir, Outcome& outcome) {
  std::filesystem::create_directories(dir);
  if (setting.fault) return write_all(truth::make_faulty(*setting.fault, *setting.scale, setting.options), dir);
  const truth::Records records = truth::make_records(*setting.which, *setting.scale, setting.options);
  outcome.share = records.train.hidden_share;
  outcome.noise = noise_gap(records.test, *setting.scale);
  const double colour = setting.options.colour * setting.options.colour;
  outcome.rows = static_cast<int>(setting.options.rows * (1 - colour) / (1 + colour));
  truth::Columns clean = records.train;
  clean.y = clean.clean_y;
  clean.F = clean.clean_F;
  truth::write_csv(clean, dir + "/clean.csv");
  return write_all(records, dir);
}

/// The gap that an entry's best fit leaves on the noise-free training record.
double fitted_gap(const std::string& lunid, const Setting& setting, const std::string& dir, const std::string& entry) {
  char mass[40];
  std::snprintf(mass, sizeof mass, "%.9g", setting.scale->mass);
  std::ofstream(dir + "/class.lua")
      << "local lunid = require 'lunid'\nlocal y, v = lunid.displacement, lunid.velocity\n"
      << "local k, c = lunid.parameter 'k', lunid.parameter 'c'\nlocal record = lunid.read '" << dir << "/clean.csv'\n"
      << "lunid.discover { model = lunid.model { mass = " << mass << ", restoring = " << setting.baseline()
      << " }, train = record, test = record, catalogue = { '" << entry << "' }, max_effects = 1, out = '.' }\n";
  const std::string command =
      "'" + lunid + "' run '" + dir + "/class.lua' --out '" + dir + "/class' > '" + dir + "/class.log' 2>&1";
  if (std::system(command.c_str()) != 0) return NAN;
  const json found = json::parse(read_text(dir + "/class/discovery.json"), nullptr, false);
  if (!found.is_object()) return NAN;
  double gap = matrix::number(found.value("final", json::object()), "gap_train");
  for (const json& rival : found.value("rivals", json::array()))
    if (rival.value("name", "") == entry) gap = std::fmin(gap, matrix::number(rival, "gap"));
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

/// Whether what was named instead of the one true effect is its equivalent on this record, and how many there are.
void compare_fits(const std::string& lunid, const Setting& setting, const json& result, const std::string& dir,
                  bool whole_class, Outcome& outcome) {
  if (!setting.is(truth::Kind::effect) || !result.is_object()) return;
  const double noise = std::pow(10, -setting.options.noise_db / 20);
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

/// Rivals of a tie whose best fit to the noise-free record differs from it by less than any test could see: with n rows
/// of noise s the best one (Neyman and Pearson 1933) tells two records that differ by d (rms) at sqrt(n) d/s
/// deviations.
std::vector<std::string> equals_of(const std::string& lunid, const Setting& setting, const std::string& dir) {
  constexpr double deviations = 2;
  const double noise = std::pow(10, -setting.options.noise_db / 20);
  std::vector<std::string> equals;
  for (const std::string& rival : setting.which->rivals) {
    const double apart =
        std::sqrt(static_cast<double>(setting.options.rows)) * fitted_gap(lunid, setting, dir, rival) / noise;
    if (apart < deviations) equals.push_back(rival);
  }
  return equals;
}

void print_head() {
  std::printf("%-28s %-6s %-9s %5s %5s  %-16s %-6s %-34s %12s  %8s %8s %8s  %6s\n", "effect", "scale", "excited",
              "noise", "share", "verdict", "answer", "named", "parameters", "before", "after", "floor", "time");
}

void print_row(const Setting& setting, const Outcome& outcome) {
  char parameters[40] = "-";
  if (outcome.parameters > 0) {
    std::snprintf(parameters, sizeof parameters, "%d/%d %+.1f sd", outcome.inside, outcome.parameters, outcome.worst);
  }
  const std::string name = setting.name() + (setting.kind.empty() ? "" : ", " + setting.kind);
  std::printf("%-28s %-6s %-9s %2.0f dB %4.0f%%  %-16s %-6s %-34s %12s  %8.4f %8.4f %8.4f  %4.1f s\n", name.c_str(),
              setting.scale->name.c_str(), to_string(setting.options.excited), setting.options.noise_db,
              100 * outcome.share, outcome.verdict.c_str(), outcome.tells ? "tells" : to_string(outcome.answer()),
              outcome.named.empty() ? "-" : outcome.named.c_str(), parameters, outcome.before, outcome.after,
              outcome.floor, outcome.seconds);
  std::fflush(stdout);
}

Outcome run(const std::string& lunid, const std::string& dir, const Setting& setting, const matrix::Plan& plan) {
  Outcome known;
  const std::string train = write_records(setting, dir, known);
  const auto start = std::chrono::steady_clock::now();
  const json result = discover(lunid, setting, dir, train, plan.alpha);
  Outcome outcome = matrix::judge(setting, result);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.share = known.share;
  outcome.noise = known.noise;
  outcome.rows = known.rows;
  if (setting.is(truth::Kind::tie))
    matrix::judge_tie(setting, result, equals_of(lunid, setting, dir), outcome);
  else if (!plan.brief)
    compare_fits(lunid, setting, result, dir, plan.full, outcome);
  return outcome;
}

/// What runs of this plan left of a setting, or runs it; what it came to is left there.
Outcome run_or_take(const std::string& lunid, const std::string& dir, const Setting& setting,
                    const matrix::Plan& plan) {
  const std::string file = dir + "/outcome.json";
  const json key = {setting.options.rows, setting.options.seed, plan.alpha};
  if (plan.resume) {
    const json left = json::parse(read_text(file), nullptr, false);
    if (left.is_object() && left.value("of", json()) == key) return matrix::outcome_of(left["outcome"]);
  }
  const Outcome outcome = run(lunid, dir, setting, plan);
  if (outcome.verdict != "failed")
    std::ofstream(file) << json{{"of", key}, {"outcome", matrix::kept(outcome)}}.dump(1) << '\n';
  return outcome;
}

/// False where an option is unknown.
bool read_options(int argc, char** argv, matrix::Plan& plan) {
  for (int i = 3; i < argc; ++i) {
    const std::string option = argv[i];
    const auto next = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string("0"); };
    if (option == "--full")
      plan.full = true;
    else if (option == "--short")
      plan.brief = true;
    else if (option == "--check")
      plan.check = true;
    else if (option == "--resume")
      plan.resume = true;
    else if (option == "--only")
      plan.only = next();
    else if (option == "--alpha")
      plan.alpha = next();
    else if (option == "--draw")
      plan.draw = std::stoi(next());
    else if (option == "--nulls")
      plan.nulls = std::stoi(next());
    else if (option == "--rows")
      plan.rows = std::stoi(next());
    else if (option == "--seed")
      plan.seed = std::stoull(next());
    else if (option == "--seeds")
      plan.seeds = std::stoi(next());
    else {
      std::fprintf(stderr, "lunid_discovery_matrix: unknown option '%s'\n", argv[i]);
      return false;
    }
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: lunid_discovery_matrix LUNID OUT_DIR [--full | --draw N | --short | --nulls N] [--rows N] "
                 "[--seed N] [--seeds N] [--alpha P] [--only WORD] [--resume] [--check]\n");
    return 2;
  }
  matrix::Plan plan;
  if (!read_options(argc, argv, plan)) return 2;
  matrix::Tally tally;
  print_head();
  int index = 0;
  for (const Setting& setting : settings(plan)) {
    std::string dir = std::string(argv[2]) + "/" + setting.folder();
    if (plan.nulls > 0) dir += "-" + std::to_string(index);
    ++index;
    const Outcome outcome = run_or_take(argv[1], dir, setting, plan);
    tally.add(setting, outcome);
    print_row(setting, outcome);
  }
  tally.print(plan.alpha);
  return plan.check && !tally.clean() ? 1 : 0;
}
