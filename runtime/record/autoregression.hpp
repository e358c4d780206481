#pragma once
// Autoregressive models of coloured noise.
#include <Eigen/Core>
#include <span>
#include <vector>

namespace lunid {

/// x_t - mean = sum coefficients[i - 1] (x_(t-i) - mean) + e_t.
struct AutoregressiveFit {
  std::vector<double> coefficients;  ///< empty: white
  double mean = 0;
  double variance = 0;   ///< of the innovations e
  double criterion = 0;  ///< value of the criterion that chose the order: n log(variance) + penalty
};

enum class OrderCriterion { bic, aic };

/// Burg's method (always stable) of the order 0 .. max_order that minimises the criterion. (Burg 1975;
/// Schwarz 1978, Akaike 1974.) max_order is cut to a third of the rows.
AutoregressiveFit fit_autoregression(std::span<const double> x, int max_order,
                                     OrderCriterion criterion = OrderCriterion::bic);

/// The columns filtered as x would be to give its innovations: u_t - sum coefficients[i-1] u_(t-i). The first
/// rows, which lack their history, are left out: rows - order of them are left. The mean is not taken off.
Eigen::MatrixXd innovations(const Eigen::Ref<const Eigen::MatrixXd>& columns, const AutoregressiveFit& fit);

}  // namespace lunid
