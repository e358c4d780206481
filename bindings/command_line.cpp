#include "command_line.hpp"

#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>

#include "expr/error.hpp"
#include "record/record.hpp"

namespace lunid::lua {

namespace {

using nlohmann::json;

/// What the options of a command are stored into, before they become JSON.
struct Values {
  std::vector<std::string> files, tests, arguments, windows, test_windows, topic, cases;
  std::string study, mass, restoring, baseline, columns, rate, catalogue, without, out, model, excitation, from, solver,
      initial, interpolation;
  double alpha = 0.01, minimum_gain = 0.05, duration = 0, step = 0;
  long long seed = 1;
  int threads = 0;
  bool imposed_motion = false, resample = false, quick = false, check = false;
};

using Check = std::function<std::string(const std::string&)>;

/// A check of an option's whole number, as CLI11 takes it: what is wrong, or nothing.
Check expects_whole(const std::string& range, long long most) {
  return [=](const std::string& text) -> std::string {
    long long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && value >= 0 && value <= most) return "";
    return "expected a whole number " + range + ", got '" + text + "'";
  };
}

void add_shared(CLI::App* app, Values& values, bool with_out = true) {
  if (with_out)
    app->add_option("--out", values.out, "directory for all that the run makes (lunid-out)")
        ->check(Check([](const std::string& text) { return text.empty() ? "expected a directory, got ''" : ""; }));
  app->add_option("--seed", values.seed, "seed of everything random (1)")
      ->check(expects_whole(">= 0", std::numeric_limits<long long>::max()));
  app->add_option("--threads", values.threads, "threads; 0 is all cores (0)")
      ->check(expects_whole("from 0 to 4096", 4096));
}

/// How a record is read that a command names.
void add_reading(CLI::App* app, Values& values) {
  app->add_option("--columns", values.columns,
                  "\"t=time,y=disp [mm],F=load [kN]\": channel=header [unit], where the header does not say it; F=0 "
                  "where nothing drives (lunid help columns)")
      ->join(',');
  app->add_option("--rate", values.rate,
                  "rows per second (\"4 kHz\"), where there is no time; of a MAT or HDF5 file also its name")
      ->check(Check([](const std::string& text) -> std::string {
        char* end = nullptr;
        const double rate = std::strtod(text.c_str(), &end);
        if (text.empty() || *end == '\0') return rate > 0 ? "" : "expected > 0, got '" + text + "'";
        return "";
      }));
  app->add_flag("--resample", values.resample, "an uneven time base is interpolated to its median step");
}

void add_run(CLI::App& app, Values& values) {
  CLI::App* run = app.add_subcommand("run", "run a study, or repeat a run from its run.json");
  run->add_option("study", values.study, "STUDY.lua, or OUT/run.json")->required();
  run->add_option("options", values.arguments, "key=value, read by lunid.option in the study");
  add_shared(run, values);
}

/// A check of an option's number, as CLI11 takes it: what is wrong, or nothing.
Check expects(const std::string& range, bool (*holds)(double)) {
  return [=](const std::string& text) {
    return holds(std::strtod(text.c_str(), nullptr)) ? "" : "expected " + range + ", got " + text;
  };
}

void add_discover(CLI::App& app, Values& values) {
  CLI::App* discover = app.add_subcommand("discover", "name the effect that a model of a record lacks");
  discover->add_option("train", values.files, "TRAIN.csv [MORE.csv ...]")->required();
  discover->add_option(
      "--mass", values.mass,
      "mass [kg] or with its unit (\"1.9 t\", \"0.8 kg m^2\", \"20 mH\"), or an expression; an unknown name is a "
      "parameter");
  discover->add_option("--restoring", values.restoring, "restoring force, such as \"k*y + c*v\"");
  discover->add_option("--baseline", values.baseline, "model.lua, in place of --mass and --restoring");
  discover->add_option("--test", values.tests,
                       "TEST.csv ...: opened once, when TRAIN has chosen; else the last 30 % is held out");
  discover->add_option("--window", values.windows, "A:B, part of the training records [s]");
  discover->add_option("--test-window", values.test_windows,
                       "A:B, part of the test records [s]; without --test of TRAIN");
  add_reading(discover, values);
  discover->add_flag("--imposed-motion", values.imposed_motion, "the motion is imposed: the gap is that of the force");
  discover
      ->add_option("--interpolation", values.interpolation,
                   "what the force does between its rows: hold, linear, cubic or band_limited (read off the rows)")
      ->check(Check([](const std::string& text) -> std::string {
        try {
          interpolation_named(text);
          return "";
        } catch (const InputError& e) {
          return e.message();
        }
      }));
  discover->add_option("--alpha", values.alpha, "level of false alarms of the whole search (0.01)")
      ->check(expects("> 0 and < 0.5", [](double alpha) { return alpha > 0 && alpha < 0.5; }));
  discover->add_option("--minimum-gain", values.minimum_gain, "least drop of the left-out gap for a name (0.05)")
      ->check(expects(">= 0 and < 1", [](double gain) { return gain >= 0 && gain < 1; }));
  discover->add_option("--catalogue", values.catalogue, "names of entries to try, \"clearance,cubic_stiffness\"");
  discover->add_option("--without", values.without, "names of entries that are not tried, \"bouc_wen\"");
  discover->add_flag("--check", values.check, "say how records and baseline are read, and stop there");
  add_shared(discover, values);
}

void add_simulate(CLI::App& app, Values& values) {
  CLI::App* simulate = app.add_subcommand("simulate", "run a model freely under a record's force");
  simulate->add_option("model", values.model, "model.lua")->required();
  simulate->add_option("--excitation", values.excitation, "RECORD.csv whose F drives the model")->required();
  add_reading(simulate, values);
  simulate->add_option("--window", values.windows, "A:B, part of the record [s]");
  simulate->add_option("--from", values.initial, "first state \"y,v\"; else the record's own motion, else rest");
  simulate->add_option("--solver", values.solver, "auto, fixed, bdf, adams, rk23, rk45, rk78 or esdirk (auto)");
  add_shared(simulate, values);
}

void add_thesis(CLI::App& app, Values& values) {
  CLI::App* thesis =
      app.add_subcommand("thesis", "the thesis made again, with Lunid's answer beside the published one");
  thesis->add_option("case", values.cases, "list | case1 | case2 ... | all (list)")->expected(0, -1);
  thesis->add_flag("--quick", values.quick, "fewer seeds, frequencies and draws");
  add_shared(thesis, values);
}

void add_small_commands(CLI::App& app, Values& values) {
  CLI::App* check = app.add_subcommand("check", "look through a study without running it");
  check->add_option("study", values.study, "STUDY.lua")->required();
  CLI::App* list = app.add_subcommand("list", "list effects, features, solvers, excitations, systems or cases");
  list->add_option("topic", values.topic, "effects | features | solvers | excitations | systems | cases")
      ->expected(0, -1);
  CLI::App* help = app.add_subcommand("help", "explain a constructor, a group of them, a command or an effect");
  help->add_option("topic", values.topic, "such as regress, discover, cubic_stiffness, or systems duffing");
  add_shared(app.add_subcommand("repl", "type expressions and see their values"), values, false);
  app.add_subcommand("doctor", "say what is installed and whether figures work here");
}

void put(json& into, const char* key, const std::string& value) {
  if (!value.empty()) into[key] = value;
}

void put(json& into, const char* key, const std::vector<std::string>& values) {
  if (!values.empty()) into[key] = values;
}

/// Options that were given, under the names that stdlib/commands reads; absent ones stay absent.
json to_json(const CLI::App& app, const Values& values) {
  json options = {{"seed", values.seed}, {"threads", values.threads}};
  put(options, "study", values.study);
  put(options, "arguments", values.arguments);
  put(options, "train", values.files);
  put(options, "test", values.tests);
  put(options, "mass", values.mass);
  put(options, "restoring", values.restoring);
  put(options, "baseline", values.baseline);
  put(options, "window", values.windows);
  put(options, "test_window", values.test_windows);
  put(options, "columns", values.columns);
  put(options, "rate", values.rate);
  put(options, "out", values.out);
  put(options, "model", values.model);
  put(options, "excitation", values.excitation);
  put(options, "from", values.initial);
  put(options, "solver", values.solver);
  std::string topic;  // "systems duffing" is systems.duffing
  for (const std::string& word : values.topic) topic += (topic.empty() ? "" : ".") + word;
  put(options, "topic", topic);
  if (app.get_name() == "discover") {
    options["alpha"] = values.alpha;
    options["minimum_gain"] = values.minimum_gain;
    put(options, "catalogue", values.catalogue);
    put(options, "without", values.without);
    put(options, "interpolation", values.interpolation);
    options["imposed_motion"] = values.imposed_motion;
    if (values.check) options["check"] = true;
  }
  put(options, "cases", values.cases);
  if (values.resample) options["resample"] = true;
  if (values.quick) options["quick"] = true;
  return options;
}

/// No option takes the next one for its value.
void expect_values(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({}))
    for (CLI::Option* option : command->get_options())
      if (option->get_expected_max() > 0 && !option->get_lnames().empty())
        option->check(Check([](const std::string& text) {
          return text.starts_with("--") ? "expected a value, got '" + text + "'" : "";
        }));
}

