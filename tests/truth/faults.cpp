#include "truth/faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <stdexcept>

namespace truth {
namespace {

constexpr int finer = 8;
constexpr double warm_up = 60;  // as make_record() has it

/// A first-order lag of a column, exact for straight lines between its samples.
std::vector<double> lagged(const std::vector<double>& u, double tau, double dt) {
  if (!(tau > 0)) return u;
  std::vector<double> x{u[0]};
  const double e = std::exp(-dt / tau);
  for (std::size_t i = 1; i < u.size(); ++i) {
    const double slope = (u[i] - u[i - 1]) / dt;
    x.push_back(u[i] - tau * slope + e * (x.back() - u[i - 1] + tau * slope));
  }
  return x;
}

std::vector<double> every(const std::vector<double>& x, int step) {
  std::vector<double> out;
  for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(step)) out.push_back(x[i]);
  return out;
}

double deviation(const std::vector<double>& x) {
  double sum = 0, squares = 0;
  for (const double v : x) sum += v;
  for (const double v : x)
    squares += (v - sum / static_cast<double>(x.size())) * (v - sum / static_cast<double>(x.size()));
  return std::sqrt(squares / static_cast<double>(x.size()));
}

void add_noise(std::vector<double>& x, double db, std::mt19937_64& bits) {
  std::normal_distribution<double> normal;
  const double sigma = deviation(x) * std::pow(10, -db / 20);
  for (double& v : x) v += sigma * normal(bits);
}

/// A run-up from 0.4 to 1.8 times the natural frequency and back, for ever: speed and angle.
double shaft_speed(double tau) { return 1.1 - 0.7 * std::cos(tau / 150); }
double shaft_angle(double tau) { return 1.1 * tau - 0.7 * 150 * std::sin(tau / 150) + 0.6; }
double shaft_rate(double tau) { return 0.7 / 150 * std::sin(tau / 150); }

struct Signals {
  Signal recorded, hidden, extra;
};

/// The recorded force, what acts beside it, and what a further channel shows.
Signals signals_of(const Fault& given, const Signal& drive, std::uint64_t seed, double share) {
  Fault fault = given;
  for (double* size : {&fault.harmonic, &fault.unbalance, &fault.base}) *size *= share;
  const Signal still = none();
  if (fault.harmonic > 0)
    return {drive, [h = fault.harmonic](double tau) { return h * std::cos(0.83 * tau + 0.4); }, still};
  if (fault.unbalance > 0) {
    const auto shaken = [u = fault.unbalance](double tau) {
      const double w = shaft_speed(tau), th = shaft_angle(tau);
      return u * (w * w * std::cos(th) + shaft_rate(tau) * std::sin(th));
    };
    return {drive, shaken, shaft_speed};
  }
  if (fault.base > 0) {
    const Signal support = multisine(0.2, 1.8, 12, seed + 77);
    return {drive, [support, b = fault.base](double tau) { return -b * support(tau); },
            [support, b = fault.base](double tau) { return b * support(tau); }};
  }
  return {drive, still, still};
}

/// The level of the excitation, of what was recorded of it.
double level_of(const Columns& columns, const Signal& total, double first, double spacing, double force) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < columns.clean_F.size(); ++i) {
    const double s = total(first + spacing * static_cast<double>(i));
    product += s * columns.clean_F[i] / force;
    square += s * s;
  }
  return square > 0 ? product / square : 0;
}

void spoil_displacement(const Fault& fault, const Scale& scale, std::vector<double>& y) {
  const double length = scale.length, last = static_cast<double>(y.size() - 1);
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] = fault.gain_y * y[i] + length * (fault.offset + fault.trend * static_cast<double>(i) / last);
    if (fault.clip_above > 0) y[i] = std::min(y[i], fault.clip_above * length);
    if (fault.clip_below > 0) y[i] = std::max(y[i], -fault.clip_below * length);
  }
}

/// `share`: of the hidden force that belongs to the level 1; `level` gets that of the excitation.
FaultyColumns make_one(const Fault& fault, const Scale& scale, const Signal& drive, double wanted,
                       const RecordOptions& options, double share, double& level) {
  Scale fine = scale;
  fine.samples *= finer;
  RecordOptions clean = options;
  clean.rows = options.rows * finer;
  clean.substeps = std::max(1, options.substeps / finer);
  const Signals signals = signals_of(fault, drive, options.seed, share);
  const Signal total = [signals](double tau) { return signals.recorded(tau) + signals.hidden(tau); };
  Columns columns = make_record(fault.physics, fine, total, wanted, clean);
  const double spacing = fine.omega() * fine.dt(),
               first = spacing * static_cast<double>(std::lround(warm_up / spacing));
  level = level_of(columns, total, first, spacing, scale.force());
  FaultyColumns out;
  for (std::size_t i = 0; i < columns.clean_F.size(); ++i) {
    const double tau = first + spacing * static_cast<double>(i);
    columns.clean_F[i] -= level * scale.force() * signals.hidden(tau);
    if (fault.unbalance > 0) out.extra.push_back(signals.extra(tau) * scale.omega());
    if (fault.base > 0) out.extra.push_back(level * signals.extra(tau) * scale.force() / scale.mass);
  }
  columns.y = every(lagged(columns.clean_y, fault.lag_y / scale.omega(), fine.dt()), finer);
  if (fault.delay > 0)  // the channel says now what acts later
    for (std::size_t i = 0; i < columns.clean_F.size(); ++i)
      columns.clean_F[i] =
          level * scale.force() * signals.recorded(first + spacing * static_cast<double>(i) + fault.delay);
  columns.F = every(lagged(columns.clean_F, fault.lag_force / scale.omega(), fine.dt()), finer);
  columns.t = every(columns.t, finer);
  out.extra = every(out.extra, finer);
  spoil_displacement(fault, scale, columns.y);
  for (double& f : columns.F) f /= fault.gain_force;
  std::mt19937_64 bits(options.seed * 40503 + 5);
  add_noise(columns.y, options.noise_db, bits);
  add_noise(columns.F, options.force_noise_db, bits);
  if (!out.extra.empty()) add_noise(out.extra, options.force_noise_db, bits);
  if (fault.unbalance > 0) out.extra_name = "speed", out.extra_unit = "rad/s";
  if (fault.base > 0) out.extra_name = "ab", out.extra_unit = "m/s^2";
  out.columns = std::move(columns);
  return out;
}

