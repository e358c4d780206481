#include "record/extension.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/autoregression.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index most_rows = 4096;  // near the end that the model of it is made of
constexpr int most_order = 256;

/// `reach` rows after the end of x, falling to zero.
VectorXd continuation(const VectorXd& x, Index reach) {
  const VectorXd near = x.tail(std::min(x.size(), most_rows));
  const AutoregressiveFit fit =
      fit_autoregression({near.data(), static_cast<std::size_t>(near.size())}, most_order, OrderCriterion::aic);
  const auto order = static_cast<Index>(fit.coefficients.size());
  const VectorXd last_first = Eigen::Map<const VectorXd>(fit.coefficients.data(), order).reverse();
  VectorXd path(order + reach);
  path.head(order) = x.tail(order).array() - fit.mean;
  for (Index i = 0; i < reach; ++i) path[order + i] = last_first.dot(path.segment(i, order));
  VectorXd result = path.tail(reach).array() + fit.mean;
  const Index half = reach / 2;
  for (Index i = half; i < reach; ++i)
    result[i] *=
        0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(i - half + 1) / static_cast<double>(reach - half));
  return result;
}

}  // namespace

Index ends_rows(Index rows) { return std::min(rows, most_rows); }

Ends ends_of(VectorXd head, VectorXd tail, const PolynomialSum& line, Index rows, Index reach) {
  const double first = line.values(0, 1)[0], last = line.values(rows - 1, 1)[0];
  Ends ends{{}, {}, first, rows > 1 ? (last - first) / static_cast<double>(rows - 1) : 0, rows};
  for (Index i = 0; i < head.size(); ++i) head[i] -= ends.line(static_cast<double>(i));
  for (Index i = 0; i < tail.size(); ++i) tail[i] -= ends.line(static_cast<double>(rows - tail.size() + i));
  ends.before = continuation(head.reverse(), reach).reverse();
  ends.after = continuation(tail, reach);
  return ends;
}

VectorXd Ends::around(Index low, Index count, const VectorXd& inside) const {
  VectorXd result(count);
  const Index first = std::max<Index>(low, 0), ahead = first - low;
  result.head(ahead) = before.segment(low + reach(), ahead);
  for (Index i = 0; i < inside.size(); ++i) result[ahead + i] = inside[i] - line(static_cast<double>(first + i));
  const Index behind = count - ahead - inside.size();
  result.tail(behind) = after.segment(std::max<Index>(low - rows, 0), behind);
  return result;
}

Extended extend(std::span<const double> x, Index reach) {
  const Eigen::Map<const VectorXd> values(x.data(), static_cast<Index>(x.size()));
  const Index n = values.size(), near = ends_rows(n);
  PolynomialSum sum(n, 1);
  sum.add_in_pieces(x);
  const Ends ends = ends_of(values.head(near), values.tail(near), sum, n, reach);
  return {ends.around(-reach, n + 2 * reach, values), reach,
          VectorXd::NullaryExpr(n, [&](Index i) { return ends.line(static_cast<double>(i)); }), ends.slope};
}

}  // namespace lunid
