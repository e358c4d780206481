#pragma once
// Ticks, their labels and the SI prefix of an axis.
#include <string>
#include <vector>

#include "figure/figure.hpp"

namespace lunid::figure {

struct Range {
  double low = 0.0;
  double high = 1.0;
};

struct Tick {
  double value = 0.0;  ///< in the axis's unit
  std::string label;   ///< "" for a minor tick
};

/// An axis ready to draw: values run from range.low to range.high, labels show value / factor in the unit of
/// `title`.
struct AxisPlan {
  Range range;
  Scale scale = Scale::linear;
  double factor = 1.0;
  std::string title;  ///< "y [mm]"
  std::vector<Tick> ticks;
  bool turned = false;  ///< the labels of a horizontal axis stand upright: names that are too long
  bool bare = false;    ///< a neighbour has the labels and the title

  /// 0 at range.low, 1 at range.high; NaN for what a log axis cannot show.
  double place(double value) const;
};

/// A factor and the unit that carries it: 1e-3 and "mm" for unit "m" and values up to 0.02. Units that take
/// no prefix (none, m^2, 1/s, already prefixed) get a power of ten in front where the values need one.
struct ScaledUnit {
  double factor = 1.0;
  std::string unit;
};
ScaledUnit scaled_unit(const std::string& unit, double largest);

/// Superscripts for powers: "N/m^3" becomes "N/m³".
std::string with_superscripts(const std::string& unit);

/// Plans an axis over `range` with about `wanted` labels, at least two. `largest` decides the SI prefix when
/// it is not beyond a thousand times the range; 0 leaves it to the range.
AxisPlan plan_axis(const Axis& axis, Range range, int wanted, double largest = 0.0);

/// `value` with `decimals` digits after the point and a true minus sign, in any locale.
std::string fixed(double value, int decimals);

/// `value` with so many significant digits, for a label beside a bar or in a cell.
std::string few_digits(double value, int digits);

}  // namespace lunid::figure
