#include "record/extension.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/autoregression.hpp"
#include "record/spectrum.hpp"

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
      fit_autoregression({near.data(), static_cast<std::size_t>(near.size())}, most_order, Criterion::aic);
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

Extended extend(std::span<const double> x, Index reach) {
  const auto n = static_cast<Index>(x.size());
  const VectorXd flat = detrend(x, 1);
  Extended result{VectorXd(n + 2 * reach), reach, Eigen::Map<const VectorXd>(x.data(), n) - flat, 0};
  if (n > 1) result.slope = (result.line[n - 1] - result.line[0]) / static_cast<double>(n - 1);
  result.values << continuation(flat.reverse(), reach).reverse(), flat, continuation(flat, reach);
  return result;
}

}  // namespace lunid
