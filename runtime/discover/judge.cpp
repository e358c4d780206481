#include "discover/judge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "discover/gap.hpp"
#include "discover/grow.hpp"
#include "discover/sensor.hpp"
#include "statistics/distributions.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

/// Parameters of the whitened fit are kept where they raise the error of the free run by no more than this factor. A
/// model that lacks something has no noise to whiten: it is shown at its least error.
constexpr double tolerable_loss = 1.05;

/// What a fit's residual would cost behind a whitening. A fit that starts again from its parameters has to find its
/// first states anew; where those are internal ones it may end in another, worse place.
double whitened_cost(const FitResult& fit, const Whitening& whitening) {
  double cost = 0;
  Eigen::VectorXd part;
  for (const auto& residual : fit.residual) {
    whiten(residual, {}, whitening, part);
    cost += part.squaredNorm();
  }
  return cost;
}

/// Of internal states, beside the motion's first values, which every candidate has. Each may follow noise at least.
/// Infinite where nothing is known, and of short runs: where the model loses the motion, their first values find it.
double price_of_first_values(const Study& study, const System& system, const FitResult& fit) {
  const Eigen::Index motion = 2 * system.degrees(), inner = system.states() - motion;
  if (inner == 0) return 0;
  if (fit.state_information.size() != fit.segments.size() || study.run_length > 0) return INFINITY;
  const SimulateOptions options = steps_of(study, fit);
  const double variance = fit.cost / fit.freedom;
  double price = 0;
  for (std::size_t s = 0; s < fit.segments.size(); ++s) {
    const FitSegment& segment = fit.segments[s];
    const FitData part = study.train[static_cast<std::size_t>(segment.record)].part(segment.first, segment.count);
    const Run run = simulate(system, view(fit.theta), part.excitation, segment.x0, options);
    if (!run.summary.completed) return INFINITY;
    const Eigen::MatrixXd& all = fit.state_information[s];
    const Eigen::MatrixXd across = all.bottomLeftCorner(inner, motion);
    const Eigen::MatrixXd own =
        all.bottomRightCorner(inner, inner) -
        across * all.topLeftCorner(motion, motion).completeOrthogonalDecomposition().solve(across.transpose());
    const Eigen::VectorXd spread = run.x.rightCols(inner).colwise().norm() / std::sqrt(run.x.rows() * variance);
    const Eigen::MatrixXd told = spread.asDiagonal() * own * spread.asDiagonal();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(told, Eigen::EigenvaluesOnly).eigenvalues();
    price += 0.5 * (1 + values.cwiseMax(0).array().log1p()).sum();
  }
  return std::isfinite(price) ? price : INFINITY;
}

}  // namespace

Eigen::VectorXd join(const std::vector<Eigen::VectorXd>& parts) {
  Eigen::Index rows = 0;
  for (const auto& p : parts) rows += p.size();
  Eigen::VectorXd out(rows);
  Eigen::Index at = 0;
  for (const auto& p : parts) {
    out.segment(at, p.size()) = p;
    at += p.size();
  }
  return out;
}

double squared_error(const FitResult& fit) {
  double sum = 0;
  for (const auto& r : fit.residual) sum += r.squaredNorm();
  return sum;
}

double rms_error(const FitResult& fit) {
  double rows = 0;
  for (const auto& r : fit.residual) rows += static_cast<double>(r.size());
  return std::sqrt(squared_error(fit) / rows);
}

Whitening residual_colour(const Study& study, const Candidate& candidate) {
  Whitening whitening;
  if (!candidate.ran()) return whitening;
  const double dt = study.train.front().record.dt();
  const double upper = study.imposed ? 0 : upper_frequency(study);
  if (upper > 0) whitening.average = std::max(1, static_cast<int>(M_PI / dt / (6 * upper)));
  Eigen::Index shortest = candidate.fit.residual.front().size();
  for (const auto& r : candidate.fit.residual) shortest = std::min(shortest, r.size());
  whitening.average = std::max(1, std::min(whitening.average, static_cast<int>(shortest / 200)));
  std::vector<Eigen::VectorXd> means;
  for (const auto& r : candidate.fit.residual) {
    Eigen::VectorXd mean;
    whiten(r, {}, {whitening.average, {}}, mean);
    means.push_back(mean);
  }
  const Eigen::VectorXd all = join(means);
  const int order = std::min<int>(20, static_cast<int>(all.size() / 20));
  const AutoregressiveFit ar = fit_autoregression(view(all), order);
  whitening.ar = ar.coefficients;
  if (whitening.ar.empty()) whitening.average = 1;
  return whitening;
}

