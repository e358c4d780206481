#include "record/derive.hpp"

#include <algorithm>
#include <cmath>

#include "expr/joined.hpp"
#include "record/checks.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"

namespace lunid {
namespace {

constexpr const char* where = "derive";

bool measured(const Record& record, const std::string& name) {
  return record.has(name) && !record.channel(name).derived;
}

/// 0 y, 1 v, 2 a; -1 for another channel.
int rank_of(const std::string& name) {
  const auto at = std::string("yva").find(name.empty() ? ' ' : name[0]);
  return at == std::string::npos ? -1 : static_cast<int>(at);
}

std::string name_at(int rank, const std::string& suffix) { return std::string(1, "yva"[rank]) + suffix; }

Channel made(const Record& record, const std::string& name, const std::string& from, Derivative derivative) {
  Channel channel;
  channel.name = name;
  channel.unit = motion_unit(record.channel(from).unit, rank_of(name));
  channel.values = std::move(derivative.values);
  channel.noise = derivative.noise;
  channel.derived = name != from;
  channel.derivation = (name == from ? "smoothed by " : "of " + from + " by ") + derivative.how;
  return channel;
}

/// The channels of one coordinate that are to be made, in the order y v a.
std::vector<int> ranks_to_make(const Record& record, const DeriveOptions& options, const std::string& suffix) {
  std::vector<int> ranks;
  int lowest = 3;
  for (int rank = 2; rank >= 0; --rank)
    if (measured(record, name_at(rank, suffix))) lowest = rank;
  for (int rank = 0; rank < 3; ++rank) {
    const std::string name = name_at(rank, suffix);
    const bool asked = std::find(options.channels.begin(), options.channels.end(), name) != options.channels.end();
    const bool wanted = options.channels.empty() ? !measured(record, name) || options.smooth : asked;
    if (!wanted) continue;
    if (rank >= lowest) {
      ranks.push_back(rank);
    } else if (asked) {
      refuse(where, "channel '" + name + "' cannot be derived: " +
                        (lowest < 3 ? "only '" + name_at(lowest, suffix) + "' was measured; use record:integrate"
                                    : "neither y" + suffix + " nor v" + suffix + " was measured"));
    }
  }
  return ranks;
}

/// The measured channel that the one of this rank is made from.
std::string source_of(const Record& record, const DeriveOptions& options, const std::string& suffix, int rank) {
  if (!options.from.empty()) return options.from;
  const int highest = options.smooth || !measured(record, name_at(rank, suffix)) ? rank : rank - 1;
  for (int from = highest; from >= 0; --from)
    if (measured(record, name_at(from, suffix))) return name_at(from, suffix);
  refuse(where, "channel '" + name_at(rank, suffix) +
                    "' is measured and there is none below it to derive it from; "
                    "set smooth = true to smooth it");
}

std::vector<Measurement> measurements(const Record& record, const std::string& from, const std::string& suffix) {
  std::vector<Measurement> list;
  for (int rank = 0; rank < 3; ++rank) {
    const std::string name = name_at(rank, suffix);
    if (from.empty() ? measured(record, name) : name == from)
      list.push_back({rank, varying(record, name, where), record.channel(name).noise});
  }
  return list;
}

Record derive_jointly(Record record, const DeriveOptions& options, const KalmanSmoother& kalman,
                      const std::string& suffix, const std::vector<int>& ranks) {
  const std::vector<Measurement> given = measurements(record, options.from, suffix);
  const SmoothedMotion motion = kalman_smoother(given, record.dt(), kalman);
  const std::string sources = joined(given, [&](const Measurement& m) { return name_at(m.rank, suffix); });
  std::vector<Channel> channels;
  for (const int rank : ranks) {
    const Eigen::Index column = rank - motion.lowest;
    const std::string from = name_at(given.front().rank, suffix);
    Channel channel = made(record, name_at(rank, suffix), from,
                           {motion.values.col(column), std::sqrt(motion.std.col(column).array().square().mean()), ""});
    channel.derived = !measured(record, channel.name);
    channel.derivation = "of " + sources + " by " + kalman_words(kalman, motion);
    channels.push_back(std::move(channel));
  }
  for (Channel& channel : channels) record = record.with(std::move(channel));
  return record;
}

Record derive_singly(const Record& record, const DeriveOptions& options, const std::string& suffix,
                     const std::vector<int>& ranks) {
  Record result = record;
  for (const int rank : ranks) {
    const std::string from = source_of(record, options, suffix, rank);
    if (rank_of(from) > rank || rank_of(from) < 0)
      refuse(where, "from: '" + from + "' is no displacement or velocity below '" + name_at(rank, suffix) + "'");
    result = result.with(made(record, name_at(rank, suffix), from,
                              differentiate(varying(record, from, where), record.dt(), record.channel(from).noise,
                                            rank - rank_of(from), options.method)));
  }
  return result;
}

}  // namespace

Derivative differentiate(std::span<const double> x, double dt, double noise, int derivative,
                         const DerivativeMethod& method) {
  if (derivative < 0 || derivative > 2)
    refuse("differentiate", "derivative: expected 0 to 2, got " + std::to_string(derivative));
  if (x.size() < 6) refuse(name_of(method), "expected at least 6 rows, got " + std::to_string(x.size()));
  return std::visit([&](const auto& m) { return differentiate_by(m, x, dt, noise, derivative); }, method);
}

std::string name_of(const DerivativeMethod& method) {
  static constexpr const char* names[] = {"finite_differences", "savitzky_golay",       "fourier", "spline",
                                          "total_variation",    "smoothed_differences", "kalman"};
  return names[method.index()];
}

Record derive(const Record& record, const DeriveOptions& options) {
  if (!options.from.empty()) numbers(record, options.from, where);
  std::vector<std::string> all = coordinates(record);
  for (const std::string& name : options.channels) {
    const std::string suffix = name.substr(std::min<std::size_t>(1, name.size()));
    if (rank_of(name) < 0 || std::find(all.begin(), all.end(), suffix) == all.end())
      refuse(where, "channels: expected v, a or those of a coordinate of the record, got '" + name + "'");
  }
  Record result = record;
  for (const std::string& suffix : all) {
    if (!options.from.empty() && options.from.substr(1) != suffix) continue;
    const std::vector<int> ranks = ranks_to_make(record, options, suffix);
    if (ranks.empty()) continue;
    const auto* kalman = std::get_if<KalmanSmoother>(&options.method);
    result = kalman ? derive_jointly(result, options, *kalman, suffix, ranks)
                    : derive_singly(result, options, suffix, ranks);
    std::string text = "derive:";
    for (const int rank : ranks) text += (rank == ranks.front() ? " " : ", ") + name_at(rank, suffix);
    result.note(text + " " + result.channel(name_at(ranks.back(), suffix)).derivation);
  }
  if (all.empty()) refuse(where, "expected a displacement y or a velocity v to derive the motion from");
  return result;
}

}  // namespace lunid
