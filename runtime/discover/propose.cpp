#include "discover/propose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "discover/lines.hpp"
#include "discover/sensor.hpp"

namespace lunid {

namespace {

/// Longer records are looked at by their first part.
constexpr Eigen::Index most_rows = 20000;

/// A step that keeps within bounds: what would leave them is held and the rest solved again.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& at,
                             const std::vector<Parameter>& table) {
  const Eigen::Index p = b.size();
  std::vector<std::uint8_t> held(static_cast<std::size_t>(p), 0);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(p);
  for (Eigen::Index i = 0; i < p; ++i) held[static_cast<std::size_t>(i)] = table[static_cast<std::size_t>(i)].fixed;
  for (Eigen::Index pass = 0; pass <= p; ++pass) {
    std::vector<Eigen::Index> open;
    for (Eigen::Index i = 0; i < p; ++i)
      if (!held[static_cast<std::size_t>(i)] && a(i, i) > 0) open.push_back(i);
    if (open.empty()) return step;
    const Eigen::VectorXd rest = b - a * step;
    const Eigen::VectorXd scale = a.diagonal()(open).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * a(open, open) * scale.asDiagonal();
    const Eigen::VectorXd right = scale.asDiagonal() * rest(open);
    const Eigen::VectorXd solved = scale.asDiagonal() * scaled.completeOrthogonalDecomposition().solve(right);
    bool again = false;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const Eigen::Index i = open[k];
      const auto& row = table[static_cast<std::size_t>(i)];
      const double wanted = at[i] + step[i] + solved[static_cast<Eigen::Index>(k)];
      const double value = std::clamp(wanted, row.min, row.max);
      if (value == wanted) continue;
      step[i] = value - at[i];
      held[static_cast<std::size_t>(i)] = again = true;
    }
    if (again) continue;
    for (std::size_t k = 0; k < open.size(); ++k) step[open[k]] += solved[static_cast<Eigen::Index>(k)];
    return step;
  }
  return step;
}

/// The values of a guess, and 1 (or the bound nearest to it) for what it leaves open.
Eigen::VectorXd start_of(const Shape& shape, const Guess& guess) {
  const auto& table = shape.system->model().parameters;
  Eigen::VectorXd theta(static_cast<Eigen::Index>(table.size()));
  for (std::size_t i = 0; i < table.size(); ++i) theta[static_cast<Eigen::Index>(i)] = guessed(table[i], guess);
  return theta;
}

/// Of a unit as entries write it, products before and behind one slash: "N s/m" 1, "s/m" 0, "m/N" -1. A kilogram is
/// N s^2/m.
int power_of_newton(const std::string& unit) {
  int power = 0, sign = 1;
  std::string word;
  for (const char c : unit + " ") {
    if (std::isalpha(static_cast<unsigned char>(c))) {
      word += c;
      continue;
    }
    if (word == "N" || word == "kg") power += sign;
    word.clear();
    if (c == '/') sign = -1;
  }
  return power;
}

std::vector<Eigen::Index> linear_ones(const Shape& shape) {
  std::vector<Eigen::Index> list;
  for (std::size_t i = 0; i < shape.linear.size(); ++i)
    if (shape.linear[i] && !shape.system->model().parameters[i].fixed) list.push_back(static_cast<Eigen::Index>(i));
  return list;
}

/// The bounds of a shape's columns.
std::vector<Parameter> table_of_columns(const Shape& shape) {
  std::vector<Parameter> table;
  for (const auto i : linear_ones(shape))
    table.push_back(shape.system->model().parameters[static_cast<std::size_t>(i)]);
  if (shape.rest) {
    table.emplace_back();
    table.back().min = 0;
  }
  return table;
}

/// A column of which the parent's projection has left something: what rounding leaves of one that the parent holds is
/// none.
bool is_own(double projected, double whole) { return projected > 1e-6 * whole; }

