// Fits on the trajectory.
#include <chrono>
#include <cmath>

#include "expr/external.hpp"
#include "expr/joined.hpp"
#include "model_threads.hpp"
#include "record/spectra.hpp"
#include "runtime.hpp"
#include "simulate/fit_check.hpp"
#include "stream.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

/// The record with the noise of its channels as outliers do not reach it: a fit weighs its channels by it.
Record with_robust_noise(const Record& record) {
  Record robust = record;
  for (const Channel& given : record.channels()) {
    const auto values = record[given.name];
    const double noise = noise_report(values, record.dt()).robust;
    if (!(given.noise > 0) || !(noise > 0)) continue;
    Channel channel = given;
    channel.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    channel.noise = noise;
    robust = robust.with(std::move(channel));
  }
  return robust;
}

std::vector<FitData> data_of(lua_State* L, int index, const System& system, std::optional<Interpolation> interpolation,
                             bool outliers) {
  std::vector<FitData> data;
  for_each(L, index, [&](lua_Integer) {
    const Record& given = check<Record>(L, -1);
    const Record record = outliers ? with_robust_noise(given) : given;
    const bool imposed = system.model().imposed_motion;
    data.push_back({record, imposed ? Excitations() : excitations_of(system, record, interpolation), {}});
  });
  return data;
}

/// Records of more noise count less: each by the noise of its first fitted channel beside that of the first record,
/// within a factor of ten, beyond which it is the model's error that counts.
void weigh(std::vector<FitData>& data, const FitOptions& options, const Model& model) {
  const std::string channel = model.imposed_motion       ? "F"
                              : options.channels.empty() ? model.channel('y', 0)
                                                         : options.channels.front();
  const auto noise = [&](const FitData& d) { return d.record.has(channel) ? d.record.channel(channel).noise : 0; };
  for (FitData& d : data)
    if (noise(d) > 0 && noise(data.front()) > 0) d.weight = std::clamp(noise(data.front()) / noise(d), 0.1, 10.0);
}

int parameter_index(const Model& model, const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    if (model.parameters[i].name == name) return static_cast<int>(i);
    names.push_back(model.parameters[i].name);
  }
  throw InputError(where + ": the model has no parameter '" + name + "'" + did_you_mean(nearest_word(name, names)));
}

FitOptions options_of(lua_State* L, int index, const Model& model, double dt) {
  FitOptions options;
  options.max_iterations = static_cast<int>(number_field(L, index, "max_iterations").value_or(options.max_iterations));
  options.threads = model_threads(L);
  options.cancelled = &runtime(L).cancelled();
  options.shorten_steps = true;
  options.force_noise = boolean_field(L, index, "force_noise", false);
  options.channels = strings_field(L, index, "channels");
  options.loss = string_field(L, index, "loss").value_or("squared") == "huber" ? Loss::huber : Loss::squared;
  options.segment = std::llround(number_field(L, index, "segment").value_or(0) / dt);
  options.solver = solver_from(string_field(L, index, "solver").value_or("auto"));
  const std::string gradient = string_field(L, index, "gradient").value_or("auto");
  options.gradient = gradient == "adjoint"   ? Gradient::adjoint
                     : gradient == "forward" ? Gradient::forward
                                             : Gradient::automatic;
  for (const std::string& name : strings_field(L, index, "separate"))
    options.separate.push_back(parameter_index(model, name, "fit_trajectory: separate"));
  validate(options);
  return options;
}

/// fit_trajectory(model, {records...}, {interpolation=, max_iterations=, channels=, separate=, loss=, segment=,
/// force_noise=})
int fit(lua_State* L) {
  TrajectoryFit fit;
  fit.system = std::make_shared<const System>(check<Model>(L, 1));
  check_table(L, 2);
  check_table(L, 3);
  fit.data = data_of(L, 2, *fit.system, interpolation_field(L, 3), string_field(L, 3, "loss").value_or("") == "huber");
  if (fit.data.empty()) throw InputError("fit_trajectory: expected at least one record, got none");
  const Model& model = fit.system->model();
  fit.options = options_of(L, 3, model, fit.data[0].record.dt());
  weigh(fit.data, fit.options, model);
  for (const Parameter& parameter : model.parameters)
    if (std::isnan(parameter.value))
      throw InputError("fit_trajectory: parameter '" + parameter.name + "' has no first guess: write model:with { " +
                       parameter.name + " = ... }");
  const std::vector<double> start = model.values();
  const ExternalWatch externals(*model.pool);
  fit.result = fit_progressively(
      *fit.system, Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size())), fit.data,
      fit.options);
  if (boolean_field(L, 3, "check", false))
    fit.checked = check_by_sundials(*fit.system, fit.result, fit.data, fit.options);
  fit.notes = externals.notes();
  push<TrajectoryFit>(L, std::move(fit));
  return 1;
}

FitLayout layout_of(const TrajectoryFit& fit) {
  return {fit.system->parameters(), static_cast<int>(fit.data.size()), fit.options.separate};
}

