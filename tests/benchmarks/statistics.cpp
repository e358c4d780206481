// Time warping of two phase portraits of 2400 rows, and mutual information of 21 features with a force over 4000 rows,
// beside what one writes by hand.
#include "statistics/statistics.hpp"

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "benchmarks/work.hpp"

namespace bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// ---- time warping ----

/// Two rows of the table at a time.
double warp(const MatrixXd& a, const MatrixXd& b) {
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> before(b.rows() + 1, infinite), here(b.rows() + 1, infinite);
  before[0] = 0;
  for (Index i = 0; i < a.rows(); ++i) {
    const double y = a(i, 0), v = a(i, 1);
    here[0] = infinite;
    for (Index j = 0; j < b.rows(); ++j) {
      const double dy = y - b(j, 0), dv = v - b(j, 1);
      here[j + 1] = std::sqrt(dy * dy + dv * dv) + std::min(here[j], std::min(before[j], before[j + 1]));
    }
    std::swap(before, here);
  }
  return before[b.rows()];
}

constexpr Index portrait_rows = 2400;

MatrixXd portrait(double omega, double third, double noise, std::uint64_t seed) {
  lunid::Philox random(seed, 0);
  MatrixXd x(portrait_rows, 2);
  for (Index i = 0; i < portrait_rows; ++i) {
    const double t = 1e-2 * static_cast<double>(i);
    x(i, 0) = std::sin(omega * t) + third * std::sin(3 * omega * t) + noise * random.normal();
    x(i, 1) = std::cos(omega * t) + 3 * third * std::cos(3 * omega * t) + noise * random.normal();
  }
  return x;
}

MatrixXd scatter(std::uint64_t seed) {
  lunid::Philox random(seed, 0);
  return MatrixXd::NullaryExpr(portrait_rows, 2, [&] { return random.normal(); });
}

// ---- mutual information ----

constexpr Index rows = 4000;
constexpr int features = 21, degree = 5, neighbours = 3;

/// The estimator of Kraskov, Stoegbauer and Grassberger: a k-d tree over the plane, built and asked as simply as may
/// be.
class Plane {
 public:
  Plane(const VectorXd& x, const VectorXd& y) : x_(x), y_(y), order_(x.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    split(0, static_cast<int>(x.size()), 0);
  }
  double third_distance(int self) const {
    double best[neighbours];
    std::fill(best, best + neighbours, std::numeric_limits<double>::infinity());
    search(0, static_cast<int>(order_.size()), 0, self, best);
    return best[neighbours - 1];
  }

 private:
  static constexpr int leaf = 8;
  double at(int point, int axis) const { return axis == 0 ? x_[point] : y_[point]; }
  void split(int first, int last, int axis) {
    if (last - first <= leaf) return;
    const int middle = (first + last) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](int i, int j) { return at(i, axis) < at(j, axis); });
    split(first, middle, 1 - axis);
    split(middle + 1, last, 1 - axis);
  }
  void offer(int point, int self, double* best) const {
    if (point == self) return;
    const double d = std::max(std::abs(x_[point] - x_[self]), std::abs(y_[point] - y_[self]));
    if (d >= best[neighbours - 1]) return;
    int i = neighbours - 1;
    for (; i > 0 && best[i - 1] > d; --i) best[i] = best[i - 1];
    best[i] = d;
  }
  void search(int first, int last, int axis, int self, double* best) const {
    if (last - first <= leaf) {
      for (int i = first; i < last; ++i) offer(order_[i], self, best);
      return;
    }
    const int middle = (first + last) / 2;
    const double beyond = at(self, axis) - at(order_[middle], axis);
    offer(order_[middle], self, best);
    if (beyond < 0) {
      search(first, middle, 1 - axis, self, best);
      if (-beyond < best[neighbours - 1]) search(middle + 1, last, 1 - axis, self, best);
    } else {
      search(middle + 1, last, 1 - axis, self, best);
      if (beyond < best[neighbours - 1]) search(first, middle, 1 - axis, self, best);
    }
  }
  const VectorXd &x_, &y_;
  std::vector<int> order_;
};

