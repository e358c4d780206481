#pragma once
// Frequency responses: the periodic answers of a model to a periodic excitation over a range of its frequency, and
// backbone curves. Harmonic balance or shooting with arc-length continuation, or simulation
// (docs/frequency_response.md).
#include <atomic>
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "simulate/harmonics.hpp"
#include "simulate/model.hpp"

namespace lunid {

enum class ResponseMethod { automatic, harmonic_balance, shooting, stepped_up, stepped_down, swept_up, swept_down };
std::string to_string(ResponseMethod);
/// "auto" "harmonic_balance" "shooting" "stepped_up" ... Throws InputError with the choices.
ResponseMethod response_method_from(std::string_view name);

struct ResponseOptions {
  double from = 0, to = 0;  ///< [Hz], 0 < from < to
  /// automatic: harmonic balance where the right-hand side is smooth, shooting where it has switches or bounds
  ResponseMethod method = ResponseMethod::automatic;
  int harmonics = 0;        ///< harmonic balance; 0: chosen along the branch, up to 63; else 1 to 500
  double accuracy = 1e-6;   ///< > 0, < 1: harmonics left out and steadiness of stepped runs, over the amplitude
  double max_step = 0.1;    ///< > 0, <= 1: of the arc length, relative changes of motion and frequency
  int max_points = 5000;    ///< >= 2: per branch
  bool stability = true;    ///< Floquet multipliers at each point
  int points = 200;         ///< >= 2: frequencies of stepped runs, even in Hz
  long max_periods = 2000;  ///< >= 1: in which a stepped run has to settle
  double rate = 0;          ///< [Hz/s], > 0: of swept runs
  const std::atomic<bool>* cancelled = nullptr;  ///< set by Ctrl-C; throws InputError(Fault::interrupted)
};
/// Throws InputError that names the option.
void validate(const ResponseOptions& options);

struct ResponsePoint {
  double frequency = 0;        ///< of the excitation [Hz]
  std::vector<Motion> motion;  ///< of each state
  /// Floquet multipliers, the largest first; empty where they were not asked for or are not known (swept)
  std::vector<std::complex<double>> multipliers;
  bool stable = true;  ///< stepped and swept: settled (they see stable motion only)
  int branch = 1;
  int harmonics = 0;  ///< of the series; 0: none
  int periods = 1;    ///< of the excitation in one of the motion (stepped; 0: it does not settle)
  std::string mark;   ///< "" or what a SpecialPoint says
};

/// peak: the amplitude of the first displacement is largest; fold: the branch turns back (a multiplier passes +1);
/// branch_point: a multiplier passes +1 and the branch goes on; period_doubling: through -1; neimark_sacker: a pair.
struct SpecialPoint {
  std::string kind;
  std::size_t point = 0;
};

struct ResponseCurve {
  std::vector<std::string> states;  ///< names, in the order of ResponsePoint::motion
  std::vector<ResponsePoint> points;
  std::vector<SpecialPoint> special;
  std::string method;                ///< in words
  std::vector<std::string> stopped;  ///< for each branch, in words: "reached 150 Hz" | ...
  bool complete = true;              ///< one branch from end to end (stepped: every frequency settled)
  bool truncated = false;            ///< somewhere the harmonics did not suffice for the accuracy
  long corrections = 0;              ///< iterations of Newton's method
  double seconds = 0;
};

/// The answer to inputs (HarmonicInput) of which each is at a multiple of the frequency.
/// Throws InputError: options out of range, imposed motion, parameters without values, a model that holds the time
/// itself (its answers have no common period), no mass at rest, an input that there is not, bounded states with
/// harmonic balance. Not converging is a result (`stopped`).
ResponseCurve frequency_response(const System& system, std::span<const double> theta,
                                 const std::vector<HarmonicInput>& inputs, const ResponseOptions& options);

struct BackboneOptions {
  double from = 0, to = 0;  ///< amplitude of the mode's largest displacement [m], 0 < from < to
  int mode = 1;             ///< counted from the lowest frequency
  int harmonics = 0;        ///< as in ResponseOptions
  double accuracy = 1e-6;
  double max_step = 0.1;
  int max_points = 5000;
  const std::atomic<bool>* cancelled = nullptr;
};
void validate(const BackboneOptions& options);

struct BackbonePoint {
  double frequency = 0;  ///< of the free motion [Hz]
  double damping = 0;    ///< ratio: half the negative damping that keeps the motion up, over omega
  std::vector<Motion> motion;
  int harmonics = 0;
};
struct Backbone {
  std::vector<std::string> states;
  std::vector<BackbonePoint> points;
  int state = 0;  ///< whose amplitude is followed
  std::string stopped;
  bool complete = true, truncated = false;
  long corrections = 0;
  double seconds = 0;
};

/// The free periodic motions that grow out of a mode of the linearised system: frequency and damping ratio over
/// amplitude. Damped models are kept in motion by a negative damping in proportion to the mass (extended periodic
/// motion: Krack 2015, Comput. Struct. 154, 59), so that of a conservative model is its nonlinear normal mode. Throws
/// InputError: options out of range, imposed motion, bounded states, no such mode, and as frequency_response().
Backbone backbone(const System& system, std::span<const double> theta, const BackboneOptions& options);

}  // namespace lunid
