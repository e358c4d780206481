// Which constraints cannot be met together, and which features they need.
#include <algorithm>
#include <cmath>

#include "regress/quadratic.hpp"
#include "regress/reduce.hpp"

namespace lunid::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Whether some coefficients meet the constraints `which`, those of `zero` being 0: the point nearest to the origin, in
/// units of the features' sizes.
bool feasible(std::span<const Constraint> constraints, const std::vector<int>& which, const VectorXd& size,
              const std::vector<bool>& zero) {
  std::vector<VectorXd> rows;
  std::vector<double> bounds;
  int equalities = 0;
  for (const bool equality : {true, false})
    for (const int i : which) {
      const Constraint& c = constraints[at(i)];
      if (c.equality() != equality) continue;
      VectorXd row = VectorXd::Zero(size.size());
      for (const auto& [feature, weight] : c.terms)
        if (zero.empty() || !zero[at(feature)]) row[feature] += size[feature] > 0 ? weight / size[feature] : weight;
      const double length = row.norm();
      if (length == 0) {  // nothing is left of it but 0
        if (c.lower > 0 || c.upper < 0) return false;
        continue;
      }
      if (std::isfinite(c.lower)) {
        rows.push_back(row / length);
        bounds.push_back(c.lower / length);
        equalities += equality;
      }
      if (std::isfinite(c.upper) && !equality) {
        rows.push_back(-row / length);
        bounds.push_back(-c.upper / length);
      }
    }
  const Index n = size.size(), m = static_cast<Index>(rows.size());
  MatrixXd c(m, n);
  VectorXd d(m);
  for (Index i = 0; i < m; ++i) {
    c.row(i) = rows[static_cast<std::size_t>(i)].transpose();
    d[i] = bounds[static_cast<std::size_t>(i)];
  }
  return solve_quadratic(MatrixXd::Identity(n, n), VectorXd::Zero(n), c, d, equalities).blocked < 0;
}

/// A smallest set of constraints that cannot be met together (Chinneck & Dravnieks 1991, ORSA J. Comput. 3, 157: the
/// deletion filter); empty when all can.
std::vector<int> contradiction(std::span<const Constraint> constraints, const VectorXd& size,
                               const std::vector<bool>& zero) {
  std::vector<int> set;
  for (int i = 0; i < static_cast<int>(constraints.size()); ++i) set.push_back(i);
  if (feasible(constraints, set, size, zero)) return {};
  for (std::size_t k = 0; k < set.size();) {
    std::vector<int> without = set;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
    if (feasible(constraints, without, size, zero))
      ++k;
    else
      set = std::move(without);
  }
  return set;
}

VectorXd sizes(const Statistic& data) { return data.rms().head(data.features()); }

}  // namespace

std::vector<bool> admissible(std::vector<bool> zero, const Statistic& data, std::span<const Constraint> constraints) {
  if (constraints.empty()) return zero;
  const VectorXd size = sizes(data);
  for (bool given_back = true; given_back;) {
    given_back = false;
    for (const int i : contradiction(constraints, size, zero))
      for (const auto& term : constraints[at(i)].terms) {
        given_back = given_back || zero[at(term.first)];
        zero[at(term.first)] = false;
      }
  }
  return zero;
}

void only_fixed(const char* solver, const Statistic& data, std::span<const Constraint> constraints) {
  for (const Constraint& c : constraints)
    if (!c.equality() || c.terms.size() != 1)
      throw InputError(std::string(solver) + ": cannot honour the constraint '" + to_text(c, data.names()) +
                           "', only fixed coefficients: leave it out or take another solver",
                       c.where);
}

void refuse_contradiction(const Statistic& data, std::span<const Constraint> constraints) {
  const std::vector<int> set = contradiction(constraints, sizes(data), {});
  if (set.empty()) return;
  const Constraint& last = constraints[at(set.back())];
  std::string text = "constraint '" + to_text(last, data.names()) + "' contradicts ";
  for (std::size_t k = 0; k + 1 < set.size(); ++k) {
    const Constraint& c = constraints[at(set[k])];
    const std::string place = to_text(c.where);
    text += (k == 0 ? "'" : " together with '") + to_text(c, data.names()) + "'" +
            (place.empty() ? "" : " (" + place + ")");
  }
  throw InputError(set.size() == 1 ? "constraint '" + to_text(last, data.names()) + "' cannot be met" : text,
                   last.where);
}

}  // namespace lunid::detail
