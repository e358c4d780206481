#include "discover/candidate.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "discover/sensor.hpp"
#include "expr/joined.hpp"
#include "simulate/measures.hpp"

namespace lunid {

namespace {

/// A record whose forces are what acts: so much later.
Record delayed(Record record, const std::vector<std::string>& forces, double delay) {
  for (const std::string& name : forces) {
    const Excitation force(record.start(), record.dt(), record[name], Interpolation::cubic);
    Channel channel = record.channel(name);
    channel.values.resize(record.rows());
    for (Eigen::Index i = 0; i < record.rows(); ++i) channel.values[i] = force.also_before(record.time(i) - delay);
    record = record.with(std::move(channel));
  }
  return record;
}

/// The forces that act on the motion: those that a record shows, as late as the candidate says.
Eigen::VectorXd late_forces(const Candidate& candidate, std::span<const double> theta, const Record& record) {
  const double delay = candidate.system->delay(theta);
  const Model& model = candidate.system->model();
  return acting_forces(model, delay > 0 ? delayed(record, model.inputs(), delay) : record);
}

/// Regression of the smoothed force on the linear parameters, the others held; bounds kept by holding what violates
/// them. Returns the squared misfit; infinite where the force is not finite.
double regress_force(const Study& study, const Candidate& candidate, Eigen::VectorXd& theta) {
  const System& system = *candidate.force_system;
  const auto& table = system.model().parameters;
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (candidate.linear[i] && !table[i].fixed) free.push_back(static_cast<Eigen::Index>(i));
  const auto p = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(p);
  double squares = 0;
  for (const auto& data : study.force) {
    Eigen::MatrixXd jacobian;
    const std::span<const double> values = view(theta);
    const Eigen::VectorXd model = imposed_force(system, values, data.record, &jacobian, start_substeps);
    if (!model.allFinite() || !jacobian.allFinite()) return INFINITY;
    Eigen::MatrixXd columns(model.size(), p);
    for (Eigen::Index j = 0; j < p; ++j) columns.col(j) = jacobian.col(free[static_cast<std::size_t>(j)]);
    Eigen::VectorXd error = late_forces(candidate, values, data.record) - model;
    for (Eigen::Index i = 0; i < error.size(); ++i)
      if (!data.use[static_cast<std::size_t>(i % data.record.rows())]) {
        error[i] = 0;
        columns.row(i).setZero();
      }
    a.noalias() += columns.transpose() * columns;
    b.noalias() += columns.transpose() * error;
    squares += error.squaredNorm();
  }
  Eigen::VectorXd scale = a.diagonal().cwiseSqrt();
  for (auto& s : scale) s = s > 0 ? 1 / s : 0;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * a * scale.asDiagonal();
  std::vector<std::uint8_t> held(static_cast<std::size_t>(p), 0);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(p);
  for (int pass = 0; pass <= p; ++pass) {
    // Held parameters move to their bound; the rest is solved again.
    std::vector<Eigen::Index> open;
    for (Eigen::Index j = 0; j < p; ++j)
      if (!held[static_cast<std::size_t>(j)]) open.push_back(j);
    if (open.empty()) break;
    Eigen::MatrixXd part(open.size(), open.size());
    Eigen::VectorXd right(open.size());
    const Eigen::VectorXd rest = b - a * step;
    for (std::size_t i = 0; i < open.size(); ++i) {
      right[static_cast<Eigen::Index>(i)] = scale[open[i]] * (rest[open[i]]);
      for (std::size_t j = 0; j < open.size(); ++j)
        part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = scaled(open[i], open[j]);
    }
    const Eigen::VectorXd solved = part.completeOrthogonalDecomposition().solve(right);
    for (std::size_t i = 0; i < open.size(); ++i)
      step[open[i]] += scale[open[i]] * solved[static_cast<Eigen::Index>(i)];
    bool again = false;
    for (const auto j : open) {
      const auto& row = table[static_cast<std::size_t>(free[static_cast<std::size_t>(j)])];
      const double value = theta[free[static_cast<std::size_t>(j)]] + step[j];
      const double bounded = std::clamp(value, row.min, row.max);
      if (bounded != value) {
        step[j] = bounded - theta[free[static_cast<std::size_t>(j)]];
        held[static_cast<std::size_t>(j)] = 1;
        again = true;
      }
    }
    if (!again) break;
  }
  for (Eigen::Index j = 0; j < p; ++j) theta[free[static_cast<std::size_t>(j)]] += step[j];
  return squares - 2 * b.dot(step) + step.dot(a * step);
}

/// Values for parameters without a first guess in a nonlinear place: a scan over magnitudes, the others solved for.
std::vector<Eigen::VectorXd> scan_unknown(const Candidate& candidate, const Eigen::VectorXd& theta) {
  std::vector<Eigen::VectorXd> out{theta};
  const auto& table = candidate.system->model().parameters;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (std::isfinite(theta[static_cast<Eigen::Index>(i)])) continue;
    std::vector<double> values{1.0};
    if (!candidate.linear[i]) {
      values = magnitudes(table[i]);
      if (values.empty()) values.push_back(std::isfinite(table[i].min) ? table[i].min : table[i].max);
    }
    std::vector<Eigen::VectorXd> next;
    for (const auto& base : out)
      for (const double v : values) {
        next.push_back(base);
        next.back()[static_cast<Eigen::Index>(i)] = std::clamp(v, table[i].min, table[i].max);
      }
    out = std::move(next);
    if (out.size() > 2000) break;
  }
  for (auto& t : out)
    for (Eigen::Index i = 0; i < t.size(); ++i)
      if (!std::isfinite(t[i])) t[i] = 1;
  return out;
}

/// It holds a number of an entry too: what bounds it by itself says nothing of the two.
void release(Model& model, const std::string& twin) {
  const auto at = std::ranges::find(model.parameters, twin, &Parameter::name);
  if (at == model.parameters.end()) return;
  at->min = -INFINITY;
  at->max = INFINITY;
}

/// The baseline with the chosen effects added.
Model extend(const Study& study, const Model& baseline, const Choices& choices,
             std::vector<std::pair<std::size_t, std::pair<double, double>>>& shown) {
  Model model = baseline;
  for (const auto& c : choices) {
    const Ranges ranges = c.effect->range ? ranges_of(c, scales(study, 0, c.effect->place)) : Ranges{};
    for (const Parameter& p : limited(c.parameters(), ranges)) {
      if (const auto limits = ranges.find(p.name); limits != ranges.end())
        shown.push_back({model.parameters.size(), limits->second});
      model.parameters.push_back(p);
    }
    for (const Twin& twin : c.effect->twins) release(model, twin.baseline);
    add_variant(model, *c.effect, c.variant);
  }
  return complete(std::move(model));
}

Tape margins_of(const Choices& choices, const Model& model) {
  std::vector<Expr> margins, parameters;
  for (const auto& c : choices)
    for (const Expr margin : c.effect->margins)
      if (std::ranges::all_of(symbols(margin, SymbolKind::parameter),
                              [&](Expr symbol) { return model.find(symbol.name()); }))
        margins.push_back(margin);
  for (const auto& p : model.parameters) parameters.push_back(model.pool->parameter(p.name));
  return Tape(margins, parameters);
}

}  // namespace

