#include "discover/sensor.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "discover/accept.hpp"
#include "discover/judge.hpp"
#include "discover/places.hpp"
#include "discover/twins.hpp"
#include "record/spectra.hpp"
#include "simulate/measures.hpp"

namespace lunid {

namespace {

/// The map of a channel in a list, which gets the channel itself where it is not there yet.
Expr& map_of(std::vector<ChannelMap>& maps, const std::string& channel, Pool& pool) {
  for (auto& [name, map] : maps)
    if (name == channel) return map;
  maps.push_back({channel, pool.channel(channel)});
  return maps.back().map;
}

bool all_hold(const std::vector<Record>& records, const std::string& channel) {
  return std::all_of(records.begin(), records.end(), [&](const Record& r) { return r.has(channel); });
}

/// With imposed motion y and v come from the record: what cannot be undone there cannot be looked at.
bool shows_in_force(const Effect& effect) {
  return std::any_of(effect.variants.begin(), effect.variants.end(), [](const EffectVariant& v) {
    if (v.delay.valid()) return false;
    if (v.measures.empty() && v.acts.empty()) return true;
    Model maps;
    maps.measures = v.measures;
    maps.acts = v.acts;
    maps.pool = {std::shared_ptr<void>(), &(v.measures.empty() ? v.acts : v.measures).front().map.pool()};
    return can_be_undone(maps);
  });
}

/// A fault of a channel that the records do not hold as they were measured cannot be seen.
bool changes_unmeasured(const Study& study, const Effect& effect) {
  return std::all_of(effect.variants.begin(), effect.variants.end(), [&](const EffectVariant& v) {
    return std::any_of(v.measures.begin(), v.measures.end(),
                       [&](const ChannelMap& map) { return map.channel != study.measured; });
  });
}

/// A constant mass, which only a known force shows: in a free decay it scales all other forces alike.
bool is_a_mass(const Effect& effect) {
  return std::all_of(effect.variants.begin(), effect.variants.end(), [](const EffectVariant& v) {
    if (!v.force.valid()) return false;
    Pool& pool = v.force.pool();
    const Expr slope = derivative(v.force, pool.channel("a"));
    return !slope.is_constant(0) && symbols(slope).size() == symbols(slope, SymbolKind::parameter).size();
  });
}

}  // namespace

bool is_physics(const Effect& effect) { return effect.family != "sensor" && effect.family != "input"; }

int physics_in(const Choices& choices) {
  return static_cast<int>(
      std::count_if(choices.begin(), choices.end(), [](const Choice& c) { return is_physics(*c.effect); }));
}

std::vector<Effect> testable(const Study& study, const Candidate& baseline, const std::vector<Effect>& catalogue,
                             std::vector<std::string>& left) {
  std::vector<Effect> out;
  const bool driven = study.imposed || !are_free(study, study.full);
  for (const Effect& given : catalogue) {
    const bool other_channel = given.any_motion && !study.imposed && study.measured != "y";
    const Effect effect = other_channel ? of_channel(study.model, given, study.measured[0]) : given;
    if (study.degrees() > 1 && effect.family == "input" && follows_base(effect)) {
      left.push_back(effect.name + " (with one coordinate alone: a base moves all)");
      continue;
    }
    const auto lacks = std::find_if(effect.channels.begin(), effect.channels.end(), [&](const std::string& channel) {
      return !all_hold(study.full, channel) || !all_hold(study.test, channel);
    });
    if (lacks != effect.channels.end())
      left.push_back(effect.name + " (no channel " + *lacks + ")");
    else if (!study.imposed && changes_unmeasured(study, effect))
      left.push_back(effect.name + " (of y, where " + study.measured + " was measured)");
    else if (study.imposed && !shows_in_force(effect))
      left.push_back(effect.name + " (shows in free motion alone)");
    else if (!driven && is_a_mass(effect))
      left.push_back(effect.name + " (no force to measure a mass by)");
    else
      out.push_back(effect);
  }
  std::vector<Effect> placed = at_places(study.model, out);
  const Model known = baseline.ran() ? fitted(baseline) : study.model;
  for (Effect& effect : placed) effect = without_twins(known, effect);
  return with_repetitions(known, placed);
}

void add_variant(Model& model, const Effect& effect, int variant) {
  const EffectVariant& form = effect.variants[static_cast<std::size_t>(variant)];
  Pool& pool = *model.pool;
  if (form.force.valid()) add_force(model, effect.place, form.force);
  std::vector<std::pair<Expr, Expr>> shown;  // a channel by what the model shows of it already
  for (const auto& [channel, map] : form.measures) {
    Expr& known = map_of(model.measures, channel, pool);
    shown.emplace_back(pool.channel(channel), known);
    known = substitute(map, shown);
  }
  for (const auto& [channel, map] : form.acts) {
    Expr& known = map_of(model.acts, channel, pool);
    const std::pair<Expr, Expr> acting[] = {{pool.channel(channel), known}};
    known = substitute(map, acting);
  }
  if (form.delay.valid()) model.delay = model.delay.valid() ? model.delay + form.delay : form.delay;
  for (InternalState state : states_of(effect, variant)) {
    for (Expr* part : {&state.rate, &state.min, &state.max})
      if (part->valid() && !shown.empty()) *part = substitute(*part, shown);
    model.states.push_back(state);
  }
}

bool goes_with(const Choices& set, const Choice& more) {
  const auto delays = [](const Choice& c) { return c.form().delay.valid(); };
  const auto holds_rate = [](const Choice& c) {
    return std::ranges::any_of(c.form().acts, [](const ChannelMap& acting) {
      return depends_on(acting.map, acting.map.pool().channel("force_rate"));
    });
  };
  return std::ranges::none_of(set, [&](const Choice& c) {
    return (delays(c) && (delays(more) || holds_rate(more))) || (holds_rate(c) && delays(more));
  });
}

void order_by_motion(const Study& study, Candidate& candidate, const Eigen::VectorXd& theta) {
  FitOptions options;
  options.max_iterations = 4;
  options.tolerance = 1e-3;
  options.cancelled = study.options->cancelled;
  std::vector<std::pair<double, Eigen::VectorXd>> starts;
  const auto try_from = [&](const Eigen::VectorXd& start) {
    FitResult fit = fit_trajectory(*candidate.system, start, study.train, options);
    const bool ran = std::isfinite(fit.cost);
    if (ran) starts.emplace_back(fit.cost, std::move(fit.theta));
    return ran;
  };
  const bool delays = candidate.system->model().delay.valid();
  for (Eigen::VectorXd start : candidate.starts) {
    if (delays) try_from(start);  // the regression was that of the delayed force
    start.head(theta.size()) = theta;
    if (try_from(start)) continue;
    // What comes late is negative damping on the force along the motion, and a run with that grows without bound.
    start.head(theta.size()) = without_signs(*candidate.system, theta);
    try_from(start);
  }
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  candidate.starts.clear();
  for (auto& [cost, start] : starts) candidate.starts.push_back(std::move(start));
}

namespace {

/// Squared error of free runs from the first states of another fit; states that it lacks start where they begin.
double squares_of_runs(const Study& study, const Candidate& candidate, const Eigen::VectorXd& theta,
                       const FitResult& states) {
  const System& system = *candidate.system;
  const std::span<const double> values = view(theta);
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = states.substeps;
  options.cancelled = study.options->cancelled;
  double squares = 0;
  for (std::size_t r = 0; r < study.train.size(); ++r) {
    const FitData& data = study.train[r];
    if (study.imposed) {
      squares += (as_vector(data.record[study.output()]) - imposed_force(system, values, data.record)).squaredNorm();
      continue;
    }
    Eigen::VectorXd x0 = measured_state(system, values, data.record, 0);
    const Eigen::VectorXd& known = states.segments[r].x0;
    x0.head(std::min(known.size(), x0.size())) = known.head(std::min(known.size(), x0.size()));
    const Run run = simulate(system, values, data.excitation, x0, options);
    if (!run.summary.completed) return INFINITY;
    const std::vector<std::string> outputs = study.outputs();
    const std::vector<double> weights = study.weights(data.record);
    for (std::size_t i = 0; i < outputs.size(); ++i)
      squares +=
          (weights[i] * (as_vector(data.record[outputs[i]]) - shown(system, values, run, outputs[i]))).squaredNorm();
  }
  return std::isfinite(squares) ? squares : INFINITY;
}

}  // namespace

void start_beside(const Study& study, Candidate& candidate, const Candidate& parent,
                  const std::vector<Guess>& guesses) {
  const auto& table = candidate.system->model().parameters;
  const Eigen::VectorXd& known = parent.fit.theta;
  std::vector<std::pair<double, Eigen::VectorXd>> starts;
  const auto hear = [&](Eigen::VectorXd theta) {
    const double squares = squares_of_runs(study, candidate, theta, parent.fit);
    if (std::isfinite(squares)) starts.emplace_back(squares, std::move(theta));
  };
  for (const Guess& guess : guesses.empty() ? std::vector<Guess>{{}} : guesses) {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(table.size()));
    theta.head(known.size()) = known;
    for (Eigen::Index i = known.size(); i < theta.size(); ++i)
      theta[i] = guessed(table[static_cast<std::size_t>(i)], guess);
    hear(std::move(theta));
  }
  if (candidate.seen_by_force && rms_error(parent.fit) > 1.05 * study.sensor_noise()) {
    // What the parent makes of its parameters without the fault may be far from what they are beside it.
    Candidate by_force = candidate;
    find_starts(study, by_force, known, {guesses});
    for (Eigen::VectorXd& start : by_force.starts) hear(std::move(start));
  }
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  candidate.starts.clear();
  for (auto& [squares, start] : starts) candidate.starts.push_back(std::move(start));
}

