// Levenberg-Marquardt on free runs, and what is known of the solution.
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>

#include "expr/digits.hpp"
#include "simulate/fit_problem.hpp"

namespace lunid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int variance_blocks = 20;  // over which sums of scores are taken to be independent

/// Parameters that may not move: fixed ones, and those at a bound that the gradient pushes against.
std::vector<std::uint8_t> frozen(const Bounds& bounds, const Eigen::VectorXd& theta, const Eigen::VectorXd& descent,
                                 std::vector<std::uint8_t>* at_bound) {
  std::vector<std::uint8_t> out = bounds.fixed;
  if (at_bound) at_bound->assign(out.size(), 0);
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const bool held = (theta[i] <= bounds.min[i] && descent[i] <= 0) || (theta[i] >= bounds.max[i] && descent[i] >= 0);
    if (held && at_bound) (*at_bound)[static_cast<std::size_t>(i)] = 1;
    if (held) out[static_cast<std::size_t>(i)] = 1;
  }
  return out;
}

/// Widens a covariance where the residual is not white: A^-1 B A^-1 with B the sum over blocks of the squared sums of
/// the scores (batch means: whatever the correlation within a block). Never narrows it.
void widen(const std::vector<Eigen::MatrixXd>& scores, const Eigen::MatrixXd& inverse, Eigen::MatrixXd& covariance) {
  Eigen::Index rows = 0;
  for (const auto& s : scores) rows += s.rows();
  const auto length = std::max<Eigen::Index>(1, rows / variance_blocks);
  const Eigen::Index p = covariance.rows();
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(p, p);
  double blocks = 0;
  for (const auto& s : scores)
    for (Eigen::Index first = 0; first + length <= s.rows(); first += length, ++blocks) {
      const Eigen::VectorXd sum = s.middleRows(first, length).colwise().sum();
      middle.noalias() += sum * sum.transpose();
    }
  if (blocks < variance_blocks / 2) return;
  const Eigen::MatrixXd robust = inverse * middle * inverse * (blocks / (blocks - 1));
  Eigen::VectorXd factor(p);
  for (Eigen::Index i = 0; i < p; ++i)
    factor[i] = covariance(i, i) > 0 ? std::sqrt(std::max(1.0, robust(i, i) / covariance(i, i))) : 1;
  covariance = factor.asDiagonal() * covariance * factor.asDiagonal();
}

/// What this leaves of the columns: their part beside the span of these states, by reflections. Where small differences
/// grow, both grow alike: of what is left of theta's columns the normal equations lose all below 1e-8 of its length.
Eigen::MatrixXd beside_states(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                              const Eigen::Ref<const Eigen::MatrixXd>& states) {
  if (states.cols() == 0) return columns;
  constexpr double same = 1e-10;  // of a column's length
  const Eigen::VectorXd lengths = states.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(states.rows(), states.cols());
  qr.setThreshold(same).compute(states * lengths.cwiseInverse().asDiagonal());
  Eigen::MatrixXd out = qr.householderQ().adjoint() * columns;
  out.topRows(qr.rank()).setZero();
  return qr.householderQ() * out;
}

/// The columns of theta with first states projected out; a matrix per segment.
std::vector<Eigen::MatrixXd> projected_columns(const Normal& normal) {
  const Eigen::Index p = normal.a.rows();
  std::vector<Eigen::MatrixXd> out;
  for (const Normal::Part& part : normal.parts)
    out.push_back(beside_states(part.columns.leftCols(p), part.columns.rightCols(part.columns.cols() - p)));
  return out;
}

/// Per row the gradient of half its squared error by theta; `out`: the projected columns.
std::vector<Eigen::MatrixXd> scores_of(const Normal& normal, std::vector<Eigen::MatrixXd> out) {
  for (std::size_t s = 0; s < out.size(); ++s) out[s] = normal.parts[s].error.asDiagonal() * out[s];
  return out;
}

constexpr double roughest = 0.3;  // noise of a force, of its deviation: beyond it is the excitation itself

Philox noise_of_forces() { return Philox(1, stream_of("noise of forces")); }

