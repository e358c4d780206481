#include <ranges>

#include "expr/digits.hpp"
#include "record/median.hpp"
#include "simulate/first_states.hpp"
#include "simulate/fit_problem.hpp"
#include "simulate/fit_steps.hpp"
#include "simulate/integrator.hpp"
#include "simulate/measures.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<FitSegment> cut(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                            Eigen::Index length) {
  std::vector<FitSegment> segments;
  for (std::size_t r = 0; r < data.size(); ++r) {
    const Eigen::Index rows = data[r].record.rows();
    const Eigen::Index parts = length <= 0 ? 1 : std::max<Eigen::Index>(1, rows / length);
    for (Eigen::Index k = 0; k < parts; ++k) {
      const Eigen::Index first = rows * k / parts, last = rows * (k + 1) / parts;
      segments.push_back({static_cast<int>(r), first, last - first,
                          measured_state(system, own_values(system, theta), data[r].record, first)});
    }
  }
  if (!segments.empty()) segments.front().anchored = true;
  return segments;
}

/// Of another fit, where its free runs begin in the same rows; states that it lacks stay as they are. Both in order.
void take_first_states(const std::vector<FitSegment>& known, std::vector<FitSegment>& segments) {
  auto k = known.begin();
  for (FitSegment& s : segments) {
    while (k != known.end() && std::pair(k->record, k->first) < std::pair(s.record, s.first)) ++k;
    if (k == known.end()) return;
    if (k->record != s.record || k->first != s.first) continue;
    const Eigen::Index count = std::min(k->x0.size(), s.x0.size());
    s.x0.head(count) = k->x0.head(count);
  }
}

/// 1.4826 times the median of |residual|, as the fit weighs it: the standard deviation of the rows that are no
/// outliers.
double robust_scale(const FitResult& result, const std::vector<FitData>& data) {
  std::vector<double> sizes;
  for (std::size_t r = 0; r < data.size(); ++r)
    for (const double e : result.residual[r])
      if (std::isfinite(e)) sizes.push_back(data[r].weight * std::abs(e));
  if (sizes.empty()) return 0;
  return 1.4826 * middle_value(std::move(sizes));
}

FitResult minimise_by(const FitOptions& options, const System& system, const Eigen::VectorXd& theta,
                      const std::vector<FitData>& data, std::vector<FitSegment> segments, int substeps, double clip) {
  const auto by = options.gradient == Gradient::adjoint ? minimise_by_adjoint : minimise;
  return by(system, theta, data, options, std::move(segments), substeps, clip);
}

/// Huber's clip at 1.345 standard deviations (95 % of the efficiency for Gaussian noise), the deviation taken anew from
/// each pass.
FitResult refit_robustly(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                         FitResult result) {
  constexpr int passes = 4;
  constexpr double huber = 1.345;
  for (int pass = 0; pass < passes && std::isfinite(result.cost); ++pass) {
    const double scale = robust_scale(result, data);
    if (!(scale > 0)) break;
    const long runs = result.runs;
    result = minimise_by(options, system, result.theta, data, result.segments, result.substeps, huber * scale);
    result.runs += runs;
  }
  return result;
}

void check(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
           const FitOptions& options) {
  const FitLayout layout(system.parameters(), static_cast<int>(data.size()), options.separate);
  if (theta.size() != system.parameters() && theta.size() != layout.size())
    throw InputError("fit_trajectory: theta: expected " + std::to_string(system.parameters()) + " values, got " +
                     std::to_string(theta.size()));
  for (const int i : options.separate)
    if (i < 0 || i >= system.parameters())
      throw InputError("fit_trajectory: separate: expected parameters from 0 to " +
                       std::to_string(system.parameters() - 1) + ", got " + std::to_string(i));
  if (!theta.allFinite()) throw InputError("fit_trajectory: theta: every first guess must be a finite number");
  if (data.empty()) throw InputError("fit_trajectory: expected at least one record, got none");
  if (options.gradient == Gradient::adjoint && !states_alone(system.model(), data, options))
    throw InputError(
        "fit_trajectory: gradient: 'adjoint' is that of the states; take 'forward' where the model measures, or where "
        "accelerations are fitted");
  for (const auto& d : data)
    if (!d.use.empty() && static_cast<Eigen::Index>(d.use.size()) != d.record.rows())
      throw InputError("fit_trajectory: use: expected one entry per row of the record");
}

}  // namespace

std::string to_string(Gradient gradient) {
  return gradient == Gradient::automatic ? "auto" : gradient == Gradient::forward ? "forward" : "adjoint";
}

std::string fit_solver_name(const FitOptions& options, int substeps) {
  return is_multistep(options.solver) ? sundials_name(options.solver) : fixed_solver_name(substeps);
}

