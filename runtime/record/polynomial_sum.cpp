#include "record/polynomial_sum.hpp"

#include <algorithm>

#include "record/method_parts.hpp"
#include "record/row_source.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

PolynomialSum::PolynomialSum(Index rows, int degree) : rows_(rows) {
  if (degree < 0 || degree > 12) refuse("detrend", "degree: expected 0 to 12, got " + std::to_string(degree));
  sums_ = squares_ = VectorXd::Zero(std::min<Index>(degree, rows - 1) + 1);
}

/// p_(k+1) = x p_k - b_k p_(k-1) at x = -1 ... 1 in even steps, b_k = k^2 (n^2 - k^2)/((4 k^2 - 1) (n - 1)^2).
template <class Use>
void PolynomialSum::each(Index first, Index count, Use use) const {
  const double n = static_cast<double>(rows_), half = std::max(0.5 * (n - 1), 0.5);
  const VectorXd x =
      VectorXd::NullaryExpr(count, [&](Index i) { return (static_cast<double>(first + i) - 0.5 * (n - 1)) / half; });
  VectorXd before = VectorXd::Zero(count), now = VectorXd::Ones(count);
  for (Index degree = 0; degree < sums_.size(); ++degree) {
    use(degree, now);
    const double k = static_cast<double>(degree), b = k * k * (n * n - k * k) / ((4 * k * k - 1) * 4 * half * half);
    VectorXd next = x.cwiseProduct(now) - b * before;
    before.swap(now);
    now.swap(next);
  }
}

void PolynomialSum::add(std::span<const double> piece) {
  const Eigen::Map<const VectorXd> values(piece.data(), static_cast<Index>(piece.size()));
  each(seen_, values.size(), [&](Index k, const VectorXd& p) {
    sums_[k] += p.dot(values);
    squares_[k] += p.squaredNorm();
  });
  seen_ += values.size();
}

void PolynomialSum::add_in_pieces(std::span<const double> all) {
  constexpr std::size_t piece = stream_rows;
  for (std::size_t at = 0; at < all.size(); at += piece) add(all.subspan(at, std::min(piece, all.size() - at)));
}

VectorXd PolynomialSum::values(Index first, Index count) const {
  VectorXd result = VectorXd::Zero(count);
  each(first, count, [&](Index k, const VectorXd& p) { result += sums_[k] / squares_[k] * p; });
  return result;
}

}  // namespace lunid
