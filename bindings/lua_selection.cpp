// Free runs as judges, for the choice of a model.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {
namespace {

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
  static constexpr Entry functions[] = {{"judge", guarded<judge>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
