#include "discover/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "discover/accept.hpp"
#include "discover/baseline.hpp"
#include "discover/between_samples.hpp"
#include "discover/views.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "expr/words.hpp"
#include "record/spectra.hpp"

namespace lunid {

namespace {

bool varies(std::span<const double> x) {
  return std::ranges::any_of(x, [&](double value) { return value != x[0]; });
}

void append_new(std::vector<std::string>& list, const std::string& text) {
  if (std::ranges::find(list, text) == list.end()) list.push_back(text);
}

constexpr auto of_noise =
    "noise is what a channel does from row to row, the least that it can be: drift, hum and slow noise are not in it; "
    "a "
    "discovery holds its models against what they leave";

/// A time in seconds that may be one in milliseconds.
std::string question_of_clock(const std::vector<Record>& records) {
  constexpr double slow = 1;  // [s] between rows
  for (const Record& record : records)
    if (record.time_without_unit() && record.dt() > slow)
      return "; the rows of " + record.name() + " are " + number(record.dt()) +
             " s apart: where that is ms, say --columns \"t=header [ms]\"";
  return "";
}

/// Channels of the language whose columns have no unit; a constant such as F=0 needs none.
std::string without_unit(const std::vector<Record>& records) {
  std::vector<std::string> names;
  for (const Record& record : records) {
    if (record.time_without_unit()) append_new(names, "t");
    for (const Channel& channel : record.channels())
      if (!channel.derived && channel.source_unit.empty() && is_channel_name(channel.name) &&
          varies(record[channel.name]))
        append_new(names, channel.name);
  }
  if (names.empty()) return "";
  return "no unit is given for " + joined(names) + ": SI is taken" + question_of_clock(records);
}

/// A set point that stands under its own name alone.
std::string unused_reference(const Study& study, const std::vector<Record>& records) {
  for (const Record& record : records)
    for (const Channel& channel : record.channels()) {
      const std::string word = lower_case(channel.name);
      for (const char* known : {"setpoint", "set_point", "set point", "reference", "command", "target"})
        if (word == known && !record.has(study.reference()))
          return "nothing uses the channel '" + channel.name + "'; where it is what a controller was to follow, say " +
                 study.reference() + "=" + channel.name;
    }
  return "";
}

/// An angle that turns on and on beside a motion that does not, under a name that no effect looks for.
std::string unused_angle(const std::vector<Record>& records) {
  constexpr double turn = 2 * std::numbers::pi, fewest = 2;
  for (const Record& record : records) {
    const auto is_known = [](const Channel& channel) {  // the rig itself turns, or the shaft has its name
      const std::string& name = channel.name;
      return name.starts_with("shaft_") || name == "phase" || (name[0] == 'y' && channel.unit == "rad");
    };
    if (std::ranges::any_of(record.channels(), is_known)) continue;
    for (const Channel& channel : record.channels()) {
      if (channel.unit != "rad" || is_channel_name(channel.name)) continue;
      Eigen::VectorXd angle = as_vector(record[channel.name]);
      if (!angle.allFinite()) continue;
      unwrap(angle);
      if (std::abs(angle[angle.size() - 1] - angle[0]) > fewest * turn)
        return "nothing uses the channel '" + channel.name +
               "', an angle that turns on; where it is that of a shaft in the rig, say shaft_angle=" + channel.name;
    }
  }
  return "";
}

/// The motion of a base is no noise, and not small beside that of the rig.
bool shakes(const Record& record, const Channel& base, const std::string& own) {
  constexpr double noises = 10, part = 0.02;
  const double size = standard_deviation(record[base.name]);
  return !base.derived && size > std::max(noises * base.noise, part * standard_deviation(record[own]));
}

/// A base whose motion was measured and stands nowhere in a baseline that nothing else drives.
std::string unused_base(const Study& study) {
  if (study.imposed) return "";
  for (const Record& record : study.full) {
    if (record.has("shaft_angle")) continue;  // what turns may drive
    for (const char quantity : {'a', 'v', 'y'}) {
      const std::string base = quantity + std::string("b");
      if (record.has(base) && shakes(record, record.channel(base), study.channel(quantity, 0)) &&
          is_free(study, record))
        return "nothing drives the baseline: F is 0 in " + record.name() + ", and " + base +
               " stands nowhere in it; where y is measured from the base add m*ab with the number m, where it is "
               "measured from the ground write k*(y - yb) + c*(v - vb)";
    }
  }
  return "";
}

/// A shaft whose angle was measured, and nothing else that drives.
std::string unused_shaft(const Study& study) {
  if (study.imposed) return "";
  for (const Record& record : study.full)
    if (record.has("shaft_angle") && is_free(study, record) && study.model.sides().empty())
      return "nothing drives the baseline: F is 0 in " + record.name() +
             ", and the shaft stands nowhere in it; rotating_unbalance is among what is tried";
  return "";
}

/// One force F of several coordinates, of which one is driven.
std::string whose_force(const Study& study, const std::vector<Record>& records) {
  if (study.degrees() == 1 || study.forces.size() != 1) return "";
  for (const Record& record : records)
    if (record.has("F") && !record.has(study.forces.front()))
      return "F of " + record.name() + " is taken for " + study.forces.front() + ", the force that drives the baseline";
  return "";
}

std::string far_clock(const std::vector<Record>& records) {
  constexpr double far = 100;  // times as long as the record
  for (const Record& record : records)
    if (std::abs(record.start()) > far * record.duration())
      return "the time of " + record.name() + " begins at " + number(record.start(), 6) +
             " s, far from 0: effects of the time (stiffness_drift, damping_drift, crane_lowering, sensor_drift) are "
             "about t = 0, and drifts can hardly be told from k and c there. Subtract a time, the same in all files";
  return "";
}

/// "hold (a.csv), linear (b.csv)" of the files whose force varies, "hold" where all are read alike; what is held out of
/// a file goes with the rest.
std::string words_of_readings(const Study& study) {
  std::vector<std::string> kinds;
  std::vector<std::vector<std::string>> files;
  std::vector<std::string> seen;
  for (const auto* list : {&study.full, &study.test})
    for (const Record& record : *list) {
      if (std::ranges::find(seen, record.name()) != seen.end()) continue;
      if (std::ranges::none_of(study.forces, [&](const std::string& force) { return varies(record[force]); })) continue;
      seen.push_back(record.name());
      const std::string kind = to_string(fit_data(study, record).excitation.interpolation());
      append_new(kinds, kind);
      files.resize(kinds.size());
      files[static_cast<std::size_t>(std::ranges::find(kinds, kind) - kinds.begin())].push_back(record.name());
    }
  if (kinds.size() < 2) return joined(kinds);
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] += " (" + joined(files[i]) + ")";
  return joined(kinds);
}

std::string reading_of_force(const Study& study) {
  if (study.imposed)
    return "the motion is imposed: the force of the baseline along y, v and a is held against F, and gaps are of it";
  const std::string kinds = words_of_readings(study);
  if (kinds.empty()) return "";
  const std::string said = "between its rows the force is read as " + kinds;
  if (is_said(study)) return said + ", as was said";
  return said + ": by its rows, as a first guess; a run asks its models how it is best read" +
         (study.full.front().has(study.reference()) && kinds != "hold"
              ? "; where a digital controller puts it out, --interpolation hold says so"
              : "");
}

}  // namespace

