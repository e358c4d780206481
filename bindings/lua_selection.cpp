// What the choice of a model needs of the runtime: motions smoothed to a given width, and free runs as judges.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "expr/tape.hpp"
#include "regress/fit.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {
namespace {

Channel smoothed(const Record& record, const char* from, const char* name, int derivative, int half_width) {
  Channel channel = record.channel(from);
  channel.name = name;
  channel.derived = true;
  channel.values = savitzky_golay(record[from], record.dt(), derivative, {half_width, 3});
  return channel;
}

/// The whole of a record's window as a record of its own.
Record alone(const Record& record) {
  std::vector<Channel> channels = record.channels();
  for (Channel& channel : channels) {
    const auto values = record[channel.name];
    channel.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  return Record(record.name(), record.start(), record.dt(), std::move(channels));
}

/// smooth_motion(record, half_width): y and v through cubics over 2*half_width + 1 samples, a as their derivative; 0:
/// the record's own y and v, a by central differences. The filter's one-sided ends are cut off.
int smooth_motion(lua_State* L) {
  const Record whole = alone(check<Record>(L, 1));
  const int half = static_cast<int>(check_integer(L, 2)), used = std::max(half, 1);
  const bool measured = whole.has("v") && !whole.channel("v").derived;
  Record out = whole;
  const auto filter = [&](const char* from, const char* name, int derivative) {
    Channel channel = whole.channel(from);
    if (half > 0) return smoothed(whole, from, name, derivative, std::max(half, 2));
    channel.name = name;
    if (derivative == 0) return channel;
    const Eigen::VectorXd x = channel.values;
    const Eigen::Index n = x.size();
    for (Eigen::Index i = 1; i + 1 < n; ++i)
      channel.values[i] = derivative == 1 ? (x[i + 1] - x[i - 1]) / (2 * whole.dt())
                                          : (x[i + 1] - 2 * x[i] + x[i - 1]) / (whole.dt() * whole.dt());
    channel.values[0] = channel.values[1];
    channel.values[n - 1] = channel.values[n - 2];
    return channel;
  };
  out = out.with(filter("y", "y", 0));
  out = out.with(measured ? filter("v", "v", 0) : filter("y", "v", 1));
  out = out.with(measured ? filter("v", "a", 1) : filter("y", "a", 2));
  if (out.rows() <= 2 * used + 6) throw InputError("select: " + whole.name() + " is too short to be smoothed");
  push<Record>(L, out.slice(used, out.rows() - 2 * used));
  return 1;
}

/// The bump (1 - t^2)^4 over 2*half + 1 samples and, for `slope`, minus its derivative per second.
Eigen::VectorXd test_function(int half, double dt, bool slope) {
  Eigen::VectorXd out(2 * half + 1);
  for (int i = -half; i <= half; ++i) {
    const double t = i / (half + 1.0), bump = 1 - t * t;
    out[i + half] = slope ? 8 * t * std::pow(bump, 3) / ((half + 1.0) * dt) : std::pow(bump, 4);
  }
  return out;
}

/// The sums of a signal under the test function, moved on by `step` samples.
Eigen::VectorXd moved_sums(const Eigen::VectorXd& x, const Eigen::VectorXd& weight, Eigen::Index step) {
  Eigen::VectorXd out((x.size() - weight.size()) / step + 1);
  for (Eigen::Index k = 0; k < out.size(); ++k) out[k] = weight.dot(x.segment(k * step, weight.size()));
  return out / weight.cwiseAbs().sum();
}

/// Columns of the features over the rows of a record. y and v pass a filter of seven samples first, since noise biases
/// their powers.
Eigen::MatrixXd columns_of(const Record& whole, const std::vector<Expr>& features) {
  const Record motion = whole.with(smoothed(whole, "y", "y", 0, 3)).with(smoothed(whole, "v", "v", 0, 3));
  std::vector<Expr> inputs;
  for (const Expr& f : features)
    for (const Expr& s : symbols(f))
      if (std::find(inputs.begin(), inputs.end(), s) == inputs.end()) inputs.push_back(s);
  const Eigen::VectorXd time =
      Eigen::VectorXd::NullaryExpr(whole.rows(), [&](Eigen::Index i) { return whole.time(i); });
  std::vector<const double*> in;
  for (const Expr& s : inputs) in.push_back(s.name() == "t" && !whole.has("t") ? time.data() : motion[s.name()].data());
  Eigen::MatrixXd columns(whole.rows(), static_cast<Eigen::Index>(features.size()));
  std::vector<double*> out;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) out.push_back(columns.col(j).data());
  const std::vector<int> stride(in.size(), 1);
  Tape(features, inputs).run_columns(in, stride, static_cast<std::size_t>(whole.rows()), out);
  return columns;
}

/// Adds the equation of motion under moving test functions, without a derivative of the data (Schaeffer & McCalla 2017,
/// Phys. Rev. E 96, 023302; Messenger & Bortz 2021, Multiscale Model. Simul. 19, 1474). `features` end with the known
/// force where there is one.
void add_weak(Statistic& sum, const Record& given, const std::vector<Expr>& features, double mass, int half) {
  const Record whole = alone(given);
  if (whole.rows() < 6 * (2 * half + 1))
    throw InputError("select: " + whole.name() + " is too short for the weak form");
  const auto step = std::max<Eigen::Index>(1, half / 4);
  const Eigen::MatrixXd columns = columns_of(whole, features);
  const Eigen::VectorXd bump = test_function(half, whole.dt(), false), slope = test_function(half, whole.dt(), true);
  Eigen::VectorXd target =
      moved_sums(whole.channel("F").values, bump, step) -
      mass * slope.cwiseAbs().sum() / bump.sum() * moved_sums(whole.channel("v").values, slope, step);
  Eigen::MatrixXd x(target.size(), sum.features());
  for (Eigen::Index j = 0; j < x.cols(); ++j) x.col(j) = moved_sums(columns.col(j), bump, step);
  if (columns.cols() > x.cols()) target -= moved_sums(columns.col(x.cols()), bump, step);
  sum.add(x, target);
}

/// The least squares fit as {features = {1-based ...}, values = {...}, r2=} on top of the stack.
void push_step(lua_State* L, const Fit& fit, const std::vector<bool>& dropped) {
  lua_newtable(L);
  lua_newtable(L);
  lua_newtable(L);
  lua_Integer i = 0;
  for (std::size_t j = 0; j < dropped.size(); ++j) {
    if (dropped[j]) continue;
    lua_pushinteger(L, static_cast<lua_Integer>(j) + 1);
    lua_rawseti(L, -3, ++i);
    lua_pushnumber(L, fit.coefficients[static_cast<Eigen::Index>(j)]);
    lua_rawseti(L, -2, i);
  }
  lua_setfield(L, -3, "values");
  lua_setfield(L, -2, "features");
  lua_pushnumber(L, fit.r2);
  lua_setfield(L, -2, "r2");
}

/// weak_path({records}, {features}, mass, half_width, known or nil) -> list of fits, the term whose loss raises the
/// residual least taken away from one to the next.
int weak_path(lua_State* L) {
  std::vector<Expr> features;
  for_each(L, 2, [&](lua_Integer) { features.push_back(check_value(L, -1).expr); });
  std::vector<std::string> names;
  for (const Expr& f : features) names.push_back(to_text(f));
  const double mass = check_number(L, 3);
  const int half = static_cast<int>(check_integer(L, 4));
  if (!lua_isnoneornil(L, 5)) features.push_back(check_value(L, 5).expr);
  Statistic sum(names);
  for_each(L, 1, [&](lua_Integer) { add_weak(sum, check<Record>(L, -1), features, mass, half); });
  std::vector<bool> dropped(names.size(), false);
  std::vector<Constraint> constraints;
  lua_newtable(L);
  for (std::size_t left = names.size(); left > 0; --left) {
    const Fit fit = least_squares(sum, constraints);
    push_step(L, fit, dropped);
    lua_rawseti(L, -2, static_cast<lua_Integer>(names.size() - left) + 1);
    double least = HUGE_VAL;
    int weakest = 0;
    for (std::size_t j = 0; j < dropped.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const double size = fit.std[i] > 0 ? std::abs(fit.coefficients[i]) / fit.std[i] : 0;
      if (dropped[j] || size >= least) continue;
      least = size;
      weakest = static_cast<int>(j);
    }
    dropped[static_cast<std::size_t>(weakest)] = true;
    constraints.push_back(fixed(weakest, 0));
  }
  return 1;
}

/// Rows whose motion gives the first state: two periods or 5 % of the rows, whichever is less, never under 5.
Eigen::Index lead_in(const Record& record) {
  const double omega = dominant_frequency(record["y"], record.dt()), rows = static_cast<double>(record.rows());
  const double periods = omega > 0 ? 4 * std::numbers::pi / omega / record.dt() : rows;
  return std::max<Eigen::Index>(5, static_cast<Eigen::Index>(std::min(periods, 0.05 * rows)));
}

/// judge(model, {records}) -> {gap=} or {cause=, stopped_at=}: RMSE of the free-run displacement over the standard
/// deviation of the measured one, over all records, first states from their lead-ins alone.
int judge(lua_State* L) {
  const System system(check<Model>(L, 1));
  const std::vector<double> theta = system.model().values();
  const Eigen::Map<const Eigen::VectorXd> values(theta.data(), static_cast<Eigen::Index>(theta.size()));
  double squares = 0, variance = 0;
  std::string cause;
  double stopped_at = 0;
  for_each(L, 2, [&](lua_Integer) {
    const Record& record = check<Record>(L, -1);
    if (!cause.empty()) return;
    const Eigen::Index lead = lead_in(record), rows = record.rows() - lead;
    const FitData data{record, excitations_of(system, record), {}};
    const StateEstimate state = estimate_state(system, values, data, 0, lead, 1);
    SimulateOptions options;
    options.solver = Solver::fixed;
    options.substeps = 1;
    options.cancelled = &runtime(L).cancelled();
    const Run run = simulate(system, theta, data.excitation, state.x0, options);
    if (!run.summary.completed) {
      cause = run.summary.cause;
      stopped_at = run.summary.stopped_at;
      return;
    }
    const auto y = record["y"];
    const Eigen::Map<const Eigen::VectorXd> measured(y.data() + lead, rows);
    squares += (run.x.col(0).tail(rows) - measured).squaredNorm();
    variance += (measured.array() - measured.mean()).square().sum();
  });
  lua_newtable(L);
  if (cause.empty()) {
    lua_pushnumber(L, std::sqrt(squares / variance));
    lua_setfield(L, -2, "gap");
  } else {
    push_text(L, cause);
    lua_setfield(L, -2, "cause");
    lua_pushnumber(L, stopped_at);
    lua_setfield(L, -2, "stopped_at");
  }
  return 1;
}

}  // namespace

void open_selections(lua_State* L) {
  static constexpr Entry functions[] = {
      {"smooth_motion", guarded<smooth_motion>}, {"weak_path", guarded<weak_path>}, {"judge", guarded<judge>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
