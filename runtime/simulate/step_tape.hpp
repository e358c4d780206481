#pragma once
// A substep of the fixed path as one tape: the stages of dormand_prince.hpp with the rates of the system, and with the
// excitation where it is an expression of time. Its values pass from stage to stage in registers of the processor. It
// has the bits of the stages run one after another. Internal to this room.
#include <vector>

#include "simulate/dormand_prince.hpp"
#include "simulate/dynamics.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

/// The state that is the rate of a displacement, which need not be kept as a rate; -1: of another state.
int speed_of(const Dynamics& dynamics, int state);

class StepTape {
 public:
  /// Of a system with switches or bounds a substep in one mode, no bound held, with the event functions at its end.
  /// `force`: the exogenous inputs, or null where they are sampled.
  explicit StepTape(const Dynamics& dynamics, const TimeTape* force = nullptr);

  /// True for systems whose events a tape can tell: no surface or bound moves with an input, and all branches have a
  /// surface.
  static bool tells_events(const Dynamics& dynamics);
  /// False: stages one by one are faster. There is no machine code, or it is too long for the processor's first cache.
  bool worthwhile() const;
  const Tape& tape() const { return tape_; }
  /// The waves of the excitation are turned on from the row within the step; else its values at the nodes are inputs.
  bool turns() const { return turns_; }

  /// Doubles that place() takes, and the registers there: inputs and outputs may be moved, the others stand as the
  /// machine code likes them.
  std::size_t memory(int width) const;
  std::vector<double*> place(double* memory, int width) const;

  // ---- the first registers of its inputs ----
  int time() const { return 0; }  ///< at the start of the step
  int h() const { return 1; }
  int theta() const { return 2; }
  int x() const { return theta() + p_; }
  int k() const { return x() + n_; }     ///< the rates at the start
  int mode() const { return k() + n_; }  ///< of each surface, +1 or -1
  /// Node 1 to 5 of the step, the last one its end: an exogenous input each, where the waves are not turned.
  int drive(int node) const { return mode() + surfaces_ + (node - 1) * exogenous_; }
  /// Where they are: cosine and sine of each wave at the row; by which they are turned to node 1 to 4; the numbers of
  /// the expression; what rest() takes at node 5.
  int wave(int w) const { return mode() + surfaces_ + 2 * w; }
  int turn(int node, int w) const { return wave(node * waves_ + w); }
  int q() const { return wave((1 + inner_nodes) * waves_); }
  int end_value() const { return q() + q_; }
  static constexpr int inner_nodes = dormand_prince::nodes - 1;

  // ---- the first registers of its outputs ----
  int next_x() const { return tape_.output_place(); }
  int next_k() const { return next_x() + n_; }  ///< the rates there, of kept() alone
  const std::vector<int>& kept() const { return kept_; }
  /// 0 where all rates on the way are finite, else NaN. Then for each surface and bound (events) at the end of the
  /// step: g times the mode, or the gap; the time derivative of g or of the gap; that times the mode.
  int sound() const { return next_k() + static_cast<int>(kept_.size()); }
  int event(int e) const { return sound() + 1 + 3 * e; }

 private:
  class Builder;

  int n_, p_, exogenous_, surfaces_, waves_ = 0, q_ = 0;
  bool turns_ = false;
  std::vector<int> kept_;
  Tape tape_;
};

}  // namespace lunid
