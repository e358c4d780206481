#include "statistics/mutual_information.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "expr/error.hpp"
#include "record/parallel.hpp"
#include "record/random.hpp"
#include "statistics/checks.hpp"
#include "statistics/kd_tree.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The digamma function of whole numbers 1 .. most.
std::vector<double> digammas(Index most) {
  std::vector<double> psi(static_cast<std::size_t>(most) + 1);
  psi[1] = -0.57721566490153286061;
  for (std::size_t n = 1; n + 1 < psi.size(); ++n) psi[n + 1] = psi[n] + 1 / static_cast<double>(n);
  return psi;
}

/// Deviation 1, and a little noise of its own for each role, so that no two distances are equal.
VectorXd prepared(std::span<const double> x, std::uint64_t role) {
  const double mean = moments::mean(x), deviation = moments::standard_deviation(x);
  Philox random(20040623, role);
  return VectorXd::NullaryExpr(static_cast<Index>(x.size()), [&](Index i) {
    return (x[static_cast<std::size_t>(i)] - mean) / deviation + 1e-10 * (random.uniform() - 0.5);
  });
}
constexpr std::uint64_t target_role = 0, column_role = 1, given_role = 2;

/// Counts the values of one column within a distance of one of them.
class Line {
 public:
  explicit Line(const VectorXd& x) : sorted_(x.begin(), x.end()) { std::sort(sorted_.begin(), sorted_.end()); }
  /// Values closer than `radius` to x, x itself included.
  Index count_within(double x, double radius) const {
    const auto first = std::partition_point(sorted_.begin(), sorted_.end(), [&](double v) { return x - v >= radius; });
    const auto last = std::partition_point(first, sorted_.end(), [&](double v) { return v - x < radius; });
    return last - first;
  }

 private:
  std::vector<double> sorted_;
};

void check(const char* who, const MatrixXd& columns, std::span<const double> target, const MatrixXd& given,
           const NeighbourOptions& options) {
  ColumnList list = columns_of(columns);
  list.push_back(target);
  for (const auto& column : columns_of(given)) list.push_back(column);
  check_columns(who, list, {.rows = 5});
  if (options.neighbours < 1 || options.neighbours >= static_cast<int>(target.size()))
    throw InputError(std::string(who) + ": neighbours: expected 1 to " + std::to_string(target.size() - 1) + ", got " +
                     std::to_string(options.neighbours));
}

double information(const VectorXd& x, const VectorXd& y, const Line& line_y, const std::vector<double>& psi, int k) {
  MatrixXd points(2, x.size());
  points.row(0) = x;
  points.row(1) = y;
  const KdTree<2> tree(points);
  const Line line_x(x);
  std::vector<double> nearest;
  double sum = 0;
  for (int place = 0; place < tree.size(); ++place) {
    const double radius = tree.kth_distance(place, k, nearest);
    const int i = tree.point(place);
    sum += psi[static_cast<std::size_t>(line_x.count_within(x[i], radius))] +
           psi[static_cast<std::size_t>(line_y.count_within(y[i], radius))];
  }
  return psi[static_cast<std::size_t>(k)] + psi[static_cast<std::size_t>(x.size())] -
         sum / static_cast<double>(x.size());
}

double conditional(const VectorXd& x, const MatrixXd& target_and_given, const KdTree<0>& tree_yz,
                   const KdTree<0>& tree_z, const std::vector<double>& psi, int k) {
  const Index rows = x.size(), dimensions = target_and_given.rows() + 1;
  MatrixXd points(dimensions, rows);  // y, z ..., x
  points.topRows(dimensions - 1) = target_and_given;
  points.row(dimensions - 1) = x;
  const KdTree<0> tree(points);
  const KdTree<0> tree_xz(points.bottomRows(dimensions - 1));
  std::vector<double> nearest;
  double sum = 0;
  for (int place = 0; place < tree.size(); ++place) {
    const double radius = tree.kth_distance(place, k, nearest);
    const double* yzx = points.col(tree.point(place)).data();
    sum += psi[static_cast<std::size_t>(tree_z.count_within(yzx + 1, radius))] -
           psi[static_cast<std::size_t>(tree_yz.count_within(yzx, radius))] -
           psi[static_cast<std::size_t>(tree_xz.count_within(yzx + 1, radius))];
  }
  return psi[static_cast<std::size_t>(k)] + sum / static_cast<double>(rows);
}

}  // namespace

VectorXd mutual_information(const MatrixXd& columns, std::span<const double> target, const NeighbourOptions& options) {
  check("mutual_information", columns, target, MatrixXd(), options);
  const std::vector<double> psi = digammas(columns.rows());
  const VectorXd y = prepared(target, target_role);
  const Line line_y(y);
  VectorXd result(columns.cols());
  parallel_for(static_cast<int>(columns.cols()), options.threads, [&](int c) {
    const VectorXd x = prepared({columns.col(c).data(), target.size()}, column_role);
    result[c] = information(x, y, line_y, psi, options.neighbours);
  });
  return result;
}

double mutual_information(std::span<const double> x, std::span<const double> target, const NeighbourOptions& options) {
  check_columns("mutual_information", {x, target}, {.rows = 5});
  return mutual_information(MatrixXd(Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()))), target,
                            options)[0];
}

VectorXd conditional_mutual_information(const MatrixXd& columns, std::span<const double> target, const MatrixXd& given,
                                        const NeighbourOptions& options) {
  if (given.cols() == 0) return mutual_information(columns, target, options);
  check("conditional_mutual_information", columns, target, given, options);
  const std::vector<double> psi = digammas(columns.rows());
  MatrixXd target_and_given(given.cols() + 1, columns.rows());
  target_and_given.row(0) = prepared(target, target_role);
  for (Index j = 0; j < given.cols(); ++j)
    target_and_given.row(j + 1) =
        prepared({given.col(j).data(), target.size()}, given_role + static_cast<std::uint64_t>(j));
  const KdTree<0> tree_yz(target_and_given), tree_z(target_and_given.bottomRows(given.cols()));
  VectorXd result(columns.cols());
  parallel_for(static_cast<int>(columns.cols()), options.threads, [&](int c) {
    const VectorXd x = prepared({columns.col(c).data(), target.size()}, column_role);
    result[c] = conditional(x, target_and_given, tree_yz, tree_z, psi, options.neighbours);
  });
  return result;
}

double significance_index(double information, double coefficient, std::span<const double> feature) {
  double largest = 0;
  for (double value : feature) largest = std::max(largest, std::abs(coefficient * value));
  return information * largest;
}

}  // namespace lunid