int free_parameters(std::span<const Parameter> table) {
  return static_cast<int>(std::ranges::count(table, false, &Parameter::fixed));
}

std::size_t Candidate::added() const {
  const std::span<const Parameter> table = system->model().parameters;
  return static_cast<std::size_t>(lunid::free_parameters(table.subspan(first_added())));
}

std::size_t Candidate::first_added() const {
  std::size_t own = 0;
  for (const auto& c : choices) own += c.parameters().size();
  return system->model().parameters.size() - own;
}

std::vector<double> magnitudes(const Parameter& parameter) {
  std::vector<double> out;
  for (int decade = -6; decade <= 6; ++decade)
    for (const double value : {std::pow(10.0, decade), -std::pow(10.0, decade)})
      if (value >= parameter.min && value <= parameter.max) out.push_back(value);
  return out;
}

std::vector<std::uint8_t> linear_parameters(const Model& model) {
  std::vector<Expr> forces;
  for (int i = 0; i < model.degrees(); ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    forces.push_back(mass * model.pool->channel(model.channel('a', i)) + restoring);
  }
  std::vector<std::uint8_t> linear(model.parameters.size(), 0);
  std::vector<Expr> kept;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const Expr p = model.pool->parameter(model.parameters[i].name);
    bool is_linear = true;
    for (const Expr force : forces) {
      const Expr slope = derivative(force, p);
      is_linear = is_linear && !depends_on(slope, p);
      for (const Expr other : kept) is_linear = is_linear && !depends_on(slope, other);
    }
    for (const auto& state : model.states)
      for (const Expr part : {state.rate, state.min, state.max})
        is_linear = is_linear && !(part.valid() && depends_on(part, p));
    for (const auto* maps : {&model.measures, &model.acts})
      for (const auto& [channel, map] : *maps) is_linear = is_linear && !depends_on(map, p);
    if (model.delay.valid()) is_linear = is_linear && !depends_on(model.delay, p);
    linear[i] = is_linear;
    if (is_linear) kept.push_back(p);
  }
  return linear;
}

