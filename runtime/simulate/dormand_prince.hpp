#pragma once
// The fifth-order method of Dormand and Prince (1980, J. Comput. Appl. Math. 6, 19), at a fixed step. Its seventh stage
// is the rate at the end of the step, which is the first of the next (FSAL): six evaluations per step. Per evaluation
// it is worth more than the classical fourth-order method: on an oscillator, one step of it equals four of those.
#include <array>

namespace lunid::dormand_prince {

inline constexpr int stages = 6;  ///< evaluations per step
/// Places of the stages in the step; the sixth and the seventh are its end.
inline constexpr std::array<double, 7> place{0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
/// Distinct places from the start on, without the end: what is stored of an input for each step.
inline constexpr int nodes = 5;

/// Row i: weights of the stages before it; row 6 is the step itself.
inline constexpr double weight[7][6] = {{},
                                        {1.0 / 5},
                                        {3.0 / 40, 9.0 / 40},
                                        {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};

/// out = x + h * (weights of stage S) . k, with the stages k one after another, n values each. N: n where the compiler
/// knows it, else 0.
template <int S, int N = 0>
inline void stage_state(int n, double h, const double* x, const double* k, double* out) noexcept {
  const int size = N > 0 ? N : n;
  for (int i = 0; i < size; ++i) {
    double sum = weight[S][0] * k[i];
    if constexpr (S > 1 && weight[S][1] != 0) sum += weight[S][1] * k[size + i];
    if constexpr (S > 2) sum += weight[S][2] * k[2 * size + i];
    if constexpr (S > 3) sum += weight[S][3] * k[3 * size + i];
    if constexpr (S > 4) sum += weight[S][4] * k[4 * size + i];
    if constexpr (S > 5) sum += weight[S][5] * k[5 * size + i];
    out[i] = x[i] + h * sum;
  }
}

/// The same for a stage known at run time.
inline void stage_state(int stage, int n, double h, const double* x, const double* k, double* out) noexcept {
  switch (stage) {
    case 1: return stage_state<1>(n, h, x, k, out);
    case 2: return stage_state<2>(n, h, x, k, out);
    case 3: return stage_state<3>(n, h, x, k, out);
    case 4: return stage_state<4>(n, h, x, k, out);
    case 5: return stage_state<5>(n, h, x, k, out);
    default: return stage_state<6>(n, h, x, k, out);
  }
}

}  // namespace lunid::dormand_prince
