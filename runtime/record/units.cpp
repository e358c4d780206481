// The table of units. A unit that is missing here is one row.
#include <array>
#include <numbers>

#include "record/columns.hpp"

namespace lunid {
namespace {

struct Row {
  std::string_view name;
  double factor;
  std::string_view si;
};

constexpr double inch = 0.0254, foot = 0.3048, pound_force = 4.4482216152605, gravity = 9.80665;
constexpr double degree = std::numbers::pi / 180;

constexpr std::array rows{
    Row{"m", 1, "m"},
    Row{"mm", 1e-3, "m"},
    Row{"um", 1e-6, "m"},
    Row{"\u00b5m", 1e-6, "m"},
    Row{"\u03bcm", 1e-6, "m"},
    Row{"cm", 1e-2, "m"},
    Row{"km", 1e3, "m"},
    Row{"in", inch, "m"},
    Row{"ft", foot, "m"},
    Row{"N", 1, "N"},
    Row{"kN", 1e3, "N"},
    Row{"MN", 1e6, "N"},
    Row{"mN", 1e-3, "N"},
    Row{"lbf", pound_force, "N"},
    Row{"kgf", gravity, "N"},
    Row{"s", 1, "s"},
    Row{"ms", 1e-3, "s"},
    Row{"us", 1e-6, "s"},
    Row{"\u00b5s", 1e-6, "s"},
    Row{"\u03bcs", 1e-6, "s"},
    Row{"min", 60, "s"},
    Row{"m/s", 1, "m/s"},
    Row{"mm/s", 1e-3, "m/s"},
    Row{"cm/s", 1e-2, "m/s"},
    Row{"in/s", inch, "m/s"},
    Row{"m/s^2", 1, "m/s^2"},
    Row{"mm/s^2", 1e-3, "m/s^2"},
    Row{"m/s2", 1, "m/s^2"},
    Row{"mm/s2", 1e-3, "m/s^2"},
    Row{"m/s\u00b2", 1, "m/s^2"},
    Row{"mm/s\u00b2", 1e-3, "m/s^2"},
    Row{"g", gravity, "m/s^2"},
    Row{"rad", 1, "rad"},
    Row{"deg", degree, "rad"},
    Row{"rad/s", 1, "rad/s"},
    Row{"deg/s", degree, "rad/s"},
    Row{"rpm", 2 * std::numbers::pi / 60, "rad/s"},
    Row{"rad/s^2", 1, "rad/s^2"},
    Row{"deg/s^2", degree, "rad/s^2"},
    Row{"V", 1, "V"},
    Row{"mV", 1e-3, "V"},
    Row{"A", 1, "A"},
    Row{"Nm", 1, "N m"},
    Row{"N m", 1, "N m"},
    Row{"N*m", 1, "N m"},
    Row{"kg", 1, "kg"},
    Row{"Hz", 1, "Hz"},
    Row{"-", 1, ""},
    Row{"1", 1, ""},
};

}  // namespace

std::optional<SiUnit> si_unit(std::string_view unit) {
  for (const Row& row : rows)
    if (row.name == unit) return SiUnit{row.factor, std::string(row.si)};
  return std::nullopt;
}

std::string known_units() {
  std::string text;
  for (const Row& row : rows) text += (text.empty() ? "" : " ") + std::string(row.name);
  return text;
}

}  // namespace lunid