/// The Gram matrix of projected columns without those that are none. `whole`: their squares before.
Eigen::MatrixXd of_own_columns(Eigen::MatrixXd gram, const Eigen::VectorXd& whole) {
  for (Eigen::Index k = 0; k < whole.size(); ++k)
    if (!is_own(gram(k, k), whole[k])) gram(k, k) = 0;
  return gram;
}

/// A guess with the linear parameters as they were solved for, and those that carry a force scaled as the rest was: of
/// f(s*p) = s*f(p) for all such p at once, a linear parameter p_k beside the rest is step_k * s^(power - 1).
Eigen::VectorXd scaled_start(const Shape& shape, std::size_t guess, const std::vector<Eigen::Index>& linear,
                             const Eigen::VectorXd& step) {
  Eigen::VectorXd theta = start_of(shape, shape.guesses[guess]);
  for (std::size_t k = 0; k < linear.size(); ++k) theta[linear[k]] = step[static_cast<Eigen::Index>(k)];
  const double scale = shape.rest ? step[step.size() - 1] : 0;
  if (!(scale > 0) || shape.force_powers.empty()) return theta;
  const auto& table = shape.system->model().parameters;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const bool solved = shape.linear[i] && !table[i].fixed;
    double& value = theta[static_cast<Eigen::Index>(i)];
    value = std::clamp(value * std::pow(scale, shape.force_powers[i] - solved), table[i].min, table[i].max);
  }
  return theta;
}

/// An unknown shape parameter that the entry gives no guess for: magnitudes of either sign that its bounds allow.
std::vector<Guess> spread_unknown(const Shape& shape, std::vector<Guess> guesses) {
  const auto& table = shape.system->model().parameters;
  if (guesses.empty()) guesses.push_back({});
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (shape.linear[i] || guesses.front().count(table[i].name) || std::isfinite(table[i].value)) continue;
    std::vector<Guess> next;
    for (const auto& guess : guesses)
      for (const double value : magnitudes(table[i])) {
        next.push_back(guess);
        next.back()[table[i].name] = value;
      }
    if (!next.empty() && next.size() <= 2000) guesses = std::move(next);
  }
  return guesses;
}

}  // namespace

RecordScales scales_beside(const Study& study, const Candidate& model, const std::optional<Place>& place) {
  double squares = 0, rows = 0;
  for (const auto& record : study.smooth) {
    squares += force_at(open_force(model, model.best_theta(), record), record.rows(), place).squaredNorm();
    rows += static_cast<double>(record.rows());
  }
  RecordScales scale = scales(study, std::isfinite(squares) ? std::sqrt(squares / rows) : 0, place);
  scale.lines = residual_lines(study, model);
  scale.modulations = modulation_lines(study, model, place);
  return scale;
}

const RecordScales& PlacedScales::at(const std::optional<Place>& place) {
  for (const auto& [known, scale] : all_)
    if (known == place) return scale;
  return all_.emplace_back(place, scales_beside(study_, model_, place)).second;
}

std::vector<Guess> PlacedScales::guesses(const Choice& choice) {
  if (!choice.effect->guess) return {};
  return choice.effect->guess(at(choice.effect->place), choice.variant);
}

std::vector<std::optional<Place>> PlacedScales::places() const {
  std::vector<std::optional<Place>> out;
  for (const auto& [place, scale] : all_) out.push_back(place);
  return out;
}

Proposer::Proposer(const Study& study, const Candidate& baseline, bool weigh) : degrees_(study.degrees()) {
  Eigen::Index all = 0;
  for (const auto& data : study.force) all += degrees_ * data.record.rows();
  for (const auto& data : study.force) {
    const Eigen::Index rows = all > most_rows ? data.record.rows() * most_rows / all : data.record.rows();
    data_.push_back(data.part(0, rows));
    rows_ += degrees_ * rows;
  }
  measured_.resize(rows_);
  Eigen::Index row = 0;
  for (const auto& data : data_) {
    measured_.segment(row, degrees_ * data.record.rows()) = acting_forces(study.model, data.record);
    row += degrees_ * data.record.rows();
  }
  if (!study.imposed && weigh) receptance_ = Receptance(study, baseline, data_);
}

