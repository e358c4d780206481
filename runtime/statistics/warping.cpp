#include "statistics/warping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "expr/error.hpp"
#include "statistics/checks.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The columns of the table that a row may use.
struct Band {
  Index rows, columns, width;
  Index centre(Index i) const { return rows > 1 ? i * (columns - 1) / (rows - 1) : columns - 1; }
  Index first(Index i) const { return std::max<Index>(i == 0 ? 0 : centre(i) - width, 0); }
  Index last(Index i) const {
    if (i + 1 >= rows) return columns - 1;
    return std::min(std::max(centre(i), centre(i + 1) - 1) + width, columns - 1);
  }
};

/// One row of the table after the other; entry 0 stands before the first column.
class Table {
 public:
  Table(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b)
      : a_(a), b_(b), before_(static_cast<std::size_t>(b.rows()) + 2), here_(before_), distance_(b.rows()) {}

  /// The cost of the best pairing within the band, if it is not beyond `bound`; else infinite.
  double cost(const Band& band, double bound) {
    std::fill(before_.begin(), before_.end(), infinite);
    std::fill(here_.begin(), here_.end(), infinite);
    before_[0] = 0;
    Index low = 0, high = -1;  // columns of the row before that are within the bound
    for (Index i = 0; i < band.rows; ++i) {
      const Index first = std::max(band.first(i), low), last = band.last(i);
      const Index open = i == 0 ? last : std::min(high + 1, last);  // up to here the row before has a say
      if (first > open) return infinite;
      measure(i, first, open - first + 1);
      double left = infinite;
      for (Index j = first; j <= open; ++j) {
        const std::size_t c = column(j);
        left = distance_[j] + std::min(left, std::min(before_[c], before_[c - 1]));
        here_[c] = left;
      }
      Index end = open;  // from here on only the way along the row is left
      while (left <= bound && end < last) {
        measure(i, ++end, 1);
        left += distance_[end];
        here_[column(end)] = left;
      }
      low = first;
      high = end;
      while (low <= high && here_[column(low)] > bound) ++low;
      while (high >= low && here_[column(high)] > bound) --high;
      if (low > high) return infinite;
      here_[column(low) - 1] = here_[column(high) + 1] = infinite;
      before_.swap(here_);
      before_[0] = infinite;
    }
    return high == band.columns - 1 ? before_[column(high)] : infinite;
  }

 private:
  static std::size_t column(Index j) { return static_cast<std::size_t>(j) + 1; }

  /// Distances of row i of a to `count` rows of b.
  void measure(Index i, Index first, Index count) {
    auto part = distance_.segment(first, count);
    part = (b_.col(0).segment(first, count).array() - a_(i, 0)).square();
    for (Index c = 1; c < b_.cols(); ++c) part += (b_.col(c).segment(first, count).array() - a_(i, c)).square();
    part = part.sqrt();
  }

  Eigen::Ref<const MatrixXd> a_, b_;
  std::vector<double> before_, here_;
  Eigen::ArrayXd distance_;
};

void check(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b) {
  if (a.cols() != b.cols() || a.cols() == 0)
    throw InputError("dtw: expected as many columns in the one curve as in the other, got " + std::to_string(a.cols()) +
                     " and " + std::to_string(b.cols()));
  ColumnList list = columns_of(a);
  for (const auto& column : columns_of(b)) list.push_back(column);
  check_columns("dtw", list, {.rows = 1, .may_be_constant = true, .may_differ = true});
}

}  // namespace

double dtw(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b, Index band) {
  check(a, b);
  Table table(a, b);
  const Index widest = band < 0 ? std::max(a.rows(), b.rows()) : band;
  double bound = infinite;
  // Narrow bands cost little, and what they find bounds the wider ones.
  for (const Index width : {Index{0}, widest / 32})
    if (width < widest) bound = std::min(bound, table.cost({a.rows(), b.rows(), width}, bound));
  return std::min(bound, table.cost({a.rows(), b.rows(), widest}, bound));
}

namespace {

/// Where the best way to a pair of rows comes from.
enum class From : unsigned char { both, row, column };

/// The table with its ways, row after row, each from its band's first column on.
class Ways {
 public:
  Ways(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b, const Band& band) : band_(band) {
    double pairs = 0;
    for (Index i = 0; i < band.rows; ++i) pairs += static_cast<double>(band.last(i) - band.first(i) + 1);
    if (pairs > 4e8)
      throw InputError("dtw: the pairing of " + std::to_string(a.rows()) + " and " + std::to_string(b.rows()) +
                       " rows takes more than 4e8 pairs: give a narrower band, or every n-th row");
    Eigen::ArrayXd before = Eigen::ArrayXd::Constant(b.rows(), infinite), here = before;
    for (Index i = 0; i < band.rows; ++i) {
      const Index first = band.first(i), last = band.last(i);
      std::vector<From>& from = from_.emplace_back(static_cast<std::size_t>(last - first + 1), From::both);
      here.setConstant(infinite);
      for (Index j = first; j <= last; ++j) {
        const double diagonal = i > 0 && j > 0 ? before[j - 1] : i == 0 && j == 0 ? 0 : infinite;
        const double up = i > 0 ? before[j] : infinite, left = j > first ? here[j - 1] : infinite;
        const double best = std::min(diagonal, std::min(up, left));
        from[static_cast<std::size_t>(j - first)] = best == diagonal ? From::both
                                                    : best == up     ? From::row
                                                                     : From::column;
        here[j] = (a.row(i) - b.row(j)).norm() + best;
      }
      before.swap(here);
    }
    cost_ = before[b.rows() - 1];
  }

  Pairing back() const {
    std::vector<Index> rows, columns;
    for (Index i = band_.rows - 1, j = band_.columns - 1; i >= 0 && j >= 0;) {
      rows.push_back(i);
      columns.push_back(j);
      const From from = from_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j - band_.first(i))];
      if (from != From::column) --i;
      if (from != From::row) --j;
    }
    const auto turned = [](const std::vector<Index>& list) {
      return Eigen::VectorX<Index>(
          Eigen::Map<const Eigen::VectorX<Index>>(list.data(), static_cast<Index>(list.size())).reverse());
    };
    return {turned(rows), turned(columns), cost_};
  }

 private:
  Band band_;
  std::vector<std::vector<From>> from_;
  double cost_ = infinite;
};

}  // namespace

Pairing dtw_pairing(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b, Index band) {
  check(a, b);
  return Ways(a, b, {a.rows(), b.rows(), band < 0 ? std::max(a.rows(), b.rows()) : band}).back();
}

double phase_portrait_distance(std::span<const double> y, std::span<const double> v, std::span<const double> model_y,
                               std::span<const double> model_v, Index band) {
  check_columns("dtw", {y, v});
  const double scale[] = {moments::standard_deviation(y), moments::standard_deviation(v)};
  const auto portrait = [&](std::span<const double> first, std::span<const double> second) {
    MatrixXd points(static_cast<Index>(first.size()), 2);
    for (Index i = 0; i < points.rows(); ++i)
      points.row(i) << first[static_cast<std::size_t>(i)] / scale[0], second[static_cast<std::size_t>(i)] / scale[1];
    return points;
  };
  check_columns("dtw", {model_y, model_v}, {.may_be_constant = true});
  return dtw(portrait(y, v), portrait(model_y, model_v), band) / static_cast<double>(y.size());
}

}  // namespace lunid
