#pragma once
// The matrix and the linear solver of SUNDIALS' Newton iterations: dense, banded or sparse by size and pattern.
// Internal to this room.
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "simulate/dynamics.hpp"

namespace lunid {

template <class Handle, class Deleter>
using SundialsHandle = std::unique_ptr<std::remove_pointer_t<Handle>, Deleter>;
struct MatrixDeleter {
  void operator()(SUNMatrix m) const noexcept { SUNMatDestroy(m); }
};
struct LinearSolverDeleter {
  void operator()(SUNLinearSolver s) const noexcept { SUNLinSolFree(s); }
};

/// Throws std::runtime_error("<call>: code <flag>") for a negative return code of a set-up call.
void check_sundials(int flag, const char* call);
void check_sundials(const void* handle, const char* call);

class NewtonMatrix {
 public:
  /// `pattern`: see Ode::pattern. Dense (LAPACK-free) without one; else banded where the band is narrow; else sparse by
  /// KLU (Davis & Palamadai Natarajan 2010, ACM TOMS 37, 36).
  NewtonMatrix(int states, const std::vector<Dynamics::Entry>* pattern, N_Vector like, SUNContext context);

  double* entries() { return entries_.data(); }  ///< of the pattern, to be filled by Ode::jacobian
  /// Writes the entries into a matrix of SUNDIALS.
  void fill(SUNMatrix j) const noexcept;
  SUNMatrix matrix() const { return matrix_.get(); }
  SUNLinearSolver solver() const { return solver_.get(); }

 private:
  void make_sparse(SUNContext context);

  int n_;
  const std::vector<Dynamics::Entry>* pattern_;
  std::vector<double> entries_;
  std::vector<int> place_;          ///< sparse: where entry i of the pattern stands in the columns
  std::vector<long> start_, rows_;  ///< sparse: the columns
  SundialsHandle<SUNMatrix, MatrixDeleter> matrix_;
  SundialsHandle<SUNLinearSolver, LinearSolverDeleter> solver_;
};

}  // namespace lunid