Eigen::VectorXd Proposer::weighted(const Eigen::VectorXd& force) const {
  return receptance_.motion_of(force, data_, degrees_);
}

namespace {

constexpr int most_substeps = 8;
constexpr int most_substeps_of_a_parent = 64;  // fitted on the trajectory, its memory may be stiff along the motion

bool are_alike(const Eigen::VectorXd& coarse, const Eigen::VectorXd& fine) {
  constexpr double share = 0.02;
  return coarse.allFinite() && fine.allFinite() && (fine - coarse).norm() <= share * fine.norm();
}

/// The fewest substeps over a piece of a record that do as twice as many: too few for the fastest of many states make
/// numbers that grow, finite for long.
int substeps_over(const Record& piece, const System& system, const Eigen::VectorXd& theta) {
  Eigen::VectorXd coarse = imposed_force(system, view(theta), piece, nullptr, 1);
  for (int substeps = 1; substeps < most_substeps; substeps *= 2) {
    const Eigen::VectorXd fine = imposed_force(system, view(theta), piece, nullptr, 2 * substeps);
    if (are_alike(coarse, fine)) return substeps;
    coarse = fine;
  }
  return most_substeps;
}

}  // namespace

/// With so many substeps that twice as many say the same: states that follow at once are stiff along a given motion. Of
/// many states a piece of the first record says how many.
int Proposer::evaluate(const System& system, const Eigen::VectorXd& theta, Eigen::VectorXd& force) const {
  constexpr Eigen::Index piece = 256;  // rows: the whole of many states costs more than one run is worth
  const bool many = many_states(system.model().states.size()), once = many || system.model().states.empty();
  const Record& first = data_.front().record;
  int substeps = many ? substeps_over(first.slice(0, std::min(piece, first.rows())), system, theta) : 1;
  bool finite = evaluate(system, theta, force, nullptr, substeps);
  if (once && finite) return substeps;
  while (substeps < most_substeps) {
    substeps *= 2;
    const Eigen::VectorXd before = std::move(force);
    finite = evaluate(system, theta, force, nullptr, substeps);
    if (finite && (once || are_alike(before, force))) return substeps;
  }
  return finite ? most_substeps : 0;
}

bool Proposer::evaluate(const System& system, const Eigen::VectorXd& theta, Eigen::VectorXd& force,
                        Eigen::MatrixXd* jacobian, int substeps) const {
  force.resize(rows_);
  if (jacobian) jacobian->resize(rows_, theta.size());
  Eigen::Index row = 0;
  for (const auto& data : data_) {
    Eigen::MatrixXd part;
    const Eigen::Index rows = degrees_ * data.record.rows();
    force.segment(row, rows) = imposed_force(system, view(theta), data.record, jacobian ? &part : nullptr, substeps);
    if (jacobian) jacobian->middleRows(row, rows) = part;
    row += rows;
  }
  return force.allFinite() && (!jacobian || jacobian->allFinite());
}

Shape Proposer::shape(const Model& model, const Choice& choice, const RecordScales& scales) const {
  const Effect& effect = *choice.effect;
  Shape shape;
  shape.choice = choice;
  Model alone;
  alone.pool = model.pool;
  alone.mass = alone.restoring = model.pool->constant(0);
  alone.further.assign(model.further.size(), {alone.mass, alone.restoring});
  add_variant(alone, effect, choice.variant);
  alone.imposed_motion = true;
  alone.parameters = limited(choice.parameters(), ranges_of(choice, scales));
  shape.linear = linear_parameters(alone);
  shape.system = std::make_shared<const System>(alone);
  if (effect.guess) shape.guesses = effect.guess(scales, choice.variant);
  shape.guesses = spread_unknown(shape, std::move(shape.guesses));
  return shape;
}

