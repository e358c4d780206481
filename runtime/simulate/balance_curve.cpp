// The branch of answers by harmonic balance, with as many harmonics as the motion asks for.
#include <algorithm>
#include <cmath>

#include "simulate/harmonic_choice.hpp"
#include "simulate/periodic.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class BalanceCurve : public PeriodicCurve {
 public:
  explicit BalanceCurve(const PeriodicProblem& problem)
      : problem_(problem),
        balance_(*problem.dynamics, problem.theta, problem.inputs),
        monodromy_(*problem.dynamics, problem.theta, problem.inputs),
        choice_(*problem.dynamics, problem.harmonics, problem.max_harmonics, problem.accuracy),
        largest_(VectorXd::Zero(static_cast<Index>(balance_.unknowns().size()))) {
    choice_.begin(balance_);
  }

  Index size() const override { return balance_.size(); }

  bool evaluate(const VectorXd& q, double lambda, VectorXd& r, MatrixXd* dx, VectorXd* dlambda) override {
    check_cancelled(problem_.cancelled);
    if (!balance_.residual(q, std::exp(lambda), 0, r, dx ? &slopes_ : nullptr)) return false;
    if (dx) {
      dx->swap(slopes_.q);
      *dlambda = std::exp(lambda) * slopes_.omega;
    }
    return true;
  }

  VectorXd weights(const VectorXd& q, double) override { return series_weights(balance_, q, largest_); }

  bool adapt(const VectorXd& q, double lambda, const std::vector<VectorXd*>& vectors) override {
    if (!choice_.adapt(balance_, q, std::exp(lambda))) return false;
    for (VectorXd* vector : vectors) *vector = balance_.resized(*vector, balance_.harmonics());
    return true;
  }

  VectorXd guess() override {
    const VectorXd& start = problem_.start;
    VectorXd q = VectorXd::Zero(size());
    for (std::size_t i = 0; i < balance_.unknowns().size(); ++i)
      q[static_cast<Index>(i) * balance_.rows()] = start[balance_.unknowns()[i]];
    return q;
  }

  VectorXd of_period(const Period& period) override {
    const Index rows = period.x.rows() - 1;
    const int count = std::min<int>(balance_.harmonics(), static_cast<int>(rows) / 2 - 1);
    const MatrixXd x = FourierTable(count, rows).series(period.x.topRows(rows));
    VectorXd q(static_cast<Index>(balance_.unknowns().size()) * x.rows());
    for (std::size_t i = 0; i < balance_.unknowns().size(); ++i)
      q.segment(static_cast<Index>(i) * x.rows(), x.rows()) = x.col(balance_.unknowns()[i]);
    return balance_.resized(q, balance_.harmonics());
  }

  bool motions(const VectorXd& q, double lambda, std::vector<Motion>& motions) override {
    const MatrixXd x = balance_.series(q, std::exp(lambda));
    motions.clear();
    for (Index i = 0; i < x.cols(); ++i) motions.push_back(motion_of_series(x.col(i)));
    return x.allFinite();
  }

  Multipliers multipliers(const VectorXd& q, double lambda) override {
    const double omega = std::exp(lambda);
    return multipliers_of(monodromy_.along(balance_.series(q, omega), omega));
  }

  double amplitude(const VectorXd& q, double lambda, int state) override {
    return motion_of_series(balance_.series(q, std::exp(lambda)).col(state)).amplitude();
  }

  int harmonics() const override { return balance_.harmonics(); }
  bool truncated() const override { return choice_.truncated(); }

 private:
  PeriodicProblem problem_;
  HarmonicBalance balance_;
  Monodromy monodromy_;
  HarmonicChoice choice_;
  HarmonicBalance::Slopes slopes_;
  VectorXd largest_;
};

}  // namespace

std::unique_ptr<PeriodicCurve> make_balance_curve(const PeriodicProblem& problem) {
  return std::make_unique<BalanceCurve>(problem);
}

}  // namespace lunid
