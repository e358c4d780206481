#include "regress/statistic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Rows per block: with 23 columns it stays in the second-level cache; in fewer rows the panels cost more than they
/// save.
constexpr Index kBlock = 512;
/// Fewer rows than this go straight into the factor in extended precision.
constexpr Index kFew = 512;

[[noreturn]] void refuse_value(const std::vector<std::string>& names, Index column, Index row, double value) {
  const bool target = column == static_cast<Index>(names.size());
  throw InputError((target ? std::string("the target") : "feature '" + names[column] + "'") + " is " +
                       (std::isnan(value) ? "not a number" : "infinite") + " at row " + std::to_string(row + 1) +
                       ": leave such rows out, or mend the record",
                   {}, Fault::data);
}

}  // namespace

Statistic::Statistic(std::vector<std::string> features) : names_(std::move(features)) {
  const Index k = static_cast<Index>(names_.size()) + 2;
  r_ = LongMatrix::Zero(k, k);
  std::vector<std::string> sorted = names_;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) throw InputError("feature '" + *twice + "' is given twice");
}

void Statistic::add(const Eigen::Ref<const MatrixXd>& x, const Eigen::Ref<const VectorXd>& target) {
  const Index n = features();
  if (x.cols() != n || target.size() != x.rows())
    throw InputError("statistic: expected " + std::to_string(n) + " columns and as many targets as rows, got " +
                     std::to_string(x.cols()) + " columns, " + std::to_string(x.rows()) + " rows and " +
                     std::to_string(target.size()) + " targets");
  MatrixXd work(x.rows(), n + 2);
  work.middleCols(1, n) = x;
  work.col(n + 1) = target;
  add_in_place(work);
}

void Statistic::add_in_place(Eigen::Ref<MatrixXd> work) {
  if (work.cols() != r_.cols())
    throw InputError("statistic: expected " + std::to_string(r_.cols()) + " columns of work space, got " +
                     std::to_string(work.cols()));
  for (Index j = 1; j < work.cols(); ++j) {
    if (std::isfinite(work.col(j).sum())) continue;
    for (Index i = 0; i < work.rows(); ++i)
      if (!std::isfinite(work(i, j))) refuse_value(names_, j - 1, rows_ + i, work(i, j));
  }
  work.col(0).setOnes();
  rows_ += work.rows();
  if (work.rows() < kFew) return triangularise(r_, work.cast<long double>());
  MatrixXd r = MatrixXd::Zero(work.cols(), work.cols());
  for (Index first = 0; first < work.rows(); first += kBlock)
    triangularise(r, work.middleRows(first, std::min(kBlock, work.rows() - first)));
  triangularise(r_, r.cast<long double>());
}

void Statistic::merge(const Statistic& other) {
  if (names_ != other.names_) throw InputError("statistic: merged with one of other features");
  triangularise(r_, other.r_);
  rows_ += other.rows_;
}

void Statistic::weigh_mean(double part) {
  LongMatrix row = r_.row(0) / r_(0, 0) * std::sqrt(static_cast<long double>(rows_) * part / (1 - part));
  row(0, 0) = 0;
  triangularise(r_, std::move(row));
}

Statistic Statistic::leading(int count) const {
  Statistic out(std::vector<std::string>(names_.begin(), names_.begin() + count));
  LongMatrix block(r_.rows(), count + 2);
  block << r_.leftCols(count + 1), r_.rightCols(1);
  triangularise(out.r_, std::move(block));
  out.rows_ = rows_;
  return out;
}

LongMatrix Statistic::factor() const {
  const Index k = r_.cols() - 1;
  LongMatrix r = LongMatrix::Zero(k, k);
  triangularise(r, r_.rightCols(k));
  return r;
}

Triangle Statistic::triangle() const {
  const Index n = features();
  const MatrixXd r = factor().cast<double>();
  return {r.topLeftCorner(n, n), r.col(n).head(n), r(n, n) * r(n, n), rows_};
}

double Statistic::residual_sum(const Eigen::Ref<const VectorXd>& b) const {
  const Index n = features();
  const LongVector left = r_.col(n + 1) - r_.middleCols(1, n) * b.cast<long double>();
  return static_cast<double>(left.squaredNorm());
}

VectorXd Statistic::rms() const {
  const VectorXd norm = r_.rightCols(r_.cols() - 1).colwise().norm().transpose().cast<double>();
  return norm / std::sqrt(static_cast<double>(rows_));
}

VectorXd Statistic::deviation() const {
  const Index k = r_.cols() - 1;
  const VectorXd norm = r_.bottomRightCorner(k, k).colwise().norm().transpose().cast<double>();
  return norm / std::sqrt(static_cast<double>(rows_));
}

VectorXd Statistic::mean() const { return (r_.row(0).tail(r_.cols() - 1).transpose() / r_(0, 0)).cast<double>(); }

int Statistic::constant_feature() const {
  const VectorXd spread = deviation(), size = rms();
  for (int j = 0; j < features(); ++j)
    if (size[j] > 0 && spread[j] <= 1e-13 * size[j]) return j;
  return -1;
}

Statistic merged(std::span<const Statistic> parts) {
  if (parts.empty()) throw InputError("statistic: nothing to merge");
  Statistic sum = parts.front();
  for (const Statistic& part : parts.subspan(1)) sum.merge(part);
  return sum;
}

}  // namespace lunid
