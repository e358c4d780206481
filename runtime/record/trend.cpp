// Trends and drift: polynomials, high passes, integrals.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "expr/joined.hpp"
#include "record/checks.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"
#include "record/polynomial_sum.hpp"
#include "record/treat_parts.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd without_polynomial(std::span<const double> x, int degree) {
  const auto n = static_cast<Index>(x.size());
  PolynomialSum sum(n, degree);
  sum.add_in_pieces(x);
  return Eigen::Map<const VectorXd>(x.data(), n) - sum.values(0, n);
}

std::string detrend_note(const std::vector<std::string>& channels, int degree) {
  return "detrend: " + joined(channels) + " less " +
         (degree == 0   ? "the mean"
          : degree == 1 ? "a line"
                        : "a polynomial of degree " + std::to_string(degree));
}

Record detrend(const Record& record, int degree, const std::vector<std::string>& channels) {
  const std::vector<std::string> names = names_or_all(record.channels(), channels, "detrend");
  Record result = record;
  for (const std::string& name : names)
    result = result.with(with_values(record, name, without_polynomial(numbers(record, name, "detrend"), degree)));
  result.note(detrend_note(names, degree));
  return result;
}

namespace {

/// Standard deviation of white noise of 1 after `times` integrations over dt, rid of drift.
double integrated_noise(const IntegrateOptions& options, int times, Index rows, double dt) {
  const double n = static_cast<double>(rows);
  if (options.below > 0) {
    const auto sections = butterworth(drift_band(options), drift_order, dt);
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

Band drift_band(const IntegrateOptions& options) { return {options.below, 0, false}; }

IntegrationPlan integration_plan(const std::vector<Channel>& channels, const IntegrateOptions& options) {
  const std::string where = "integrate";
  if (options.degree < 0 || options.degree > 10)
    refuse(where, "degree: expected 0 to 10, got " + std::to_string(options.degree));
  const auto measured = [&](const std::string& name) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const Channel& channel) { return channel.name == name && !channel.derived; });
  };
  IntegrationPlan plan{options.from, 0, ""};
  for (const char* name : {"v", "a"})
    if (plan.from.empty() && measured(name)) plan.from = name;
  if (plan.from.empty()) refuse(where, "expected a measured acceleration a or velocity v");
  const auto rank = std::string("yva").find(plan.from[0]);
  if (rank == std::string::npos || rank == 0)
    refuse(where, "from: expected an acceleration or a velocity, got '" + plan.from + "'");
  plan.rank = static_cast<int>(rank);
  plan.suffix = plan.from.substr(1);
  if (measured(plan.name(plan.rank - 1)) && (plan.rank == 1 || measured(plan.name(0))))
    refuse(where, "nothing to make: all that lies below '" + plan.from + "' was measured");
  return plan;
}

Channel integral_channel(const IntegrationPlan& plan, const Channel& source, const IntegrateOptions& options, int times,
                         Index rows, double dt) {
  Channel channel;
  channel.name = plan.name(plan.rank - times);
  channel.unit = motion_unit(source.unit, plan.rank - times);
  channel.noise = source.noise * integrated_noise(options, times, rows, dt);
  channel.derived = true;
  channel.derivation = "of " + plan.from + " by integration, less " +
                       (options.below > 0 ? "all below " + short_number(options.below) + " Hz"
                                          : "a polynomial of degree " + std::to_string(options.degree + times - 1));
  return channel;
}

Record integrate(const Record& record, const IntegrateOptions& options) {
  const IntegrationPlan plan = integration_plan(record.channels(), options);
  const std::span<const double> x = varying(record, plan.from, "integrate");
  Record result = record;
  VectorXd values = Eigen::Map<const VectorXd>(x.data(), record.rows());
  const auto whole = [&] { return std::span<const double>(values.data(), static_cast<std::size_t>(values.size())); };
  for (int times = 1; times <= plan.rank; ++times) {
    values = integrate(whole(), record.dt(), -1);
    values = options.below > 0 ? filter_zero_phase(whole(), drift_band(options), drift_order, record.dt())
                               : without_polynomial(whole(), options.degree + times - 1);
    Channel channel = integral_channel(plan, record.channel(plan.from), options, times, record.rows(), record.dt());
    if (record.has(channel.name) && !record.channel(channel.name).derived) continue;  // measured: stays
    channel.values = values;
    result.note("integrate: " + channel.name + " " + channel.derivation);
    result = result.with(std::move(channel));
  }
  return result;
}

}  // namespace lunid