void judge(const Study& study, Candidate& candidate, const Whitening& whitening, int iterations, bool force_noise) {
  if (!candidate.ran()) return;
  FitOptions options;
  options.max_iterations = iterations;
  options.tolerance = 1e-6;
  options.whitening = whitening;
  options.force_noise = force_noise;
  options.first_states = candidate.fit.segments;
  options.threads = study.options->threads;
  options.cancelled = study.options->cancelled;  // substeps: chosen anew, the search used coarse ones
  // What ran in fixed steps stays with them: a stiff solver may take minutes over a run that ends nowhere.
  if (candidate.fit.solver.starts_with("fixed")) options.solver = Solver::fixed;
  FitResult whitened = fit_trajectory(*candidate.system, candidate.fit.theta, study.train, options);
  if (!(whitened.cost <= tolerable_loss * whitened_cost(candidate.fit, whitening))) whitened = candidate.fit;
  std::vector<Eigen::VectorXd> parts;
  for (std::size_t r = 0; r < whitened.residual.size(); ++r) {
    Eigen::VectorXd part;
    whiten(whitened.residual[r], {}, whitening, part);
    parts.push_back(part);
  }
  candidate.innovations = join(parts);
  candidate.likelihood_cost = candidate.innovations.squaredNorm();
  const auto n = static_cast<double>(candidate.innovations.size());
  candidate.log_likelihood = -0.5 * n * (std::log(2 * M_PI * candidate.likelihood_cost / n) + 1);
  candidate.whitened = std::move(whitened);
  candidate.price_of_first_values = price_of_first_values(study, *candidate.system, candidate.whitened);
  if (rms_error(candidate.whitened) <= tolerable_loss * rms_error(candidate.fit)) {
    candidate.fit = candidate.whitened;
    return;
  }
  options.whitening = {};
  options.substeps = candidate.whitened.substeps;
  FitResult plain = fit_trajectory(*candidate.system, candidate.fit.theta, study.train, options);
  if (plain.cost <= tolerable_loss * squared_error(candidate.fit)) candidate.fit = std::move(plain);
}

double price_of_unknowns(const Candidate& c, double rows) {
  const double runs = static_cast<double>(std::max<std::size_t>(1, c.fit.segments.size()));
  const double first_values = 0.5 * c.first_values() * std::log(std::max(1.0, rows / runs));
  return 0.5 * c.free_parameters() * std::log(rows) + std::min(first_values, c.price_of_first_values);
}

double bic(const Candidate& c) {
  return 2 * (price_of_unknowns(c, static_cast<double>(c.innovations.size())) - c.log_likelihood);
}

double improvement_p_value(const Candidate& smaller, const Candidate& larger, double smaller_cost, double larger_cost,
                           double rows) {
  const double added = larger.unknowns() - smaller.unknowns(), freedom = rows - larger.unknowns() - 2;
  if (!(larger_cost < smaller_cost) || added <= 0 || freedom <= 0) return 1;
  return f_tail((smaller_cost - larger_cost) / added / (larger_cost / freedom), added, freedom);
}

double improvement_p_value(const Candidate& smaller, const Candidate& larger) {
  return improvement_p_value(smaller, larger, smaller.likelihood_cost, larger.likelihood_cost,
                             static_cast<double>(larger.innovations.size()));
}

double corrected(double p_value, int tried) { return std::min(1.0, p_value * std::max(1, tried)); }

std::tuple<int, std::size_t, int> simplicity(const Candidate& c) {
  return {c.free_parameters(), c.choices.size(), physics_in(c.choices)};
}