std::string words_of_baseline(Model baseline, bool moves, const std::vector<Record>& train,
                              const std::vector<Record>& test) {
  const auto is_measured = [&](const std::string& force) {
    const auto holds = [&](const Record& record) { return record.has("F") || record.has(force); };
    return std::ranges::any_of(train, holds) || std::ranges::any_of(test, holds);
  };
  for (const std::string& input : baseline.inputs())
    if (moves && input[0] == 'F' && !is_measured(input)) baseline.acts.push_back({input, baseline.pool->constant(0)});
  std::string text = baseline.equation();
  for (const Parameter& p : baseline.parameters)
    text += "\n  " + p.words() + (p.fixed || std::isnan(p.value) ? "" : ": to fit, from there");
  return text;
}

std::vector<std::string> remarks(const Study& study, const std::vector<Record>& train,
                                 const std::vector<Record>& test) {
  check_excitation_of_linear(study, study.model);
  std::vector<Record> all = train;
  all.insert(all.end(), test.begin(), test.end());
  std::vector<std::string> out{without_unit(all),       unused_reference(study, all), unused_angle(all),
                               whose_force(study, all), unused_base(study),           unused_shaft(study),
                               far_clock(all),          reading_of_force(study),      of_noise};
  std::erase(out, "");
  return out;
}

}  // namespace lunid
