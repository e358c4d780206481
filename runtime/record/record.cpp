#include "record/record.hpp"

#include "expr/joined.hpp"
#include "record/checks.hpp"

#include <cmath>
#include <set>
#include <sstream>

namespace lunid {
namespace {

std::string names_of(const std::vector<Channel>& channels) {
  const std::string text = joined(channels, &Channel::name);
  return text.empty() ? "none" : text;
}

}  // namespace

void check_rows(Eigen::Index rows, const std::string& name) {
  if (rows < least_rows)
    throw InputError("expected at least " + std::to_string(least_rows) + " rows, got " + std::to_string(rows), {name},
                     Fault::data);
}

std::string to_string(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::hold: return "hold";
    case Interpolation::linear: return "linear";
    case Interpolation::cubic: return "cubic";
    case Interpolation::band_limited: return "band_limited";
  }
  return "";
}

Interpolation interpolation_named(std::string_view word) {
  for (const Interpolation each : every_interpolation)
    if (word == to_string(each)) return each;
  throw InputError("expected hold, linear, cubic or band_limited, got '" + std::string(word) + "'");
}

Record::Record(std::string name, double t0, double dt, std::vector<Channel> channels)
    : name_(std::move(name)), t0_(t0), dt_(dt) {
  if (!std::isfinite(t0) || !std::isfinite(dt) || dt <= 0)
    throw InputError("record: expected a finite start and a time step > 0", {name_}, Fault::data);
  if (channels.empty() || channels.front().values.size() == 0)
    throw InputError("record: expected at least one row", {name_}, Fault::data);
  count_ = channels.front().values.size();
  std::set<std::string> seen;
  for (const Channel& channel : channels) {
    if (channel.values.size() != count_)
      throw InputError("record: channel '" + channel.name + "' has " + std::to_string(channel.values.size()) +
                           " rows, channel '" + channels.front().name + "' has " + std::to_string(count_),
                       {name_}, Fault::data);
    if (!seen.insert(channel.name).second)
      throw InputError("record: two channels are named '" + channel.name + "'", {name_}, Fault::data);
  }
  channels_ = std::make_shared<const std::vector<Channel>>(std::move(channels));
}

bool Record::has(std::string_view channel) const {
  if (!channels_) return false;
  for (const Channel& candidate : *channels_)
    if (candidate.name == channel) return true;
  return false;
}

const Channel& Record::channel(std::string_view channel) const {
  static const std::vector<Channel> none;
  const std::vector<Channel>& channels = channels_ ? *channels_ : none;
  for (const Channel& candidate : channels)
    if (candidate.name == channel) return candidate;
  throw InputError("no channel '" + std::string(channel) + "': the record has " + names_of(channels), {name_},
                   Fault::data);
}

std::span<const double> Record::operator[](std::string_view channel) const {
  return {this->channel(channel).values.data() + first_, static_cast<std::size_t>(count_)};
}

Record Record::slice(Eigen::Index first, Eigen::Index count) const {
  if (first < 0 || count < 1 || first + count > count_)
    throw InputError("slice: rows " + std::to_string(first + 1) + " to " + std::to_string(first + count) +
                         " are outside the record, which has " + std::to_string(count_) + " rows",
                     {name_}, Fault::data);
  Record part = *this;
  part.first_ = first_ + first;
  part.count_ = count;
  return part;
}

std::pair<Eigen::Index, Eigen::Index> rows_of_window(const std::string& name, double start, double dt,
                                                     Eigen::Index rows, double from, double to) {
  // A time that is meant as a row's must find it in spite of rounding: a part in a million of a step is
  // forgiven.
  const double slack = 1e-6, end = static_cast<double>(rows - 1);
  const double low = std::ceil((from - start) / dt - slack), high = std::floor((to - start) / dt + slack);
  const double first = std::max(low, 0.0), last = std::min(high, end);
  if (!(last - first + 1 >= static_cast<double>(least_rows))) {
    std::ostringstream text;
    text << "window " << from << " to " << to << " s: expected at least " << least_rows
         << " rows, the record has t = " << start << " to " << start + dt * end << " s in steps of " << dt << " s";
    throw InputError(text.str(), {name}, Fault::data);
  }
  return {static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first) + 1};
}

Record Record::window(double from, double to) const {
  const auto [first, count] = rows_of_window(name_, start(), dt_, count_, from, to);
  return slice(first, count);
}

Record Record::with(Channel channel) const {
  std::vector<Channel> channels;
  bool replaced = false;
  for (const Channel& old : *channels_) {
    if (old.name == channel.name) {
      channels.push_back(channel);
      replaced = true;
    } else {
      channels.push_back(old);
      channels.back().values = old.values.segment(first_, count_).eval();
    }
  }
  if (!replaced) channels.push_back(std::move(channel));
  Record result(name_, start(), dt_, std::move(channels));
  result.take_notes(*this);
  result.gaps_ = gaps_;
  return result;
}

void Record::take_notes(const Record& from) {
  warnings_ = from.warnings_;
  history_ = from.history_;
  part_ = from.part_;
  parts_ = from.parts_;
  time_without_unit_ = from.time_without_unit_;
}

std::string Record::words_of_part() const {
  if (part_ == 0) return "";
  std::ostringstream text;
  text << ", part " << part_ << " of " << parts_ << ", from t = " << start() << " s";
  return text.str();
}

std::vector<Record> Record::pieces(Eigen::Index least) const {
  const double end = start() + duration(), slack = 1e-6 * dt_;
  std::vector<std::pair<double, double>> parts;
  double from = start();
  for (const auto& [before, after] : gaps_) {
    if (after <= from || before >= end) continue;
    parts.push_back({from, before});
    from = after;
  }
  if (parts.empty()) return {*this};
  parts.push_back({from, end});
  std::vector<Record> out;
  Eigen::Index left_out = 0;
  for (const auto& [first, last] : parts) {
    const auto rows = static_cast<Eigen::Index>(std::floor((last - first + slack) / dt_)) + 1;
    if (rows < least)
      left_out += std::max<Eigen::Index>(0, rows);
    else
      out.push_back(window(first, last));
    if (out.size() > 1) out.back().warnings_.clear();  // said once
  }
  if (out.empty())
    throw InputError("gaps leave no part of " + std::to_string(least) + " rows and more", {name_}, Fault::data);
  for (std::size_t i = 0; out.size() > 1 && i < out.size(); ++i) {
    out[i].part_ = static_cast<int>(i) + 1;
    out[i].parts_ = static_cast<int>(out.size());
  }
  if (left_out > 0)
    out.front().warn(std::to_string(left_out) + " rows in parts of fewer than " + std::to_string(least) +
                     " rows between gaps are left out");
  return out;
}

}  // namespace lunid