/// A recorded force, the deviation of its samples and the noise of its channel; none of one that has a formula.
struct RecordedForce {
  std::string name;
  Excitation signal;
  double spread, noise;
};

std::vector<RecordedForce> recorded_forces(const FitData& data) {
  std::vector<RecordedForce> out;
  for (int i = 0; i < data.excitation.count(); ++i) {
    const Excitation& signal = data.excitation[i];
    const std::string& name = data.excitation.channel(i);
    if (!data.record.has(name) || signal.analytic()) continue;
    const Channel& channel = data.record.channel(name);
    const Eigen::VectorXd samples = signal.samples();
    const double spread = spread_of({samples.data(), static_cast<std::size_t>(samples.size())});
    out.push_back({name, signal, spread, channel.formula.valid() ? 0 : channel.noise});
  }
  return out;
}

/// The same with white noise of its own.
void add_noise(const RecordedForce& force, double deviation, Philox& random, Excitations& to) {
  std::vector<double> noise(static_cast<std::size_t>(force.signal.samples().size()));
  for (double& x : noise) x = deviation * random.normal();
  to = to.replaced(force.name, force.signal.plus(noise));
}

bool any_force(const std::vector<FitData>& data, bool (*is_so)(const RecordedForce&)) {
  return std::ranges::any_of(data, [&](const FitData& d) { return std::ranges::any_of(recorded_forces(d), is_so); });
}

bool acts(const RecordedForce& force) { return force.spread > 0; }

/// So much that it is no matter of rounding.
bool has_noise(const RecordedForce& force) {
  constexpr double least = 1e-3;  // of the force's deviation
  return force.noise > least * force.spread && force.noise <= roughest * force.spread;
}

/// Recorded forces with white noise: what their channels have, or, where none has any, so much that the response to it
/// is linear still (a disturbance, of a size that the residual tells).
std::vector<FitData> with_noise_again(std::vector<FitData> data, bool disturbed, Philox& random) {
  constexpr double trial = 0.01;  // of the force's deviation
  for (FitData& d : data) {
    if (!disturbed) {
      if (std::optional<Excitations> noisy = with_noise_again(d, random)) d.excitation = std::move(*noisy);
      continue;
    }
    for (const RecordedForce& force : recorded_forces(d)) add_noise(force, trial * force.spread, random, d.excitation);
  }
  return data;
}

/// What noise on the forces does to the residual and to theta, to first order.
struct NoiseOfForces {
  Eigen::MatrixXd left;  ///< changes of the residual that neither theta nor the first states take up; a column per draw
  Eigen::MatrixXd step;  ///< of theta
};

NoiseOfForces draw_noise_of_forces(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                                   const Normal& normal, const FitResult& result,
                                   const std::vector<Eigen::MatrixXd>& columns, const Eigen::MatrixXd& inverse,
                                   bool disturbed) {
  constexpr int draws = 24;
  Philox random = noise_of_forces();
  Eigen::Index rows = 0, ran = 0;
  for (const Normal::Part& part : normal.parts) rows += part.error.size();
  std::vector<Eigen::MatrixXd> by_states;
  for (const Eigen::MatrixXd& axx : normal.axx) by_states.push_back(pseudo_inverse(axx));
  NoiseOfForces out{Eigen::MatrixXd(rows, draws), Eigen::MatrixXd(inverse.rows(), draws)};
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<FitData> noisy = with_noise_again(data, disturbed, random);
    Problem problem(system, noisy, options, result.substeps);
    problem.clip = result.clip;
    problem.prepare(result.segments);
    const Normal there = problem.evaluate(result.theta, result.segments, false);
    if (!std::isfinite(there.cost)) continue;
    std::vector<Eigen::VectorXd> changes;
    Eigen::VectorXd score = Eigen::VectorXd::Zero(inverse.rows());
    for (std::size_t s = 0; s < columns.size(); ++s) {
      changes.push_back(there.parts[s].error - normal.parts[s].error);
      score += columns[s].transpose() * changes.back();
    }
    out.step.col(ran) = inverse * score;
    Eigen::Index row = 0;
    for (std::size_t s = 0; s < columns.size(); ++s) {
      Eigen::VectorXd change = changes[s] - columns[s] * out.step.col(ran);
      if (!normal.axx.empty()) {
        const auto states = normal.parts[s].columns.rightCols(normal.axx[s].cols());
        change -= states * (by_states[s] * (states.transpose() * changes[s]));
      }
      out.left.col(ran).segment(row, change.size()) = change;
      row += change.size();
    }
    ++ran;
  }
  out.left.conservativeResize(Eigen::NoChange, ran);
  out.step.conservativeResize(Eigen::NoChange, ran);
  return out;
}

