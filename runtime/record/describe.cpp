// A record in words.
#include <algorithm>
#include <cmath>
#include <cstdio>

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

std::string channel_line(const Record& record, const Channel& channel) {
  const ChannelSummary s = summary(record[channel.name]);
  std::string line = "  " + channel.name + std::string(channel.name.size() < 3 ? 3 - channel.name.size() : 1, ' ');
  line += short_number(s.least) + " to " + short_number(s.most) + (channel.unit.empty() ? "" : " " + channel.unit) +
          ", deviation " + short_number(s.std);
  if (channel.noise > 0 && s.std > 0) {
    line += ", noise " + short_number(channel.noise);
    char part[32];
    std::snprintf(part, sizeof part, " (%.2g %%)", 100 * channel.noise / s.std);
    line += part;
  }
  if (s.missing > 0) line += ", " + std::to_string(s.missing) + (s.missing == 1 ? " row is" : " rows are") + " missing";
  constexpr double visible = 0.02;  // of the deviation; all that is written with some digits has a step
  const double step = channel.derived ? 0 : quantisation_step(record[channel.name]);
  if (step > visible * s.std)
    line += ", in steps of " + short_number(step) + (channel.unit.empty() ? "" : " " + channel.unit);
  if (s.held >= 4 && s.held + 1 < record.rows()) line += ", up to " + std::to_string(s.held + 1) + " equal rows on end";
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
