#include "simulate/response_checks.hpp"

#include <cmath>

#include "expr/digits.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw InputError(what); }

void check_range(const std::string& caller, const char* unit, double from, double to) {
  if (!(from > 0) || !std::isfinite(from)) refuse(caller + ": from: expected > 0 " + unit + ", got " + number(from));
  if (!(to > from) || !std::isfinite(to))
    refuse(caller + ": to: expected > from, which is " + number(from) + " " + unit + ", got " + number(to));
}

void check_series(const std::string& caller, int harmonics, double accuracy, double max_step, int max_points) {
  if (harmonics < 0 || harmonics > 500)
    refuse(caller + ": harmonics: expected 1 to 500, got " + std::to_string(harmonics));
  if (!(accuracy > 0) || !(accuracy < 1)) refuse(caller + ": accuracy: expected > 0 and < 1, got " + number(accuracy));
  if (!(max_step > 0) || !(max_step <= 1))
    refuse(caller + ": max_step: expected > 0 and <= 1, got " + number(max_step));
  if (max_points < 2) refuse(caller + ": max_points: expected >= 2, got " + std::to_string(max_points));
}

constexpr ResponseMethod methods[] = {ResponseMethod::automatic,    ResponseMethod::harmonic_balance,
                                      ResponseMethod::shooting,     ResponseMethod::stepped_up,
                                      ResponseMethod::stepped_down, ResponseMethod::swept_up,
                                      ResponseMethod::swept_down};

}  // namespace

std::string to_string(ResponseMethod method) {
  switch (method) {
    case ResponseMethod::automatic: return "auto";
    case ResponseMethod::harmonic_balance: return "harmonic_balance";
    case ResponseMethod::shooting: return "shooting";
    case ResponseMethod::stepped_up: return "stepped_up";
    case ResponseMethod::stepped_down: return "stepped_down";
    case ResponseMethod::swept_up: return "swept_up";
    case ResponseMethod::swept_down: return "swept_down";
  }
  return "";
}

ResponseMethod response_method_from(std::string_view name) {
  std::vector<std::string> choices;
  for (const ResponseMethod method : methods) {
    if (to_string(method) == name) return method;
    choices.push_back(to_string(method));
  }
  throw InputError(
      "method: expected auto, harmonic_balance, shooting, stepped_up, stepped_down, swept_up or "
      "swept_down, got '" +
      std::string(name) + "'" + did_you_mean(nearest_word(std::string(name), choices)));
}

void validate(const ResponseOptions& o) {
  const std::string caller = "frequency_response";
  check_range(caller, "Hz", o.from, o.to);
  check_series(caller, o.harmonics, o.accuracy, o.max_step, o.max_points);
  if (o.points < 2) refuse(caller + ": points: expected >= 2, got " + std::to_string(o.points));
  if (o.max_periods < 1) refuse(caller + ": max_periods: expected >= 1, got " + std::to_string(o.max_periods));
  const bool swept = o.method == ResponseMethod::swept_up || o.method == ResponseMethod::swept_down;
  if (swept && !(o.rate > 0)) refuse(caller + ": rate: a swept run needs a rate > 0 Hz/s, got " + number(o.rate));
}

void validate(const BackboneOptions& o) {
  check_range("backbone", "m", o.from, o.to);
  check_series("backbone", o.harmonics, o.accuracy, o.max_step, o.max_points);
  if (o.mode < 1) refuse("backbone: mode: expected >= 1, got " + std::to_string(o.mode));
}

void check_periodic(const char* caller, const System& system, std::span<const double> theta,
                    std::span<const HarmonicInput> inputs) {
  const std::string name = caller;
  if (system.model().imposed_motion)
    refuse(name + ": the motion of this model is imposed: nothing is free to answer a force");
  if (static_cast<int>(theta.size()) != system.parameters())
    refuse(name + ": theta: expected " + std::to_string(system.parameters()) + " values, got " +
           std::to_string(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i)
    if (!std::isfinite(theta[i]))
      refuse(name + ": parameter '" + system.model().parameters[i].name + "' has no value; give it one");
  const Dynamics& d = system.dynamics();
  if (!d.dense())
    refuse(name + ": the model has " + std::to_string(d.n) + " states, expected at most " +
           std::to_string(Dynamics::dense_limit));
  for (const HarmonicInput& h : inputs) {
    if (h.input < 0 || h.input >= d.exogenous)
      refuse(name + ": inputs: expected an input 0 to " + std::to_string(d.exogenous - 1) + ", got " +
             std::to_string(h.input));
    if (h.harmonic < 0 || h.derivative < 0) refuse(name + ": inputs: expected a harmonic and a derivative >= 0");
    if (!std::isfinite(h.coefficient.real()) || !std::isfinite(h.coefficient.imag()))
      refuse(name + ": inputs: expected a finite coefficient");
  }
  if (depends_on_time(d, theta))
    refuse(name +
           ": the model holds the time t itself, so its answers do not repeat with the excitation; use "
           "simulate and poincare");
  const std::string fault = mass_fault(system, theta, 0, rest_of(system));
  if (!fault.empty()) refuse(name + ": " + fault);
}

void check_balance(const char* caller, const Dynamics& d, const char* instead) {
  for (const StateBound& bound : d.bounds)
    refuse(std::string(caller) + ": the state '" + d.names[bound.state] +
           "' is held at a bound, which harmonic balance cannot follow" + instead);
}

Eigen::VectorXd rest_of(const System& system) {
  const auto& states = system.model().states;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.states());
  for (std::size_t i = 0; i < states.size(); ++i)
    x[x.size() - static_cast<Eigen::Index>(states.size() - i)] = states[i].initial;
  return x;
}

std::string in_hertz(double frequency) { return number(frequency) + " Hz"; }

}  // namespace lunid