bool shows_beside(const Study& study, const Candidate& candidate, const Candidate& parent) {
  if (!candidate.seen_by_force) return true;
  constexpr double least = 1e-6;  // of a column's square: rounding of what the parent holds already
  const Eigen::Index before = parent.parameters(), p = candidate.parameters();
  const Eigen::MatrixXd gram = gram_of_force(study, candidate, candidate.starts.front(), start_substeps);
  if (!gram.allFinite()) return true;  // the trajectory will tell
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  const Eigen::MatrixXd own = scaled.topLeftCorner(before, before);
  for (Eigen::Index j = before; j < p; ++j) {
    if (!(gram(j, j) > 0)) continue;
    const Eigen::VectorXd with = scaled.col(j).head(before);
    if (before == 0 || 1 - with.dot(own.completeOrthogonalDecomposition().solve(with)) > least) return true;
  }
  return false;
}

Record with_shaft(const Record& record) {
  const auto has = [&](const char* name) { return record.has(name); };
  constexpr std::array derived{"shaft_angle", "shaft_speed", "shaft_rate"};
  constexpr std::array speeds{"speed", "shaft_speed"};
  const bool angle = std::ranges::any_of(shaft_angles, has);
  const auto& sources = angle ? shaft_angles : speeds;
  const auto at = std::ranges::find_if(sources, has);
  if (at == sources.end() || std::ranges::all_of(derived, has)) return record;
  const char* source = *at;
  Eigen::VectorXd x = as_vector(record[source]);
  if (record.channel(source).unit == "Hz") x *= 2 * M_PI;
  if (angle) unwrap(x);
  const std::span<const double> values = view(x);
  const double noise = noise_level(values);
  const auto derivative = [&](int order) {
    return savitzky_golay(values, record.dt(), order, choose_savitzky_golay(values, noise, order));
  };
  Eigen::VectorXd turned = x;
  if (!angle) {
    turned[0] = 0;
    for (Eigen::Index i = 1; i < x.size(); ++i) turned[i] = turned[i - 1] + 0.5 * record.dt() * (x[i - 1] + x[i]);
  }
  Record out = record;
  const auto add = [&](const char* name, const char* unit, Eigen::VectorXd column) {
    Channel channel;
    channel.name = name;
    channel.source = source;
    channel.unit = unit;
    channel.values = std::move(column);
    channel.derived = true;
    out = out.with(std::move(channel));
  };
  add("shaft_angle", "rad", angle ? derivative(0) : turned);
  add("shaft_speed", "rad/s", derivative(angle ? 1 : 0));
  add("shaft_rate", "rad/s^2", derivative(angle ? 2 : 1));
  return out;
}

