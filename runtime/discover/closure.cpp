#include "discover/closure.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/lines.hpp"
#include "discover/places.hpp"
#include "discover/proposal_fits.hpp"
#include "expr/digits.hpp"
#include "record/parallel.hpp"
#include "simulate/inertia.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

struct Feature {
  Expr force;
  std::string words;
  std::optional<InternalState> state = {};  ///< that the force is a function of
  bool acts = false;                        ///< beside the force that is recorded, on its side of the equation
};

/// With two digits, for an equation that is read.
double rounded(double size) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", size);
  return size > 0 ? std::strtod(text, nullptr) : 1;
}

/// A recorded force on the one coordinate that there is, in some record.
bool drives_what_it_moves(const Study& study, const Model& model) {
  return !study.imposed && model.degrees() == 1 && !model.delay.valid() && !are_free(study, study.full);
}

std::vector<Feature> generic_forces(const Study& study, const Candidate& beside, const std::optional<Place>& place) {
  const Model& model = beside.system->model();
  Pool& pool = *model.pool;
  const RecordScales s = scales(study, 1, place);
  const Expr u = motion_at(model, place, 'y') / rounded(s.y_std), w = motion_at(model, place, 'v') / rounded(s.v_std),
             t = pool.channel("t");
  const Expr slow = t / rounded(study.train.front().record.duration());
  auto tanh = [&](Expr x) { return pool.apply(Op::tanh, {x}); };
  auto abs = [&](Expr x) { return pool.apply(Op::abs, {x}); };
  const Expr z = pool.state("closure_memory");
  const InternalState memory{z, (w - z) * pool.constant(rounded(study.omega)), 0, {}, {}};
  std::vector<Feature> out{{pool.constant(1), "constant"},
                           {u, "linear in y"},
                           {w, "linear in v"},
                           {pow(u, 2), "even in y"},
                           {pow(u, 3), "odd in y, growing with |y|"},
                           {pow(u, 4), "even in y"},
                           {pow(u, 5), "odd in y, growing with |y|"},
                           {tanh(4.0 * u), "odd in y, saturating"},
                           {pow(w, 2), "even in v"},
                           {pow(w, 3), "odd in v, growing with |v|"},
                           {pow(w, 5), "odd in v, growing with |v|"},
                           {tanh(4.0 * w), "odd in v, saturating"},
                           {u * w, "a product of y and v"},
                           {pow(u, 2) * w, "damping that depends on y"},
                           {abs(u) * w, "damping that depends on y"},
                           {u * pow(w, 2), "stiffness that depends on v"},
                           {u * abs(w), "stiffness that depends on v"},
                           {pow(u, 3) * w, "a product of y and v"},
                           {z, "memory of the velocity", memory},
                           {slow * u, "stiffness that changes with time"},
                           {slow * w, "damping that changes with time"}};
  if (const std::vector<double> lines = modulation_lines(study, beside, place); !lines.empty()) {
    const std::string words = "stiffness that goes up and down at " + number(lines.front(), 4) + " rad/s";
    const Expr phase = lines.front() * t;
    for (const Op wave : {Op::cos, Op::sin}) out.push_back({pool.apply(wave, {phase}) * u, words});
  }
  if (drives_what_it_moves(study, model)) {
    const Expr force = pool.channel("F");
    for (const auto& [factor, words] : {std::pair{u, "y"}, {pow(u, 2), "y"}, {w, "v"}, {pow(w, 2), "v"}})
      out.push_back({force * factor, std::string("a drive whose force depends on ") + words, {}, true});
  }
  return out;
}

/// Whitened residual and whitened columns of length one [model's own parameters and first states | generic forces], all
/// records.
struct Columns {
  Eigen::VectorXd residual;
  Eigen::MatrixXd own, extra;
  std::vector<int> part;  ///< block of each row, for leaving out
};

/// Down to the sensor's noise.
bool is_followed(const Study& study, const FitResult& fit) { return rms(fit) < 1.1 * study.sensor_noise(); }

bool collect(const Study& study, const Candidate& candidate, const System& system, const Whitening& whitening,
             Columns& out) {
  const Eigen::Index p = candidate.parameters(), all = system.parameters(), extra = all - p;
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(all);
  theta.head(p) = candidate.whitened.theta;
  Linearised linear;
  if (!linearise(study, system, theta, candidate.whitened, whitening, linear)) return false;
  hold_and_scale(candidate.system->model(), candidate.whitened, linear.columns);
  out.residual = std::move(linear.residual);
  out.extra = linear.columns.middleCols(p, extra);
  out.own.resize(linear.columns.rows(), linear.columns.cols() - extra);
  out.own << linear.columns.leftCols(p), linear.columns.rightCols(linear.columns.cols() - all);
  for (std::size_t r = 0; r + 1 < linear.row_of_record.size(); ++r) {
    const Eigen::Index n = linear.row_of_record[r + 1] - linear.row_of_record[r];
    for (Eigen::Index i = 0; i < n; ++i) out.part.push_back(part_of(i, n, study.options->blocks));
  }
  return true;
}

