#pragma once
// Inside statistics: near neighbours in the maximum norm. (Bentley 1975, Commun. ACM 18, 509. The libraries at hand add
// up distances over the coordinates and have no maximum norm.)
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace lunid {

/// A tree over points in Dim dimensions; Dim 0: as many as the points have. Immutable once made.
template <int Dim>
class KdTree {
 public:
  /// A column for each point, all finite.
  explicit KdTree(const Eigen::MatrixXd& points)
      : dimensions_(static_cast<int>(points.rows())), order_(static_cast<std::size_t>(points.cols())) {
    std::iota(order_.begin(), order_.end(), 0);
    if (points.cols() > 0) split(points, 0, static_cast<int>(points.cols()));
    sorted_.resize(points.rows(), points.cols());
    for (Eigen::Index i = 0; i < points.cols(); ++i) sorted_.col(i) = points.col(order_[static_cast<std::size_t>(i)]);
  }

  int size() const { return static_cast<int>(order_.size()); }
  /// The number of the point at a place of the tree; neighbours in place are near each other.
  int point(int place) const { return order_[static_cast<std::size_t>(place)]; }

  /// The distance from the point at `place` to the k-th nearest other one, 1 <= k < size().
  double kth_distance(int place, int k, std::vector<double>& nearest) const {
    nearest.assign(static_cast<std::size_t>(k), std::numeric_limits<double>::infinity());
    search(0, sorted_.col(place).data(), place, 0, nearest);
    return nearest.back();
  }

  /// The number of points that are closer than `radius` to a centre, one that lies on it included.
  int count_within(const double* centre, double radius) const { return count(0, centre, radius); }

 private:
  static constexpr int leaf_size = 12;
  struct Node {
    int first, last;                       ///< places
    int axis = -1;                         ///< -1: a leaf
    int right = 0;                         ///< the left child is the next node
    double left_end = 0, right_begin = 0;  ///< of the children along the axis
  };

  int dimensions() const { return Dim > 0 ? Dim : dimensions_; }

  /// The axis along which the points spread widest.
  int widest_axis(const Eigen::MatrixXd& points, int first, int last) const {
    int widest = 0;
    double spread = -1;
    for (int axis = 0; axis < dimensions(); ++axis) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int i = first; i < last; ++i) {
        const double value = points(axis, order_[static_cast<std::size_t>(i)]);
        low = std::min(low, value);
        high = std::max(high, value);
      }
      if (high - low > spread) spread = high - low, widest = axis;
    }
    return widest;
  }

  void split(const Eigen::MatrixXd& points, int first, int last) {
    const auto self = nodes_.size();
    nodes_.push_back({first, last});
    if (last - first <= leaf_size) return;
    const int axis = widest_axis(points, first, last), middle = first + (last - first) / 2;
    const auto begin = order_.begin();
    const auto before = [&](int i, int j) {
      return points(axis, i) < points(axis, j) || (points(axis, i) == points(axis, j) && i < j);
    };
    std::nth_element(begin + first, begin + middle, begin + last, before);
    nodes_[self].axis = axis;
    nodes_[self].left_end = points(axis, *std::max_element(begin + first, begin + middle, before));
    nodes_[self].right_begin = points(axis, order_[static_cast<std::size_t>(middle)]);
    split(points, first, middle);
    nodes_[self].right = static_cast<int>(nodes_.size());
    split(points, middle, last);
  }

  double distance(const double* a, const double* b) const {
    double largest = 0;
    for (int i = 0; i < dimensions(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
  }

  /// `gap`: no point of the node is closer. In the maximum norm the gaps of the axes do not add up.
  void search(int index, const double* centre, int self, double gap, std::vector<double>& nearest) const {
    if (gap >= nearest.back()) return;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.axis < 0) {
      for (int place = node.first; place < node.last; ++place) {
        const double d = distance(centre, sorted_.col(place).data());
        if (d < nearest.back() && place != self) insert(nearest, d);
      }
      return;
    }
    const double to_left = centre[node.axis] - node.left_end, to_right = node.right_begin - centre[node.axis];
    const double left = std::max(gap, to_left), right = std::max(gap, to_right);
    if (left <= right) {
      search(index + 1, centre, self, left, nearest);
      search(node.right, centre, self, right, nearest);
    } else {
      search(node.right, centre, self, right, nearest);
      search(index + 1, centre, self, left, nearest);
    }
  }

  static void insert(std::vector<double>& nearest, double d) {
    std::size_t i = nearest.size() - 1;
    for (; i > 0 && nearest[i - 1] > d; --i) nearest[i] = nearest[i - 1];
    nearest[i] = d;
  }

  int count(int index, const double* centre, double radius) const {
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.axis < 0) {
      int inside = 0;
      for (int place = node.first; place < node.last; ++place)
        inside += distance(centre, sorted_.col(place).data()) < radius;
      return inside;
    }
    int inside = 0;
    if (centre[node.axis] - node.left_end < radius) inside += count(index + 1, centre, radius);
    if (node.right_begin - centre[node.axis] < radius) inside += count(node.right, centre, radius);
    return inside;
  }

  int dimensions_;
  std::vector<int> order_;
  Eigen::MatrixXd sorted_;
  std::vector<Node> nodes_;
};

}  // namespace lunid