/// The model with the values found for a record, counted from 0.
Model model_of(const TrajectoryFit& fit, int record) {
  Model model = fit.system->model();
  const FitLayout layout = layout_of(fit);
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const int place = layout.place(record, static_cast<int>(i));
    model.parameters[i].value = fit.result.theta[place];
    model.parameters[i].std = fit.result.deviation(place);
  }
  return model;
}

/// Of the first fitted channel of all records: RMSE over standard deviation, 1 where a constant would do as well.
double gap_of(const TrajectoryFit& fit) {
  const Model& model = fit.system->model();
  double squares = 0, variance = 0;
  for (std::size_t r = 0; r < fit.data.size() && r < fit.result.residual.size(); ++r) {
    const Record& record = fit.data[r].record;
    const std::string channel = model.imposed_motion           ? model.channel('F', 0)
                                : fit.options.channels.empty() ? fitted_channels(model, record).front().channel
                                                               : fit.options.channels.front();
    std::vector<double> measured;
    for (Eigen::Index i = 0; i < fit.result.residual[r].size(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      if (!fit.data[r].use.empty() && !fit.data[r].use[row]) continue;
      squares += fit.result.residual[r][i] * fit.result.residual[r][i];
      measured.push_back(record[channel][row]);
    }
    if (measured.empty()) continue;
    const Eigen::Map<const Eigen::ArrayXd> x(measured.data(), static_cast<Eigen::Index>(measured.size()));
    variance += (x - x.mean()).square().sum();
  }
  return std::sqrt(squares / variance);
}

/// Names of the parameters that others make up for.
std::vector<std::string> unidentifiable(const TrajectoryFit& fit) {
  const FitLayout layout = layout_of(fit);
  std::vector<std::string> names;
  for (int place = 0; place < layout.size(); ++place) {
    const auto i = static_cast<std::size_t>(layout.parameter(place));
    const std::string& name = fit.system->model().parameters[i].name;
    if (!fit.result.identifiable(place) && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

void push_fit_summary(lua_State* L, const TrajectoryFit& fit) {
  const FitResult& r = fit.result;
  lua_newtable(L);
  lua_pushboolean(L, r.converged);
  lua_setfield(L, -2, "converged");
  for (const auto& [field, words] :
       {std::pair{"stopped", r.stopped}, std::pair{"solver", r.solver}, std::pair{"gradient", to_string(r.gradient)}}) {
    push_text(L, words);
    lua_setfield(L, -2, field);
  }
  for (const auto& [field, value] :
       {std::pair{"iterations", static_cast<long>(r.iterations)}, std::pair{"runs", r.runs},
        std::pair{"rows", static_cast<long>(r.rows)}, std::pair{"outliers", static_cast<long>(r.outliers)},
        std::pair{"substeps", static_cast<long>(r.substeps)}}) {
    lua_pushinteger(L, value);
    lua_setfield(L, -2, field);
  }
  lua_pushnumber(L, r.cost);
  lua_setfield(L, -2, "cost");
  lua_pushnumber(L, std::sqrt(r.cost / static_cast<double>(std::max<Eigen::Index>(1, r.rows))));
  lua_setfield(L, -2, "rmse");
  lua_pushnumber(L, gap_of(fit));
  lua_setfield(L, -2, "gap");
  if (!std::isnan(fit.checked)) {
    lua_pushnumber(L, fit.checked);
    lua_setfield(L, -2, "checked");
  }
  push_texts(L, unidentifiable(fit));
  lua_setfield(L, -2, "unidentifiable");
}

/// The correlations between what was fitted, as rows; 0 where there is no deviation.
void push_correlation(lua_State* L, const FitResult& result) {
  const Eigen::Index n = result.covariance.rows();
  lua_newtable(L);
  for (Eigen::Index i = 0; i < n; ++i) {
    lua_newtable(L);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double scale = std::sqrt(result.covariance(i, i) * result.covariance(j, j));
      lua_pushnumber(L, scale > 0 ? result.covariance(i, j) / scale : 0);
      lua_rawseti(L, -2, j + 1);
    }
    lua_rawseti(L, -2, i + 1);
  }
}

/// fit:profile(name, record = 1) -> {value = {...}, drop = {...}, low=, high=}
int profile(lua_State* L) {
  const TrajectoryFit& fit = check<TrajectoryFit>(L, 1);
  const int parameter = parameter_index(fit.system->model(), check_string(L, 2), "profile");
  const auto record = lua_isnoneornil(L, 3) ? 1 : check_integer(L, 3);
  if (record < 1 || record > static_cast<long long>(fit.data.size()))
    throw InputError("profile: record: expected 1 to " + std::to_string(fit.data.size()) + ", got " +
                     std::to_string(record));
  const Profile found = profile_likelihood(*fit.system, fit.result, fit.data, fit.options,
                                           layout_of(fit).place(static_cast<int>(record) - 1, parameter));
  lua_newtable(L);
  for (const auto& [field, member] :
       {std::pair{"value", &Profile::Point::value}, std::pair{"drop", &Profile::Point::drop}}) {
    lua_newtable(L);
    for (std::size_t i = 0; i < found.points.size(); ++i) {
      lua_pushnumber(L, found.points[i].*member);
      lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
    }
    lua_setfield(L, -2, field);
  }
  for (const auto& [field, value] : {std::pair{"low", found.low}, std::pair{"high", found.high}}) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, field);
  }
  return 1;
}

/// fit:residual(record = 1) -> column: measured - model of its first fitted channel
int residual(lua_State* L) {
  const TrajectoryFit& fit = check<TrajectoryFit>(L, 1);
  const auto record = lua_isnoneornil(L, 2) ? 1 : check_integer(L, 2);
  if (record < 1 || record > static_cast<long long>(fit.data.size()))
    throw InputError("residual: record: expected 1 to " + std::to_string(fit.data.size()) + ", got " +
                     std::to_string(record));
  push_column(L, fit.result.residual[static_cast<std::size_t>(record) - 1]);
  return 1;
}

/// Fields model, models, summary, correlation; or a method.
int get(lua_State* L) {
  const TrajectoryFit& fit = check<TrajectoryFit>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "model") {
    push<Model>(L, model_of(fit, 0));
  } else if (key == "models") {
    lua_newtable(L);
    for (std::size_t r = 0; r < fit.data.size(); ++r) {
      push<Model>(L, model_of(fit, static_cast<int>(r)));
      lua_rawseti(L, -2, static_cast<lua_Integer>(r) + 1);
    }
  } else if (key == "summary") {
    push_fit_summary(L, fit);
  } else if (key == "correlation") {
    push_correlation(L, fit.result);
  } else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1))
      throw InputError("a trajectory fit has no '" + key +
                       "' (fields: model models summary correlation; methods: profile residual)");
  }
  return 1;
}