double misfit(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, Eigen::Index* rank = nullptr) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  qr.setThreshold(1e-7);
  if (rank) *rank = qr.rank();
  return (b - a * qr.solve(b)).squaredNorm();
}

/// Squared error on rows that the regression did not see, for the own columns and for all; small ridge on all.
std::pair<double, double> left_out_misfit(const Columns& columns, int parts) {
  double with = 0, without = 0;
  const Eigen::Index own = columns.own.cols();
  Eigen::MatrixXd all(columns.own.rows(), own + columns.extra.cols());
  all << columns.own, columns.extra;
  const Eigen::Index m = all.cols();
  std::vector<Eigen::MatrixXd> gram(static_cast<std::size_t>(parts), Eigen::MatrixXd::Zero(m, m));
  std::vector<Eigen::VectorXd> right(static_cast<std::size_t>(parts), Eigen::VectorXd::Zero(m));
  std::vector<std::vector<Eigen::Index>> rows(static_cast<std::size_t>(parts));
  for (Eigen::Index i = 0; i < all.rows(); ++i)
    rows[static_cast<std::size_t>(columns.part[static_cast<std::size_t>(i)])].push_back(i);
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(m, m);
  Eigen::VectorXd target = Eigen::VectorXd::Zero(m);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Eigen::MatrixXd part = all(rows[k], Eigen::all);
    const Eigen::VectorXd b = columns.residual(rows[k]);
    gram[k] = part.transpose() * part;
    right[k] = part.transpose() * b;
    total += gram[k];
    target += right[k];
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Eigen::MatrixXd a = total - gram[k];
    a.diagonal().array() += 1e-9;
    const Eigen::VectorXd b = target - right[k];
    const Eigen::MatrixXd part = all(rows[k], Eigen::all);
    const Eigen::VectorXd residual = columns.residual(rows[k]);
    with += (residual - part * a.ldlt().solve(b)).squaredNorm();
    without += (residual - part.leftCols(own) * a.topLeftCorner(own, own).ldlt().solve(b.head(own))).squaredNorm();
  }
  return {without, with};
}

/// The model with generic forces at a place, all with coefficient zero.
struct Generic {
  Closure closure;
  std::vector<Feature> features;
  Columns columns;
  double left = INFINITY;  ///< squared error beside them
};

/// On the one coordinate.
void add_acting_force(Model& model, Expr force) {
  if (model.acts.empty()) model.acts.push_back({"F", model.pool->channel("F")});
  Expr& acting = model.acts.front().map;
  acting = acting + force;
}

/// The model with these of the generic forces.
std::shared_ptr<const System> with_forces(const Study& study, const Candidate& candidate,
                                          const std::optional<Place>& place, const std::vector<Feature>& features,
                                          const std::vector<std::size_t>& listed) {
  Model model = candidate.system->model();
  const Units units = study.units();
  for (std::size_t j = 0; j < features.size(); ++j) {
    if (std::ranges::find(listed, j) == listed.end()) continue;
    const auto& state = features[j].state;
    const auto is_there = [&](const InternalState& each) { return each.symbol.id() == state->symbol.id(); };
    if (state && std::ranges::none_of(model.states, is_there)) model.states.push_back(*state);
    std::string name = "closure_" + std::to_string(j + 1);
    while (model.find(name)) name += "_more";
    const Expr force = model.pool->parameter(name) * features[j].force;
    if (features[j].acts)
      add_acting_force(model, force);
    else
      add_force(model, place, force);
    Parameter row;
    row.name = name;
    row.value = 0;
    row.unit = features[j].acts ? "" : units.force;
    model.parameters.push_back(row);
  }
  return std::make_shared<const System>(complete(std::move(model)));
}

/// Of all generic forces.
Generic generic_at(const Study& study, const Candidate& candidate, const std::optional<Place>& place) {
  Generic out;
  out.closure.place = place;
  out.features = generic_forces(study, candidate, place);
  std::vector<std::size_t> all(out.features.size());
  std::iota(all.begin(), all.end(), 0);
  out.closure.system = with_forces(study, candidate, place, out.features, all);
  return out;
}