namespace {

bool is_unseen(const FitResult& fit, Eigen::Index k) {
  return static_cast<std::size_t>(k) < fit.unseen.size() && fit.unseen[static_cast<std::size_t>(k)];
}

/// Also where the rows say nothing of it. `given`: parameters that count as known.
bool within_two_deviations_of_zero(const FitResult& fit, Eigen::Index k, const std::vector<Eigen::Index>& given = {}) {
  if (is_unseen(fit, k)) return true;
  double variance = fit.covariance.rows() > k ? fit.covariance(k, k) : 0;
  if (variance > 0 && !given.empty()) {
    const Eigen::VectorXd with = fit.covariance(given, k);
    variance -= with.dot(Eigen::MatrixXd(fit.covariance(given, given)).ldlt().solve(with));
  }
  return variance > 0 && !(fit.theta[k] * fit.theta[k] > 4 * variance);
}

/// Exponents and the like, on which the units of a coefficient hang: k*y^n in micrometres and in metres would be two
/// cases.
std::vector<Eigen::Index> numbers_added(const Candidate& larger, const Candidate& smaller) {
  const auto& table = larger.system->model().parameters;
  std::vector<Eigen::Index> out;
  for (std::size_t j = 0; j < table.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    const bool varies = larger.fit.covariance.rows() > k && larger.fit.covariance(k, k) > 0;
    if (!smaller.system->model().find(table[j].name) && !larger.linear[j] && table[j].unit.empty() && varies)
      out.push_back(k);
  }
  return out;
}

/// Sum of squares along the motion of what a model's force loses where these parameters are zero.
double squares_without(const Study& study, const Candidate& c, const Eigen::VectorXd& theta,
                       const std::vector<Eigen::Index>& parameters) {
  Eigen::VectorXd without = theta;
  without(parameters).setZero();
  double squares = 0;
  for (const Record& record : study.smooth)
    squares += (open_force(c, theta, record) - open_force(c, without, record)).squaredNorm();
  return squares;
}

/// What `larger` adds along the motion has gone, all but a fifth, where these parameters are a twentieth of what they
/// are.
bool are_its_size(const Study& study, const Candidate& larger, const Candidate& smaller,
                  const std::vector<Eigen::Index>& parameters) {
  constexpr double part = 0.05, left = 0.2;
  const Eigen::VectorXd without = values_of(smaller, {&larger});
  Eigen::VectorXd little = larger.fit.theta;
  little(parameters) *= part;
  double whole = 0, rest = 0;
  for (const Record& record : study.smooth) {
    const Eigen::VectorXd none = open_force(smaller, without, record);
    whole += (open_force(larger, larger.fit.theta, record) - none).squaredNorm();
    rest += (open_force(larger, little, record) - none).squaredNorm();
  }
  return rest <= left * left * whole;
}

}  // namespace

std::vector<Eigen::Index> turned_negative(const Candidate& baseline, const Candidate& named, double deviations) {
  std::vector<Eigen::Index> out;
  if (!baseline.ran() || !named.ran()) return out;
  const auto& table = baseline.system->model().parameters;
  const auto may_be_negative = [&](Eigen::Index j) {
    return std::ranges::any_of(named.choices, [&](const Choice& choice) {
      const std::vector<Twin>& twins = choice.effect->twins;
      return std::ranges::find(twins, table[static_cast<std::size_t>(j)].name, &Twin::baseline) != twins.end();
    });
  };
  // Where it and a name are one law nearly, neither has a deviation that says anything.
  constexpr double many_times = 10;
  const auto is_sure = [&](Eigen::Index j) {
    const double alone = baseline.fit.theta[j], beside = named.fit.theta[j];
    return beside < -deviations * named.fit.deviation(j) ||
           (alone > deviations * baseline.fit.deviation(j) && beside < -many_times * alone);
  };
  for (Eigen::Index j = 0; j < baseline.parameters(); ++j)
    if (baseline.fit.theta[j] > 0 && named.fit.theta[j] < 0 && is_sure(j) && !may_be_negative(j)) out.push_back(j);
  return out;
}

bool told_from_zero(const Study& study, const Candidate& larger, const Candidate& smaller) {
  const auto& table = larger.system->model().parameters;
  const std::vector<Eigen::Index> numbers = numbers_added(larger, smaller);
  std::vector<Eigen::Index> linear;
  for (std::size_t j = 0; j < table.size(); ++j) {
    if (smaller.system->model().find(table[j].name)) continue;
    const auto k = static_cast<Eigen::Index>(j);
    if (larger.linear[j])
      linear.push_back(k);
    else if (within_two_deviations_of_zero(larger.fit, k) && are_its_size(study, larger, smaller, {k}))
      return false;
  }
  const auto is_told = [&](Eigen::Index k) { return !within_two_deviations_of_zero(larger.fit, k, numbers); };
  return linear.empty() || std::ranges::any_of(linear, is_told) || !are_its_size(study, larger, smaller, linear);
}

bool sizes_are_told(const Study& study, const Candidate& named) {
  const auto& table = named.system->model().parameters;
  const auto has_size = [&](const Choice& choice) {
    std::vector<Eigen::Index> own, linear;
    for (const Parameter& p : choice.parameters()) {
      const auto at = std::ranges::find(table, p.name, &Parameter::name) - table.begin();
      if (at == std::ssize(table) || !(named.fit.deviation(at) > 0)) continue;
      own.push_back(at);
      if (named.linear[static_cast<std::size_t>(at)]) linear.push_back(at);
    }
    if (linear.empty()) return true;
    const auto force = [&](const Eigen::VectorXd& theta) {
      return std::sqrt(squares_without(study, named, theta, linear));
    };
    constexpr double step = 1e-3;  // of a value
    const double size = force(named.fit.theta);
    Eigen::VectorXd slopes(std::ssize(own));
    for (std::size_t i = 0; i < own.size(); ++i) {
      Eigen::VectorXd theta = named.fit.theta;
      const double moved = step * theta[own[i]];
      theta[own[i]] += moved;
      slopes[static_cast<Eigen::Index>(i)] = moved != 0 ? (force(theta) - size) / moved : 0;
    }
    const double variance = slopes.dot(named.fit.covariance(own, own) * slopes);
    return !(size * size < variance);
  };
  return std::ranges::all_of(named.choices, has_size);
}