/// Forces with the linear parameters at zero and each at one; of those without memory from one run's slopes. The rest
/// is looked for at the first guess.
Eigen::MatrixXd Proposer::columns_at(Shape& shape, const Guess& guess) const {
  const System& system = *shape.system;
  const auto linear = linear_ones(shape);
  const auto own = static_cast<Eigen::Index>(linear.size());
  const bool first = shape.columns.empty();
  Eigen::VectorXd theta = start_of(shape, guess), force, rest = Eigen::VectorXd::Zero(rows_);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows_, own);
  int substeps = 1;  // 0: not finite
  if (own > 0 && system.model().states.empty()) {
    Eigen::MatrixXd slopes;
    if (!evaluate(system, theta, force, &slopes, start_substeps)) substeps = 0;
    rest = force;
    for (Eigen::Index k = 0; k < own; ++k) {
      const Eigen::Index i = linear[static_cast<std::size_t>(k)];
      columns.col(k) = slopes.col(i);
      rest -= theta[i] * slopes.col(i);
    }
  } else {  // values alone: slopes of many states would cost far more
    for (const auto i : linear) theta[i] = 0;
    if (first || shape.rest) substeps = evaluate(system, theta, rest);
    for (Eigen::Index k = 0; substeps > 0 && k < own; ++k) {
      const Eigen::Index i = linear[static_cast<std::size_t>(k)];
      theta[i] = 1;
      substeps = evaluate(system, theta, force);
      columns.col(k) = force - rest;
      theta[i] = 0;
    }
  }
  constexpr double rounding = 1e-9;
  if (first) shape.rest = own == 0 || rest.norm() > rounding * columns.norm();
  shape.substeps.push_back(substeps);
  if (substeps == 0) return {};
  Eigen::MatrixXd out(rows_, own + shape.rest);
  for (Eigen::Index k = 0; k < own; ++k) out.col(k) = weighted(columns.col(k));
  if (shape.rest) out.col(own) = weighted(rest);
  return out.allFinite() ? out : Eigen::MatrixXd();
}

/// Twice the newton, twice the force: true of every force whose parameters carry their units and that holds no F.
bool Proposer::scales_with_force(const Shape& shape, const std::vector<int>& powers) const {
  const auto& table = shape.system->model().parameters;
  Eigen::VectorXd theta = start_of(shape, shape.guesses.front()), once, twice;
  if (evaluate(*shape.system, theta, once) == 0) return false;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    if (table[i].fixed && powers[i] != 0) return false;
    theta[static_cast<Eigen::Index>(i)] *= std::pow(2.0, powers[i]);
  }
  return evaluate(*shape.system, theta, twice) > 0 && (twice - 2 * once).norm() < 1e-3 * once.norm();
}

void Proposer::run(Shape& shape) const {
  for (const auto& guess : shape.guesses) shape.columns.push_back(columns_at(shape, guess));
  if (!shape.rest) return;
  std::vector<int> powers;
  for (const auto& row : shape.system->model().parameters) powers.push_back(power_of_newton(row.unit));
  if (scales_with_force(shape, powers)) shape.force_powers = std::move(powers);
}

Proposer::Parent Proposer::parent(const Candidate& candidate, const Eigen::VectorXd& theta) const {
  Parent out;
  out.theta = out.start = theta;
  Eigen::VectorXd force;
  Eigen::MatrixXd slopes;
  const double runaway = measured_.isZero(0) ? INFINITY : 100 * measured_.norm();
  for (int substeps = start_substeps; substeps <= most_substeps_of_a_parent; substeps *= 2) {
    evaluate(*candidate.force_system, theta, force, &slopes, substeps);
    if (force.norm() < runaway) break;
  }
  const auto& table = candidate.system->model().parameters;
  out.jacobian.resize(rows_, theta.size());
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const auto& row = table[static_cast<std::size_t>(j)];
    if (row.fixed || !slopes.col(j).allFinite()) slopes.col(j).setZero();
    out.jacobian.col(j) = weighted(slopes.col(j));
  }
  out.table.assign(table.begin(), table.begin() + theta.size());
  out.open = weighted(measured_ - force);
  span(out);
  return out;
}