// ---- hints ----

namespace {

/// A row belongs to a flat top when it and its neighbour have exactly the extreme value.
double flat_share(const Eigen::VectorXd& y) {
  const double high = y.maxCoeff(), low = y.minCoeff();
  double flat = 0;
  for (Eigen::Index i = 1; i < y.size(); ++i) flat += y[i] == y[i - 1] && (y[i] == high || y[i] == low);
  return flat / static_cast<double>(y.size());
}

/// The part of a residual's sum of squares that `wanted` explains beyond `known` (columns).
double partial_share(const Eigen::MatrixXd& known, const Eigen::MatrixXd& wanted, const Eigen::VectorXd& residual) {
  Eigen::MatrixXd all(known.rows(), known.cols() + wanted.cols());
  all << known, wanted;
  const auto left = [&](const Eigen::MatrixXd& a) {
    return (residual - a * a.colPivHouseholderQr().solve(residual)).squaredNorm();
  };
  const double before = left(known);
  return before > 0 ? 1 - left(all) / before : 0;
}

/// Normalised columns, so that units do not matter.
Eigen::MatrixXd columns_of(std::vector<Eigen::VectorXd> list) {
  Eigen::MatrixXd out(list.front().size(), static_cast<Eigen::Index>(list.size()));
  for (std::size_t j = 0; j < list.size(); ++j)
    out.col(static_cast<Eigen::Index>(j)) = list[j] / std::max(list[j].norm(), 1e-300);
  return out;
}

/// How much of the displacement that the model leaves open is a slow trend.
double trend_share(const Eigen::VectorXd& residual) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(residual.size(), -1, 1);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(residual.size());
  return partial_share(columns_of({one}), columns_of({t, t.cwiseAbs2()}), residual);
}

