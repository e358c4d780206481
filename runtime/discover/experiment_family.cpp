#include "discover/experiment_family.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "record/random.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int most_lines = 120, draws = 12, steps = 5;

std::string hertz(double f) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g Hz", f);
  return text;
}

std::string band(const ShapeBase& base) { return hertz(base.from) + " to " + hertz(base.to); }

double duration(const ShapeBase& base) { return base.dt * static_cast<double>(base.rows - 1); }

VectorXd normalised(VectorXd x) {
  const double peak = x.cwiseAbs().maxCoeff();
  if (peak > 0) x /= peak;
  return x;
}

/// From 0 to 1 over [0, 1], without a kink.
double ramp(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return 0.5 - 0.5 * std::cos(M_PI * x);
}

/// Lines of equal amplitude; of several draws of the phases the one with the lowest peak.
VectorXd multisine(const ShapeBase& base, double time, std::uint64_t stream) {
  std::vector<double> frequencies;
  const Index first = std::max<Index>(1, static_cast<Index>(std::ceil(base.from * time))),
              last = std::max(first, static_cast<Index>(std::floor(base.to * time)));
  const Index stride = std::max<Index>(1, (last - first + 1) / most_lines);
  for (Index k = first; k <= last; k += stride) frequencies.push_back(static_cast<double>(k) / time);
  VectorXd best;
  double lowest = INFINITY;
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(base.seed, stream + static_cast<std::uint64_t>(draw));
    VectorXd x = VectorXd::Zero(base.rows);
    for (const double f : frequencies) {
      const double phase = 2 * M_PI * random.uniform();
      for (Index i = 0; i < base.rows; ++i) x[i] += std::cos(2 * M_PI * f * base.dt * static_cast<double>(i) + phase);
    }
    const double crest = x.cwiseAbs().maxCoeff() / std::max(1e-300, x.norm());
    if (crest < lowest) {
      lowest = crest;
      best = normalised(std::move(x));
    }
  }
  return best;
}

/// An even number of octaves per second.
VectorXd swept_sine(const ShapeBase& base, double from, double to) {
  VectorXd x(base.rows);
  const double time = duration(base), rate = std::log(to / from);
  for (Index i = 0; i < base.rows; ++i) {
    const double t = base.dt * static_cast<double>(i);
    x[i] = std::sin(2 * M_PI * from * time / rate * (std::exp(rate * t / time) - 1));
  }
  return x;
}

/// A sine whose amplitude goes up in even steps; each change takes one cycle.
VectorXd stepped_amplitude(const ShapeBase& base, double frequency) {
  VectorXd x(base.rows);
  const double time = duration(base), dwell = time / steps;
  for (Index i = 0; i < base.rows; ++i) {
    const double t = base.dt * static_cast<double>(i);
    const double whole = std::min(std::floor(t / dwell), steps - 1.0);
    const double level = (whole + ramp((t - whole * dwell) * frequency)) / steps;
    x[i] = level * std::sin(2 * M_PI * frequency * t);
  }
  return x;
}

/// A level that changes smoothly from `before` to `after` in the middle, over a tenth of the time.
double changing(double part, double before, double after) {
  return before + (after - before) * ramp((part - 0.45) / 0.1);
}

VectorXd weighted(const ShapeBase& base, VectorXd x, double factor_before, double factor_after, double offset_before,
                  double offset_after) {
  for (Index i = 0; i < base.rows; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(base.rows - 1);
    x[i] = changing(part, factor_before, factor_after) * x[i] + changing(part, offset_before, offset_after);
  }
  return normalised(std::move(x));
}

/// Held at levels of either sign, the largest last.
VectorXd staircase(const ShapeBase& base) {
  static constexpr double levels[] = {1.0 / 3, 2.0 / 3, 0, -1.0 / 3, 1, -2.0 / 3, 0, -1};
  VectorXd x(base.rows);
  for (Index i = 0; i < base.rows; ++i) x[i] = levels[std::min<Index>(7, 8 * i / base.rows)];
  return x;
}

/// Pulled slowly to either side and let go: free decays without a first state that must be known.
VectorXd pull_and_release(const ShapeBase& base, int times) {
  VectorXd x(base.rows);
  for (Index i = 0; i < base.rows; ++i) {
    const double at = static_cast<double>(i) / static_cast<double>(base.rows) * times;
    const double part = at - std::floor(at), sign = static_cast<int>(at) % 2 == 0 ? 1 : -1;
    x[i] = part < 0.4 ? sign * ramp(part / 0.35) : 0;
  }
  return x;
}

}  // namespace

ExcitationShape multisine_shape(const ShapeBase& base) {
  return {"multisine", "multisine, " + band(base), multisine(base, duration(base), 0), Interpolation::cubic};
}

std::vector<ExcitationShape> excitation_family(const ShapeBase& base, bool smooth) {
  const double f = base.frequency;
  const VectorXd sum = multisine(base, duration(base), draws);
  std::vector<ExcitationShape> out{
      multisine_shape(base),
      {"swept_sine_up", "swept sine, " + band(base), swept_sine(base, base.from, base.to), Interpolation::cubic},
      {"swept_sine_down", "swept sine, " + hertz(base.to) + " down to " + hertz(base.from),
       swept_sine(base, base.to, base.from), Interpolation::cubic},
      {"stepped_amplitude", "sine at " + hertz(f) + " in five steps of amplitude", stepped_amplitude(base, f),
       Interpolation::cubic},
      {"slow_cycles", "slow sine at " + hertz(base.from) + " in five steps of amplitude",
       stepped_amplitude(base, base.from), Interpolation::cubic},
      {"amplitude_pair", "multisine, " + band(base) + ", a fifth of the level and then the whole",
       weighted(base, sum, 0.2, 1, 0, 0), Interpolation::cubic},
      {"offsets", "multisine, " + band(base) + ", about a static offset on one side and then on the other",
       weighted(base, sum, 0.6, 0.6, 0.4, -0.4), Interpolation::cubic}};
  if (smooth) return out;
  const int times = std::clamp(static_cast<int>(duration(base) * f / 25), 1, 8);
  out.push_back({"steps", "steps to either side", staircase(base), Interpolation::hold});
  out.push_back({"free_decay",
                 "slow pull and sudden release, " + std::to_string(times) + (times > 1 ? " times" : " time"),
                 pull_and_release(base, times), Interpolation::hold});
  return out;
}

}  // namespace lunid
