#pragma once
// A catalogue entry: data, declared in Lua (stdlib/effects), never special-cased in C++.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "simulate/model.hpp"

namespace lunid {

/// What a record says about scales, given to an entry's guess function. All in SI, from the training records.
struct RecordScales {
  double y_max, y_min, y_std;  ///< of the displacement [m]; y_max = max(y), y_min = min(y)
  double v_max, v_std;         ///< of the velocity [m/s]; v_max = max |v|
  double force_std;            ///< of the force that the model lacks at the outset: F - m*a [N]
  double residual_std;         ///< of the force that the baseline leaves unexplained [N]
  double omega;                ///< dominant angular frequency of y [rad/s]
  double stiffness;            ///< force_std / y_std [N/m]
};

/// Values for an entry's nonlinear ("shape") parameters to start from; parameters absent here are linear and solved
/// for.
using Guess = std::map<std::string, double>;
/// Limits of shape parameters.
using Ranges = std::map<std::string, std::pair<double, double>>;

struct Effect {
  std::string name;  ///< contract: EFFECTS.md
  std::string family;
  std::string formula;  ///< as an engineer writes it, e.g. "Fc*sign(v)"
  /// Contribution to f, and its mirror images or signs where the entry has some (one_sided_stop). At least one.
  std::vector<Expr> variants;
  std::vector<Parameter> parameters;
  std::vector<InternalState> states;
  std::vector<std::string> special_case_of, confusers, channels;
  std::string signature, sentence, source;
  /// First guesses of the shape parameters of a variant, several to try; called on the main thread. Empty: all are
  /// linear.
  std::function<std::vector<Guess>(const RecordScales&, int variant)> guess;
  /// Where a record of these scales can show the shape parameters; called on the main thread. At such a limit the entry
  /// is another, simpler one (a stop that is always in contact), and is not named.
  std::function<Ranges(const RecordScales&, int variant)> range;
};

}  // namespace lunid