/// Rms of a training signal; the sizes of what acts beside the force are those beside a multisine.
double strength_of(Excited excited) {
  switch (excited) {
    case Excited::multisine: return std::sqrt(40 / 2.0);
    case Excited::noise: return std::sqrt(300 / 2.0);
    default: return std::sqrt(1 / 2.0);
  }
}

Fault with(const char* name, const char* effect, const std::function<void(Fault&)>& set) {
  Fault fault;
  fault.name = name;
  fault.effect = effect;
  set(fault);
  return fault;
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> table = {
      with("missing_harmonic", "missing_harmonic", [](Fault& f) { f.harmonic = 3; }),
      with("base_motion", "base_motion", [](Fault& f) { f.base = 0.8; }),
      with("rotating_unbalance", "rotating_unbalance", [](Fault& f) { f.unbalance = 1.5; }),
      with("lag_of_y", "sensor_lag", [](Fault& f) { f.lag_y = 0.4; }),
      with("lag_of_force", "sensor_lag", [](Fault& f) { f.lag_force = 0.4; }),
      with("delay_of_force", "force_delay", [](Fault& f) { f.delay = 0.4; }),
      with("force_gain", "force_gain", [](Fault& f) { f.gain_force = 1.2, f.stiffness_known = true; }),
      with("gain_of_y", "sensor_gain",
           [](Fault& f) {
             f.gain_y = 0.85, f.stiffness_known = true, f.baseline = "k*y + c*v + k3*y^3", f.physics.k3 = 0.06;
           }),
      with("offset", "displacement_offset", [](Fault& f) { f.offset = 0.5, f.in_decay = true; }),
      with("offset_duffing", "displacement_offset",
           [](Fault& f) { f.offset = 0.5, f.baseline = "k*y + c*v + k3*y^3", f.physics.k3 = 0.06, f.in_decay = true; }),
      with("drift", "sensor_drift", [](Fault& f) { f.offset = 0.1, f.trend = 0.8, f.in_decay = true; }),
      with("clipping", "clipping", [](Fault& f) { f.clip_above = f.clip_below = 1.3, f.in_decay = true; }),
      with("clipping_above", "clipping", [](Fault& f) { f.clip_above = 1.1, f.in_decay = true; }),
  };
  return table;
}

const Fault& fault_named(const std::string& name) {
  std::string choices;
  for (const Fault& each : faults()) {
    if (each.name == name) return each;
    choices += " " + each.name;
  }
  throw std::invalid_argument("no fault '" + name + "'; there are:" + choices);
}

FaultyRecords make_faulty(const Fault& fault, const Scale& scale, const RecordOptions& options) {
  const double duration = scale.omega() * scale.dt() * options.rows + warm_up;
  FaultyRecords out;
  double first = 1;
  const double share = strength_of(options.excited) / strength_of(Excited::multisine);
  out.train =
      make_one(fault, scale, training_signal(options.excited, duration, options.seed), 1.0, options, share, first);
  // What shakes the mass beside the force is as strong in every record, whatever the level of the excitation there.
  const bool beside = fault.harmonic > 0 || fault.unbalance > 0 || fault.base > 0;
  const auto further = [&](const Signal& signal, double wanted, Excited excited, std::uint64_t seed) {
    RecordOptions own = options;
    own.seed = options.seed + seed;
    own.excited = excited;
    FaultyColumns record;
    double part = share, level = 1;
    for (int pass = 0; pass < (beside ? 6 : 1); ++pass) {
      record = make_one(fault, scale, signal, wanted, own, part, level);
      part = share * first / level;
    }
    return record;
  };
  if (options.excited == Excited::tones) {
    const Signal second = training_signal(options.excited, duration, options.seed, true);
    out.more.push_back(further(second, 0.6, options.excited, 2000003));
  }
  const Excited other = options.excited == Excited::chirp ? Excited::multisine : Excited::chirp;
  out.test = further(training_signal(other, duration, options.seed), 0.8, Excited::chirp, 1000003);
  out.baseline = baseline_at(fault.baseline, fault.stiffness_known, scale);
  return out;
}

void write_csv(const FaultyColumns& record, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path);
  const bool extra = !record.extra_name.empty();
  std::fprintf(file, "t [s],F [N],y [m]");
  if (extra) std::fprintf(file, ",%s [%s]", record.extra_name.c_str(), record.extra_unit.c_str());
  const Columns& c = record.columns;
  for (std::size_t i = 0; i < c.t.size(); ++i) {
    std::fprintf(file, "\n%.10g,%.9g,%.9g", c.t[i], c.F[i], c.y[i]);
    if (extra) std::fprintf(file, ",%.9g", record.extra[i]);
  }
  std::fprintf(file, "\n");
  if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

}  // namespace truth
