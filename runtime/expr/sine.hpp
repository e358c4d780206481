#pragma once
// Sine and cosine of the language: the same operations in the same order for one number and for four at once, so that
// lanes have the bits of single runs on every machine (those of the C library differ with the machine's instructions).
// The argument less the nearest multiple of pi/2, which is subtracted in three parts of 30, 30 and 53 bits (Cody &
// Waite 1980), then a polynomial of degree 13 or 14, fitted here at Chebyshev's nodes to 2e-17. Within 1 unit in the
// last place (measured 0.8); where the argument is so close to a zero that less than 1e-12 is left, within 1e-27.
// Beyond `sine_reach`, and for NaN and infinity, the C library's.
#include <bit>
#include <cmath>
#include <cstdint>

namespace lunid::wave {

/// The multiple of pi/2 stays below 2^22, so that its products with the first two parts are exact.
constexpr double sine_reach = 5e6;

/// One number, and its bits. A pack of numbers has the same three words (kernel.hpp).
struct Single {
  using Number = double;
  using Bits = std::int64_t;
  static double as_number(std::int64_t bits) { return std::bit_cast<double>(bits); }
  static std::int64_t as_bits(double x) { return std::bit_cast<std::int64_t>(x); }
  static double choose(bool first, double a, double b) { return first ? a : b; }
};

/// sin(x + turn * pi/2) for |x| <= sine_reach.
template <class Pack>
__attribute__((always_inline)) inline typename Pack::Number reduced_sine(typename Pack::Number x, int turn) {
  using T = typename Pack::Number;
  using Bits = typename Pack::Bits;
  constexpr double per_quarter = 0x1.45f306dc9c883p-1, round_off = 0x1.8p52;
  constexpr double part1 = 0x1.921fb54000000p+0, part2 = 0x1.10b4611800000p-30, part3 = 0x1.313198a2e0370p-61;
  const T shifted = x * per_quarter + round_off;  // the sum has no digits behind the point: its last bits count
  const Bits quarter = Pack::as_bits(shifted) + turn;
  const T k = shifted - round_off;
  const T first = x - k * part1, second = k * part2, high = first - second;
  const T low = ((first - high) - second) - k * part3;
  const T r = high + low, rest = (high - r) + low;
  const T z = r * r, half = z * 0.5, w = z * z;
  // in pairs of coefficients: short chains of operations
  const T s =
      (0.008333333333330946 * z - 0.16666666666666666) + w * ((2.755731610068303e-06 * z - 0.0001984126983675497) +
                                                              w * (1.591810123027412e-10 * z - 2.5051131455427946e-08));
  const T sine = r + (r * z * s + (rest - rest * half));
  const T c = (0.041666666666666664 - 0.0013888888888887395 * z) +
              w * ((2.4801587298763433e-05 - 2.7557317270560326e-07 * z) +
                   w * (2.0876146024689747e-09 - 1.1382614868556325e-11 * z));
  const T base = 1.0 - half;
  const T cosine = base + (((1.0 - base) - half) + (w * c - r * rest));
  const T value = Pack::choose((quarter & 1) != 0, cosine, sine);
  return Pack::as_number(Pack::as_bits(value) ^ ((quarter & 2) << 62));
}

inline double sin(double x) { return std::abs(x) <= sine_reach ? reduced_sine<Single>(x, 0) : std::sin(x); }
inline double cos(double x) { return std::abs(x) <= sine_reach ? reduced_sine<Single>(x, 1) : std::cos(x); }

}  // namespace lunid::wave
