#include "simulate/backward.hpp"

#include <algorithm>
#include <vector>

#include "simulate/dormand_prince.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// lambda at the end of a step becomes that at its start. `product(stage, mu)` adds mu' dx'/dtheta of that stage to the
/// gradient and returns mu' dx'/dx: the transpose of x + h * (weights) . k, stage after stage.
template <class Product>
void back_over_stages(double h, VectorXd& lambda, Product product) {
  std::array<VectorXd, dp::stages> mu;
  for (int s = 0; s < dp::stages; ++s) mu[s] = h * dp::weight[dp::stages][s] * lambda;
  for (int s = dp::stages - 1; s >= 0; --s) {
    const VectorXd nu = product(s, mu[s]);
    lambda += nu;
    for (int j = 0; j < s; ++j) mu[j] += h * dp::weight[s][j] * nu;
  }
}

/// The fixed path without switches, once more, and its transpose.
class SmoothSweep {
 public:
  SmoothSweep(const FixedProblem& problem, const Tape& tape)
      : problem_(problem),
        d_(*problem.dynamics),
        tape_(tape),
        rate_r_(registers(d_.rate)),
        back_r_(registers(tape)),
        stages_(static_cast<std::size_t>(problem.substeps) * dp::stages * d_.n),
        k_(static_cast<std::size_t>(dp::stages) * d_.n) {}

  void interval(Index row, const VectorXd& x, Backward& back) {
    VectorXd state = x;
    for (int j = 0; j < problem_.substeps; ++j) forward(row, j, state);
    for (int j = problem_.substeps - 1; j >= 0; --j)
      back_over_stages(h(), back.lambda,
                       [&](int stage, const VectorXd& mu) { return product(row, j, stage, mu, back); });
    back.evaluations += 2L * dp::stages * problem_.substeps;
  }

 private:
  double h() const { return problem_.dt / problem_.substeps; }
  double* stage_of(int substep, int stage) { return stages_.data() + (substep * dp::stages + stage) * d_.n; }

  std::vector<double> registers(const Tape& tape) const {
    std::vector<double> r(static_cast<std::size_t>(std::max(tape.registers(), tape.inputs()) + 1), 0.0);
    std::copy(problem_.theta.begin(), problem_.theta.end(), r.begin() + (d_.inputs() - d_.p));
    tape.prepare(r.data());
    return r;
  }

  void load(Index row, int substep, int stage, double* r) {
    const Index step = row * problem_.substeps + substep;
    const int last = problem_.hold ? dp::nodes - 1 : dp::nodes;  // a held input has jumped at the end
    const Index node = dp::nodes * step + std::min(stage, last);
    r[0] = problem_.t0 + static_cast<double>(step) * h() + dp::place[stage] * h();
    for (int i = 0; i < d_.exogenous; ++i) r[1 + i] = problem_.drive[i][node];
    std::copy_n(stage_of(substep, stage), d_.n, r + 1 + d_.exogenous);
  }

  /// The states of the stages of a substep; x becomes its end.
  void forward(Index row, int substep, VectorXd& x) {
    for (int stage = 0; stage < dp::stages; ++stage) {
      if (stage == 0)
        std::copy(x.begin(), x.end(), stage_of(substep, 0));
      else
        dp::stage_state(stage, d_.n, h(), x.data(), k_.data(), stage_of(substep, stage));
      load(row, substep, stage, rate_r_.data());
      d_.rate.run_prepared(rate_r_.data());
      std::copy_n(rate_r_.data() + d_.rate.output_place(), d_.n, k_.data() + stage * d_.n);
    }
    dp::stage_state<6>(d_.n, h(), x.data(), k_.data(), x.data());
  }

  VectorXd product(Index row, int substep, int stage, const VectorXd& mu, Backward& back) {
    load(row, substep, stage, back_r_.data());
    std::copy(mu.begin(), mu.end(), back_r_.begin() + d_.inputs());
    tape_.run_prepared(back_r_.data());
    const double* out = back_r_.data() + tape_.output_place();
    back.by_theta += Eigen::Map<const VectorXd>(out + d_.n, d_.p);
    return Eigen::Map<const VectorXd>(out, d_.n);
  }

  const FixedProblem& problem_;
  const Dynamics& d_;
  const Tape& tape_;
  std::vector<double> rate_r_, back_r_, stages_, k_;
};

}  // namespace

