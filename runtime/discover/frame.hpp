#pragma once
// A rig on a base that moves (a shaker's table, the ground, a frame that vibrates), looked at from that base.
#include <string>
#include <vector>

#include "discover/discover.hpp"
#include "discover/effect.hpp"

namespace lunid {

/// m*a + f(y - yb, v - vb) = F on a base that moves is, in motions relative to the base, m*a + f(y, v) = F - m*ab, a
/// rig on the ground (Den Hartog 1956, Mechanical Vibrations, chapter 2): discovery looks at that. So it does at a
/// baseline in relative motions that holds m*ab itself. A baseline without the motion of a base is taken as it is.
class Frame {
 public:
  /// Throws InputError where the base enters otherwise than through differences to it or through m*ab, and where a mass
  /// is no number: only a force would show it.
  explicit Frame(const Model& given);

  bool moves() const { return kind_ != Kind::ground; }
  const Model& model() const { return model_; }  ///< the baseline, as it is seen from the base

  /// A record in relative motions, whose force is F - m*ab. An ab that was not measured is the derivative of yb or vb.
  /// Throws InputError for one that does not hold the same quantity of the rig and of its base.
  Record seen(const Record& record) const;
  std::vector<Record> seen(const std::vector<Record>& records) const;
  /// Entries whose accelerations, and those of masses of their own (Effect::absolute), are those against the ground.
  std::vector<Effect> seen(const std::vector<Effect>& catalogue) const;

  /// A model that was found, as the baseline was given. One with a fault of a channel stays as it is seen from the
  /// base.
  Model as_given(const Model& found) const;
  Discovery as_given(Discovery found) const;

  std::string note() const;  ///< what y and F are; empty on the ground

 private:
  std::string other_weight() const;
  enum class Kind { ground, absolute, relative };  ///< of the motions that the baseline is given in

  void look_from_base(const Model& given);
  void take_inertia(const Model& given);
  Channel force_on(int coordinate, const Record& record, const Channel& ab) const;

  Kind kind_ = Kind::ground;
  Model model_;
  std::vector<int> driven_;      ///< coordinates that a force acts on beside, as Model::driven
  std::vector<double> inertia_;  ///< of each coordinate: what multiplies -ab in its force [kg]
};

}  // namespace lunid