/// How much of the force that is left open follows the rate of the acceleration, which a lag tau leaves as m*tau*da/dt.
double lag_share(const Study& study, const Candidate& baseline, std::size_t index) {
  const Record& smooth = study.smooth[index];
  const Eigen::VectorXd force =
      as_vector(smooth["F"]) - imposed_force(*baseline.force_system, view(baseline.fit.theta), smooth);
  const Eigen::VectorXd jerk =
      savitzky_golay(smooth["a"], smooth.dt(), 1, smoothing_kernel(study, study.train[index].record));
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < force.size(); ++i)
    if (study.force[index].use[static_cast<std::size_t>(i)] && std::isfinite(force[i])) rows.push_back(i);
  if (rows.size() < 30) return 0;
  std::vector<Eigen::VectorXd> known{Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rows.size()))};
  for (const char* name : {"y", "v", "a"}) known.push_back(as_vector(smooth[name])(rows));
  return partial_share(columns_of(known), columns_of({jerk(rows)}), force(rows));
}

}  // namespace

std::string sensor_hint(const Study& study, const Candidate& baseline) {
  if (study.degrees() > 1) return "";
  constexpr double much = 0.5, few_rows = 0.005;
  std::string text;
  double flat = 0, trend = 0, lag = 0;
  for (std::size_t i = 0; i < study.train.size(); ++i) {
    flat = std::max(flat, flat_share(as_vector(study.full[i][study.imposed ? "y" : study.output()])));
    if (study.imposed || !baseline.ran()) continue;
    if (study.run_length == 0) trend = std::max(trend, trend_share(baseline.fit.residual[i]));
    lag = std::max(lag, lag_share(study, baseline, i));
  }
  if (flat > few_rows) text += "; the measured motion is flat at its extremes, as of a clipped channel";
  if (trend > much) text += "; what is left of the motion is a slow trend, as of a drifting sensor";
  if (lag > much) text += "; it follows the rate of the acceleration, as of a channel that lags";
  return text;
}

}  // namespace lunid
