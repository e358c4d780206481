#include "discover/remarks.hpp"

#include <algorithm>
#include <cctype>

#include "discover/between_samples.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "expr/words.hpp"

namespace lunid {

namespace {

bool varies(std::span<const double> x) {
  return std::ranges::any_of(x, [&](double value) { return value != x[0]; });
}

void append_new(std::vector<std::string>& list, const std::string& text) {
  if (std::ranges::find(list, text) == list.end()) list.push_back(text);
}

/// Channels of the language whose columns have no unit; a constant such as F=0 needs none.
std::string without_unit(const std::vector<Record>& records) {
  std::vector<std::string> names;
  for (const Record& record : records)
    for (const Channel& channel : record.channels())
      if (!channel.derived && channel.source_unit.empty() && is_channel_name(channel.name) &&
          varies(record[channel.name]))
        append_new(names, channel.name);
  if (names.empty()) return "";
  return "no unit is given for " + joined(names) + ": SI is taken";
}

/// A set point that stands under its own name alone.
std::string unused_reference(const Study& study, const std::vector<Record>& records) {
  for (const Record& record : records)
    for (const Channel& channel : record.channels()) {
      std::string word = channel.name;
      std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
      for (const char* known : {"setpoint", "set_point", "set point", "reference", "command", "target"})
        if (word == known && !record.has(study.reference()))
          return "nothing uses the channel '" + channel.name + "'; where it is what a controller was to follow, say " +
                 study.reference() + "=" + channel.name;
    }
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
  const std::string kinds = study.imposed ? "" : words_of_readings(study);
  if (kinds.empty()) return "";
  return "between its rows the force is read as " + kinds +
         (is_said(study) ? ", as was said" : ": by its rows; discovery asks the models too");
}

}  // namespace

std::vector<std::string> remarks(const Study& study, const std::vector<Record>& train,
                                 const std::vector<Record>& test) {
  std::vector<Record> all = train;
  all.insert(all.end(), test.begin(), test.end());
  std::vector<std::string> out{without_unit(all), unused_reference(study, all), far_clock(all),
                               reading_of_force(study)};
  std::erase(out, "");
  return out;
}

}  // namespace lunid