VectorXd standardised(const VectorXd& x) {
  const VectorXd c = x.array() - x.mean();
  return c / std::sqrt(c.squaredNorm() / static_cast<double>(x.size()));
}

Index within(const std::vector<double>& sorted, double x, double radius) {
  return std::lower_bound(sorted.begin(), sorted.end(), x + radius) -
         std::upper_bound(sorted.begin(), sorted.end(), x - radius);
}

double information(const VectorXd& feature, const VectorXd& y, const std::vector<double>& sorted_y,
                   const std::vector<double>& psi) {
  const VectorXd x = standardised(feature);
  std::vector<double> sorted_x(x.begin(), x.end());
  std::sort(sorted_x.begin(), sorted_x.end());
  const Plane plane(x, y);
  double sum = 0;
  for (int i = 0; i < x.size(); ++i) {
    const double radius = plane.third_distance(i);
    sum += psi[within(sorted_x, x[i], radius)] + psi[within(sorted_y, y[i], radius)];
  }
  return psi[neighbours] + psi[x.size()] - sum / static_cast<double>(x.size());
}

double information_by_hand(const MatrixXd& columns, const VectorXd& force) {
  std::vector<double> psi(rows + 2);
  psi[1] = -0.57721566490153286;
  for (Index n = 1; n <= rows; ++n) psi[n + 1] = psi[n] + 1 / static_cast<double>(n);
  psi[0] = psi[1];
  const VectorXd y = standardised(force);
  std::vector<double> sorted_y(y.begin(), y.end());
  std::sort(sorted_y.begin(), sorted_y.end());
  double sum = 0;
  for (int c = 0; c < columns.cols(); ++c) sum += information(columns.col(c), y, sorted_y, psi);
  return sum;
}

struct Force {
  MatrixXd columns{rows, features};
  VectorXd force{rows};
  Force() {
    lunid::Philox random(1, 0);
    for (Index i = 0; i < rows; ++i) {
      const double t = 1e-2 * static_cast<double>(i);
      const double y = std::sin(7 * t) + 0.5 * std::sin(11.3 * t + 1) + 0.02 * random.normal();
      const double v = std::cos(7 * t) + 0.8 * std::cos(11.3 * t + 1) + 0.02 * random.normal();
      force[i] = 2 * y + 0.3 * v + 0.7 * y * y * y + 0.1 * random.normal();
      int column = 0;
      for (int power = 1; power <= degree; ++power)
        for (int j = 0; j <= power; ++j) columns(i, column++) = std::pow(y, power - j) * std::pow(v, j);
      columns(i, column) = std::tanh(3 * y);  // 20 monomials and this one
    }
  }
};

}  // namespace

std::vector<Work> statistics_works() {
  const auto measured = std::make_shared<MatrixXd>(portrait(7, 0.1, 0.05, 1)),
             model = std::make_shared<MatrixXd>(portrait(7.02, 0.08, 0.05, 2)),
             one = std::make_shared<MatrixXd>(scatter(3)), other = std::make_shared<MatrixXd>(scatter(4));
  const auto data = std::make_shared<Force>();
  return {{"dtw-2400", 1.5, [=] { benchmark::DoNotOptimize(lunid::dtw(*measured, *model)); },
           [=] { benchmark::DoNotOptimize(warp(*measured, *model)); }},
          {"dtw-2400-unlike", 1.5, [=] { benchmark::DoNotOptimize(lunid::dtw(*one, *other)); },
           [=] { benchmark::DoNotOptimize(warp(*one, *other)); }},
          {"mutual-information-21", 1.5,
           [=] {
             const std::span<const double> force(data->force.data(), static_cast<std::size_t>(rows));
             benchmark::DoNotOptimize(lunid::mutual_information(data->columns, force, {neighbours, 1}).sum());
           },
           [=] { benchmark::DoNotOptimize(information_by_hand(data->columns, data->force)); }}};
}

}  // namespace bench
