// The branch of answers by shooting: the state that comes back to itself after one period of the excitation (Nayfeh &
// Balachandran 1995, Applied nonlinear dynamics, section 5). Runs and their sensitivities are those of the fixed path,
// exact through switches, so that models with friction, stops and slip are followed as they are.
#include <Eigen/SVD>
#include <cmath>

#include "simulate/periodic.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Step in log(omega) for the derivative by it: half of the digits.
constexpr double frequency_step = 1e-6;
constexpr int reported_harmonics = 15;
constexpr double least_scale = 1e-3;
/// A direction along which the state comes back whatever it is, but for this part of the most that others do not.
constexpr double open_direction = 1e-9;
/// Extremes of motions with kinks are looked for on a grid that is so many times finer: a reversal under dry friction
/// is a jump of the acceleration between two samples.
constexpr int fine_grid = 8;

class ShootingCurve : public PeriodicCurve {
 public:
  explicit ShootingCurve(const PeriodicProblem& problem)
      : problem_(problem),
        pairs_(displacement_pairs(*problem.dynamics)),
        run_(problem),
        scale_(VectorXd::Zero(problem.dynamics->n)),
        largest_(scale_) {}

  Index size() const override { return problem_.dynamics->n; }

  bool evaluate(const VectorXd& x, double lambda, VectorXd& r, MatrixXd* dx, VectorXd* dlambda) override {
    if (!at(x, lambda, dx != nullptr)) return false;
    r = period_.end() - x;
    if (!dx) return true;
    *dx = period_.monodromy - MatrixXd::Identity(size(), size());
    const Period aside = run_.run(x, std::exp(lambda + frequency_step), false);
    if (!aside.fault.empty()) return false;
    *dlambda = (aside.end() - period_.end()) / frequency_step;
    if (!dx->allFinite()) return false;
    centre(x, lambda, r, *dx);
    return true;
  }

  VectorXd weights(const VectorXd& x, double) override {
    if (period_.x.rows() > 0) measure();
    VectorXd w(size());
    for (Index i = 0; i < w.size(); ++i) {
      const double scale = std::max(scale_[i], least_scale * largest_[i]);
      w[i] = scale > 0 ? 1 / (scale * std::sqrt(static_cast<double>(size()))) : 1;
    }
    return w;
  }

  bool adapt(const VectorXd& x, double lambda, const std::vector<VectorXd*>&) override {
    if (!at(x, lambda, false)) return false;
    const Index before = run_.rows();
    run_.choose_rows(period_);
    if (run_.rows() == before) return false;
    known_ = false;
    return run_.rows() > before;
  }

  VectorXd guess() override { return problem_.start; }
  VectorXd of_period(const Period& period) override { return period.end(); }

  bool motions(const VectorXd& x, double lambda, std::vector<Motion>& motions) override {
    const Period period = fine(x, lambda);
    if (!period.fault.empty()) return false;
    motions = period.motions(reported_harmonics, run_.kinks());
    return true;
  }

  Multipliers multipliers(const VectorXd& x, double lambda) override {
    if (!at(x, lambda, true)) return Multipliers(size(), {std::nan(""), 0});
    return multipliers_of(period_.monodromy);
  }

  double amplitude(const VectorXd& x, double lambda, int state) override {
    const Period period = fine(x, lambda);
    return motion_of_samples(period.x.col(state), period.rate.col(state), period.dt(), 0).amplitude();
  }

  std::string fault() const override { return period_.fault; }

 private:
  /// The period from x, kept until another is asked for.
  bool at(const VectorXd& x, double lambda, bool sensitivities) {
    const bool enough = known_ && (!sensitivities || period_.monodromy.size() > 0);
    if (enough && lambda == lambda_ && x == x_) return period_.fault.empty();
    if (run_.steps() == 0)
      if (const std::string fault = run_.choose_rows(x, std::exp(lambda)); !fault.empty()) {
        period_.fault = fault;
        return false;
      }
    period_ = run_.run(x, std::exp(lambda), sensitivities);
    x_ = x;
    lambda_ = lambda;
    known_ = true;
    return period_.fault.empty();
  }

  /// Where a rest may lie anywhere (a slider that does not slip, a mass on no spring) the answer is one of many: that
  /// whose mean along the open direction is the state of rest.
  void centre(const VectorXd& x, double lambda, VectorXd& r, MatrixXd& dx) {
    const VectorXd w = weights(x, lambda);
    const MatrixXd scaled = w.asDiagonal() * dx * w.cwiseInverse().asDiagonal();
    const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const VectorXd mean = period_.x.topRows(period_.x.rows() - 1).colwise().mean();
    for (Index k = 0; k < size(); ++k) {
      if (svd.singularValues()[k] > open_direction * svd.singularValues()[0]) continue;
      const VectorXd out = svd.matrixU().col(k).cwiseQuotient(w), along = svd.matrixV().col(k).cwiseProduct(w);
      r += out * along.dot(mean - problem_.start);
      dx += out * (along.transpose() * period_.mean_slope);
    }
  }

  Period fine(const VectorXd& x, double lambda) {
    return run_.run_fine(x, std::exp(lambda), problem_.dynamics->smooth() ? 1 : fine_grid);
  }

  /// The sizes of the states over the period; displacements share theirs, and so do velocities.
  void measure() {
    for (Index i = 0; i < size(); ++i) scale_[i] = 0.5 * (period_.x.col(i).maxCoeff() - period_.x.col(i).minCoeff());
    double y_size = 0, v_size = 0;
    for (const auto& [y, v] : pairs_) {
      y_size = std::max(y_size, scale_[y]);
      v_size = std::max(v_size, scale_[v]);
    }
    for (const auto& [y, v] : pairs_) {
      scale_[y] = y_size;
      scale_[v] = v_size;
    }
    for (Index i = 0; i < size(); ++i)
      if (std::isfinite(scale_[i])) largest_[i] = std::max(largest_[i], scale_[i]);
  }

  PeriodicProblem problem_;
  std::vector<std::pair<int, int>> pairs_;
  PeriodRun run_;
  Period period_;
  VectorXd scale_, largest_, x_;
  double lambda_ = 0;
  bool known_ = false;
};

}  // namespace

std::unique_ptr<PeriodicCurve> make_shooting_curve(const PeriodicProblem& problem) {
  return std::make_unique<ShootingCurve>(problem);
}

}  // namespace lunid