double priced(const Candidate& c) {
  const auto n = static_cast<double>(c.fit.rows);
  return n * std::log(c.fit.cost) + c.parameters() * std::log(n);
}

SimulateOptions steps_of(const Study& study, const FitResult& fit) {
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = std::max(1, fit.substeps);
  options.cancelled = study.options->cancelled;
  return options;
}

bool Candidate::degenerate() const {
  const auto& table = system->model().parameters;
  const std::size_t own = first_added();
  for (std::size_t i = own; i < table.size(); ++i)
    if (linear[i] && i < fit.at_bound.size() && fit.at_bound[i] && fit.theta[static_cast<Eigen::Index>(i)] == 0)
      return true;
  for (const auto& [i, limits] : shown) {
    double value = fit.theta[static_cast<Eigen::Index>(i)], least = limits.first, most = limits.second;
    if (least > 0 && most > 2e3 * least) {  // over so many decades a limit is near by its logarithm
      value = std::log(value);
      least = std::log(least);
      most = std::log(most);
    }
    const double margin = 1e-3 * (most - least);
    if (value < least + margin || value > most - margin) return true;
  }
  std::vector<double> margin(static_cast<std::size_t>(margins.outputs()));
  std::vector<double> scratch(static_cast<std::size_t>(margins.registers()));
  margins.run_point(fit.theta.data(), margin.data(), scratch.data());
  return std::any_of(margin.begin(), margin.end(), [](double m) { return m < 0; });
}

Ranges ranges_of(const Choice& choice, const RecordScales& scales) {
  return choice.effect->range ? choice.effect->range(scales, choice.variant) : Ranges{};
}

std::vector<Parameter> limited(std::vector<Parameter> parameters, const Ranges& ranges) {
  for (Parameter& p : parameters)
    if (const auto limits = ranges.find(p.name); limits != ranges.end()) {
      p.min = std::max(p.min, limits->second.first);
      p.max = std::min(p.max, limits->second.second);
    }
  return parameters;
}

Candidate compile(const Study& study, const Model& baseline, const Choices& choices) {
  Candidate candidate;
  candidate.choices = choices;
  Model model = extend(study, baseline, choices, candidate.shown);
  const Units units = study.units();
  for (std::size_t i = baseline.parameters.size(); i < model.parameters.size(); ++i)
    model.parameters[i].unit = in_units(units, model.parameters[i].unit);
  candidate.linear = linear_parameters(model);
  candidate.margins = margins_of(choices, model);
  candidate.seen_by_force = can_be_undone(model) && !model.delay.valid();
  candidate.system = std::make_shared<const System>(model);
  if (model.imposed_motion) {
    candidate.force_system = candidate.system;
  } else {
    model.imposed_motion = true;
    if (model.delay.valid())  // not felt along the motion; a parameter has to stand in some expression
      model.restoring = model.restoring + model.pool->constant(0) * std::exchange(model.delay, {});
    candidate.force_system = std::make_shared<const System>(model);
  }
  return candidate;
}

double guessed(const Parameter& parameter, const Guess& guess) {
  const auto found = guess.find(parameter.name);
  const double value = found != guess.end() ? found->second : std::isfinite(parameter.value) ? parameter.value : 1;
  return std::clamp(value, parameter.min, parameter.max);
}

void find_starts(const Study& study, Candidate& candidate, const Eigen::VectorXd& theta,
                 const std::vector<std::vector<Guess>>& guesses) {
  const auto& table = candidate.system->model().parameters;
  Eigen::VectorXd base(static_cast<Eigen::Index>(table.size()));
  for (std::size_t i = 0; i < table.size(); ++i) base[static_cast<Eigen::Index>(i)] = table[i].value;
  base.head(theta.size()) = theta;
  // One set of guesses per chosen effect; all combinations.
  std::vector<Eigen::VectorXd> shapes{base};
  for (const auto& options : guesses) {
    if (options.empty()) continue;
    std::vector<Eigen::VectorXd> next;
    for (const auto& shape : shapes)
      for (const auto& guess : options) {
        next.push_back(shape);
        for (const auto& [name, value] : guess)
          for (std::size_t i = 0; i < table.size(); ++i)
            if (table[i].name == name)
              next.back()[static_cast<Eigen::Index>(i)] = std::clamp(value, table[i].min, table[i].max);
      }
    shapes = std::move(next);
  }
  struct Start {
    double cost;
    Eigen::VectorXd theta;
  };
  std::vector<Start> starts;
  for (const auto& shape : shapes)
    for (auto start : scan_unknown(candidate, shape)) {
      const double cost = regress_force(study, candidate, start);
      if (std::isfinite(cost) && start.allFinite()) starts.push_back({cost, std::move(start)});
    }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  if (starts.size() > 3) starts.resize(3);
  const bool shaped = std::count(candidate.linear.begin(), candidate.linear.end(), 0) > 0;
  if (shaped) {
    FitOptions options;
    options.max_iterations = 8;
    options.tolerance = 1e-3;
    options.substeps = start_substeps;
    options.cancelled = study.options->cancelled;
    for (auto& s : starts) {
      const FitResult refined = fit_trajectory(*candidate.force_system, s.theta, study.force, options);
      if (refined.cost < s.cost) s = {refined.cost, refined.theta};
    }
    std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  }
  candidate.starts.clear();
  for (auto& s : starts) candidate.starts.push_back(std::move(s.theta));
  candidate.force_cost = starts.empty() ? INFINITY : starts.front().cost;
  if (!candidate.seen_by_force) order_by_motion(study, candidate, theta);
}

