#include "record/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "expr/error.hpp"
#include "expr/number.hpp"
#include "record/random_signal.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Kind = SensorFault::Kind;

void validate(const SensorFault& fault) {
  const auto fail = [](const char* text, double got) {
    throw InputError(std::string("noise: ") + text + ", got " + write_number(got, Format::plain).text);
  };
  if (fault.kind != Kind::dropped && !(fault.size > 0 && std::isfinite(fault.size)))
    fail("size: expected > 0", fault.size);
  if (!(fault.fraction >= 0 && fault.fraction <= 1)) fail("fraction: expected 0 to 1", fault.fraction);
  if (fault.bits < 0 || fault.bits > 52) fail("bits: expected 1 to 52", fault.bits);
}

/// The fault's size in the channel's unit.
double size_on(const SensorFault& fault, const VectorXd& x) {
  if (!fault.relative) return fault.size;
  if (fault.kind == Kind::clipped || fault.kind == Kind::quantised) return fault.size * x.cwiseAbs().maxCoeff();
  return fault.size * std::sqrt((x.array() - x.mean()).square().mean());
}

/// The rows that are hit: each with the same probability, independent of the others.
std::vector<bool> hit_rows(Index rows, double fraction, Philox& random) {
  std::vector<bool> hit(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < hit.size(); ++i) hit[i] = random.uniform() < fraction;
  return hit;
}

/// Fills the lost rows from `first` up to before `end` from their neighbours; before the first kept row by it.
void fill_gap(VectorXd& x, Index first, Index end, SensorFault::Fill fill) {
  const bool has_before = first > 0, has_after = end < x.size();
  for (Index i = first; i < end; ++i) {
    if (fill == SensorFault::Fill::gap || (!has_before && !has_after)) {
      x[i] = std::numeric_limits<double>::quiet_NaN();
    } else if (!has_before) {
      x[i] = x[end];
    } else if (fill == SensorFault::Fill::hold || !has_after) {
      x[i] = x[first - 1];
    } else {
      const double part = static_cast<double>(i - first + 1) / static_cast<double>(end - first + 1);
      x[i] = x[first - 1] + part * (x[end] - x[first - 1]);
    }
  }
}

Index drop(const SensorFault& fault, VectorXd& x, Philox& random) {
  const std::vector<bool> lost = hit_rows(x.size(), fault.fraction, random);
  Index count = 0;
  for (Index i = 0; i < x.size();) {
    Index end = i;
    while (end < x.size() && lost[static_cast<std::size_t>(end)]) ++end;
    if (end > i) fill_gap(x, i, end, fault.fill);
    count += end - i;
    i = end + 1;
  }
  return count;
}

Index add_outliers(const SensorFault& fault, double size, VectorXd& x, Philox& random) {
  const std::vector<bool> hit = hit_rows(x.size(), fault.fraction, random);
  Index count = 0;
  for (Index i = 0; i < x.size(); ++i) {
    const double side = random.below(2) ? 1 : -1;  // drawn for each row, so that the rows do not depend on each other
    if (!hit[static_cast<std::size_t>(i)]) continue;
    x[i] += side * size;
    ++count;
  }
  return count;
}

/// The nearest of the levels that a converter has: with bits, 2^bits - 1 steps from -size to size.
Index quantise(const SensorFault& fault, double size, VectorXd& x) {
  if (fault.bits == 0) {
    for (double& value : x) value = size * std::nearbyint(value / size);
    return 0;
  }
  const double step = 2 * size / (std::ldexp(1.0, fault.bits) - 1);
  Index limited = 0;
  for (double& value : x) {
    limited += std::abs(value) > size;
    value = step * std::nearbyint((std::clamp(value, -size, size) + size) / step) - size;
  }
  return limited;
}

Index clip(double size, VectorXd& x) {
  Index count = 0;
  for (double& value : x) {
    count += std::abs(value) > size;
    value = std::clamp(value, -size, size);
  }
  return count;
}

void count_quanta(double size, VectorXd& x, Philox& random) {
  for (double& value : x) value = std::copysign(size * random.poisson(std::abs(value) / size), value);
}

VectorXd coloured(const SensorFault& fault, Index rows, Philox& random) {
  return fault.ar.empty() ? coloured_noise(rows, fault.exponent, random) : autoregressive_noise(rows, fault.ar, random);
}

}  // namespace

Index apply(const SensorFault& fault, VectorXd& x, Philox& random) {
  validate(fault);
  if (x.size() == 0) return 0;
  if (fault.kind == Kind::dropped) return drop(fault, x, random);
  const double size = size_on(fault, x);
  if (!(size > 0)) return 0;
  switch (fault.kind) {
    case Kind::gaussian: x += size * white_noise(x.size(), random); break;
    case Kind::uniform: x += size * uniform_noise(x.size(), random); break;
    case Kind::coloured: x += size * coloured(fault, x.size(), random); break;
    case Kind::multiplicative: x.array() *= 1 + size * white_noise(x.size(), random).array(); break;
    case Kind::poisson: count_quanta(size, x, random); break;
    case Kind::outliers: return add_outliers(fault, size, x, random);
    case Kind::quantised: return quantise(fault, size, x);
    case Kind::clipped: return clip(size, x);
    case Kind::dropped: break;
  }
  return 0;
}

}  // namespace lunid
