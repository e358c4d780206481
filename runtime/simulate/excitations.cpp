// What drives a model: the channels of a record or of a study, in the order of the system's inputs, delayed where the
// model says so.
#include <algorithm>
#include <cmath>
#include <optional>

#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "simulate/run.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

using Eigen::Index;

namespace {

constexpr const char* force_rate = "force_rate";

}  // namespace

TimeFunction function_of_time(TimeTape tape, std::vector<double> q, int output) {
  const auto at = static_cast<std::size_t>(output);
  TimeFunction f = [tape, q, at](std::span<const double> t, std::span<double> out) {
    const Tape& direct = tape.direct();
    std::vector<double> in(1 + q.size()), scratch(static_cast<std::size_t>(direct.registers() + 1));
    std::vector<double> values(static_cast<std::size_t>(direct.outputs()));
    std::copy(q.begin(), q.end(), in.begin() + 1);
    for (std::size_t i = 0; i < t.size(); ++i) {
      in[0] = t[i];
      direct.run_point(in.data(), values.data(), scratch.data());
      out[i] = values[at];
    }
  };
  f.grid = [tape, q, at](double t0, double dt, double place, std::span<double> out) {
    std::vector<std::vector<double>> others(static_cast<std::size_t>(tape.outputs()) - 1,
                                            std::vector<double>(out.size()));
    std::vector<double*> to;
    for (auto& column : others) to.push_back(column.data());
    to.insert(to.begin() + static_cast<std::ptrdiff_t>(at), out.data());
    tape.fill(t0, dt, place, q, static_cast<Index>(out.size()), to);
  };
  return f;
}

TimeFunction function_of_time(Expr formula) {
  const Expr inputs[] = {formula.pool().channel("t")};
  return function_of_time(TimeTape(std::span<const Expr>(&formula, 1), inputs), {}, 0);
}

Excitation excitation_of(const Record& record, std::optional<Interpolation> interpolation, std::string_view name) {
  const Channel& channel = record.channel(name);
  const std::span<const double> force = record[name];
  if (interpolation || !channel.formula.valid())
    return Excitation(record.start(), record.dt(), force, interpolation.value_or(channel.between));
  return Excitation(record.start(), record.dt(), force, channel.between, function_of_time(channel.formula));
}

Excitations& Excitations::offer(const std::string& channel, Excitation signal) {
  add(channel, std::move(signal));
  offered_.push_back(channel);
  return *this;
}

Excitations& Excitations::add(const std::string& channel, Excitation signal) {
  const auto refuse = [&](const std::string& what) { throw InputError("excitation: " + channel + ": " + what); };
  if (std::find(channels_.begin(), channels_.end(), channel) != channels_.end()) refuse("given twice");
  if (!empty()) {
    const double apart = std::max(std::abs(signal.t0() - t0()), std::abs(signal.dt() - dt()) * double(rows()));
    if (signal.rows() != rows() || !(apart <= 1e-6 * dt()))
      refuse("expected the time base of " + channels_[0] + " (" + std::to_string(rows()) + " rows from " +
             number(t0()) + " s by " + number(dt()) + " s), got " + std::to_string(signal.rows()) + " rows from " +
             number(signal.t0()) + " s by " + number(signal.dt()) + " s");
    if ((signal.interpolation() == Interpolation::hold) != (interpolation() == Interpolation::hold))
      refuse("a held signal cannot be joined with one that is not held");
  }
  channels_.push_back(channel);
  signals_.push_back(std::move(signal));
  return *this;
}

Excitations Excitations::part(Index first, Index count) const {
  Excitations cut = *this;
  for (Excitation& signal : cut.signals_) signal = signal.part(first, count);
  return cut;
}

std::optional<Interpolation> read_between(const Model& model, const Record& record,
                                          const std::vector<std::string>& inputs) {
  const bool says_it = std::ranges::any_of(inputs, [&](const std::string& input) {
    return record.has(input) &&
           (record.channel(input).formula.valid() || record.channel(input).between != Interpolation::linear);
  });
  return says_it ? std::nullopt : model.interpolation;
}

Excitations excitations_of(const System& system, const Record& record, std::optional<Interpolation> interpolation) {
  if (!interpolation) interpolation = read_between(system.model(), record, system.inputs());
  Excitations found;
  std::string missing;
  for (const std::string& input : system.inputs()) {
    const bool alone = input == system.inputs().front() && !record.has(input) && record.has("F");
    const std::string name = alone ? "F" : input;  // F is the force of the first driven coordinate
    if (input == force_rate) continue;             // follows from the force
    if (record.has(name))
      found.add(input, excitation_of(record, interpolation, name));
    else if (input[0] != 'F' || system.inputs().size() == 1)
      missing = input;
  }
  if (found.empty() && missing.empty()) missing = system.inputs().front();
  if (!missing.empty())
    throw InputError("the record " + record.name() + " has no channel '" + missing + "', which drives the model");
  return found;
}

