#pragma once
// Passivity: a restoring force that creates no energy, on the range of the data.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"
#include "record/stream.hpp"
#include "regress/constraint.hpp"

namespace lunid {

/// v * (f(y, v) - f(y, 0)) >= 0 at the points of a grid over the range of y and v: the part of the force that depends
/// on the velocity takes energy out of the motion. (The rest, f(y, 0), is conservative.)
struct PassiveOptions {
  int points_y = 9, points_v = 8;  ///< of the grid, 2..100 each
  bool impose = true;              ///< false: only looked at
  SourceSpan where{};
};
void validate(const PassiveOptions& options);

/// What was found on a grid four times as fine.
struct Passivity {
  double least_power = 0;  ///< [W] least dissipated power; below 0 energy is created
  double y = 0, v = 0;     ///< where
  bool imposed = false;
};

namespace detail {

struct MotionRange {
  double y_low = 0, y_high = 0, v_low = 0, v_high = 0;
};
/// Of all records. Throws InputError where y or v is missing.
MotionRange motion_range(std::span<const Stream> records);

/// The power of each feature, and of the known part, as a function of y and v.
class Dissipation {
 public:
  /// Throws InputError (at `where`) on a feature that depends on anything but y, v and parameters with a value.
  Dissipation(const std::vector<Expr>& features, Expr known, const std::map<std::string, double>& values,
              const SourceSpan& where);
  /// Power per unit coefficient, the known part last.
  std::vector<double> at(double y, double v) const;

 private:
  Tape tape_;
  std::vector<double> values_;  // of the inputs after y and v
};

/// The constraints of a grid.
std::vector<Constraint> passive_constraints(const Dissipation& dissipation, const MotionRange& range,
                                            const PassiveOptions& options);
Passivity look_at(const Dissipation& dissipation, const MotionRange& range, const PassiveOptions& options,
                  std::span<const double> coefficients);

}  // namespace detail
}  // namespace lunid
