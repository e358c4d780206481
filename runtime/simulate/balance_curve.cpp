// The branch of answers by harmonic balance, with as many harmonics as the motion asks for.
#include <algorithm>
#include <cmath>

#include "simulate/balance.hpp"
#include "simulate/periodic.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int first_harmonics = 5, least_harmonics = 3;
constexpr Index least_samples = 128, most_samples = 4096;
/// Harmonics are given up where the highest kept are below this part of the accuracy, for so many points in a row.
constexpr double spare = 1e-4;
constexpr int patience = 6;
/// What lies above half of the sampled band comes back as aliases and is kept to this part of the accuracy.
constexpr double alias_part = 0.1;

Index samples_for(int harmonics) {
  Index samples = least_samples;
  while (samples < 8 * (harmonics + 1)) samples *= 2;
  return samples;
}

class BalanceCurve : public PeriodicCurve {
 public:
  explicit BalanceCurve(const PeriodicProblem& problem)
      : problem_(problem),
        balance_(*problem.dynamics, problem.theta, problem.inputs),
        monodromy_(*problem.dynamics, problem.theta, problem.inputs),
        largest_(VectorXd::Zero(static_cast<Index>(balance_.unknowns().size()))) {
    const int count = problem.harmonics > 0 ? problem.harmonics : std::min(first_harmonics, problem.max_harmonics);
    balance_.set_harmonics(count, samples_for(count));
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
    const HarmonicBalance::Tail tail = balance_.tail(q, std::exp(lambda));
    const double accuracy = problem_.accuracy;
    if (tail.aliased > alias_part * accuracy && balance_.samples() < most_samples) {
      balance_.set_harmonics(balance_.harmonics(), 2 * balance_.samples());
      return true;
    }
    truncated_ = tail.left_out > accuracy;
    if (problem_.harmonics > 0) return false;
    const int now = balance_.harmonics();
    if (truncated_ && now < problem_.max_harmonics) {
      calm_ = 0;
      return change(std::min(problem_.max_harmonics, now + std::max(2, now / 2)), vectors);
    }
    const int needed = needed_harmonics(q);
    calm_ = needed + 2 < now ? calm_ + 1 : 0;
    if (calm_ < patience) return false;
    calm_ = 0;
    return change(std::max(least_harmonics, needed + 2), vectors);
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
  bool truncated() const override { return truncated_; }

 private:
  /// The highest harmonic that is not negligible.
  int needed_harmonics(const VectorXd& q) const {
    const Index rows = balance_.rows();
    int needed = 1;
    for (std::size_t i = 0; i < balance_.unknowns().size(); ++i) {
      const auto part = q.segment(static_cast<Index>(i) * rows, rows);
      const double scale = part.tail(rows - 1).norm();
      for (int k = balance_.harmonics(); k > needed; --k)
        if (part.segment(2 * k - 1, 2).norm() > spare * problem_.accuracy * scale) needed = k;
    }
    return needed;
  }

  bool change(int harmonics, const std::vector<VectorXd*>& vectors) {
    for (VectorXd* vector : vectors) *vector = balance_.resized(*vector, harmonics);
    const bool more = harmonics > balance_.harmonics();
    balance_.set_harmonics(harmonics, std::max(samples_for(harmonics), more ? balance_.samples() : 0));
    return true;
  }

  PeriodicProblem problem_;
  HarmonicBalance balance_;
  Monodromy monodromy_;
  HarmonicBalance::Slopes slopes_;
  VectorXd largest_;
  bool truncated_ = false;
  int calm_ = 0;
};

}  // namespace

std::unique_ptr<PeriodicCurve> make_balance_curve(const PeriodicProblem& problem) {
  return std::make_unique<BalanceCurve>(problem);
}

}  // namespace lunid
