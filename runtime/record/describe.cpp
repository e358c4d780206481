// A record in words.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "record/columns.hpp"
#include "record/method_parts.hpp"
#include "record/spectra.hpp"

namespace lunid {

using Eigen::Index;

ChannelSummary summary(std::span<const double> x) {
  ChannelSummary s;
  s.least = INFINITY, s.most = -INFINITY;
  double count = 0, sum = 0, square = 0;
  Index run = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    run = i > 0 && x[i] == x[i - 1] ? run + 1 : 0;
    s.held = std::max(s.held, run);
    if (!std::isfinite(x[i])) {
      ++s.missing;
      continue;
    }
    s.least = std::min(s.least, x[i]);
    s.most = std::max(s.most, x[i]);
    sum += x[i];
    ++count;
  }
  if (count == 0) {
    s.least = s.most = s.mean = s.std = NAN;
    return s;
  }
  s.mean = sum / count;
  for (const double value : x)
    if (std::isfinite(value)) square += (value - s.mean) * (value - s.mean);
  s.std = std::sqrt(square / count);
  return s;
}

namespace {

/// Where a column of the file stands under another name or in another unit; else empty.
std::string words_of_source(const Channel& channel) {
  if (channel.derived || channel.source.empty()) return "";
  const HeaderCell header = split_header(channel.source);
  const std::string& unit = channel.source_unit;
  if (header.name == channel.name && (unit.empty() || unit == channel.unit)) return "";
  return "; from '" + channel.source + "'" + (unit == header.unit ? "" : " [" + unit + "]");
}

/// Takes the jumps from turn to turn out of the angle of a shaft; false where there are none.
bool unwrapped(const std::string& name, Eigen::VectorXd& x) {
  if (std::ranges::find(shaft_angles, name) == shaft_angles.end() || !x.allFinite()) return false;
  const double last = x[x.size() - 1];
  unwrap(x);
  return x[x.size() - 1] != last;
}

bool is_measured_motion(const Channel& channel) {
  const std::string& name = channel.name;
  return !channel.derived && std::string_view("yva").find(name[0]) != name.npos &&
         name.find_first_not_of("0123456789", 1) == name.npos;
}

/// Rows on end at the least and the greatest value of a signal.
struct FlatTops {
  int places = 0;
  Index shortest = 0, longest = 0, rows = 0;

  /// A motion that was made to go from one level to the other: all rows are at one, or it stays as long each time.
  bool by_design(Index all) const {
    constexpr double some = 0.3, nearly_all = 0.9;
    const double part = static_cast<double>(rows) / static_cast<double>(all);
    return part > nearly_all || (part > some && longest <= shortest + 1);
  }
};

/// Those that a clipped sensor has: the rows before and after are some steps away. A peak that is flat since the signal
/// is written in coarse steps, or since a thing sticks there, is left by one step.
FlatTops flat_tops(std::span<const double> x, const ChannelSummary& s, double step) {
  constexpr std::size_t fewest = 3;
  FlatTops out;
  for (std::size_t first = 0, end = 0; first < x.size(); first = end) {
    for (end = first + 1; end < x.size() && x[end] == x[first];) ++end;
    if ((x[first] != s.least && x[first] != s.most) || end - first < fewest || first == 0 || end == x.size()) continue;
    if (std::min(std::abs(x[first - 1] - x[first]), std::abs(x[end] - x[first])) <= 2 * step) continue;
    const auto rows = static_cast<Index>(end - first);
    out.shortest = out.places++ > 0 ? std::min(out.shortest, rows) : rows;
    out.longest = std::max(out.longest, rows);
    out.rows += rows;
  }
  return out;
}

/// ", up to 8 equal rows on end", and whether a clipped sensor made them.
std::string words_of_equal_rows(const Record& record, const Channel& channel, const ChannelSummary& s, double step) {
  const auto words = [](Index rows) { return ", up to " + std::to_string(rows) + " equal rows on end"; };
  if (is_measured_motion(channel)) {
    const FlatTops flat = flat_tops(record[channel.name], s, step);
    if (flat.places > 1 && !flat.by_design(record.rows()))
      return words(flat.longest) + " at its extremes, " + std::to_string(flat.places) + " times: clipped?";
  }
  return s.held >= 4 && s.held + 1 < record.rows() ? words(s.held + 1) : "";
}

std::string channel_line(const Record& record, const Channel& channel) {
  Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(record[channel.name].data(), record.rows());
  const bool wraps = unwrapped(channel.name, x);
  const std::span<const double> rows(x.data(), static_cast<std::size_t>(x.size()));
  const ChannelSummary s = summary(rows);
  const double noise = wraps ? noise_level(rows) : channel.noise;
  std::string line = "  " + channel.name + std::string(channel.name.size() < 3 ? 3 - channel.name.size() : 1, ' ');
  line += short_number(s.least) + " to " + short_number(s.most) + (channel.unit.empty() ? "" : " " + channel.unit);
  if (wraps) line += ", wraps, " + short_number((s.most - s.least) / (2 * std::numbers::pi)) + " turns";
  line += ", deviation " + short_number(s.std);
  if (noise > 0 && s.std > 0) {
    line += ", noise " + short_number(noise);
    char part[32];
    std::snprintf(part, sizeof part, " (%.2g %%)", 100 * noise / s.std);
    line += part;
  }
  if (s.missing > 0) line += ", " + std::to_string(s.missing) + (s.missing == 1 ? " row is" : " rows are") + " missing";
  constexpr double visible = 0.02;  // of the deviation; all that is written with some digits has a step
  const double step = channel.derived ? 0 : quantisation_step(record[channel.name]);
  if (step > visible * s.std)
    line += ", in steps of " + short_number(step) + (channel.unit.empty() ? "" : " " + channel.unit);
  line += words_of_equal_rows(record, channel, s, step);
  line += words_of_source(channel);
  if (!channel.derivation.empty()) line += "; " + channel.derivation;
  return line;
}

}  // namespace

std::string describe(const Record& record) {
  char head[160];
  std::string names;
  for (const Channel& channel : record.channels()) names += " " + channel.name + (channel.derived ? "*" : "");
  std::snprintf(head, sizeof head, ": %lld rows, %.6g s at %.6g Hz; channels", static_cast<long long>(record.rows()),
                record.duration(), 1 / record.dt());
  std::string text = "record " + record.name() + record.words_of_part() + head + names;
  for (const Channel& channel : record.channels()) text += "\n" + channel_line(record, channel);
  for (const std::string& done : record.history()) text += "\n  " + done;
  for (const std::string& warning : record.warnings()) text += "\n  warning: " + warning;
  return text;
}

}  // namespace lunid
