#include "record/banded.hpp"

#include <algorithm>
#include <cmath>

namespace lunid {

using Eigen::Index;

BandedLeastSquares::BandedLeastSquares(Index unknowns, Index band)
    : unknowns_(unknowns),
      band_(band),
      triangle_(Eigen::MatrixXd::Zero(band, unknowns)),
      right_(Eigen::VectorXd::Zero(unknowns)),
      work_(band) {}

void BandedLeastSquares::add(Index first, std::span<const double> row, double right) {
  double* w = work_.data();
  std::fill(std::copy(row.begin(), row.end(), w), w + band_, 0.0);
  for (Index j = first; j < unknowns_; ++j) {
    double* r = triangle_.data() + j * band_;
    if (w[0] != 0) {
      if (r[0] == 0) {  // nothing in this row of the triangle yet: the row comes to rest here
        std::copy(w, w + band_, r);
        right_[j] = right;
        return;
      }
      const double length = std::sqrt(r[0] * r[0] + w[0] * w[0]), c = r[0] / length, s = w[0] / length;
      for (Index k = 0; k < band_; ++k) {
        const double old = r[k];
        r[k] = c * old + s * w[k];
        w[k] = c * w[k] - s * old;
      }
      const double old = right_[j];
      right_[j] = c * old + s * right;
      right = c * right - s * old;
    }
    std::copy(w + 1, w + band_, w);
    w[band_ - 1] = 0;
    if (std::all_of(w, w + band_, [](double value) { return value == 0; })) break;
  }
  squares_ += right * right;
}

Eigen::VectorXd BandedLeastSquares::solve() const {
  Eigen::VectorXd x(unknowns_);
  for (Index j = unknowns_ - 1; j >= 0; --j) {
    const Index rest = std::min(band_ - 1, unknowns_ - 1 - j);
    x[j] = (right_[j] - triangle_.col(j).segment(1, rest).dot(x.segment(j + 1, rest))) / triangle_(0, j);
  }
  return x;
}

double BandedLeastSquares::log_determinant() const { return triangle_.row(0).array().abs().log().sum(); }

Eigen::MatrixXd BandedLeastSquares::inverse_band() const {
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(band_, unknowns_);
  const auto entry = [&](Index i, Index j) { return i <= j ? inverse(j - i, i) : inverse(i - j, j); };
  for (Index i = unknowns_ - 1; i >= 0; --i) {
    const Index last = std::min(i + band_ - 1, unknowns_ - 1);
    for (Index j = last; j >= i; --j) {
      double sum = j == i ? 1 / triangle_(0, i) : 0;
      for (Index k = i + 1; k <= last; ++k) sum -= triangle_(k - i, i) * entry(k, j);
      inverse(j - i, i) = sum / triangle_(0, i);
    }
  }
  return inverse;
}

}  // namespace lunid
