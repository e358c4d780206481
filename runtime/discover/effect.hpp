#pragma once
// A catalogue entry: data, declared in Lua (stdlib/effects), never special-cased in C++.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulate/model.hpp"

namespace lunid {

/// What a record says about scales, given to an entry's guess function. All in SI, from the training records.
struct RecordScales {
  double y_max, y_min, y_std;              ///< of the displacement [m]; y_max = max(y), y_min = min(y)
  double v_max, v_std;                     ///< of the velocity [m/s]; v_max = max |v|
  double shown_max, shown_min, shown_std;  ///< of the channel of the motion that was measured, as y_max is of y
  double force_std;                        ///< of the force that acts, of a free decay of m*a [N]
  double residual_std;                     ///< of the force that the baseline leaves unexplained [N]
  double omega;                            ///< dominant angular frequency of y [rad/s]
  double stiffness;                        ///< force_std / y_std [N/m]
  double interval;                         ///< between samples [s]
  double duration;                         ///< of the longest record [s]
  std::vector<double> lines;  ///< angular frequencies that stand out in what the model leaves open, strongest first
  std::vector<double> modulations;  ///< of a stiffness that goes up and down and would take most of it
};

/// Values for an entry's nonlinear ("shape") parameters to start from; parameters absent here are linear and solved
/// for.
using Guess = std::map<std::string, double>;
/// Limits of shape parameters.
using Ranges = std::map<std::string, std::pair<double, double>>;

/// One form of an entry: what it adds to the restoring force, or what a channel shows because of it.
struct EffectVariant {
  std::string formula;                     ///< as an engineer writes it, e.g. "Fc*sign(v)"
  Expr force;                              ///< empty: none
  std::vector<ChannelMap> measures, acts;  ///< as Model has them, for the channels y and F
  Expr delay;                              ///< as Model has it; empty: none
  EffectVariant() = default;
  EffectVariant(Expr force) : force(force) {}  // implicit: most are no more than this
};

/// Where a force acts in a model of several coordinates, counted from 0: on one against the ground, or between two.
struct Place {
  int of = 0, from = -1;  ///< from -1: the ground
  bool joint() const { return from >= 0; }
  friend bool operator==(const Place&, const Place&) = default;
};
/// "at y2", "in y1 - y2"
std::string words_of(const Place& place);
/// What the force is a function of there: "y2", "y1 - y2"
std::string motion_of(const Place& place);

/// By the entry's own name, "mu", and the baseline's.
struct Twin {
  std::string own, baseline;
  friend bool operator==(const Twin&, const Twin&) = default;
};

struct Effect {
  std::string name;  ///< contract: EFFECTS.md
  std::optional<Place>
      place;  ///< with several coordinates: where its forms, names and states are those of (places.hpp)
  std::string family;
  /// Contribution to f, and its mirror images or signs where the entry has some (one_sided_stop), or the channels whose
  /// sensor may be at fault. At least one. States and parameters that a variant does not lead to are not part of it.
  std::vector<EffectVariant> variants;
  std::vector<Parameter> parameters;
  std::vector<InternalState> states;
  std::vector<Expr> margins;  ///< of the parameters alone; below zero the entry is another effect, and is not named
  std::vector<std::string> special_case_of, channels;
  /// Numbers of the entry that are left out, since a parameter of the baseline holds them too (twins.hpp).
  std::vector<Twin> twins;
  bool any_motion = false;  ///< what it says of the channel y holds of v or a where one of these was measured
  /// Parameters that are those of one record: a test record has its own.
  struct Separate {
    std::string parameter;  ///< the entry's own name of it
    std::string unless;     ///< not where the records hold this channel themselves; empty: always
  };
  std::vector<Separate> separate;
  bool repeats = false;  ///< may stand several times at one place: stops on either side, masses that are not measured
  int number = 1;        ///< of those; the second stands beside the first alone
  /// Of the states: velocities of masses of its own, against which a base that moves acts (frame.hpp).
  std::vector<std::string> absolute;
  std::string suffix = {};  ///< behind the entry's own names of parameters and states: of a place, of a repetition
  std::string sentence;
  /// Its name, and where it is: "coulomb_friction at y2".
  std::string label() const { return place ? name + " " + words_of(*place) : name; }
  bool is_special_case(const Effect& general) const {
    return place == general.place &&
           std::find(special_case_of.begin(), special_case_of.end(), general.name) != special_case_of.end();
  }
  /// First guesses of the shape parameters of a variant, several to try; called on the main thread. Empty: all are
  /// linear.
  std::function<std::vector<Guess>(const RecordScales&, int variant)> guess;
  /// Where a record of these scales can show the shape parameters; called on the main thread. At such a limit the entry
  /// is another, simpler one (a stop that is always in contact), and is not named.
  std::function<Ranges(const RecordScales&, int variant)> range;
};

/// A form of it holds the motion of a base.
bool follows_base(const Effect& effect);

/// Of the entry's states and parameters, those that the form leads to.
std::vector<InternalState> states_of(const Effect& effect, int variant);
std::vector<Parameter> parameters_of(const Effect& effect, int variant);

/// The entry under other names: its parameters, states, guesses and ranges with this behind them, and other symbols by
/// these. Changes the pool.
Effect with_suffix(Pool& pool, const Effect& effect, const std::string& suffix,
                   std::vector<std::pair<Expr, Expr>> symbols = {});

/// Behind each entry that may stand several times its repetitions. One that is an element of the model already begins
/// with the first that is not. Changes the pool.
std::vector<Effect> with_repetitions(const Model& model, const std::vector<Effect>& catalogue);

/// An entry that is an element of a model has its names there.
bool is_element_of(const Model& model, const Effect& effect);

/// The entry's own name of one of its parameters: "k3" of cubic_stiffness_k3_1_2.
std::string own_name(const Effect& effect, std::string parameter);

}  // namespace lunid