/// What is wrong with the first word, where it should be a command and is not.
std::optional<std::string> unknown_command(const CLI::App& app, int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.empty()) return "lunid: a command is needed, such as `lunid help`";
  std::vector<std::string> commands;
  for (const CLI::App* known : app.get_subcommands({})) commands.push_back(known->get_name());
  if (word[0] == '-' || std::find(commands.begin(), commands.end(), word) != commands.end()) return std::nullopt;
  return "lunid: no command '" + word + "'" + did_you_mean(nearest_word(word, commands));
}

/// What is wrong with an option that a command does not have.
std::string unknown_option(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string& word : command.remaining()) {
    if (word.empty() || word[0] != '-') continue;
    const std::string option = word.substr(0, word.find('='));
    return command.get_name() + " has no option '" + option + "'" + did_you_mean(nearest_word(option, names));
  }
  return command.get_name() + ": one word too many: '" +
         (command.remaining().empty() ? "" : command.remaining().front()) + "'";
}

}  // namespace

Command parse_command_line(int argc, char** argv) {
  Command command;
  CLI::App app("Lunid: from a measured record to the equation of its motion", "lunid");
  Values values;
  app.set_version_flag("-v,--version", "lunid " LUNID_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    std::string name = failed->get_name();
    std::string text = error.what();
    for (const CLI::App* sub : failed->get_subcommands()) {
      name += " " + sub->get_name();
      if (dynamic_cast<const CLI::ExtrasError*>(&error)) text = unknown_option(*sub);
    }
    return "lunid: " + text + "\nlunid: see `" + name + " --help`\n";
  });
  add_run(app, values);
  add_discover(app, values);
  add_simulate(app, values);
  add_thesis(app, values);
  add_small_commands(app, values);
  expect_values(app);
  if (const auto unknown = unknown_command(app, argc, argv)) {
    std::cerr << *unknown << "\nlunid: see `lunid --help`\n";
    command.exit_code = 2;
    return command;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    command.exit_code = app.exit(error, std::cout, std::cerr) == 0 ? 0 : 2;
    return command;
  }
  const CLI::App* chosen = app.get_subcommands().front();
  command.name = chosen->get_name();
  command.options = to_json(*chosen, values);
  return command;
}

std::filesystem::path executable_path() { return std::filesystem::read_symlink("/proc/self/exe"); }

}  // namespace lunid::lua
