#include "simulate/newton_matrix.hpp"

#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lunid {
namespace {

/// A band narrower than this part of the matrix is solved as a band.
constexpr int band_part = 4;

struct Band {
  int lower = 0, upper = 0;
};

Band band_of(const std::vector<Dynamics::Entry>& pattern) {
  Band band;
  for (const auto& [row, column] : pattern) {
    band.lower = std::max(band.lower, row - column);
    band.upper = std::max(band.upper, column - row);
  }
  return band;
}

/// An infinite slope (a root at zero) would end Newton's iteration, which a rough Jacobian does not.
double tame(double slope) { return std::isfinite(slope) ? slope : 0; }

}  // namespace

void check_sundials(int flag, const char* call) {
  if (flag < 0) throw std::runtime_error(std::string(call) + ": code " + std::to_string(flag));
}

void check_sundials(const void* handle, const char* call) {
  if (!handle) throw std::runtime_error(std::string(call) + ": no memory");
}

NewtonMatrix::NewtonMatrix(int states, const std::vector<Dynamics::Entry>* pattern, N_Vector like, SUNContext context)
    : n_(states), pattern_(pattern) {
  if (!pattern) {
    entries_.resize(static_cast<std::size_t>(n_) * n_);
    matrix_.reset(SUNDenseMatrix(n_, n_, context));
    check_sundials(matrix_.get(), "SUNDenseMatrix");
    solver_.reset(SUNLinSol_Dense(like, matrix_.get(), context));
    check_sundials(solver_.get(), "SUNLinSol_Dense");
    return;
  }
  entries_.resize(pattern->size());
  const Band band = band_of(*pattern);
  if (band_part * (band.lower + band.upper + 1) <= n_) {
    matrix_.reset(SUNBandMatrix(n_, band.upper, band.lower, context));
    check_sundials(matrix_.get(), "SUNBandMatrix");
    solver_.reset(SUNLinSol_Band(like, matrix_.get(), context));
    check_sundials(solver_.get(), "SUNLinSol_Band");
    return;
  }
  make_sparse(context);
  solver_.reset(SUNLinSol_KLU(like, matrix_.get(), context));
  check_sundials(solver_.get(), "SUNLinSol_KLU");
}

/// Columns of the pattern with the whole diagonal, which I - h J needs.
void NewtonMatrix::make_sparse(SUNContext context) {
  std::vector<std::vector<long>> columns(n_);
  for (int i = 0; i < n_; ++i) columns[i].push_back(i);
  for (const auto& [row, column] : *pattern_)
    if (row != column) columns[column].push_back(row);
  start_.assign(1, 0);
  for (std::vector<long>& rows : columns) {
    std::sort(rows.begin(), rows.end());
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    start_.push_back(static_cast<long>(rows_.size()));
  }
  for (const auto& [row, column] : *pattern_) {
    const auto first = rows_.begin() + start_[column], last = rows_.begin() + start_[column + 1];
    place_.push_back(static_cast<int>(std::lower_bound(first, last, row) - rows_.begin()));
  }
  matrix_.reset(SUNSparseMatrix(n_, n_, static_cast<sunindextype>(rows_.size()), CSC_MAT, context));
  check_sundials(matrix_.get(), "SUNSparseMatrix");
}

void NewtonMatrix::fill(SUNMatrix j) const noexcept {
  switch (SUNMatGetID(j)) {
    case SUNMATRIX_DENSE:
      for (int row = 0; row < n_; ++row)
        for (int column = 0; column < n_; ++column) SM_ELEMENT_D(j, row, column) = tame(entries_[row * n_ + column]);
      return;
    case SUNMATRIX_BAND:
      SUNMatZero(j);
      for (std::size_t i = 0; i < entries_.size(); ++i)
        SM_ELEMENT_B(j, (*pattern_)[i].row, (*pattern_)[i].column) = tame(entries_[i]);
      return;
    default: break;
  }
  std::copy(start_.begin(), start_.end(), SUNSparseMatrix_IndexPointers(j));
  std::copy(rows_.begin(), rows_.end(), SUNSparseMatrix_IndexValues(j));
  double* values = SUNSparseMatrix_Data(j);
  std::fill_n(values, rows_.size(), 0.0);
  for (std::size_t i = 0; i < entries_.size(); ++i) values[place_[i]] = tame(entries_[i]);
}

}  // namespace lunid
