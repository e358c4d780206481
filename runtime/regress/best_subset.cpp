// The best subset of each size, by branch and bound.
#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "expr/digits.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"
#include "regress/subset.hpp"

namespace lunid {
namespace {

using detail::Subsets;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMost = 30;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// The tree of dropped features. A node is a list of candidates of which the first `kept` stay in all below it, with
/// the triangular factor of [them in this order, target]: its leading columns give the sums of squares of the leading
/// subsets for nothing. A node's own sum is the least of all below it.
class Search {
 public:
  Search(const Subsets& subsets, long max_nodes)
      : subsets_(subsets),
        max_nodes_(max_nodes),
        best_(at(subsets.count() + 1), kInfinity),
        models_(at(subsets.count() + 1)) {}

  void run() {
    const Index n = subsets_.count();
    std::vector<int> all(at(n));
    std::iota(all.begin(), all.end(), 0);
    std::stable_partition(all.begin(), all.end(), [&](int k) { return needed(k); });
    MatrixXd r = MatrixXd::Zero(n + 1, n + 1);
    for (Index i = 0; i < n; ++i) r.col(i).head(n) = subsets_.problem().r.col(all[at(i)]);
    r.col(n).head(n) = subsets_.problem().z;
    MatrixXd triangle = MatrixXd::Zero(n + 1, n + 1);
    triangularise(triangle, r);
    const std::size_t kept = subsets_.needed().size();
    offer({all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept)}, kInfinity);
    visit(all, triangle, static_cast<Index>(kept));
  }

  bool complete() const { return nodes_ < max_nodes_; }
  long nodes() const { return nodes_; }
  double best(int size) const { return best_[at(size)]; }
  const std::vector<int>& model(int size) const { return models_[at(size)]; }

 private:
  bool needed(int k) const {
    return std::find(subsets_.needed().begin(), subsets_.needed().end(), k) != subsets_.needed().end();
  }

  /// A subset with its sum of squares without the constraints (or infinite, when it is not known).
  void offer(std::vector<int> in, double free) {
    const std::size_t size = in.size();
    if (std::isfinite(free) && free >= best_[size]) return;
    const double rss = subsets_.constrained() || std::isinf(free) ? subsets_.rss(in) : free;
    if (rss >= best_[size]) return;
    best_[size] = rss;
    models_[size] = std::move(in);
  }

  /// The least sum of squares that a subset of at least `size` candidates has to beat: best_ falls with the size, but
  /// for sizes that no model has been found for.
  double to_beat(Index size, Index largest) const {
    double value = 0;
    for (Index k = size; k <= largest; ++k) value = std::max(value, best_[at(k)]);
    return value;
  }

  void visit(std::vector<int> list, MatrixXd r, Index kept) {
    if (++nodes_ >= max_nodes_) return;
    const Index n = static_cast<Index>(list.size());
    order(list, r, kept);
    double sum = subsets_.rest() + r(n, n) * r(n, n);
    std::vector<double> leading(at(n + 1));
    for (Index k = n; k > kept; --k) {
      leading[at(k)] = sum;
      sum += r(k - 1, n) * r(k - 1, n);
    }
    for (Index k = kept + 1; k <= n; ++k)
      offer({list.begin(), list.begin() + static_cast<std::ptrdiff_t>(k)}, leading[at(k)]);
    const double bound = leading[at(n)];
    for (Index i = kept; i + 1 < n; ++i) {
      if (bound >= to_beat(i + 1, n - 1)) continue;
      std::vector<int> rest = list;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      visit(std::move(rest), dropped(r, i), i);
      if (nodes_ >= max_nodes_) return;
    }
  }

  /// The factor without column i, restored by plane rotations; the target's last entry takes up what falls out.
  static MatrixXd dropped(const MatrixXd& r, Index i) {
    const Index n = r.cols() - 1;
    MatrixXd out(n + 1, n);
    out.leftCols(i) = r.leftCols(i);
    out.rightCols(n - i) = r.rightCols(n - i);
    for (Index k = i; k < n; ++k) {
      Eigen::JacobiRotation<double> turn;
      turn.makeGivens(out(k, k), out(k + 1, k));
      out.rightCols(n - k).applyOnTheLeft(k, k + 1, turn.adjoint());
    }
    return out.topRows(n);
  }

