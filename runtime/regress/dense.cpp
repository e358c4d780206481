#include "regress/dense.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LongVector solve_by_qr(const LongMatrix& a, const LongVector& b) {
  const Index n = a.cols();
  LongMatrix r = LongMatrix::Zero(n + 1, n + 1), block(a.rows(), n + 1);
  block << a, b;
  triangularise(r, std::move(block));
  return r.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(r.col(n).head(n));
}

FullQr full_qr(LongMatrix a) {
  const Index n = a.rows(), k = a.cols();
  FullQr out{LongMatrix::Identity(n, n), LongMatrix::Zero(k, k)};
  for (Index j = 0; j < k; ++j) {
    LongVector v = LongVector::Zero(n);
    v.tail(n - j) = a.col(j).tail(n - j);
    const long double norm = v.norm();
    v[j] += std::signbit(v[j]) ? -norm : norm;
    const long double norm2 = v.squaredNorm();
    if (norm2 > 0) {
      const LongVector on_a = (2 / norm2) * (a.transpose() * v);
      a -= v * on_a.transpose();
      const LongVector on_q = (2 / norm2) * (out.q * v);
      out.q -= on_q * v.transpose();
    }
    out.triangle.col(j).head(j + 1) = a.col(j).head(j + 1);
  }
  return out;
}

double condition_number(MatrixXd a) {
  const Index n = a.cols();
  if (n == 0) return 1;
  bool turned = true;
  for (int sweep = 0; turned && sweep < 60; ++sweep) {
    turned = false;
    for (Index i = 0; i < n; ++i)
      for (Index j = i + 1; j < n; ++j) {
        const double p = a.col(i).squaredNorm(), q = a.col(j).squaredNorm(), w = a.col(i).dot(a.col(j));
        if (std::abs(w) <= 1e-15 * std::sqrt(p * q)) continue;
        turned = true;
        const double zeta = (q - p) / (2 * w), t = std::copysign(1 / (std::abs(zeta) + std::hypot(1, zeta)), zeta);
        const double c = 1 / std::hypot(1, t), s = c * t;
        const VectorXd column = a.col(i);
        a.col(i) = c * column - s * a.col(j);
        a.col(j) = s * column + c * a.col(j);
      }
  }
  const VectorXd values = a.colwise().norm();
  return values.maxCoeff() / values.minCoeff();
}

}  // namespace lunid::detail