namespace {

/// A signal `delay` later, and its rate.
std::pair<Excitation, Excitation> shifted(const Excitation& signal, double delay) {
  if (signal.interpolation() == Interpolation::hold) return signal.held_later(delay);
  const double h = 1e-4 * signal.dt();
  const auto at = [=](double t) { return signal.also_before(t - delay); };
  const auto slope = [=](double t) {
    return (signal.also_before(t - delay + h) - signal.also_before(t - delay - h)) / (2 * h);
  };
  const auto of = [&](std::function<double(double)> f) {
    return Excitation(signal.t0(), signal.dt(), signal.rows(), std::move(f));
  };
  return {of(at), of(slope)};
}

}  // namespace

Excitation rate_of(const Excitation& signal) {
  const Eigen::VectorXd f = signal.samples();
  const Index n = f.size();
  Eigen::VectorXd rate(n);
  for (Index i = 0; i < n; ++i) {
    const Index before = std::max<Index>(i - 1, 0), after = std::min<Index>(i + 1, n - 1);
    const double near = (f[after] - f[before]) / static_cast<double>(after - before);
    rate[i] = i < 2 || i + 2 >= n ? near : (4 * near - (f[i + 2] - f[i - 2]) / 4) / 3;
  }
  rate /= signal.dt();
  const bool held = signal.interpolation() == Interpolation::hold;
  return Excitation(signal.t0(), signal.dt(), {rate.data(), static_cast<std::size_t>(n)},
                    held ? Interpolation::hold : Interpolation::cubic);
}

Excitations Excitations::replaced(const std::string& channel, Excitation signal) const {
  Excitations out;
  out.offered_ = offered_;
  for (std::size_t i = 0; i < signals_.size(); ++i)
    if (channels_[i] != channel && channels_[i] != force_rate) out.add(channels_[i], signals_[i]);
  return out.add(channel, std::move(signal));
}

Excitations Excitations::of(const System& system, std::span<const double> theta) const {
  Excitations all = ordered(system);
  if (!system.model().delay.valid()) return all;
  const double delay = system.delay(theta);
  const std::size_t forces = system.model().driven.size();
  Excitations moved = all;
  for (std::size_t i = 0; i < forces; ++i) {
    auto [later, rate] = shifted(all.signals_[i], delay);
    moved.signals_[i] = std::move(later);
    moved.channels_.push_back("rate_of_" + all.channels_[i]);
    moved.signals_.push_back(std::move(rate));
  }
  moved.channels_.push_back("delay_now");
  moved.signals_.push_back(Excitation(t0(), dt(), std::vector<double>(static_cast<std::size_t>(rows()), delay),
                                      moved.signals_[0].interpolation()));
  return moved;
}

Excitations Excitations::ordered(const System& system) const {
  const std::vector<std::string>& inputs = system.inputs();
  Excitations ordered;
  std::vector<int> place(inputs.size(), -1);
  for (int i = 0; i < count(); ++i) {
    auto at = std::find(inputs.begin(), inputs.end(), channels_[i]);
    // F is the force of the first driven coordinate, F1 the one of a single coordinate
    if (at == inputs.end() && (channels_[i] == "F" || (channels_[i] == "F1" && system.degrees() == 1)))
      at = inputs.begin();
    if (at == inputs.end() && std::find(offered_.begin(), offered_.end(), channels_[i]) != offered_.end()) continue;
    if (at == inputs.end()) {
      const std::string words = joined(inputs);
      throw InputError("excitation: " + channels_[i] + ": drives nothing in this model; its inputs are " + words);
    }
    int& entry = place[at - inputs.begin()];
    if (entry >= 0) throw InputError("excitation: " + channels_[i] + ": given twice");
    entry = i;
  }
  std::optional<Excitation> still;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const bool rate = place[i] < 0 && inputs[i] == force_rate && place[0] >= 0;
    if (place[i] < 0 && !still && !rate)
      still = Excitation(t0(), dt(), std::vector<double>(static_cast<std::size_t>(rows()), 0.0), interpolation());
    ordered.channels_.push_back(inputs[i]);
    ordered.signals_.push_back(place[i] >= 0 ? signals_[place[i]] : rate ? rate_of(signals_[place[0]]) : *still);
  }
  return ordered;
}

}  // namespace lunid
