#include "record/checks.hpp"

#include <algorithm>
#include <cmath>

#include "expr/joined.hpp"
#include "record/method_parts.hpp"

namespace lunid {

namespace {

/// Throws InputError where no channel has that name.
void need(const std::vector<Channel>& channels, std::string_view channel, std::string_view where) {
  std::vector<std::string> names;
  for (const Channel& each : channels) names.push_back(each.name);
  if (std::find(names.begin(), names.end(), channel) != names.end()) return;
  const std::string near = nearest_word(std::string(channel), names);
  refuse(std::string(where), "the record has no channel '" + std::string(channel) + "'" +
                                 (near.empty() ? " (it has " + joined(names) + ")" : did_you_mean(near)));
}

}  // namespace

std::span<const double> numbers(const Record& record, std::string_view channel, std::string_view where,
                                Eigen::Index rows) {
  const std::string at(where);
  need(record.channels(), channel, where);
  const std::span<const double> x = record[channel];
  if (record.rows() < rows)
    refuse(at, "expected at least " + std::to_string(rows) + " rows, got " + std::to_string(record.rows()));
  const auto bad = std::find_if(x.begin(), x.end(), [](double value) { return !std::isfinite(value); });
  if (bad == x.end()) return x;
  const auto count = std::count_if(x.begin(), x.end(), [](double value) { return !std::isfinite(value); });
  refuse(at, "channel '" + std::string(channel) +
                 "' is not a number at t = " + short_number(record.time(bad - x.begin())) + " s (" +
                 std::to_string(count) + (count == 1 ? " row" : " rows") + " of " + std::to_string(record.rows()) +
                 "); cut the record there with record:window");
}

std::span<const double> varying(const Record& record, std::string_view channel, std::string_view where,
                                Eigen::Index rows) {
  const std::span<const double> x = numbers(record, channel, where, rows);
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  if (*low == *high)
    refuse(std::string(where),
           "channel '" + std::string(channel) + "' is constant, " + short_number(*low) + ": there is no motion in it");
  return x;
}

std::vector<std::string> names_or_all(const std::vector<Channel>& channels, const std::vector<std::string>& names,
                                      std::string_view where) {
  std::vector<std::string> all;
  for (const Channel& channel : channels) all.push_back(channel.name);
  for (const std::string& name : names) need(channels, name, where);
  return names.empty() ? all : names;
}

Record remade(const Record& record, double t0, double dt, std::vector<Channel> channels) {
  Record result(record.name(), t0, dt, std::move(channels));
  result.take_notes(record);
  return result;
}

Channel with_values(const Record& record, std::string_view channel, Eigen::VectorXd values) {
  const Channel& old = record.channel(channel);
  Channel result{old.name,    old.unit,    old.source, old.source_unit, std::move(values), old.noise,
                 old.derived, old.between, {},         old.derivation};
  return result;
}

}  // namespace lunid