Eigen::VectorXd residual_of(const Normal& normal, Eigen::Index rows) {
  Eigen::VectorXd out(rows);
  Eigen::Index row = 0;
  for (const Normal::Part& part : normal.parts) {
    out.segment(row, part.error.size()) = part.error;
    row += part.error.size();
  }
  return out;
}

/// How much of that noise the residual holds, 0 to 1: none where the system felt it. By the residual's energy beyond
/// that of white noise in the space of the drawn changes, over what one more draw would have there.
double share_in_residual(const NoiseOfForces& drawn, const Normal& normal, double freedom) {
  const Eigen::VectorXd residual = residual_of(normal, drawn.left.rows());
  Eigen::MatrixXd gram = drawn.left.transpose() * drawn.left;
  const auto draws = static_cast<double>(gram.rows());
  if (!(gram.trace() > 0)) return 0;
  gram.diagonal().array() += 1e-9 * gram.trace() / draws;  // of fewer dimensions than draws
  const Eigen::MatrixXd inverse = gram.inverse();
  const Eigen::VectorXd along = drawn.left.transpose() * residual;
  const double inside = along.dot(inverse * along), white = (normal.cost - inside) / std::max(1.0, freedom - draws);
  const double one_more = (gram.diagonal() - inverse.diagonal().cwiseInverse()).mean();
  return one_more > 0 ? std::clamp((inside - draws * white) / one_more, 0.0, 1.0) : 0;
}

/// The power of a disturbance in the residual, in those of the draws. By moments: over draws d a white residual r has
/// the mean (d'r)^2 = white d'd, and one that holds another draw d' also (d'd')^2.
double power_of_disturbance(const NoiseOfForces& drawn, const Normal& normal, double freedom) {
  const Eigen::MatrixXd gram = drawn.left.transpose() * drawn.left;
  const auto draws = static_cast<double>(gram.rows());
  const double own = gram.trace() / draws,
               other = (gram.squaredNorm() - gram.diagonal().squaredNorm()) / (draws * (draws - 1));
  const double along = (drawn.left.transpose() * residual_of(normal, drawn.left.rows())).squaredNorm() / draws;
  // What the disturbance has of the residual's energy is not white: white = (cost - power * own) / freedom.
  const double power = (along - normal.cost / freedom * own) / (other - own * own / freedom);
  return std::isfinite(power) ? std::clamp(power, 0.0, normal.cost / own) : 0;
}

/// Of what was drawn: beside the noise of the channels that the residual holds whole a disturbance may act too.
double power_in_residual(const NoiseOfForces& drawn, const Normal& normal, double freedom, bool disturbed) {
  const double share = disturbed ? 0 : share_in_residual(drawn, normal, freedom);
  return disturbed || share == 1 ? std::max(share, power_of_disturbance(drawn, normal, freedom)) : share;
}

Eigen::MatrixXd by_noise_of_forces(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                                   const Normal& normal, const FitResult& result,
                                   const std::vector<Eigen::MatrixXd>& columns, const Eigen::MatrixXd& inverse,
                                   bool disturbed) {
  const NoiseOfForces drawn = draw_noise_of_forces(system, data, options, normal, result, columns, inverse, disturbed);
  if (drawn.step.cols() < 2) return Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
  return drawn.step * drawn.step.transpose() / static_cast<double>(drawn.step.cols()) *
         power_in_residual(drawn, normal, result.freedom, disturbed);
}

