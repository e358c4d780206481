#pragma once
// One instruction over rows that stand side by side: the one kernel of column runs (blocks of rows) and of bundles of
// lanes. Every row rounds as a scalar does, so the bits are those of the point run for any width of the machine's
// vectors.
#include <cmath>
#include <cstddef>

#include "expr/branch.hpp"
#include "expr/program.hpp"
#include "expr/sine.hpp"

/// Compiled for wider vectors too; those of the machine are chosen when the program starts.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LUNID_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LUNID_WIDE
#endif
/// Within a function that is compiled for several widths.
#define LUNID_INLINE __attribute__((always_inline)) inline

namespace lunid::kernel {

/// Four rows at once, wherever they lie in memory.
typedef double Quad __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

LUNID_INLINE const Quad& quad(const double* at) { return *reinterpret_cast<const Quad*>(at); }
LUNID_INLINE Quad& quad(double* at) { return *reinterpret_cast<Quad*>(at); }

/// f(i) for the first row of each four; `count` rows, a multiple of eight. A destination is either apart from an
/// operand or the same rows.
template <class F>
LUNID_INLINE void fours(std::size_t count, F f) {
  for (std::size_t i = 0; i < count; i += 8) {
    f(i);
    f(i + 4);
  }
}

/// dst[i] = f(i), not unrolled, so that the compiler vectorises it.
template <class F>
LUNID_INLINE void rows(std::size_t count, double* dst, F f) {
#pragma GCC ivdep
#pragma GCC unroll 1
  for (std::size_t i = 0; i < count; ++i) dst[i] = f(i);
}

/// Four numbers and their bits, for functions of the language.
struct Four {
  using Number = Quad;
  typedef std::int64_t Bits __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
  LUNID_INLINE static Bits as_bits(const Quad& x) { return reinterpret_cast<const Bits&>(x); }
  LUNID_INLINE static Quad as_number(const Bits& x) { return reinterpret_cast<const Quad&>(x); }
  LUNID_INLINE static Quad choose(const Bits& first, const Quad& a, const Quad& b) { return first ? a : b; }
};

/// dst = sin(x + turn * pi/2), four at once where all are within reach.
LUNID_INLINE void sines(std::size_t count, double* dst, const double* x, int turn) {
  Four::Bits within = quad(x) == quad(x);
  for (std::size_t i = 0; i < count; i += 4)
    within &= (quad(x + i) <= wave::sine_reach) & (quad(x + i) >= -wave::sine_reach);
  if (within[0] & within[1] & within[2] & within[3])
    for (std::size_t i = 0; i < count; i += 4) quad(dst + i) = wave::reduced_sine<Four>(quad(x + i), turn);
  else
    for (std::size_t i = 0; i < count; ++i) dst[i] = turn ? wave::cos(x[i]) : wave::sin(x[i]);
}

/// True when operand d is a value.
LUNID_INLINE bool has_four(Code code) {
  return code == Code::mul_add_mul || code == Code::mul_sub_mul || code == Code::sub_sum || code == Code::external;
}

#define LUNID_FOURS(expression) \
  return fours(count, [=](std::size_t i) LUNID_INLINE_LAMBDA { quad(dst + i) = expression; })
#define LUNID_ROWS(expression) return rows(count, dst, [=](std::size_t i) LUNID_INLINE_LAMBDA { return expression; })
#define LUNID_INLINE_LAMBDA __attribute__((always_inline))
#define A quad(a + i)
#define B quad(b + i)
#define C quad(c + i)
#define D quad(d + i)

/// `dst` = the instruction on operands a, b, c (and d, where it has four), `count` rows each. `externals`: of the tape.
LUNID_INLINE void run(std::size_t count, const Instruction& at, double* dst, const double* a, const double* b,
                      const double* c, const double* d, const ExternalCall* externals) {
  using namespace branch;
  switch (at.code) {
    case Code::copy: LUNID_FOURS(A);
    case Code::add: LUNID_FOURS(A + B);
    case Code::sub: LUNID_FOURS(A - B);
    case Code::mul: LUNID_FOURS(A * B);
    case Code::div: LUNID_FOURS(A / B);
    case Code::neg: LUNID_FOURS(-A);
    case Code::mul3: LUNID_FOURS(A * B * C);
    case Code::mul_add: LUNID_FOURS(A * B + C);
    case Code::mul_sub: LUNID_FOURS(A * B - C);
    case Code::sub_mul: LUNID_FOURS(C - A * B);
    case Code::mul_add_mul: LUNID_FOURS(A * B + C * D);
    case Code::mul_sub_mul: LUNID_FOURS(A * B - C * D);
    case Code::sub_sum: LUNID_FOURS(D - (A * B + C));
    case Code::call: {
      if (at.d == static_cast<std::uint32_t>(Op::sin)) return sines(count, dst, a, 0);
      if (at.d == static_cast<std::uint32_t>(Op::cos)) return sines(count, dst, a, 1);
      const auto value = row_of(static_cast<Op>(at.d)).value;
      for (std::size_t i = 0; i < count; ++i) dst[i] = value(a[i], b[i], c[i]);
      return;
    }
    case Code::external:
      for (std::size_t i = 0; i < count; ++i) dst[i] = externals[at.function](a[i], b[i], c[i], d[i]);
      return;
    case Code::sqrt: LUNID_ROWS(std::sqrt(a[i]));
    case Code::sign: LUNID_ROWS(sign(a[i]));
    case Code::abs: LUNID_ROWS(std::fabs(a[i]));
    case Code::min: LUNID_ROWS(min(a[i], b[i]));
    case Code::max: LUNID_ROWS(max(a[i], b[i]));
    case Code::greater: LUNID_ROWS(greater(a[i], b[i]));
    case Code::less: LUNID_ROWS(greater(b[i], a[i]));
    case Code::greater_equal: LUNID_ROWS(greater_equal(a[i], b[i]));
    case Code::less_equal: LUNID_ROWS(greater_equal(b[i], a[i]));
    case Code::choose: LUNID_ROWS(a[i] > 0 ? b[i] : c[i]);
    case Code::select:
    case Code::where: LUNID_ROWS(where(a[i], b[i], c[i]));
    default: return;
  }
}

#undef A
#undef B
#undef C
#undef D
#undef LUNID_FOURS
#undef LUNID_ROWS
#undef LUNID_INLINE_LAMBDA

}  // namespace lunid::kernel
