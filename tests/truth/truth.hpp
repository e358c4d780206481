#pragma once
// Records with a hidden effect, made by code that shares nothing with Lunid: another integrator, another
// rate, the force evaluated exactly. What a study is tested against (docs/discovery.md).
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "truth/oscillator.hpp"

namespace truth {

/// Units of a machine: the dimensionless oscillator times these.
struct Scale {
  std::string name;  ///< "micro" | "milli" | "metre"
  double mass;       ///< [kg]
  double frequency;  ///< natural frequency [Hz]
  double length;     ///< rms of the training motion [m]
  double samples;    ///< per natural period
  double omega() const;
  double force() const;  ///< m omega0^2 L [N]
  double dt() const;     ///< [s]
};
const std::vector<Scale>& scales();
const Scale& scale_named(const std::string& name);

/// A parameter of the truth under Lunid's name, dimensionless, with the powers that give it units.
struct TrueParameter {
  std::string effect, name;
  double value;
  double force = 0, length = 0, speed = 0;  ///< times (m omega^2 L)^force * L^length * (omega L)^speed
  double in(const Scale& scale) const;      ///< SI
};

/// What drives the training record: a multisine; two tones, each in a record of its own; a sweep; noise in the same
/// band; nothing (a free decay); one tone of one amplitude.
enum class Excited { multisine, tones, chirp, noise, decay, tone };
const char* to_string(Excited);
/// The force of a training record over dimensionless time, of the second one of two tones the other tone.
Signal training_signal(Excited excited, double duration, std::uint64_t seed, bool second = false);

/// What a case tests: one hidden effect, two, none, one that the catalogue lacks; a record that cannot tell the hidden
/// effect from its rivals.
enum class Kind { effect, pair, null, outside, tie };
constexpr int kinds = 5;

struct Case {
  std::string name;
  Kind kind;
  std::string baseline;              ///< restoring force that the study knows
  std::vector<std::string> effects;  ///< names to be found; empty for null and outside
  std::vector<TrueParameter> parameters;
  Physics physics;
  std::string only_at = {};                ///< the scale at which alone it shows; "": at each
  std::optional<Excited> only_under = {};  ///< the excitation under which alone it is asked
  bool in_decay = true;                    ///< a free decay shows it: of a mass only a force tells
  bool test_alike = false;                 ///< the test record is excited as the training record, and as far
  bool stiffness_known = false;            ///< the k of the baseline is its true value, as a number
  std::vector<std::string> rivals = {};    ///< of a tie: what the hidden effect may be in one with
};
/// The case's baseline at a scale: with the number of k where that is known.
std::string baseline_at(const std::string& baseline, bool stiffness_known, const Scale& scale);
const std::vector<Case>& cases();
std::vector<Case> catalogue_cases();  ///< of those, the ones that are a Law
/// Throws std::invalid_argument naming the choices.
const Case& case_named(const std::string& name);

/// Columns in SI. `y` and `F` carry noise; the rest is the truth.
struct Columns {
  std::vector<double> t, F, y;
  std::vector<double> clean_y, clean_F;
  double hidden_share = 0;  ///< rms of the hidden force over rms of the whole restoring force
  double stuck_share = 0;   ///< of the time, spent sticking
};
struct Records {
  Columns train, test;
  std::vector<Columns> more;  ///< further training records
};

struct RecordOptions {
  int rows = 6400;
  double noise_db = 40;        ///< std(y) over the std of y's white noise, 20 log10
  double force_noise_db = 60;  ///< the same for F
  std::uint64_t seed = 1;
  int substeps = 24;  ///< RK4 steps per sample
  Excited excited = Excited::multisine;
  double colour = 0;    ///< of the noise of y: the coefficient of a first-order autoregression, 0: white
  double unknown = 0;   ///< rms of a random force that the record does not hold, over that of the force
  double feedback = 0;  ///< closed loop: the force holds -feedback * v, from a controller
};
/// Train: a motion of rms 1 (lengths of the scale). Test: a swept sine of rms 0.8, or, where a sweep trains, a
/// multisine. Both from a motion that has run for some ten periods, so that the first state is not rest; a free decay
/// begins at three times its rms.
Records make_records(const Case& which, const Scale& scale, const RecordOptions& options = {});

/// One record under any signal, its level set so that the rms of the motion is `rms`; for examples and tests.
Columns make_record(const Physics& physics, const Scale& scale, const Signal& signal, double rms,
                    const RecordOptions& options);

/// Writes `t [s],F [N],y [m]` or, with factors, other units.
struct CsvUnits {
  std::string force = "N", length = "m";
  double force_factor = 1, length_factor = 1;  ///< file = SI * factor
  std::string comment;
  int digits = 9;
};
void write_csv(const Columns& columns, const std::string& path, const CsvUnits& units = {});

}  // namespace truth