std::size_t added_near_zero(const Candidate& c, double level) {
  std::size_t count = 0;
  for (auto k = static_cast<Eigen::Index>(c.first_added()); k < c.parameters(); ++k) {
    const double deviation = c.fit.deviation(k);
    count += is_unseen(c.fit, k) || (deviation > 0 && 2 * normal_tail(std::abs(c.fit.theta[k]) / deviation) > level);
  }
  return count;
}

bool carries_force(const Study& study, const Candidate& larger, const Candidate& smaller) {
  constexpr double least = 1e-3;
  const auto& table = larger.system->model().parameters;
  std::vector<Eigen::Index> added_parameters;
  for (std::size_t j = 0; j < table.size(); ++j) {
    if (smaller.system->model().find(table[j].name)) continue;
    if (!larger.linear[j]) return true;
    added_parameters.push_back(static_cast<Eigen::Index>(j));
  }
  const double squares = squares_without(study, larger, larger.fit.theta, added_parameters);
  double rows = 0;
  for (const Record& record : study.smooth) rows += static_cast<double>(record.rows());
  const auto added = std::find_if(larger.choices.begin(), larger.choices.end(),
                                  [&](const Choice& c) { return !holds(smaller.choices, c.effect); });
  const std::optional<Place> place = added != larger.choices.end() ? added->effect->place : std::nullopt;
  return !(std::sqrt(squares / rows) < least * scales(study, 0, place).force_std);
}

double vuong_z(const Candidate& a, const Candidate& b) {
  const auto n = static_cast<double>(a.innovations.size());
  // Pointwise log-likelihoods, each model with its own noise variance.
  const double variance_a = a.likelihood_cost / n, variance_b = b.likelihood_cost / n;
  const Eigen::VectorXd difference =
      0.5 * (std::log(variance_b / variance_a) + b.innovations.array().square() / variance_b -
             a.innovations.array().square() / variance_a)
                .matrix();
  const double correction = price_of_unknowns(a, n) - price_of_unknowns(b, n);
  const double variance = long_run_variance(view(difference));
  if (!(variance > 0)) return 0;
  return (difference.sum() - correction) / std::sqrt(n * variance);
}

bool stays_above_noise(const Study& study, double cost, double best, double rows, double best_rms) {
  constexpr double at_noise = 1.1, above = 1.1, nats = 50;
  return best_rms < at_noise * study.sensor_noise() && cost > above * best && cost - best > 2 * nats * best / rows;
}

bool fits_worse(const Study& study, const Candidate& c, const Candidate& best) {
  return vuong_z(best, c) >= vuong_level ||
         stays_above_noise(study, c.likelihood_cost, best.likelihood_cost, static_cast<double>(best.innovations.size()),
                           rms_error(best.fit));
}

double required_gain(const Study& study, double gap_after) {
  return std::min(0.5, study.options->minimum_gain * (gap_after < 1.5 * study.noise_gap() ? 1 : 5));
}

double at_most_all(double gap) { return gap < 1 ? gap : 1; }

double closed_share(double before, double after, double floor) {
  before = at_most_all(before);
  const double excess = before * before - floor * floor;
  return excess > 0 ? (before * before - after * after) / excess : 0;
}

double closed_share(const Study& study, const Candidate& before, const Candidate& after) {
  const double y = study.measured_std();
  return closed_share(rms_error(before.fit) / y, rms_error(after.fit) / y, study.noise_gap());
}

Eigen::Index bootstrap_block(const Study& study) {
  const Record& record = study.train.front().record;
  return bootstrap_block(study, record.dt(), record.rows());
}

Eigen::Index bootstrap_block(const Study& study, double dt, Eigen::Index rows) {
  const double period = study.omega > 0 ? 2 * M_PI / study.omega / dt : 1;
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(2 * period), 5, std::max<Eigen::Index>(5, rows / 20));
}

double left_out_p_value(const Study& study, const Candidate& before, const Candidate& after) {
  if (after.left_out.size() == 0) return 1;
  if (before.left_out.size() == 0) return 0;
  return p_value_of_lower_error(view(before.left_out), view(after.left_out), bootstrap_block(study),
                                study.options->seed);
}

}  // namespace lunid