  /// The candidates that may still be dropped, the one that is missed most first: good models are met early, and the
  /// large branches hang on features that are hard to do without.
  void order(std::vector<int>& list, MatrixXd& r, Index kept) const {
    const Index n = static_cast<Index>(list.size());
    if (n - kept < 3) return;
    // Rise of the sum of squares without feature k: b_k^2 / ((X'X)^-1)_kk.
    const MatrixXd inverse = r.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(MatrixXd::Identity(n, n));
    const Eigen::VectorXd b = inverse * r.col(n).head(n);
    std::vector<Index> place(at(n));
    std::iota(place.begin(), place.end(), 0);
    const auto rise = [&](Index k) { return b[k] * b[k] / inverse.row(k).squaredNorm(); };
    std::stable_sort(place.begin() + static_cast<std::ptrdiff_t>(kept), place.end(),
                     [&](Index p, Index q) { return rise(p) > rise(q); });
    MatrixXd block(n + 1, n + 1);
    std::vector<int> sorted;
    for (Index i = 0; i < n; ++i) {
      block.col(i) = r.col(place[at(i)]);
      sorted.push_back(list[at(place[at(i)])]);
    }
    block.col(n) = r.col(n);
    r.setZero();
    triangularise(r, block);
    list = std::move(sorted);
  }

  const Subsets& subsets_;
  long max_nodes_, nodes_ = 0;
  std::vector<double> best_;  // by size
  std::vector<std::vector<int>> models_;
};

}  // namespace

void validate(const BestSubsetOptions& options) {
  if (options.terms < 0) throw InputError("best_subset: terms: expected >= 0, got " + std::to_string(options.terms));
  if (options.max_nodes < 1)
    throw InputError("best_subset: max_nodes: expected >= 1, got " + std::to_string(options.max_nodes));
}

Fit best_subset(const Statistic& data, const BestSubsetOptions& options, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  validate(options);
  const Subsets subsets(data, constraints);
  if (subsets.count() > kMost)
    throw InputError("best_subset: expected at most " + std::to_string(kMost) + " features that are not fixed, got " +
                     std::to_string(subsets.count()) + ": the search grows as 2^features, take frols or stepwise");
  const int least = static_cast<int>(subsets.needed().size());
  if (options.terms > subsets.count() || (options.terms > 0 && options.terms < least))
    throw InputError("best_subset: terms: expected " + std::to_string(least) + " to " +
                     std::to_string(subsets.count()) + ", got " + std::to_string(options.terms));
  Search search(subsets, options.max_nodes);
  search.run();
  std::vector<SelectionStep> steps;
  int chosen = options.terms;
  double value = kInfinity, before = subsets.target();
  for (int size = least; size <= subsets.count(); ++size) {
    if (std::isinf(search.best(size))) continue;
    const bool bic = options.criterion == Criterion::bic;
    const double rss = search.best(size), now = detail::information(bic, subsets.rows(), rss, subsets.target(), size);
    const double fall = subsets.target() > 0 ? (before - rss) / subsets.target() : 0;
    steps.push_back({subsets.features(search.model(size)), -1, true, fall, std::sqrt(rss / subsets.rows()), now});
    before = rss;
    if (options.terms == 0 && now < value) {
      value = now;
      chosen = size;
    }
  }
  Fit fit = subsets.fit(search.model(chosen));
  fit.steps = std::move(steps);
  fit.summary.solver = "best subset, " + std::to_string(chosen) + " terms" +
                       (options.terms > 0                     ? ""
                        : options.criterion == Criterion::bic ? " by BIC"
                                                              : " by AICc");
  fit.summary.iterations = static_cast<int>(search.nodes());
  fit.summary.converged = fit.summary.converged && search.complete();
  fit.summary.stopped = search.complete() ? "all subsets searched or bounded" : "max_nodes reached";
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
