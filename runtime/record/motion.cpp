// Velocity and acceleration where they were not measured, and displacement where only its derivatives were.
#include <algorithm>
#include <cmath>

#include "record/motion.hpp"
#include "record/record.hpp"
#include "record/savitzky_golay.hpp"
#include "record/spectrum.hpp"

namespace lunid {

std::string motion_unit(const std::string& from, int rank) {
  const std::string base = from.substr(0, from.find('/'));
  if (base != "m" && base != "rad") return "";
  return rank == 0 ? base : rank == 1 ? base + "/s" : base + "/s^2";
}

std::vector<std::string> coordinates(const Record& record) {
  std::vector<std::string> found;
  for (const Channel& channel : record.channels()) {
    if (channel.name.find_first_of("yva") != 0) continue;
    const std::string suffix = channel.name.substr(1);
    const bool number = suffix.find_first_not_of("0123456789") == std::string::npos && suffix[0] != '0';
    if ((number || suffix == "b") && std::find(found.begin(), found.end(), suffix) == found.end())
      found.push_back(suffix);
  }
  return found;
}

Eigen::VectorXd continued_integral(double start, const Eigen::VectorXd& x, Eigen::Index low, Eigen::Index first,
                                   Eigen::Index count, Eigen::Index rows, double dt) {
  Eigen::VectorXd sum(count);
  sum[0] = start;
  for (Eigen::Index k = 0; k + 1 < count; ++k) {
    const Eigen::Index row = first + k, i = row - low;
    const bool inside = row > 0 && row + 2 < rows;
    const double mean = inside ? (-x[i - 1] + 13 * x[i] + 13 * x[i + 1] - x[i + 2]) / 24 : (x[i] + x[i + 1]) / 2;
    sum[k + 1] = sum[k] + dt * mean;
  }
  return sum;
}

Eigen::VectorXd integrate(std::span<const double> x, double dt, int degree) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::VectorXd sum = continued_integral(0, Eigen::Map<const Eigen::VectorXd>(x.data(), n), 0, 0, n, n, dt);
  return degree < 0 ? sum : detrend({sum.data(), x.size()}, degree);
}

Channel at_rest(Channel channel, const std::string& from, Eigen::Index rows) {
  channel.values = Eigen::VectorXd::Zero(rows);
  channel.derived = true;
  channel.derivation = "of " + from + ", which is constant";
  return channel;
}

namespace {

/// The smoothed derivative of a channel, with the noise that the filter lets through.
Channel differentiate(const Record& record, const std::string& from, const std::string& name, int derivative,
                      int rank) {
  const Channel& source = record.channel(from);
  const std::span<const double> x = record[from];
  Channel channel;
  channel.name = name;
  channel.unit = motion_unit(source.unit, rank);
  if (std::all_of(x.begin(), x.end(), [&](double value) { return value == x[0]; }))
    return at_rest(channel, from, record.rows());
  const SavitzkyGolay filter = choose_savitzky_golay(x, source.noise, derivative);
  channel.values = savitzky_golay(x, record.dt(), derivative, filter);
  channel.noise = source.noise * savitzky_golay_noise(record.dt(), derivative, filter);
  channel.derived = true;
  channel.derivation = "of " + from + " by Savitzky-Golay of order " + std::to_string(filter.order) + " over " +
                       std::to_string(2 * filter.half_width + 1) + " rows";
  return channel;
}

/// The integral of a channel. Integrated white noise is a random walk; rid of its line it has the mean
/// variance noise^2 dt^2 n / 15 (of a Brownian motion on [0, 1]: 1/6 about its mean, less 1/10 in its slope).
Channel integral(const Record& record, const std::string& from, const std::string& name, int degree, int rank) {
  const Channel& source = record.channel(from);
  Channel channel;
  channel.name = name;
  channel.unit = motion_unit(source.unit, rank);
  channel.values = integrate(record[from], record.dt(), degree);
  channel.noise = source.noise * record.dt() * std::sqrt(static_cast<double>(record.rows()) / 15);
  channel.derived = true;
  channel.derivation = "of " + from + " by integration, less a polynomial of degree " + std::to_string(degree);
  return channel;
}

Record derive_coordinate(Record result, const std::string& suffix) {
  const std::string y = "y" + suffix, v = "v" + suffix, a = "a" + suffix;
  const bool has_y = result.has(y), has_v = result.has(v), has_a = result.has(a);
  if (!has_v) result = result.with(has_y ? differentiate(result, y, v, 1, 1) : integral(result, a, v, 1, 1));
  // Twice integrated, an offset of the accelerometer is a parabola.
  if (!has_y) result = result.with(integral(result, v, y, has_v ? 1 : 2, 0));
  if (!has_a) result = result.with(has_v ? differentiate(result, v, a, 1, 2) : differentiate(result, y, a, 2, 2));
  return result;
}

}  // namespace

Record derive_motion(const Record& record) {
  const std::vector<std::string> all = coordinates(record);
  if (all.empty())
    throw InputError("expected a displacement y, a velocity v or an acceleration a to derive the motion from",
                     {record.name()}, Fault::data);
  check_rows(record.rows(), record.name());
  Record result = record;
  for (const std::string& suffix : all) result = derive_coordinate(std::move(result), suffix);
  return result;
}

Record derive_motion_anew(const Record& record) {
  std::vector<Channel> measured;
  for (const Channel& channel : record.channels()) {
    if (channel.derived) continue;
    const std::span<const double> rows = record[channel.name];
    measured.push_back(channel);
    measured.back().values = Eigen::Map<const Eigen::VectorXd>(rows.data(), record.rows());
  }
  const Record again = derive_motion(Record(record.name(), record.start(), record.dt(), std::move(measured)));
  Record result = record;
  for (const Channel& channel : record.channels())
    if (channel.derived && again.has(channel.name)) result = result.with(again.channel(channel.name));
  return result;
}

std::string measured_channel(const Record& record, const std::string& suffix) {
  for (const char* quantity : {"y", "v", "a"})
    if (record.has(quantity + suffix) && !record.channel(quantity + suffix).derived) return quantity + suffix;
  return "y" + suffix;
}

bool has_motion(const Record& record) { return !coordinates(record).empty(); }

}  // namespace lunid
