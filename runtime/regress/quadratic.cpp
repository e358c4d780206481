#include "regress/quadratic.hpp"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The iteration's state, in the paper's letters: x, the active set with its multipliers u, J = R^-1 Q and the
/// triangle of the active constraints in J's coordinates.
class DualActiveSet {
 public:
  DualActiveSet(const MatrixXd& r, const VectorXd& z, const MatrixXd& c, const VectorXd& d, int equalities)
      : c_(c),
        d_(d),
        equalities_(equalities),
        n_(r.cols()),
        sign_(VectorXd::Ones(c.rows())),
        triangle_(MatrixXd::Zero(n_, n_)),
        in_(static_cast<std::size_t>(c.rows()), false) {
    x_ = r.triangularView<Eigen::Upper>().solve(z);
    j_ = r.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(n_, n_));
  }

  QuadraticSolution run() {
    QuadraticSolution out;
    for (int row = 0; row < equalities_ && out.blocked < 0; ++row) {
      if (slack(row) > 0) sign_[row] = -1;  // approach an equality from below
      if (!take_up(row)) out.blocked = row;
    }
    // Each turn raises the dual function, so that no active set comes twice; the limit stops rounding from cycling.
    const int limit = 50 * static_cast<int>(c_.rows() + n_) + 100;
    for (int row = 0; out.blocked < 0 && (row = most_violated()) >= 0;) {
      out.finished = iterations_ < limit;
      if (!out.finished) break;
      if (!take_up(row)) out.blocked = row;
    }
    out.x = x_;
    out.multipliers = VectorXd::Zero(c_.rows());
    for (std::size_t k = 0; k < active_.size(); ++k) out.multipliers[active_[k]] = sign_[active_[k]] * u_[k];
    out.active = active_;
    out.iterations = iterations_;
    return out;
  }

 private:
  double slack(int row) const { return sign_[row] * (c_.row(row).dot(x_) - d_[row]); }
  double tolerance(int row) const { return 1e-12 * (x_.norm() * c_.row(row).norm() + std::abs(d_[row])); }

  int most_violated() const {
    int worst = -1;
    double least = 0;
    for (int row = equalities_; row < c_.rows(); ++row) {
      if (in_[static_cast<std::size_t>(row)]) continue;
      const double s = slack(row);
      if (s < -tolerance(row) && s < least) {
        least = s;
        worst = row;
      }
    }
    return worst;
  }

  /// Steps until constraint `row` is active; false when no x can meet it together with those that cannot be dropped.
  bool take_up(int row) {
    const VectorXd normal = sign_[row] * c_.row(row).transpose();
    double multiplier = 0;
    for (;;) {
      ++iterations_;
      const Index q = static_cast<Index>(active_.size());
      const VectorXd along = j_.transpose() * normal;
      const double free = along.tail(n_ - q).norm();
      const bool dependent = free <= 1e-13 * along.norm();
      const VectorXd fall = triangle_.topLeftCorner(q, q).triangularView<Eigen::Upper>().solve(along.head(q));

      double partial = kInfinity;
      Index leaving = -1;
      for (Index k = 0; k < q; ++k)
        if (active_[static_cast<std::size_t>(k)] >= equalities_ && fall[k] > 0 &&
            u_[static_cast<std::size_t>(k)] / fall[k] < partial) {
          partial = u_[static_cast<std::size_t>(k)] / fall[k];
          leaving = k;
        }
      const double gap = -slack(row), full = dependent ? kInfinity : gap / (free * free);
      if (dependent && gap <= tolerance(row)) return true;  // already met by the active ones
      if (partial == kInfinity && full == kInfinity) return false;

      const double step = std::min(partial, full);
      if (full < kInfinity) x_ += step * (j_.rightCols(n_ - q) * along.tail(n_ - q));
      for (Index k = 0; k < q; ++k) u_[static_cast<std::size_t>(k)] -= step * fall[k];
      multiplier += step;
      if (step == full) {
        add(row, along, multiplier);
        return true;
      }
      drop(leaving);
    }
  }

  /// A reflection of J's free columns turns the new constraint's free part into one entry.
  void add(int row, const VectorXd& along, double multiplier) {
    const Index q = static_cast<Index>(active_.size()), m = n_ - q;
    VectorXd v = along.tail(m);
    const double beta = -std::copysign(v.norm(), v[0]);
    triangle_.col(q).head(q) = along.head(q);
    triangle_(q, q) = beta;
    v[0] -= beta;
    const double norm2 = v.squaredNorm();
    if (norm2 > 0) {
      const VectorXd product = j_.rightCols(m) * v;
      j_.rightCols(m) -= (2 / norm2) * product * v.transpose();
    }
    active_.push_back(row);
    u_.push_back(multiplier);
    in_[static_cast<std::size_t>(row)] = true;
  }

  /// Removes the k-th active constraint and restores the triangle by plane rotations.
  void drop(Index k) {
    const Index q = static_cast<Index>(active_.size());
    in_[static_cast<std::size_t>(active_[static_cast<std::size_t>(k)])] = false;
    active_.erase(active_.begin() + k);
    u_.erase(u_.begin() + k);
    for (Index column = k; column + 1 < q; ++column)
      triangle_.col(column).head(column + 2) = triangle_.col(column + 1).head(column + 2);
    triangle_.col(q - 1).setZero();
    for (Index i = k; i + 1 < q; ++i) {
      Eigen::JacobiRotation<double> turn;
      turn.makeGivens(triangle_(i, i), triangle_(i + 1, i));
      triangle_.applyOnTheLeft(i, i + 1, turn.adjoint());
      triangle_(i + 1, i) = 0;
      j_.applyOnTheRight(i, i + 1, turn);
    }
  }

  const MatrixXd& c_;
  const VectorXd& d_;
  int equalities_;
  Index n_;
  VectorXd sign_, x_;
  MatrixXd j_, triangle_;
  std::vector<int> active_;  // rows of c_
  std::vector<double> u_;    // their multipliers
  std::vector<bool> in_;
  int iterations_ = 0;
};

}  // namespace

QuadraticSolution solve_quadratic(const MatrixXd& r, const VectorXd& z, const MatrixXd& c, const VectorXd& d,
                                  int equalities) {
  return DualActiveSet(r, z, c, d, equalities).run();
}

}  // namespace lunid