std::string unidentifiable(const Candidate& candidate) {
  const auto& table = candidate.system->model().parameters;
  std::string names;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (!candidate.fit.identifiable(static_cast<Eigen::Index>(i))) append_item(names, table[i].name);
  return names;
}

Eigen::VectorXd open_force(const Candidate& candidate, const Eigen::VectorXd& theta, const Record& record) {
  const std::span<const double> values = view(theta);
  return late_forces(candidate, values, record) - imposed_force(*candidate.force_system, values, record);
}

Eigen::MatrixXd gram_of_force(const Study& study, const Candidate& candidate, const Eigen::VectorXd& theta,
                              int substeps) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(theta.size(), theta.size());
  for (const auto& data : study.force) {
    Eigen::MatrixXd jacobian;
    imposed_force(*candidate.force_system, view(theta), data.record, &jacobian, substeps);
    gram += jacobian.transpose() * jacobian;
  }
  return gram;
}

Eigen::VectorXd without_signs(const System& system, Eigen::VectorXd theta) {
  for (Eigen::Index i = 0; i < theta.size(); ++i)
    if (const Parameter& p = system.model().parameters[static_cast<std::size_t>(i)]; !p.fixed)
      theta[i] = std::clamp(std::abs(theta[i]), p.min, p.max);
  return theta;
}

std::vector<double> inertias(const Model& model, const Eigen::VectorXd& theta) {
  std::vector<std::pair<Expr, Expr>> values;
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    values.emplace_back(model.pool->parameter(model.parameters[i].name),
                        model.pool->constant(theta[static_cast<Eigen::Index>(i)]));
  std::vector<double> out;
  for (int i = 0; i < model.degrees(); ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    const Expr slope = derivative(restoring, model.pool->channel(model.channel('a', i)));
    const Expr total = substitute(mass + slope, values);
    out.push_back(total.is_constant() ? total.value() : NAN);
  }
  return out;
}

bool takes_the_mass(const std::vector<double>& before, const std::vector<double>& after) {
  constexpr double least = 0.1;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (after[i] < least * before[i]) return true;
  return false;
}

bool takes_the_mass(const Candidate& before, const Candidate& after) {
  return before.ran() && after.ran() &&
         takes_the_mass(inertias(before.system->model(), before.fit.theta),
                        inertias(after.system->model(), after.fit.theta));
}

bool in_a_mass(const Model& model, Expr symbol) {
  for (int i = 0; i < model.degrees(); ++i)
    if (depends_on(model.coordinate(i).mass, symbol)) return true;
  return false;
}

Eigen::VectorXd values_of(const Candidate& c, std::initializer_list<const Candidate*> fits) {
  const auto& table = c.system->model().parameters;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(c.parameters());
  for (const Candidate* known : fits) {
    const auto& rows = known->system->model().parameters;
    for (std::size_t i = 0; i < table.size(); ++i)
      for (std::size_t j = 0; j < rows.size(); ++j)
        if (rows[j].name == table[i].name)
          out[static_cast<Eigen::Index>(i)] = known->fit.theta[static_cast<Eigen::Index>(j)];
  }
  return out;
}

Model fitted(const Candidate& c) {
  Model model = c.system->model();
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    model.parameters[i].value = c.fit.theta[k];
    model.parameters[i].std = c.fit.deviation(k);
  }
  return model;
}

Model fitted(const Study& study, const Candidate& candidate) {
  Model out = fitted(candidate);
  if (!study.imposed) out.interpolation = study.between.kind;
  return out;
}

void fit(const Study& study, Candidate& candidate, const FitOptions& options) {
  candidate.fit = fit_progressively(*candidate.system, candidate.starts.front(), study.train, options);
}

}  // namespace lunid
