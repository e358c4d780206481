// Savitzky-Golay filters, and the choice of their window by the estimated error of the derivative.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "record/derivative_error.hpp"
#include "record/record.hpp"
#include "record/savitzky_golay.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

constexpr int most_order = 12;

/// Fits polynomials over 2h+1 samples in the scaled position s = (i - h)/h, so that the fit is well
/// conditioned.
class Fit {
 public:
  Fit(int half_width, int order) : half_width_(half_width), order_(order) {
    const int points = 2 * half_width + 1;
    Eigen::MatrixXd powers(points, order + 1);
    for (int i = 0; i < points; ++i) powers.row(i) = basis(i - half_width, 0).transpose();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(powers);
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(points, order + 1);
    const Eigen::MatrixXd r = qr.matrixQR().topRows(order + 1).triangularView<Eigen::Upper>();
    solution_ = r.triangularView<Eigen::Upper>().solve(q.transpose());
  }
  /// Coefficients of the polynomial through a window of samples.
  Eigen::VectorXd coefficients(const Eigen::Ref<const Eigen::VectorXd>& window) const { return solution_ * window; }
  /// Derivatives of the basis, per sample^derivative, `offset` samples from the middle.
  Eigen::VectorXd basis(int offset, int derivative) const {
    const double s = static_cast<double>(offset) / half_width_;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(order_ + 1);
    for (int p = derivative; p <= order_; ++p) {
      double factor = 1;
      for (int k = 0; k < derivative; ++k) factor *= (p - k) / static_cast<double>(half_width_);
      row[p] = factor * std::pow(s, p - derivative);
    }
    return row;
  }
  Eigen::VectorXd weights(int offset, int derivative) const {
    return solution_.transpose() * basis(offset, derivative);
  }

 private:
  int half_width_, order_;
  Eigen::MatrixXd solution_;
};

void validate(const SavitzkyGolay& options, int derivative, std::size_t rows) {
  const auto fail = [](const std::string& text) { throw InputError("savitzky_golay: " + text, {}, Fault::study); };
  if (derivative < 0) fail("derivative: expected >= 0, got " + std::to_string(derivative));
  if (options.order < derivative || options.order > most_order)
    fail("order: expected " + std::to_string(derivative) + " to " + std::to_string(most_order) + ", got " +
         std::to_string(options.order));
  if (options.half_width < 1 || 2 * options.half_width + 1 < options.order + 1)
    fail("half_width: expected at least " + std::to_string((options.order + 1) / 2) + " for order " +
         std::to_string(options.order) + ", got " + std::to_string(options.half_width));
  if (static_cast<std::size_t>(2 * options.half_width + 1) > rows)
    fail("half_width: expected a window of at most " + std::to_string(rows) + " rows, got " +
         std::to_string(2 * options.half_width + 1));
}

/// Sum of w[k] x[i + k] for every whole window; wide windows by Fourier transforms of overlapping blocks.
Eigen::VectorXd correlate(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::VectorXd& w) {
  const Eigen::Index points = w.size(), count = x.size() - points + 1;
  Eigen::VectorXd result(count);
  if (points <= 256) {
    result.setZero();
    for (Eigen::Index k = 0; k < points; ++k) result += w[k] * x.segment(k, count);
    return result;
  }
  const Eigen::Index length = power_of_two_above(8 * points), useful = length - points + 1;
  const Eigen::VectorXcd filter = half_spectrum({w.data(), static_cast<std::size_t>(points)}, length).conjugate();
  for (Eigen::Index start = 0; start < count; start += useful) {
    const Eigen::Index rows = std::min(length, x.size() - start);
    // The level is taken off first, so that a large offset costs no digits; the filter's sum puts it back.
    const double level = x.segment(start, rows).mean();
    const Eigen::VectorXd part = x.segment(start, rows).array() - level;
    const Eigen::VectorXcd product =
        half_spectrum({part.data(), static_cast<std::size_t>(rows)}, length).cwiseProduct(filter);
    const Eigen::Index take = std::min(useful, count - start);
    result.segment(start, take) = inverse_half_spectrum(product, length).head(take).array() + level * w.sum();
  }
  return result;
}

}  // namespace

Eigen::VectorXd savitzky_golay_weights(int derivative, const SavitzkyGolay& options) {
  return Fit(options.half_width, options.order).weights(0, derivative);
}

double savitzky_golay_noise(double dt, int derivative, const SavitzkyGolay& options) {
  return savitzky_golay_weights(derivative, options).norm() / std::pow(dt, derivative);
}

Eigen::VectorXd savitzky_golay(std::span<const double> x, double dt, int derivative, const SavitzkyGolay& options) {
  validate(options, derivative, x.size());
  const auto n = static_cast<Eigen::Index>(x.size());
  const int h = options.half_width;
  const Eigen::Map<const Eigen::VectorXd> values(x.data(), n);
  const Fit fit(h, options.order);
  Eigen::VectorXd result(n);
  result.segment(h, n - 2 * h) = correlate(values, fit.weights(0, derivative));
  const Eigen::VectorXd head = fit.coefficients(values.head(2 * h + 1)),
                        tail = fit.coefficients(values.tail(2 * h + 1));
  for (int i = 0; i < h; ++i) {
    result[i] = fit.basis(i - h, derivative).dot(head);
    result[n - 1 - i] = fit.basis(h - i, derivative).dot(tail);
  }
  return result / std::pow(dt, derivative);
}

SavitzkyGolay choose_savitzky_golay(std::span<const double> x, double noise, int derivative) {
  return choose_savitzky_golay(DerivativeError(x, noise, derivative), static_cast<Eigen::Index>(x.size()), derivative);
}

SavitzkyGolay choose_savitzky_golay(const DerivativeError& error, Eigen::Index n, int derivative) {
  const int widest = static_cast<int>(std::max<Eigen::Index>(std::min({n / 10, error.length() / 10, (n - 1) / 2}), 2));
  // The narrowest filter of order 3 is there for any record of 5 rows.
  SavitzkyGolay best{2, 3};
  double least = std::numeric_limits<double>::infinity();
  for (int order : {3, 5}) {
    for (int h = (order + 1) / 2; h <= widest; h = std::max(h + 1, static_cast<int>(1.2 * h))) {
      const SavitzkyGolay candidate{h, order};
      const double expected = error.of(savitzky_golay_weights(derivative, candidate));
      if (expected >= least) continue;
      least = expected;
      best = candidate;
    }
  }
  return best;
}

}  // namespace lunid
