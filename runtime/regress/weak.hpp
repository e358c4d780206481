#pragma once
// The weak form: the equation of motion integrated against test functions of compact support, so that no derivative of
// the data is needed (Messenger & Bortz 2021, Multiscale Model. Simul. 19, 1474).
#include <map>
#include <string>
#include <vector>

#include "regress/columns.hpp"

namespace lunid {

/// Test functions (1 - (t/T)^2)^order on |t| < T, one every spacing * T.
struct WeakForm {
  double half_width = 0;  ///< T [s], >= 0; 0: so that three times the dominant frequency of y still passes
  int order = 8;          ///< 3..16
  double spacing = 0.25;  ///< 0 < spacing <= 1
};
void validate(const WeakForm& form);

namespace detail {

/// One integral: (-1)^derivative * integral of the test function's derivative times `integrand`.
struct WeakTerm {
  int derivative = 0;
  Expr integrand;
};

/// The features and the target F - m*a - known as weak terms.
struct WeakProblem {
  std::vector<WeakTerm> features;
  std::vector<std::pair<double, WeakTerm>> target;  // factor, term
  std::vector<std::string> warnings;                // features that still hold a derivative of the data
  std::string text;                                 // "weak form, T = 0.02 s, a by parts from y"
  double half_width = 0;                            // [s]
};

/// Moves derivatives to the test functions: of the mass times a (from y, v or a, whichever carries least noise), and of
/// v*g(y) where v was derived from y. Throws InputError where the mass is no number.
WeakProblem weak_problem(const std::vector<Expr>& features, double mass, Expr known, std::span<const Stream> records,
                         const WeakForm& form);

/// The statistics of the integrals within each block. Throws InputError where a block is shorter than a test function.
std::vector<Statistic> weak_statistics(const WeakProblem& problem, const std::vector<std::string>& names,
                                       const WeakForm& form, const std::map<std::string, double>& values,
                                       std::span<const Stream> records, std::span<const TimeBlock> blocks, int threads);

}  // namespace detail
}  // namespace lunid