/// Basis, residual and cost of a parent's open force, and its theta where these are least.
void Proposer::span(Parent& parent) const {
  const Eigen::VectorXd norm = parent.jacobian.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  parent.basis.resize(rows_, 0);
  parent.back.resize(parent.theta.size(), 0);
  if (parent.jacobian.size() > 0 && !parent.jacobian.isZero(0)) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(parent.jacobian * norm.asDiagonal());
    qr.setThreshold(1e-9);
    parent.basis = qr.householderQ() * Eigen::MatrixXd::Identity(rows_, qr.rank());
    parent.back = norm.asDiagonal() * qr.solve(parent.basis);
  }
  const Eigen::VectorXd along = parent.basis.transpose() * parent.open;
  parent.residual = parent.open - parent.basis * along;
  parent.theta += parent.back * along;
  for (Eigen::Index j = 0; j < parent.theta.size(); ++j) {
    const Parameter& row = parent.table[static_cast<std::size_t>(j)];
    parent.theta[j] = std::clamp(parent.theta[j], row.min, row.max);
  }
  parent.cost = parent.residual.squaredNorm();
}

std::optional<Proposer::Parent> Proposer::held_at_bounds(const Parent& parent, const Eigen::VectorXd& values) const {
  Parent out = parent;
  out.theta = parent.start;
  bool any = false;
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    Parameter& row = out.table[static_cast<std::size_t>(j)];
    const double bound = std::clamp(values[j], row.min, row.max);
    if (row.min == row.max || bound == values[j] || out.jacobian.col(j).isZero(0)) continue;
    any = true;
    out.open -= out.jacobian.col(j) * (bound - out.theta[j]);
    out.theta[j] = row.min = row.max = bound;
    out.jacobian.col(j).setZero();
  }
  if (!any) return {};
  out.start = out.theta;
  span(out);
  return out;
}

Standing Proposer::score(const Shape& shape, const Parent& parent) const {
  Standing best;
  best.shape = &shape;
  best.cost = INFINITY;
  const auto linear = linear_ones(shape);
  const std::vector<Parameter> table = table_of_columns(shape);
  for (std::size_t g = 0; g < shape.columns.size(); ++g) {
    const Eigen::MatrixXd& full = shape.columns[g];
    if (full.rows() == 0) continue;
    const Eigen::MatrixXd columns = full - parent.basis * (parent.basis.transpose() * full);
    const Eigen::MatrixXd gram = columns.transpose() * columns;
    const Eigen::VectorXd right = columns.transpose() * parent.residual;
    const Eigen::VectorXd whole = full.colwise().squaredNorm();
    for (Eigen::Index k = 0; k < full.cols(); ++k) best.shown = best.shown || is_own(gram(k, k), whole[k]);
    const Eigen::VectorXd step =
        bounded_step(of_own_columns(gram, whole), right, Eigen::VectorXd::Zero(right.size()), table);
    const double cost = parent.cost - 2 * right.dot(step) + step.dot(gram * step);
    if (!(cost < best.cost)) continue;
    best.cost = cost;
    best.own = scaled_start(shape, g, linear, step);
    best.substeps = shape.substeps[g];
    const Eigen::VectorXd force = parent.basis.transpose() * (full * step);
    best.parent = parent.theta - parent.back * force;
  }
  if (best.parent.size() == 0) return best;
  const std::optional<Parent> held = held_at_bounds(parent, best.parent);
  return held ? score(shape, *held) : best;
}

namespace {

/// The columns of a shape at one of its guesses, and where they stand among those of all.
struct Block {
  Eigen::Index shape, first;
  const Eigen::MatrixXd& columns;
};

}  // namespace