/// Of theta among the parameters that are free; zero of the others.
Eigen::MatrixXd information_of_free(const FitResult& result, const Bounds& bounds) {
  Eigen::MatrixXd information = result.information;
  for (Eigen::Index i = 0; i < information.rows(); ++i)
    if (result.at_bound[static_cast<std::size_t>(i)] || bounds.fixed[static_cast<std::size_t>(i)]) {
      information.row(i).setZero();
      information.col(i).setZero();
    }
  return information;
}

/// Parameters along which a direction of no information goes: what its pseudo-inverse leaves out.
std::vector<std::uint8_t> unidentifiable(const Eigen::MatrixXd& information, const Eigen::MatrixXd& inverse) {
  constexpr double share = 1e-6;  // of the direction, beyond what rounding mixes in
  std::vector<std::uint8_t> out;
  for (Eigen::Index i = 0; i < information.rows(); ++i)  // the projector on what is known has ones on its diagonal
    out.push_back(information(i, i) > 0 && 1 - information.row(i).dot(inverse.col(i)) > share);
  return out;
}

/// Of theta, by the residual's own noise and by what else is given; wider where the residual is not white.
Eigen::MatrixXd covariance_of(const Normal& normal, std::vector<Eigen::MatrixXd> columns,
                              const Eigen::MatrixXd& inverse, double freedom, const Eigen::MatrixXd& further) {
  Eigen::MatrixXd out = inverse * (normal.cost / freedom) + further;
  widen(scores_of(normal, std::move(columns)), inverse, out);
  return out;
}

/// Covariance, ranks and residuals at the solution.
void finish(const System& system, const std::vector<FitData>& data, const Bounds& bounds, const Normal& normal,
            FitResult& result) {
  const Eigen::Index p = result.theta.size();
  result.rows = normal.rows;
  result.outliers = normal.outliers;
  Eigen::Index channels = 1;
  for (std::size_t s = 0; s < result.segments.size(); ++s)
    channels = std::max(channels, normal.parts[s].residual.size() / result.segments[s].count);
  for (Eigen::Index c = 0; c < channels; ++c)
    for (const auto& d : data) result.residual.push_back(Eigen::VectorXd::Constant(d.record.rows(), NAN));
  for (std::size_t s = 0; s < result.segments.size(); ++s) {
    const FitSegment& segment = result.segments[s];
    for (Eigen::Index c = 0; c < normal.parts[s].residual.size() / segment.count; ++c)
      result.residual[static_cast<std::size_t>(c) * data.size() + static_cast<std::size_t>(segment.record)].segment(
          segment.first, segment.count) = normal.parts[s].residual.segment(c * segment.count, segment.count);
  }
  std::vector<Eigen::MatrixXd> columns = projected_columns(normal);
  result.information = Eigen::MatrixXd::Zero(p, p);
  for (const Eigen::MatrixXd& own : columns) result.information.noalias() += own.transpose() * own;
  result.unseen.assign(static_cast<std::size_t>(p), 0);
  constexpr double least = 1e-16;  // of the square of a column's length
  Eigen::Index free = 0;
  for (Eigen::Index i = 0; i < p; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(result.information(i, i) > least * normal.a(i, i))) result.unseen[k] = 1;
    if (!result.at_bound[k] && !bounds.fixed[k]) ++free;
  }
  const double states =
      system.model().imposed_motion ? 0 : static_cast<double>(result.segments.size()) * 2 * system.degrees();
  result.freedom = std::max(1.0, static_cast<double>(normal.rows - free) - states);
  const Eigen::MatrixXd information = information_of_free(result, bounds), inverse = pseudo_inverse(information);
  result.unidentifiable = unidentifiable(information, inverse);
  result.covariance = covariance_of(normal, std::move(columns), inverse, result.freedom, Eigen::MatrixXd::Zero(p, p));
}

}  // namespace

void count_noise_of_forces(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                           FitResult& result) {
  if (system.model().imposed_motion || !std::isfinite(result.cost)) return;
  const bool disturbed = !any_force(data, has_noise);
  if (disturbed && !any_force(data, acts)) return;
  Problem problem(system, data, options, result.substeps);
  problem.clip = result.clip;
  problem.prepare(result.segments);
  const Normal normal = problem.evaluate(result.theta, result.segments, true);
  const Eigen::MatrixXd inverse =
      pseudo_inverse(information_of_free(result, Bounds(system.model(), problem.layout(), options)));
  std::vector<Eigen::MatrixXd> columns = projected_columns(normal);
  const Eigen::MatrixXd further =
      by_noise_of_forces(system, data, options, normal, result, columns, inverse, disturbed);
  result.covariance = covariance_of(normal, std::move(columns), inverse, result.freedom, further);
  result.runs += problem.runs;
}