int to_string(lua_State* L) {
  const TrajectoryFit& fit = check<TrajectoryFit>(L, 1);
  const FitResult& r = fit.result;
  const double gap = gap_of(fit);
  char text[200];
  std::snprintf(text, sizeof text, "fit of %zu %s, %lld rows: RMSE %.4g (gap %.3g) after %d iterations, %s",
                fit.data.size(), fit.data.size() == 1 ? "record" : "records", static_cast<long long>(r.rows),
                std::sqrt(r.cost / static_cast<double>(std::max<Eigen::Index>(1, r.rows))), gap, r.iterations,
                r.converged ? "converged" : "not converged");
  std::string all = text;
  if (r.outliers > 0) all += "; " + std::to_string(r.outliers) + " rows count as outliers";
  const FitLayout layout = layout_of(fit);
  for (int place = 0; place < layout.size(); ++place) {
    const auto i = static_cast<std::size_t>(layout.parameter(place));
    const Parameter& parameter = fit.system->model().parameters[i];
    const int further = place - fit.system->parameters();
    const bool own = std::find(fit.options.separate.begin(), fit.options.separate.end(), static_cast<int>(i)) !=
                     fit.options.separate.end();
    const int record = further < 0 ? 1 : 2 + further / static_cast<int>(fit.options.separate.size());
    std::snprintf(text, sizeof text, "\n  %s = %.6g", parameter.name.c_str(), r.theta[place]);
    all += text;
    std::snprintf(text, sizeof text, " +- %.2g", r.deviation(place));
    if (r.deviation(place) > 0) all += text;
    all += (parameter.unit.empty() ? "" : " " + parameter.unit);
    if (own) all += " (record " + std::to_string(record) + ")";
    if (static_cast<std::size_t>(place) < r.at_bound.size() && r.at_bound[static_cast<std::size_t>(place)])
      all += " (at its bound)";
    if (parameter.fixed) all += " (fixed)";
    if (!r.identifiable(place)) all += " (not identifiable)";
  }
  const std::string together = joined(unidentifiable(fit));
  if (!together.empty())
    all += "\n  note: other values of " + together +
           ", together, make the same motion on these records: fix one of them, or take a record under a known force";
  constexpr double worth_saying = 1e-4;
  if (fit.checked > worth_saying) {
    std::snprintf(
        text, sizeof text,
        "\n  note: SUNDIALS' runs differ from these by %.2g of the motion's deviation: the motion is chaotic, "
        "or the steps are too long",
        fit.checked);
    all += text;
  }
  constexpr double no_fit = 0.9;
  if (gap > no_fit)
    all +=
        "\n  note: this is no fit: a constant leaves as much of the motion. The first guesses are far off, or the "
        "model "
        "is; lunid.regress along the measured motion needs none";
  for (const std::string& note : fit.notes) all += "\n  note: " + note;
  push_text(L, all);
  return 1;
}

}  // namespace

void open_fits(lua_State* L) {
  static constexpr Entry methods[] = {{"profile", guarded<profile>}, {"residual", guarded<residual>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<TrajectoryFit>(L, methods, meta);
  static constexpr Entry functions[] = {{"fit_trajectory", guarded<fit>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
