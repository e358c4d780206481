#pragma once
// Expressions of time, compiled for even grids. Where they hold sines or cosines of rate*t + phase, a grid does not
// evaluate these at each time: it takes them at every sixteenth sample and turns them on to the rest, by the sines and
// cosines of rate*dt*row and rate*dt*place. Each value is that of the formula itself within a few roundings of the
// angle, as every other evaluation of it is: nothing adds up from sample to sample. Single runs and bundles of lanes
// turn by the same operations in the same order.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "expr/tape.hpp"

namespace lunid {

class TimeTape {
 public:
  TimeTape() = default;
  /// Inputs: t, then the symbols q. Adds nodes to their pool. Throws InputError naming another symbol.
  TimeTape(std::span<const Expr> outputs, std::span<const Expr> inputs);

  int outputs() const { return direct_.outputs(); }
  int inputs() const { return direct_.inputs(); }
  /// (t, q...) -> outputs, at any time.
  const Tape& direct() const { return direct_; }

  /// out[j][row] = output j at t0 + dt*(row + place) for `rows` rows, 0 <= place < 1.
  void fill(double t0, double dt, double place, std::span<const double> q, Eigen::Index rows,
            std::span<double* const> out) const;

  // ---- what a grid is made of ----
  static constexpr Eigen::Index turned_rows = 16;
  int waves() const { return waves_; }
  /// (t, q...) -> the angle of each wave, then the rate [rad/s] of each.
  const Tape& angles() const { return angles_; }
  /// What rest() takes of the waves.
  struct Value {
    int wave;
    bool sine;
  };
  std::span<const Value> values() const { return values_; }
  /// (t, q..., values...) -> outputs.
  const Tape& rest() const { return rest_; }

 private:
  Tape direct_, angles_, rest_;
  int waves_ = 0;
  std::vector<Value> values_;
};

}  // namespace lunid