Step damped_step(const Normal& normal, double lambda, const std::vector<std::uint8_t>& frozen) {
  Eigen::MatrixXd a = normal.a;
  Eigen::VectorXd b = normal.b;
  a.diagonal() *= 1 + lambda;
  std::vector<Eigen::MatrixXd> inverse;
  for (std::size_t s = 0; s < normal.axx.size(); ++s) {
    Eigen::MatrixXd axx = normal.axx[s];
    axx.diagonal() *= 1 + lambda;
    inverse.push_back(pseudo_inverse(axx));
    a.noalias() -= normal.ax[s] * inverse[s] * normal.ax[s].transpose();
    b.noalias() -= normal.ax[s] * (inverse[s] * normal.bx[s]);
  }
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (frozen[static_cast<std::size_t>(i)]) {
      a.row(i).setZero();
      a.col(i).setZero();
      b[i] = 0;
    }
  Step step;
  step.theta = pseudo_inverse(a, 1e-13) * b;
  for (std::size_t s = 0; s < normal.axx.size(); ++s)
    step.x0.push_back(inverse[s] * (normal.bx[s] - normal.ax[s].transpose() * step.theta));
  return step;
}

namespace {

std::vector<FitSegment> moved(std::vector<FitSegment> segments, const Step& step, double part) {
  for (std::size_t s = 0; s < step.x0.size(); ++s) segments[s].x0 += part * step.x0[s];
  return segments;
}

bool is_finite(const Eigen::VectorXd& theta, const std::vector<FitSegment>& segments) {
  return theta.allFinite() &&
         std::all_of(segments.begin(), segments.end(), [](const FitSegment& s) { return s.x0.allFinite(); });
}

/// Length of a step, each entry in units of its own column.
double length_of(const Normal& normal, const Step& step) {
  double sum = normal.a.diagonal().dot(step.theta.cwiseAbs2());
  for (std::size_t s = 0; s < step.x0.size(); ++s) sum += normal.axx[s].diagonal().dot(step.x0[s].cwiseAbs2());
  return std::sqrt(sum);
}

/// Adds to a step what the bend of the runs along it asks for: in a narrow bent valley straight steps stay short
/// (geodesic acceleration: Transtrum, Machta and Sethna 2011, Phys. Rev. E 83, 036701). Costs one run; leaves
/// the step as it is where the second order is not small beside the first.
void bend(Problem& problem, const Normal& normal, const Eigen::VectorXd& theta, const std::vector<FitSegment>& segments,
          double lambda, const std::vector<std::uint8_t>& hold, const Bounds& bounds, Step& step) {
  constexpr double part = 0.1, most = 0.375;  // of the step
  const Eigen::VectorXd ahead = theta + part * step.theta;
  const std::vector<FitSegment> from = moved(segments, step, part);
  const bool inside = (ahead.array() >= bounds.min.array()).all() && (ahead.array() <= bounds.max.array()).all();
  if (!inside || !is_finite(ahead, from)) return;
  const Normal there = problem.evaluate(ahead, from, false);
  if (!std::isfinite(there.cost)) return;
  const Eigen::Index p = theta.size();
  Normal second = normal;
  second.b.setZero();
  for (std::size_t s = 0; s < normal.parts.size(); ++s) {
    const auto& here = normal.parts[s];
    Eigen::VectorXd along = here.columns.leftCols(p) * step.theta;
    if (!step.x0.empty()) along += here.columns.rightCols(here.columns.cols() - p) * step.x0[s];
    const Eigen::VectorXd bent = (2 / part) * ((there.parts[s].error - here.error) / part + along);
    second.b += here.columns.leftCols(p).transpose() * bent;
    if (!step.x0.empty()) second.bx[s] = here.columns.rightCols(here.columns.cols() - p).transpose() * bent;
  }
  const Step turn = damped_step(second, lambda, hold);
  if (!(length_of(normal, turn) <= most * length_of(normal, step))) return;
  step.theta += 0.5 * turn.theta;
  for (std::size_t s = 0; s < step.x0.size(); ++s) step.x0[s] += 0.5 * turn.x0[s];
}

}  // namespace