Backward sweep_smooth(const FixedProblem& problem, const Tape& tape, const Eigen::MatrixXd& x,
                      const Eigen::MatrixXd& slope) {
  SmoothSweep sweep(problem, tape);
  const Index rows = x.rows();
  Backward back{slope.row(rows - 1).transpose(), VectorXd::Zero(problem.dynamics->p)};
  for (Index row = rows - 2; row >= 0; --row) {
    check_cancelled(problem.cancelled);
    sweep.interval(row, x.row(row).transpose(), back);
    back.lambda += slope.row(row).transpose();
  }
  return back;
}

void MotionRecord::step(const ModeMachine& modes, const Segment& segment, double from, double to, const double* x) {
  ModeMachine::Mode mode = modes.mode();
  if (modes_.empty() || modes_.back() != mode) modes_.push_back(std::move(mode));
  parts_.push_back({Part::step, static_cast<Index>(steps_.size())});
  steps_.push_back({segment.row, segment.substep, modes_.size() - 1, from, to});
  states_.insert(states_.end(), x, x + d_.n);
}

void MotionRecord::jump(const double* gx, const double* gtheta, const double* direction) {
  const std::size_t size = static_cast<std::size_t>(2 * d_.n + d_.p);
  parts_.push_back({Part::jump, static_cast<Index>(jumps_.size() / size)});
  jumps_.insert(jumps_.end(), gx, gx + d_.n);
  jumps_.insert(jumps_.end(), gtheta, gtheta + d_.p);
  jumps_.insert(jumps_.end(), direction, direction + d_.n);
}

/// The transpose of a step of the sensitivities, in the mode in which it was taken.
void MotionRecord::back_over(const Step& step, const double* x, const FixedProblem& problem, ModeMachine& modes,
                             Backward& back) const {
  const int n = d_.n, p = d_.p;
  Segment segment = segment_of(problem, step.row, step.substep);
  const double h = (step.to - step.from) * segment.h;
  modes.take_up(modes_[step.mode]);
  std::vector<double> k(static_cast<std::size_t>(dp::stages * n)), state(x, x + n);
  std::array<RowMajor, dp::stages> jx, jtheta;
  for (int stage = 0; stage < dp::stages; ++stage) {
    if (stage > 0) dp::stage_state(stage, n, h, x, k.data(), state.data());
    const Derivatives at = modes.derivatives(stage_drive(segment, step.from, step.to, stage), state.data());
    std::copy_n(at.f, n, k.data() + stage * n);
    jx[stage] = Eigen::Map<const RowMajor>(at.jx, n, n);
    jtheta[stage] = Eigen::Map<const RowMajor>(at.jtheta, n, p);
    jx[stage].diagonal() = jx[stage].diagonal().cwiseMin(steepest / h).cwiseMax(-steepest / h);
  }
  back_over_stages(h, back.lambda, [&](int stage, const VectorXd& mu) -> VectorXd {
    back.by_theta.noalias() += jtheta[stage].transpose() * mu;
    return jx[stage].transpose() * mu;
  });
}

void MotionRecord::back_over_jump(const double* values, Backward& back) const {
  const Eigen::Map<const VectorXd> gx(values, d_.n), gtheta(values + d_.n, d_.p), direction(values + d_.n + d_.p, d_.n);
  const double taken = direction.dot(back.lambda);
  back.by_theta += taken * gtheta;
  back.lambda += taken * gx;
}

Backward MotionRecord::sweep(const FixedProblem& problem, const Eigen::MatrixXd& slope) const {
  Backward back{VectorXd::Zero(d_.n), VectorXd::Zero(d_.p)};
  ModeMachine modes(d_, problem.theta, problem.dt / problem.substeps);
  const Index jump_size = 2 * d_.n + d_.p;
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part) {
    switch (part->kind) {
      case Part::row:
        check_cancelled(problem.cancelled);
        back.lambda += slope.row(part->index).transpose();
        break;
      case Part::step:
        back_over(steps_[static_cast<std::size_t>(part->index)], states_.data() + part->index * d_.n, problem, modes,
                  back);
        break;
      case Part::jump: back_over_jump(jumps_.data() + part->index * jump_size, back); break;
    }
  }
  back.evaluations = modes.evaluations;
  return back;
}

}  // namespace lunid
