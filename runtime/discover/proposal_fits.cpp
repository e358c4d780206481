#include "discover/proposal_fits.hpp"

#include <algorithm>
#include <cmath>

#include "discover/gap.hpp"
#include "record/parallel.hpp"

namespace lunid {

bool is_above_noise(const Study& study, const Candidate& c, double more) {
  constexpr double most = 3;
  const double left = rms(c) / (1 + more), sensors = study.sensor_noise();
  return left > sensors && (left > most * sensors || left > noise_alone(study, c));
}

FitOptions fixed_fit(const Study& study, int iterations, double tolerance, int substeps) {
  FitOptions options;
  options.max_iterations = iterations;
  options.tolerance = tolerance;
  options.solver = Solver::fixed;
  options.substeps = substeps;
  options.threads = study.options->threads;
  options.cancelled = study.options->cancelled;
  return options;
}

FitResult fit_near(const Study& study, const Candidate& candidate, const Eigen::VectorXd& start, int iterations,
                   int substeps, const std::vector<FitSegment>& first_states) {
  FitOptions options = fixed_fit(study, iterations, 1e-4, substeps);
  options.first_states = first_states;
  return fit_trajectory(*candidate.system, start, study.train, options);
}

bool all_linear(const Shape& shape) {
  return std::all_of(shape.linear.begin(), shape.linear.end(), [](auto l) { return l != 0; });
}

ProposalFits::ProposalFits(const Study& study, const Candidate& baseline, Eigen::Index force_rows)
    : study_(study),
      baseline_(baseline),
      force_rows_(force_rows),
      decays_(!study.imposed && are_free(study, study.full)) {}

int ProposalFits::coarse_substeps(const Candidate& c) const {
  return baseline_.ran() ? std::max(c.state_substeps, (baseline_.fit.substeps + 1) / 2) : 0;
}

void ProposalFits::begin(Candidate& c, const Candidate& parent) const {
  c.fit = fit_near(study_, c, c.starts.front(), 4, coarse_substeps(c));
  if (parent.ran() && !(c.fit.cost < 0.9 * parent.fit.cost)) begin_at_parent(c, parent);
  if (c.ran()) lengthen_steps(c);
}

void ProposalFits::begin_at_parent(Candidate& c, const Candidate& parent) const {
  Eigen::VectorXd warm = c.starts.front();
  warm.head(parent.fit.theta.size()) = parent.fit.theta;
  for (Eigen::Index j = parent.fit.theta.size(); j < warm.size(); ++j)
    if (c.linear[static_cast<std::size_t>(j)]) warm[j] = 0;
  FitResult again = fit_near(study_, c, warm, 4, coarse_substeps(c));
  if (again.cost < c.fit.cost) c.fit = std::move(again);
}

/// The first guess of an entry may be far stiffer than where its fit goes.
void ProposalFits::lengthen_steps(Candidate& c) const {
  constexpr int many = 4;
  constexpr double as_good = 1.01;  // in squared error
  if (study_.imposed || c.fit.substeps < many) return;
  FitResult longer = fit_near(study_, c, c.fit.theta, 1, 0, c.fit.segments);
  if (longer.substeps < c.fit.substeps && longer.cost < as_good * c.fit.cost) c.fit = std::move(longer);
}

void ProposalFits::go_on(Candidate& c, int iterations) const {
  FitResult further = fit_near(study_, c, c.fit.theta, iterations, c.fit.substeps, c.fit.segments);
  if (further.cost < c.fit.cost) c.fit = std::move(further);
}

void ProposalFits::try_guesses(Candidate& c, const Shape& shape, const Eigen::VectorXd& from) const {
  constexpr std::size_t most = 8, ahead = 2;
  constexpr int first_iterations = 2, iterations = 8;
  constexpr double near = 1.2;  // in squared error
  if (all_linear(shape) || many_states(c.choices)) return;
  const auto& table = c.system->model().parameters;
  const auto before = from.size() - static_cast<Eigen::Index>(shape.linear.size());
  const std::size_t step = std::max<std::size_t>(1, (shape.guesses.size() + most - 1) / most);
  std::vector<FitResult> others((shape.guesses.size() + step - 1) / step);
  parallel_for(static_cast<int>(others.size()), study_.options->threads, [&](int i) {
    const auto g = static_cast<std::size_t>(i);
    Eigen::VectorXd start = from;
    for (Eigen::Index j = before; j < start.size(); ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (!c.linear[k]) start[j] = guessed(table[k], shape.guesses[g * step]);
    }
    others[g] = fit_near(study_, c, start, first_iterations, coarse_substeps(c));
  });
  std::ranges::stable_sort(others, {}, &FitResult::cost);
  others.resize(std::min(ahead, others.size()));
  std::erase_if(others, [](const FitResult& f) { return !std::isfinite(f.cost); });
  for (const Eigen::VectorXd& start : starts_along_the_motion(c, shape, from.head(before))) {
    others.emplace_back();
    others.back().cost = INFINITY;
    others.back().theta = start;
    others.back().substeps = coarse_substeps(c);
  }
  parallel_for(static_cast<int>(others.size()), study_.options->threads, [&](int i) {
    FitResult& other = others[static_cast<std::size_t>(i)];
    FitResult further = fit_near(study_, c, other.theta, iterations, other.substeps, other.segments);
    if (further.cost < other.cost) other = std::move(further);
  });
  // What ended at a limit is no name: whatever else there is goes first.
  const auto at_limit = [&c](const FitResult& fit) {
    Candidate there = c;
    there.fit = fit;
    return !there.ran() || there.degenerate();
  };
  const auto best =
      std::ranges::min_element(others, {}, [&](const FitResult& fit) { return std::pair(at_limit(fit), fit.cost); });
  const bool leaves_a_limit = best != others.end() && c.degenerate() && !at_limit(*best);
  if (best != others.end() && best->cost < (leaves_a_limit ? near : 1) * c.fit.cost) c.fit = std::move(*best);
}

/// Of an entry with memory alone, whose guesses a free run may never lead to where the force is followed.
std::vector<Eigen::VectorXd> ProposalFits::starts_along_the_motion(const Candidate& c, const Shape& shape,
                                                                   const Eigen::VectorXd& parent) const {
  if (shape.system->model().states.empty() || c.choices.size() > 1) return {};
  Candidate along = c;
  find_starts(study_, along, parent, {shape.guesses});
  return std::move(along.starts);
}

void ProposalFits::leave_limits(Candidate& c, const Shape& shape, const Candidate& parent) const {
  if (c.guesses_tried || !c.ran() || !c.degenerate() || !parent.ran()) return;
  c.guesses_tried = true;
  Eigen::VectorXd from = Eigen::VectorXd::Zero(c.parameters());
  from.head(parent.parameters()) = parent.fit.theta;
  try_guesses(c, shape, from);
}

void ProposalFits::leave_minimum(Candidate& c, const Shape& shape) const {
  if (!c.ran() || c.minimum_left) return;
  try_guesses(c, shape, Eigen::VectorXd(c.fit.theta));
  begin_in_short_runs(c);
}

void ProposalFits::begin_in_short_runs(Candidate& c) const {
  if (!c.ran() || c.minimum_left) return;
  c.minimum_left = true;
  const Eigen::VectorXd present = c.fit.theta;
  const bool converged = c.fit.converged;
  if (!converged) go_on(c, 40);
  const double cost = c.fit.cost;
  try_short_runs(c, c.fit.theta, INFINITY);
  if (!converged && !(c.fit.cost < cost)) try_short_runs(c, present, INFINITY);
}

void ProposalFits::try_short_runs(Candidate& c, const Eigen::VectorXd& from, double to_beat) const {
  if (c.ran()) to_beat = std::min(to_beat, rms(c));
  FitResult other =
      fit_progressively(*c.system, from, study_.train, fixed_fit(study_, 12, 1e-4, coarse_substeps(c)), to_beat);
  if (!c.ran() || other.cost < c.fit.cost) c.fit = std::move(other);
}

double ProposalFits::promised(const Candidate& c) const {
  const bool told = !decays_ && std::isfinite(c.force_cost);
  return told ? std::sqrt(c.force_cost / static_cast<double>(force_rows_)) : 0;
}

void ProposalFits::end(Candidate& c, double to_beat) const {
  constexpr double followed = 0.3;  // of the motion: what several effects follow they need not find again
  if (c.ran()) go_on(c, 24);
  if (c.ran() && c.choices.size() > 2 && rms(c) < followed * study_.measured_std()) return;
  const double hope = promised(c);
  if (hope > to_beat || (c.ran() && rms(c) < std::max(1.5 * hope, 2 * study_.sensor_noise()))) return;
  try_short_runs(c, c.starts.front(), std::max(to_beat, 2 * study_.sensor_noise()));
}

}  // namespace lunid