std::optional<Excitations> with_noise_again(const FitData& data, Philox& random) {
  std::optional<Excitations> out;
  for (const RecordedForce& force : recorded_forces(data)) {
    if (!(force.noise > 0) || force.noise > roughest * force.spread) continue;
    if (!out) out = data.excitation;
    add_noise(force, force.noise, random, *out);
  }
  return out;
}

FitResult minimise(const System& system, const Eigen::VectorXd& given, const std::vector<FitData>& data,
                   const FitOptions& options, std::vector<FitSegment> segments, int substeps, double clip) {
  Problem problem(system, data, options, substeps);
  problem.clip = clip;
  problem.prepare(segments);
  const Bounds bounds(system.model(), problem.layout(), options);
  const Eigen::VectorXd start = problem.layout().expanded(given);
  FitResult result;
  result.substeps = substeps;
  result.solver = system.model().imposed_motion ? "imposed motion" : fit_solver_name(options, substeps);
  result.clip = clip;
  result.theta = start.cwiseMax(bounds.min).cwiseMin(bounds.max);
  result.at_bound.assign(static_cast<std::size_t>(start.size()), 0);
  Normal normal = problem.evaluate(result.theta, segments, true);
  double lambda = 1e-4;
  bool bent = false;  // the last straight step was refused
  result.stopped = "iterations";
  if (!std::isfinite(normal.cost)) {
    result.cost = infinity;
    result.segments = std::move(segments);
    result.stopped = "free run: " + normal.cause;
    result.lost = result.theta;
    result.runs = problem.runs;
    return result;
  }
  for (; result.iterations < options.max_iterations && !result.converged; ++result.iterations) {
    bool improved = false;
    for (int attempt = 0; attempt < 12 && !improved; ++attempt) {
      auto hold = frozen(bounds, result.theta, normal.b, &result.at_bound);
      Step step = damped_step(normal, lambda, hold);
      if (bent || attempt > 0) bend(problem, normal, result.theta, segments, lambda, hold, bounds, step);
      Eigen::VectorXd theta = (result.theta + step.theta).cwiseMax(bounds.min).cwiseMin(bounds.max);
      std::vector<FitSegment> trial = moved(segments, step, 1);
      if (!is_finite(theta, trial)) {
        lambda = lambda * 10 + 1e-6;
        continue;
      }
      // The first step of an iteration is nearly always taken: its derivatives are computed along with its cost.
      Normal full = problem.evaluate(theta, trial, attempt == 0);
      if (full.cost < normal.cost) {
        const double drop = (normal.cost - full.cost) / normal.cost;
        if (attempt > 0) full = problem.evaluate(theta, trial, true);
        if (!std::isfinite(full.cost)) {
          lambda = lambda * 10 + 1e-6;
          continue;
        }
        result.theta = std::move(theta);
        segments = std::move(trial);
        normal = std::move(full);
        improved = true;
        bent = attempt > 0;
        lambda = std::max(lambda * 0.1, 1e-12);
        if (drop < options.tolerance) {
          result.converged = true;
          result.stopped = "relative drop of the cost below " + number(options.tolerance);
        }
      } else {
        if (!std::isfinite(full.cost) && result.lost.size() == 0) result.lost = theta;
        lambda = lambda * 10 + 1e-9;
      }
    }
    if (!improved) {
      result.converged = true;
      result.stopped = "no step lowers the cost";
    }
  }
  frozen(bounds, result.theta, normal.b, &result.at_bound);
  result.cost = normal.cost;
  result.segments = std::move(segments);
  finish(system, data, bounds, normal, result);
  result.state_information = std::move(normal.axx);
  result.runs = problem.runs;
  return result;
}

}  // namespace lunid