void validate(const FitOptions& o) {
  auto refuse = [](const std::string& what) { throw InputError("fit_trajectory: " + what); };
  if (o.solver != Solver::automatic && o.solver != Solver::fixed && !is_multistep(o.solver))
    refuse("solver: expected auto, fixed, bdf or adams, which carry sensitivities, got '" + to_string(o.solver) + "'");
  if (o.gradient == Gradient::adjoint && is_multistep(o.solver))
    refuse("gradient: 'adjoint' is that of the fixed path; take 'forward' with solver '" + to_string(o.solver) + "'");
  if (o.gradient == Gradient::adjoint && (o.whitening.average > 1 || !o.whitening.ar.empty()))
    refuse("gradient: 'adjoint' takes residuals as they are; take 'forward' with a whitening");
  if (o.segment < 0) refuse("segment: expected >= 0 rows, got " + std::to_string(o.segment));
  if (o.max_iterations < 1) refuse("max_iterations: expected >= 1, got " + std::to_string(o.max_iterations));
  if (!(o.tolerance > 0)) refuse("tolerance: expected > 0, got " + number(o.tolerance));
  if (o.whitening.average < 1)
    refuse("whitening.average: expected >= 1 rows, got " + std::to_string(o.whitening.average));
  if (o.substeps < 0) refuse("substeps: expected >= 0, got " + std::to_string(o.substeps));
  if (o.threads < 0) refuse("threads: expected >= 0, got " + std::to_string(o.threads));
}

namespace {

constexpr int finest = 8;            // times the substeps that a fit began with
constexpr double finer_gain = 0.99;  // of the cost, at which the fit goes on with shorter steps

/// Some parameters were not simulated only because the steps were too long for them (a stiff bristle): a fit stops at
/// that wall as at a bound.
bool lost_by_long_steps(const System& system, const FitResult& result, const std::vector<FitData>& data,
                        const FitOptions& options, const std::vector<FitSegment>& segments, int finer) {
  if (result.lost.size() == 0 || system.model().imposed_motion || is_multistep(options.solver)) return false;
  Problem problem(system, data, options, finer);
  problem.prepare(segments);
  return std::isfinite(problem.evaluate(result.lost, segments, false).cost);
}

}  // namespace

FitData FitData::part(Eigen::Index first, Eigen::Index count) const {
  FitData out{record.slice(first, count), {}, {}, weight};
  if (!excitation.empty()) out.excitation = excitation.part(first, count);
  if (!use.empty()) out.use.assign(use.begin() + first, use.begin() + first + count);
  return out;
}

FitResult fit_trajectory(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                         const FitOptions& options) {
  validate(options);
  check(system, theta, data, options);
  const FitOptions chosen = with_steps(system, theta, data, options);
  const int substeps = chosen.substeps;
  std::vector<FitSegment> segments = cut(system, theta, data, options.segment);
  if (options.first_states.empty() && !system.model().imposed_motion && !is_multistep(chosen.solver))
    settle_first_states(system, theta, data, chosen, segments);
  take_first_states(options.first_states, segments);
  FitResult result = minimise_by(chosen, system, theta, data, segments, substeps, 0);
  const int limit = options.shorten_steps ? std::min(finest * substeps, explicit_limit) : 0;
  for (int finer = 2 * substeps; finer <= limit; finer *= 2) {
    const bool ran = std::isfinite(result.cost);
    const std::vector<FitSegment>& first = ran ? result.segments : segments;
    if (!lost_by_long_steps(system, result, data, chosen, first, finer)) continue;
    FitResult again = minimise_by(chosen, system, ran ? result.theta : theta, data, first, finer, 0);
    again.runs += result.runs;
    if (!(again.cost < finer_gain * result.cost)) break;
    result = std::move(again);
  }
  if (options.loss == Loss::huber) result = refit_robustly(system, data, chosen, std::move(result));
  if (options.force_noise) count_noise_of_forces(system, data, chosen, result);
  return result;
}