Eigen::MatrixXd Proposer::pair_costs(const std::vector<const Shape*>& shapes, const Parent& parent) const {
  std::vector<Block> blocks;
  std::vector<std::vector<Parameter>> tables;
  Eigen::Index width = 0;
  for (const Shape* shape : shapes) {
    for (const Eigen::MatrixXd& full : shape->columns) {
      if (full.rows() == 0) continue;
      blocks.push_back({static_cast<Eigen::Index>(tables.size()), width, full});
      width += full.cols();
    }
    tables.push_back(table_of_columns(*shape));
  }
  Eigen::MatrixXd columns(parent.residual.size(), width);
  Eigen::VectorXd whole(width);  // squares of the columns before the parent's are projected out
  for (const auto& [shape, first, full] : blocks) {
    whole.segment(first, full.cols()) = full.colwise().squaredNorm();
    columns.middleCols(first, full.cols()) = full - parent.basis * (parent.basis.transpose() * full);
  }
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  const Eigen::VectorXd right = columns.transpose() * parent.residual;
  const auto count = static_cast<Eigen::Index>(shapes.size());
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(count, count, INFINITY);
  const auto hear = [&](std::initializer_list<Block> heard) {
    std::vector<Eigen::Index> at;
    std::vector<Parameter> table;
    for (const auto& [shape, first, full] : heard) {
      for (Eigen::Index j = 0; j < full.cols(); ++j) at.push_back(first + j);
      const auto& own = tables[static_cast<std::size_t>(shape)];
      table.insert(table.end(), own.begin(), own.end());
    }
    const Eigen::MatrixXd own = gram(at, at);
    const Eigen::VectorXd on = right(at);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(on.size());
    const Eigen::VectorXd step = bounded_step(of_own_columns(own, whole(at)), on, none, table);
    const double cost = parent.cost - 2 * on.dot(step) + step.dot(own * step);
    const Eigen::Index a = heard.begin()->shape, b = std::prev(heard.end())->shape;
    if (cost < costs(a, b)) costs(a, b) = costs(b, a) = cost;
  };
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    hear({blocks[i]});
    for (std::size_t j = 0; j < i; ++j)
      if (blocks[i].shape != blocks[j].shape) hear({blocks[i], blocks[j]});
  }
  return costs;
}

void Proposer::refine(Standing& standing, const Parent& parent, int iterations) const {
  standing.refined = true;
  const System& system = *standing.shape->system;
  const auto& table = system.model().parameters;
  Eigen::VectorXd values;
  standing.substeps = std::max(1, evaluate(system, standing.own, values));
  const int substeps = std::max(start_substeps, standing.substeps);
  const auto own = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return x - parent.basis * (parent.basis.transpose() * x);
  };
  struct State {
    Eigen::VectorXd theta, force, error;
    Eigen::MatrixXd slopes;
    double cost = INFINITY;
  } now;
  const auto reach = [&](const Eigen::VectorXd& theta, State& state) {
    Eigen::VectorXd force;
    Eigen::MatrixXd slopes;
    if (!evaluate(system, theta, force, &slopes, substeps)) return false;
    state.theta = theta;
    state.force = weighted(force);
    state.error = parent.residual - own(state.force);
    state.slopes.resize(rows_, slopes.cols());
    for (Eigen::Index j = 0; j < slopes.cols(); ++j) state.slopes.col(j) = own(weighted(slopes.col(j)));
    state.cost = state.error.squaredNorm();
    return std::isfinite(state.cost);
  };
  if (!reach(standing.own, now)) return;
  double lambda = 1e-3;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::MatrixXd a = now.slopes.transpose() * now.slopes;
    a.diagonal() *= 1 + lambda;
    const Eigen::VectorXd step = bounded_step(a, now.slopes.transpose() * now.error, now.theta, table);
    State next;
    if (step.allFinite() && reach(now.theta + step, next) && next.cost < now.cost) {
      const double drop = 1 - next.cost / now.cost;
      now = std::move(next);
      lambda *= 0.1;
      if (drop < 1e-3) break;
    } else {
      lambda = 10 * lambda + 1e-2;
    }
  }
  standing.cost = now.cost;
  standing.own = now.theta;
  standing.parent = parent.theta - parent.back * (parent.basis.transpose() * now.force);
  const std::optional<Parent> held = held_at_bounds(parent, standing.parent);
  if (!held) return;
  Standing within = score(*standing.shape, *held);
  if (!std::isfinite(within.cost)) return;
  refine(within, *held, iterations);
  standing = std::move(within);
}

}  // namespace lunid