void test(const Study& study, const Candidate& candidate, const Whitening& whitening, Generic& generic) {
  Closure& closure = generic.closure;
  Columns& columns = generic.columns;
  if (!collect(study, candidate, *closure.system, whitening, columns)) return;
  const Eigen::MatrixXd &own = columns.own, &extra = columns.extra;
  Eigen::MatrixXd all(own.rows(), own.cols() + extra.cols());
  all << own, extra;
  Eigen::Index rank_own = 0, rank_all = 0;
  const double before = misfit(own, columns.residual, &rank_own);
  generic.left = misfit(all, columns.residual, &rank_all);
  const double added = static_cast<double>(rank_all - rank_own);
  const double freedom = static_cast<double>(own.rows() - rank_all);
  if (added > 0 && freedom > 0 && generic.left > 0)
    closure.p_value = f_tail((before - generic.left) / added / (generic.left / freedom), added, freedom);
}

constexpr std::size_t all_forces = 100;

/// Forward selection of the generic forces that explain more than chance beside those before them, best first: what all
/// of them follow together does not hold for another motion. No more than `most` of them.
std::vector<std::size_t> select(const Columns& columns, double alpha, std::size_t most = all_forces) {
  std::vector<std::size_t> chosen;
  Eigen::MatrixXd with = columns.own;
  double before = misfit(with, columns.residual);
  const auto all = static_cast<std::size_t>(columns.extra.cols());
  while (chosen.size() < std::min(most, all)) {
    double least = before;
    std::size_t best = all;
    with.conservativeResize(Eigen::NoChange, with.cols() + 1);
    for (std::size_t j = 0; j < all; ++j) {
      if (std::ranges::find(chosen, j) != chosen.end()) continue;
      with.rightCols(1) = columns.extra.col(static_cast<Eigen::Index>(j));
      if (const double cost = misfit(with, columns.residual); cost < least) least = cost, best = j;
    }
    const double freedom = static_cast<double>(with.rows() - with.cols());
    if (best == all || !(freedom > 0 && least > 0)) break;
    const double p_value = f_tail((before - least) / (least / freedom), 1, freedom);
    if (!(corrected(p_value, static_cast<int>(all)) < alpha)) break;
    with.rightCols(1) = columns.extra.col(static_cast<Eigen::Index>(best));
    chosen.push_back(best);
    before = least;
  }
  return chosen;
}

}  // namespace

Closure test_closure(const Study& study, const Candidate& candidate, const Whitening& whitening) {
  if (!candidate.ran() || candidate.innovations.size() == 0) return {};
  std::vector<Generic> all;
  for (const Place& place : places_of(study.model)) all.push_back(generic_at(study, candidate, place));
  if (all.empty()) all.push_back(generic_at(study, candidate, {}));
  parallel_for(static_cast<int>(all.size()), study.options->threads,
               [&](int i) { test(study, candidate, whitening, all[static_cast<std::size_t>(i)]); });
  Generic& best =
      *std::min_element(all.begin(), all.end(), [](const Generic& a, const Generic& b) { return a.left < b.left; });
  Closure out = best.closure;
  out.p_value = std::min(1.0, out.p_value * static_cast<double>(all.size()));
  if (!std::isfinite(best.left)) return out;
  const std::vector<std::size_t> chosen = select(best.columns, study.options->alpha);
  if (chosen.empty()) return out;
  out.shape = best.features[chosen.front()].words;
  const std::vector<Eigen::Index> columns(chosen.begin(), chosen.end());
  best.columns.extra = best.columns.extra(Eigen::all, columns).eval();
  const auto [without, with] = left_out_misfit(best.columns, study.options->blocks);
  out.gain = 1 - std::sqrt(with / without);
  out.system = with_forces(study, candidate, out.place, best.features, chosen);
  return out;
}

