// Trends and drift: polynomials, high passes, integrals.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/checks.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"
#include "record/treat.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd without_polynomial(std::span<const double> x, int degree) {
  if (degree < 0 || degree > 12) refuse("detrend", "degree: expected 0 to 12, got " + std::to_string(degree));
  const auto n = static_cast<Index>(x.size());
  VectorXd rest = Eigen::Map<const VectorXd>(x.data(), n);
  const VectorXd position = VectorXd::LinSpaced(n, -1, 1);
  VectorXd before = VectorXd::Zero(n), now = VectorXd::Constant(n, 1 / std::sqrt(static_cast<double>(n)));
  for (int d = 0; d <= degree && d < n; ++d) {
    rest -= now * now.dot(rest);
    VectorXd next = position.cwiseProduct(now);  // the discrete orthogonal polynomials, one from the two before it
    next -= now * now.dot(next);
    next -= before * before.dot(next);
    const double size = next.norm();
    before = now;
    if (!(size > 1e-12)) break;
    now = next / size;
  }
  return rest;
}

Record detrend(const Record& record, int degree, const std::vector<std::string>& channels) {
  Record result = record;
  std::string names;
  for (const std::string& name : names_or_all(record, channels, "detrend")) {
    result = result.with(with_values(record, name, without_polynomial(numbers(record, name, "detrend"), degree)));
    names += (names.empty() ? "" : ", ") + name;
  }
  result.note("detrend: " + names + " less " +
              (degree == 0   ? "the mean"
               : degree == 1 ? "a line"
                             : "a polynomial of degree " + std::to_string(degree)));
  return result;
}

namespace {

constexpr int high_pass_order = 4;

/// Standard deviation of white noise of 1 after `times` integrations over dt, rid of drift.
double integrated_noise(const IntegrateOptions& options, int times, Index rows, double dt) {
  const double n = static_cast<double>(rows);
  if (options.below > 0) {
    const auto sections = butterworth({options.below, 0, false}, high_pass_order, dt);
    constexpr int points = 8192;
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double s = (i + 0.5) / points, f = 0.5 / dt * s * s * s;  // denser towards 0, where the power is
      const double gain =
          std::pow(amplitude_at(sections, f, dt), 2 * times) / std::pow(2 * std::numbers::pi * f, times);
      sum += gain * gain * 3 * s * s / points;
    }
    return std::sqrt(sum);
  }
  // The mean over time of the variance left of a Brownian motion on [0, 1] (1/15 without its line), and of its integral
  // (1/2620 without its parabola, by simulation); both for the degrees by default, larger for less.
  return times == 1 ? dt * std::sqrt(n / 15) : dt * dt * n * std::sqrt(n / 2620);
}

}  // namespace

Record integrate(const Record& record, const IntegrateOptions& options) {
  const std::string where = "integrate";
  if (options.degree < 0 || options.degree > 10)
    refuse(where, "degree: expected 0 to 10, got " + std::to_string(options.degree));
  std::string from = options.from;
  for (const char* name : {"v", "a"})
    if (from.empty() && record.has(name) && !record.channel(name).derived) from = name;
  if (from.empty()) refuse(where, "expected a measured acceleration a or velocity v");
  const auto rank = std::string("yva").find(from[0]);
  if (rank == std::string::npos || rank == 0)
    refuse(where, "from: expected an acceleration or a velocity, got '" + from + "'");
  const std::span<const double> x = varying(record, from, where);
  const Channel& source = record.channel(from);
  Record result = record;
  VectorXd values = Eigen::Map<const VectorXd>(x.data(), record.rows());
  std::string names;
  for (int r = static_cast<int>(rank) - 1, times = 1; r >= 0; --r, ++times) {
    const std::string name = std::string(1, "yva"[r]) + from.substr(1);
    const std::span<const double> whole(values.data(), static_cast<std::size_t>(values.size()));
    values = integrate(whole, record.dt(), -1);
    values = options.below > 0 ? filter_zero_phase({values.data(), whole.size()}, {options.below, 0, false},
                                                   high_pass_order, record.dt())
                               : without_polynomial({values.data(), whole.size()}, options.degree + times - 1);
    if (record.has(name) && !record.channel(name).derived) continue;  // measured: stays
    Channel channel;
    channel.name = name;
    channel.unit = motion_unit(source.unit, r);
    channel.values = values;
    channel.noise = source.noise * integrated_noise(options, times, record.rows(), record.dt());
    channel.derived = true;
    channel.derivation = "of " + from + " by integration, less " +
                         (options.below > 0 ? "all below " + short_number(options.below) + " Hz"
                                            : "a polynomial of degree " + std::to_string(options.degree + times - 1));
    names += (names.empty() ? "" : ", ") + name;
    result = result.with(std::move(channel));
    result.note("integrate: " + name + " " + result.channel(name).derivation);
  }
  if (names.empty()) refuse(where, "nothing to make: all that lies below '" + from + "' was measured");
  return result;
}

}  // namespace lunid