Profile profile_likelihood(const System& system, const FitResult& result, const std::vector<FitData>& data,
                           const FitOptions& given, int index) {
  if (index < 0 || index >= result.theta.size() || std::isnan(result.deviation(index)))
    throw InputError("profile: the parameter has no standard deviation: it is fixed, sits at a bound, or is not seen");
  constexpr double step = 0.5, farthest = 10, chi_squared = 3.841459;  // of one degree of freedom, 95 %
  FitOptions options = given;
  options.hold = {index};
  options.gradient = Gradient::forward;
  if (result.solver == sundials_name(Solver::bdf)) options.solver = Solver::bdf;
  const FitLayout layout(system.parameters(), static_cast<int>(data.size()), options.separate);
  const Bounds bounds(system.model(), layout, given);
  const double centre = result.theta[index], std = result.deviation(index);
  // where the residual is not white, the covariance is wider than the curvature of the cost; so is the interval
  const Eigen::MatrixXd white = pseudo_inverse(result.information) * (result.cost / result.freedom);
  const double widening =
      white(index, index) > 0 ? std::max(1.0, result.covariance(index, index) / white(index, index)) : 1;
  const double unit = result.cost / result.freedom * widening;
  Profile profile;
  profile.points = {{centre, 0}};
  for (const int side : {-1, 1}) {
    double& end = side < 0 ? profile.low : profile.high;
    end = side * infinity;
    Eigen::VectorXd theta = result.theta;
    std::vector<FitSegment> segments = result.segments;
    double at = centre, drop = 0;
    for (double k = step; k <= farthest; k += step) {
      const double value = std::clamp(centre + side * k * std, bounds.min[index], bounds.max[index]);
      if (value == at) break;  // the bound: open on this side
      theta[index] = value;
      const FitResult fit = minimise(system, theta, data, options, segments, result.substeps, result.clip);
      if (!std::isfinite(fit.cost)) break;
      theta = fit.theta;
      segments = fit.segments;
      const double next = std::max(0.0, (fit.cost - result.cost) / unit);
      profile.points.push_back({value, next});
      if (next > chi_squared) {  // the root of the drop is nearly straight
        const double a = std::sqrt(drop), b = std::sqrt(next);
        end = at + (value - at) * (std::sqrt(chi_squared) - a) / (b - a);
        break;
      }
      at = value;
      drop = next;
    }
  }
  std::sort(profile.points.begin(), profile.points.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
  return profile;
}

namespace {

bool is_driven(const Model& model, const Record& record) {
  return std::ranges::any_of(model.inputs(), [&](const std::string& channel) {
    return !record.has(channel) || std::ranges::any_of(record[channel], [](double value) { return value != 0; });
  });
}

std::vector<FitData> first_rows(const std::vector<FitData>& data, Eigen::Index count) {
  std::vector<FitData> out;
  for (const FitData& d : data) out.push_back(d.part(0, std::min(count, d.record.rows())));
  return out;
}

Eigen::Index rows_in_use(const std::vector<FitData>& data) {
  Eigen::Index rows = 0;
  for (const FitData& d : data) rows += d.record.rows() - std::ranges::count(d.use, 0);
  return rows;
}

}  // namespace

FitResult fit_progressively(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                            const FitOptions& options, double to_beat) {
  validate(options);
  check(system, theta, data, options);
  if (system.model().imposed_motion) return fit_trajectory(system, theta, data, options);
  Eigen::Index longest = 0, length = 0;
  for (const auto& d : data) {
    longest = std::max(longest, d.record.rows());
    length =
        std::max(length, static_cast<Eigen::Index>(2 * shortest_period(d.record[first_channel(system, d, options)])));
  }
  length = std::clamp<Eigen::Index>(length, 20, longest);
  const FitOptions chosen = with_steps(system, theta, data, options);
  FitOptions stage = chosen;
  stage.whitening = {};
  stage.force_noise = false;
  stage.tolerance = std::max(options.tolerance, 1e-3);
  stage.max_iterations = std::min(options.max_iterations, 12);
  Eigen::VectorXd current = theta;
  long runs = 0;
  const auto take = [&](FitResult fit) {
    runs += fit.runs;
    if (!std::isfinite(fit.cost)) return;
    current = fit.theta;
    stage.first_states = std::move(fit.segments);
    // A record's internal states begin as the model says: a short run may have moved what it could not see.
    for (FitSegment& s : stage.first_states)
      if (s.first == 0) s.x0.conservativeResize(2 * system.degrees());
  };
  const bool decays = std::ranges::none_of(data, [&](const FitData& d) { return is_driven(system.model(), d.record); });
  if (decays && options.segment == 0) {
    for (Eigen::Index rows = length; rows < longest; rows = 3 * rows / 2)
      if (const std::vector<FitData> first = first_rows(data, rows); rows_in_use(first) >= length)
        take(fit_trajectory(system, current, first, stage));
  } else {
    const Eigen::Index last = options.segment > 0 ? options.segment : longest;
    std::vector<Eigen::Index> lengths;  // from run to run three are joined to one, which begins where the first began
    for (Eigen::Index joined = last / 3; joined >= length; joined /= 3) lengths.push_back(joined);
    for (const Eigen::Index rows : lengths | std::views::reverse) {
      stage.segment = rows;
      FitResult fit = fit_trajectory(system, current, data, stage);
      if (std::isfinite(fit.cost) && std::sqrt(fit.cost / static_cast<double>(fit.rows)) > to_beat) {
        fit.runs += runs;
        fit.cost = INFINITY;
        fit.converged = false;
        fit.stopped = "runs of " + std::to_string(rows) + " rows leave too much";
        return fit;
      }
      take(std::move(fit));
    }
  }
  FitOptions final_stage = chosen;
  if (!stage.first_states.empty()) final_stage.first_states = stage.first_states;
  FitResult result = fit_trajectory(system, current, data, final_stage);
  runs += result.runs;
  if (!std::isfinite(result.cost) && !stage.first_states.empty()) {  // what short runs led to grows without bound
    final_stage.first_states = chosen.first_states;
    FitResult whole = fit_trajectory(system, theta, data, final_stage);
    runs += whole.runs;
    if (std::isfinite(whole.cost)) result = std::move(whole);
  }
  result.runs = runs;
  return result;
}

}  // namespace lunid