namespace {

/// From the candidate's parameters and first states, and from what the force along the motion says of all.
FitResult fit_forces(const Study& study, const Candidate& candidate, const System& system) {
  const FitOptions options = fixed_fit(study, 20, 1e-5, candidate.whitened.substeps);
  FitOptions beside = options;
  beside.first_states = candidate.fit.segments;
  Eigen::VectorXd start = Eigen::VectorXd::Zero(system.parameters());
  start.head(candidate.parameters()) = candidate.fit.theta;
  FitResult out = fit_trajectory(system, start, study.train, beside);
  if (is_followed(study, out)) return out;
  // What was named may be far from what generic forces make of its part.
  Candidate generic = compile(study, system.model(), {});
  find_starts(study, generic, start, {});
  if (generic.starts.empty()) return out;
  FitResult other = fit_progressively(system, generic.starts.front(), study.train, options);
  return out.cost <= other.cost ? out : other;
}

/// The model with the forces fitted so far, and those that explain more than chance along its own run; null where none
/// does. What a poor model shows of a force at first is not all of it: the run is another one.
std::shared_ptr<const System> with_further_forces(const Study& study, const Candidate& fitted,
                                                  const Whitening& whitening, const std::optional<Place>& place,
                                                  std::size_t most) {
  Generic generic = generic_at(study, fitted, place);
  test(study, fitted, whitening, generic);
  if (!std::isfinite(generic.left)) return {};
  const std::vector<std::size_t> chosen = select(generic.columns, study.options->alpha, most);
  return chosen.empty() ? nullptr : with_forces(study, fitted, place, generic.features, chosen);
}

bool is_in_force(const Model& model, Expr symbol) {
  for (const auto& [channel, map] : model.acts)
    if (depends_on(map, symbol)) return true;
  for (int i = 0; i < model.degrees(); ++i)
    if (depends_on(model.coordinate(i).restoring, symbol)) return true;
  return false;
}

Expr without_summands_of(Expr force, Expr coefficient) {
  Expr out = force.pool().constant(0);
  for (const Expr summand : summands(force))
    if (!depends_on(summand, coefficient)) out = out + summand;
  return out;
}

/// The model without the summands of a coefficient; none where that would leave another parameter without use.
std::optional<Model> without_force(const Model& model, const std::string& coefficient) {
  Model out = model;
  Pool& pool = *out.pool;
  const Expr gone = pool.parameter(coefficient);
  out.restoring = without_summands_of(out.restoring, gone);
  for (Coordinate& row : out.further) row.restoring = without_summands_of(row.restoring, gone);
  for (auto& [channel, map] : out.acts) map = without_summands_of(map, gone);
  std::erase_if(out.parameters, [&](const Parameter& row) { return row.name == coefficient; });
  const auto loses = [&](Expr symbol) { return is_in_force(model, symbol) && !is_in_force(out, symbol); };
  for (const Parameter& row : out.parameters)
    if (loses(pool.parameter(row.name))) return {};
  for (const InternalState& state : out.states)
    if (loses(state.symbol) && !symbols(state.rate, SymbolKind::parameter).empty()) return {};
  std::erase_if(out.states, [&](const InternalState& state) { return loses(state.symbol); });
  return out;
}

/// The parameter from `first` on that is least told from zero by its own fit, within two standard deviations.
std::optional<std::size_t> least_told(const Candidate& c, std::size_t first) {
  std::optional<std::size_t> out;
  double least = 2;
  for (std::size_t j = first; j < c.linear.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    const double told = std::abs(c.fit.theta[k]) / c.fit.deviation(k);  // not a number where it has no deviation
    if (c.linear[j] && told < least) least = told, out = j;
  }
  return out;
}

/// Adds forces along the closure's own run, so many at a time, while that lowers the cost.
void add_forces(const Study& study, const Whitening& whitening, int rounds, std::size_t at_a_time, Closure& closure) {
  for (int i = 0; i < rounds && !is_followed(study, closure.fit); ++i) {
    Candidate fitted = compile(study, closure.system->model(), {});
    fitted.fit = fitted.whitened = closure.fit;
    const std::shared_ptr<const System> more = with_further_forces(study, fitted, whitening, closure.place, at_a_time);
    if (!more) return;
    FitResult fit = fit_forces(study, fitted, *more);
    if (!(fit.cost < 0.9 * closure.fit.cost)) return;
    closure.system = more;
    closure.fit = std::move(fit);
  }
}

/// Takes forces behind the first parameters out again, one by one, that are not told from zero and without which it
/// fits as well.
void shorten(const Study& study, int parameters, Closure& closure) {
  constexpr double as_well = 1.01;
  Candidate now = compile(study, closure.system->model(), {});
  now.fit = closure.fit;
  while (const auto weakest = least_told(now, static_cast<std::size_t>(parameters))) {
    const Model& model = now.system->model();
    const std::optional<Model> less = without_force(model, model.parameters[*weakest].name);
    if (!less) return;
    Candidate shorter = compile(study, *less, {});
    shorter.fit = fit_near(study, shorter, values_of(shorter, {&now}), 20, now.fit.substeps, now.fit.segments);
    if (!(shorter.fit.cost < as_well * now.fit.cost)) return;
    now = std::move(shorter);
    closure.system = now.system;
    closure.fit = now.fit;
  }
}

}  // namespace

void fit_closure(const Study& study, const Candidate& candidate, Closure& closure) {
  closure.fit = fit_forces(study, candidate, *closure.system);
}

void refine_closure(const Study& study, const Whitening& whitening, Closure& closure) {
  add_forces(study, whitening, 2, all_forces, closure);
}

Closure grow_closure(const Study& study, const Candidate& candidate, const Whitening& whitening,
                     const std::optional<Place>& place) {
  Closure out;
  out.place = place;
  out.system = candidate.system;
  out.fit = candidate.fit;
  add_forces(study, whitening, 8, 1, out);
  shorten(study, candidate.parameters(), out);
  return out;
}

}  // namespace lunid
