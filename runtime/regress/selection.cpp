// Forward regression by error reduction ratio, and stepwise selection.
#include <algorithm>
#include <cmath>
#include <limits>

#include "expr/digits.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"
#include "regress/subset.hpp"

namespace lunid {

using detail::Stopwatch;
using detail::Subsets;

namespace {

bool contains(const std::vector<int>& list, int k) { return std::find(list.begin(), list.end(), k) != list.end(); }

std::vector<int> with(std::vector<int> list, int k) {
  list.push_back(k);
  return list;
}

std::vector<int> without(std::vector<int> list, int k) {
  list.erase(std::find(list.begin(), list.end(), k));
  return list;
}

SelectionStep step_of(const Subsets& subsets, const std::vector<int>& in, int k, bool added, double before,
                      double after, double criterion) {
  return {subsets.features(in),
          subsets.columns()[static_cast<std::size_t>(k)],
          added,
          subsets.target() > 0 ? (before - after) / subsets.target() : 0,
          std::sqrt(after / subsets.rows()),
          criterion};
}

/// The candidate outside `in` whose addition leaves the least sum of squares; -1 when there is none.
int best_addition(const Subsets& subsets, const std::vector<int>& in, double& rss) {
  int best = -1;
  rss = std::numeric_limits<double>::infinity();
  for (int k = 0; k < subsets.count(); ++k) {
    if (contains(in, k)) continue;
    const double value = subsets.rss(with(in, k));
    if (value >= rss) continue;
    rss = value;
    best = k;
  }
  return best;
}

int best_removal(const Subsets& subsets, const std::vector<int>& in, double& rss) {
  int best = -1;
  rss = std::numeric_limits<double>::infinity();
  for (const int k : in) {
    if (contains(subsets.needed(), k)) continue;
    const double value = subsets.rss(without(in, k));
    if (value >= rss) continue;
    rss = value;
    best = k;
  }
  return best;
}

/// The features without which the constraints cannot be met come first, the most explaining before the others.
std::vector<int> begin(const Subsets& subsets, bool bic, std::vector<SelectionStep>& steps) {
  std::vector<int> in, left = subsets.needed();
  double before = subsets.target();
  while (!left.empty()) {
    int best = left.front();
    for (const int k : left)
      if (subsets.unconstrained(with(in, k)) < subsets.unconstrained(with(in, best))) best = k;
    in.push_back(best);
    left = without(left, best);
    const double after = left.empty() ? subsets.rss(in) : subsets.unconstrained(in);
    const double value = detail::information(bic, subsets.rows(), after, subsets.target(), static_cast<int>(in.size()));
    steps.push_back(step_of(subsets, in, best, true, before, after, value));
    before = after;
  }
  return in;
}

void finish(Fit& fit, std::string solver, std::string stopped, std::vector<SelectionStep> steps,
            const Stopwatch& watch) {
  fit.summary.solver = std::move(solver);
  fit.summary.stopped = std::move(stopped);
  fit.summary.iterations = static_cast<int>(steps.size());
  fit.steps = std::move(steps);
  fit.summary.seconds = watch.seconds();
}

void check_terms(const char* where, int terms) {
  if (terms < 0) throw InputError(std::string(where) + ": max_terms: expected >= 0, got " + std::to_string(terms));
}

int at_most(int max_terms, const Subsets& subsets) { return max_terms > 0 ? max_terms : subsets.count(); }

}  // namespace

void validate(const FrolsOptions& options) {
  if (!(options.threshold >= 0 && options.threshold < 1))
    throw InputError("frols: threshold: expected >= 0 and < 1 (part of the target's sum of squares), got " +
                     exact_number(options.threshold));
  check_terms("frols", options.max_terms);
}

Fit frols(const Statistic& data, const FrolsOptions& options, std::span<const Constraint> constraints) {
  const Stopwatch watch;
  validate(options);
  const Subsets subsets(data, constraints);
  std::vector<SelectionStep> steps;
  std::vector<int> in = begin(subsets, true, steps);
  std::string stopped = "all features taken up";
  for (double before = subsets.rss(in); static_cast<int>(in.size()) < subsets.count();) {
    double after = 0;
    const int best = best_addition(subsets, in, after);
    const double ratio = best < 0 ? 0 : (before - after) / subsets.target();
    stopped = "no error reduction ratio above the threshold";
    if (best < 0 || !(ratio >= options.threshold) || ratio <= 0) break;
    stopped = "max_terms reached";
    if (static_cast<int>(in.size()) >= at_most(options.max_terms, subsets)) break;
    in.push_back(best);
    const double value =
        detail::information(true, subsets.rows(), after, subsets.target(), static_cast<int>(in.size()));
    steps.push_back(step_of(subsets, in, best, true, before, after, value));
    before = after;
    stopped = "all features taken up";
  }
  Fit fit = subsets.fit(in);
  finish(fit, "frols, threshold = " + number(options.threshold, 4), stopped, std::move(steps), watch);
  return fit;
}

void validate(const StepwiseOptions& options) { check_terms("stepwise", options.max_terms); }

Fit stepwise(const Statistic& data, const StepwiseOptions& options, std::span<const Constraint> constraints) {
  const Stopwatch watch;
  validate(options);
  const bool bic = options.criterion == Criterion::bic;
  const Subsets subsets(data, constraints);
  const auto value_of = [&](double rss, std::size_t terms) {
    return detail::information(bic, subsets.rows(), rss, subsets.target(), static_cast<int>(terms));
  };
  std::vector<SelectionStep> steps;
  std::vector<int> in = begin(subsets, bic, steps);
  double rss = subsets.rss(in), value = value_of(rss, in.size());
  std::string stopped = "no step lowers the criterion";
  for (;;) {  // each step lowers the criterion, so that no model comes twice
    double larger = 0, smaller = 0;
    const bool room = static_cast<int>(in.size()) < at_most(options.max_terms, subsets);
    const int add = room ? best_addition(subsets, in, larger) : -1;
    const int drop = best_removal(subsets, in, smaller);
    const double added = add >= 0 ? value_of(larger, in.size() + 1) : std::numeric_limits<double>::infinity();
    const double dropped = drop >= 0 ? value_of(smaller, in.size() - 1) : std::numeric_limits<double>::infinity();
    if (!(std::min(added, dropped) < value)) {
      if (!room && subsets.count() > static_cast<int>(in.size())) stopped = "max_terms reached";
      break;
    }
    const bool grows = added <= dropped;
    in = grows ? with(in, add) : without(in, drop);
    value = std::min(added, dropped);
    steps.push_back(step_of(subsets, in, grows ? add : drop, grows, rss, grows ? larger : smaller, value));
    rss = grows ? larger : smaller;
  }
  Fit fit = subsets.fit(in);
  finish(fit, std::string("stepwise by ") + (bic ? "BIC" : "AICc"), stopped, std::move(steps), watch);
  return fit;
}

}  // namespace lunid
