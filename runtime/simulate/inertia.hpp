#pragma once
// Terms of the restoring force that are affine in the acceleration belong to the mass.
#include <map>

#include "expr/expr.hpp"

namespace lunid {

/// restoring = inertia * a + force, with neither part depending on a. An empty `inertia` stands for zero.
struct InertiaSplit {
  Expr inertia;
  Expr force;
};

/// Splits an expression that is affine in `a`. Throws InputError naming the part that is not.
InertiaSplit split_inertia(Expr restoring, Expr a);

struct Model;
/// The equations of motion  sum_j mass_ij a_j + force_i = F_i  with no acceleration in mass or force.
struct InertiaRow {
  std::map<int, Expr> mass;  ///< by column; an absent entry is zero
  Expr force;
};
/// One row per coordinate of the model. Throws InputError naming the part that is not affine in the accelerations.
std::vector<InertiaRow> inertia_rows(const Model& model);

/// The accelerations for given right-hand sides F - force, as expressions: a division where the mass matrix is
/// diagonal, else Gaussian elimination by rows without pivoting (a mass matrix is positive definite), zeros left out.
std::vector<Expr> solve_accelerations(std::vector<InertiaRow> rows, std::vector<Expr> right);

/// An expression as a list of summands: sums and differences taken apart, signs kept.
std::vector<Expr> summands(Expr f);

}  // namespace lunid
