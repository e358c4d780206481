#include "truth/truth.hpp"

#include "truth/noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace truth {
namespace {

constexpr double warm_up = 60;  // radians before the record begins: nearly ten periods

double mean(const std::vector<double>& x) {
  double sum = 0;
  for (double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

double rms(const std::vector<double>& x) { return std::hypot(mean(x), deviation(x)); }

/// The level of the force at which the motion has the wanted rms: coarse runs, each corrected by the last. A
/// level at which the motion escapes (softening) bounds the search from above.
double level_for(const Physics& physics, const Signal& signal, double wanted, int rows, double spacing) {
  double level = 0.05 * wanted, safe = 0, wild = 1e9;
  for (int pass = 0; pass < 30; ++pass) {
    const double reached = deviation(integrate(physics, signal, level, {}, rows, spacing, 3).x) / wanted;
    if (std::abs(reached - 1) < 0.02) break;
    if (reached < 20) {
      safe = level;
      level = std::min(level * std::clamp(1 / reached, 0.5, 2.0), 0.5 * (level + wild));
    } else {
      wild = level;
      level = 0.5 * (safe + wild);
    }
  }
  return level;
}

}  // namespace

double deviation(const std::vector<double>& x) {
  const double centre = mean(x);
  double sum = 0;
  for (double value : x) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

std::vector<double> noisy(const std::vector<double>& x, double db, double colour, std::mt19937_64& bits) {
  const double sigma = deviation(x) * std::pow(10, -db / 20) * std::sqrt(1 - colour * colour);
  const auto uniform = [&bits] { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; };
  std::vector<double> out(x.size());
  double noise = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    noise = colour * noise + sigma * radius * std::cos(2 * M_PI * uniform());
    out[i] = x[i] + noise;
  }
  return out;
}

double Scale::omega() const { return 2 * M_PI * frequency; }
double Scale::force() const { return mass * omega() * omega() * length; }
double Scale::dt() const { return 1 / (frequency * samples); }

const std::vector<Scale>& scales() {
  static const std::vector<Scale> table = {
      {"micro", 1e-6, 2000, 2e-6, 32}, {"milli", 49, 20, 2e-3, 40}, {"metre", 2000, 0.5, 0.4, 50}};
  return table;
}

const Scale& scale_named(const std::string& name) {
  for (const Scale& scale : scales()) {
    if (scale.name == name) return scale;
  }
  throw std::invalid_argument("no scale '" + name + "'; there are: micro milli metre");
}

double TrueParameter::in(const Scale& scale) const {
  return value * std::pow(scale.force(), force) * std::pow(scale.length, length) *
         std::pow(scale.omega() * scale.length, speed);
}

const char* to_string(Excited excited) {
  switch (excited) {
    case Excited::multisine: return "multisine";
    case Excited::tones: return "tones";
    case Excited::chirp: return "chirp";
    case Excited::noise: return "noise";
    case Excited::tone: return "tone";
    default: return "decay";
  }
}

Columns make_record(const Physics& given, const Scale& scale, const Signal& signal, double wanted,
                    const RecordOptions& options) {
  const double spacing = scale.omega() * scale.dt();
  const bool decays = options.excited == Excited::decay;
  const bool is_new = decays || (given.law && given.law->ages);
  const int early = is_new ? 0 : static_cast<int>(std::lround(warm_up / spacing));
  const int rows = options.rows + early;
  // What the controller takes from the motion acts as damping of its own; the recorded force holds it.
  Physics physics = given;
  physics.zeta += 0.5 * options.feedback;
  double level = decays ? 0 : level_for(physics, signal, wanted, rows, spacing);
  Signal driving = signal;
  if (options.unknown > 0) {
    double squares = 0;
    for (int i = 0; i < rows; ++i) squares += std::pow(signal(i * spacing), 2) / rows;
    const Signal other = multisine(0.1, 3, 60, options.seed + 77);  // of rms sqrt(30)
    const double share = options.unknown * std::sqrt(squares / 30);
    driving = [signal, other, share](double tau) { return signal(tau) + share * other(tau); };
  }
  const State start{decays ? 3 * wanted : 0, 0, 0};
  const auto run = [&] { return integrate(physics, driving, level, start, rows, spacing, options.substeps); };
  Motion motion = run();
  // At the edge of what the system holds a finer step may escape where the search for the level did not.
  for (int pass = 0; pass < 20 && !std::isfinite(deviation(motion.x)); ++pass) {
    level *= 0.9;
    motion = run();
  }
  for (int i = 0; i < rows; ++i) motion.force[i] = level * signal(i * spacing) - options.feedback * motion.v[i];
  const auto kept = [early](const std::vector<double>& x, double factor) {
    std::vector<double> out(x.begin() + early, x.end());
    for (double& value : out) value *= factor;
    return out;
  };
  Columns columns;
  for (int i = 0; i < options.rows; ++i) columns.t.push_back(i * scale.dt());
  columns.clean_F = kept(motion.force, scale.force());
  columns.clean_y = kept(motion.x, scale.length);
  std::mt19937_64 bits(options.seed * 2654435761u + 17);
  columns.y = noisy(columns.clean_y, options.noise_db, options.colour, bits);
  columns.F = noisy(columns.clean_F, options.force_noise_db, 0, bits);
  columns.hidden_share = rms(motion.hidden) / rms(motion.restoring);
  columns.stuck_share = motion.stuck / (spacing * rows);
  return columns;
}

Signal training_signal(Excited excited, double duration, std::uint64_t seed, bool second) {
  switch (excited) {
    case Excited::multisine: return multisine(0.15, 2.2, 40, seed);
    case Excited::tones: return tone(second ? 1.31 : 0.73);
    case Excited::chirp: return chirp(0.3, 2.0, duration);
    case Excited::noise: return multisine(0.05, 2.5, 300, seed);
    case Excited::tone: return tone(1);
    default: return none();
  }
}

std::string baseline_at(const std::string& baseline, bool stiffness_known, const Scale& scale) {
  if (!stiffness_known) return baseline;
  char known[40];
  std::snprintf(known, sizeof known, "%.9g", scale.mass * scale.omega() * scale.omega());
  return known + baseline.substr(1);  // it begins with k
}

Records make_records(const Case& which, const Scale& scale, const RecordOptions& options) {
  const double duration = scale.omega() * scale.dt() * options.rows + warm_up;
  RecordOptions second = options, third = options;
  second.seed = options.seed + 1000003;
  third.seed = options.seed + 2000003;
  const Signal force = training_signal(options.excited, duration, options.seed);
  Records out;
  out.train = make_record(which.physics, scale, force, 1.0, options);
  if (options.excited == Excited::tones) {
    const Signal other = training_signal(options.excited, duration, options.seed, true);
    out.more.push_back(make_record(which.physics, scale, other, 0.6, third));
  }
  if (which.test_alike) {
    out.test = make_record(which.physics, scale, force, 1.0, second);
    return out;
  }
  second.excited = Excited::chirp;
  const Excited other = options.excited == Excited::chirp ? Excited::multisine : Excited::chirp;
  out.test = make_record(which.physics, scale, training_signal(other, duration, options.seed), 0.8, second);
  return out;
}

void write_csv(const Columns& columns, const std::string& path, const CsvUnits& units) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path);
  if (!units.comment.empty()) std::fprintf(file, "# %s\n", units.comment.c_str());
  std::fprintf(file, "t [s],F [%s],y [%s]\n", units.force.c_str(), units.length.c_str());
  for (std::size_t i = 0; i < columns.t.size(); ++i) {
    std::fprintf(file, "%.10g,%.*g,%.*g\n", columns.t[i], units.digits, columns.F[i] * units.force_factor, units.digits,
                 columns.y[i] * units.length_factor);
  }
  if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

}  // namespace truth
