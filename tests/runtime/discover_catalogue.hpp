#pragma once
// A small catalogue in C++ and records of the independent generator, for tests of the discover room alone.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "discover/discover.hpp"
#include "record/random.hpp"
#include "truth/truth.hpp"

namespace lunid::testing {

inline Parameter row(const std::string& name, double min = -std::numeric_limits<double>::infinity()) {
  Parameter p;
  p.name = name;
  p.min = min;
  return p;
}

inline Effect entry(Pool& pool, const std::string& name, const std::string& force, std::vector<Parameter> parameters) {
  Effect effect;
  effect.name = name;
  effect.family = "test";
  for (const auto& p : parameters) pool.parameter(p.name);
  effect.variants.push_back(parse(pool, force));
  effect.variants.back().formula = force;
  effect.parameters = std::move(parameters);
  return effect;
}

/// An entry with a state z; `limit`: holds it within -limit and limit.
inline Effect entry_with_state(Pool& pool, const std::string& name, const std::string& force, const std::string& rate,
                               std::vector<Parameter> parameters, const std::string& limit = "") {
  const Expr z = pool.state("z");
  Effect effect = entry(pool, name, force, std::move(parameters));
  const auto bound = [&](const char* sign) { return limit.empty() ? Expr() : parse(pool, sign + limit); };
  effect.states.push_back({z, parse(pool, rate), 0, bound("-"), bound("")});
  return effect;
}

/// In two forms, sharp and rounded; the second has a parameter that the first has not.
inline Effect friction(Pool& pool) {
  Effect effect = entry(pool, "coulomb_friction", "coulomb_friction_Fc*sign(v)",
                        {row("coulomb_friction_Fc", 0), row("coulomb_friction_vr", 0)});
  effect.variants.push_back(parse(pool, "coulomb_friction_Fc*tanh(v/coulomb_friction_vr)"));
  effect.variants[1].formula = "Fc*tanh(v/vr)";
  const auto only_rounded = [](int variant, auto values) { return variant == 1 ? values : decltype(values){}; };
  effect.guess = [=](const RecordScales& s, int variant) {
    return only_rounded(variant, std::vector{Guess{{"coulomb_friction_vr", 0.05 * s.v_max}}});
  };
  effect.range = [=](const RecordScales& s, int variant) {
    return only_rounded(variant, Ranges{{"coulomb_friction_vr", {2e-3 * s.v_max, s.v_max}}});
  };
  return effect;
}

inline std::vector<Effect> small_catalogue(Pool& pool) {
  return {entry(pool, "cubic_stiffness", "cubic_stiffness_k3*y^3", {row("cubic_stiffness_k3")}),
          entry(pool, "quadratic_stiffness", "quadratic_stiffness_k2*y^2", {row("quadratic_stiffness_k2")}),
          entry(pool, "constant_force", "constant_force_F0", {row("constant_force_F0")}),
          entry(pool, "viscous_damping", "viscous_damping_c*v", {row("viscous_damping_c", 0)}), friction(pool)};
}

/// A fault of the displacement's channel that shows `map` of the true one.
inline Effect sensor(Pool& pool, const std::string& name, const std::string& map, std::vector<Parameter> parameters) {
  Effect effect = entry(pool, name, map, std::move(parameters));
  effect.family = "sensor";
  effect.variants[0].measures = {{"y", effect.variants[0].force}};
  effect.variants[0].force = {};
  return effect;
}

inline Channel channel(const std::string& name, const std::string& unit, const std::vector<double>& values) {
  Channel c;
  c.name = c.source = name;
  c.unit = unit;
  c.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  c.noise = noise_level(values);
  return c;
}

inline Record record_of(const truth::Columns& columns, const std::string& name) {
  return Record(name, columns.t.front(),
                (columns.t.back() - columns.t.front()) / static_cast<double>(columns.t.size() - 1),
                {channel("F", "N", columns.F), channel("y", "m", columns.y)});
}

/// Records of a case of the truth at a scale, 6400 rows.
inline truth::Records records_of(const char* name, const truth::Scale& scale, double noise_db, std::uint64_t seed,
                                 truth::Excited excited = truth::Excited::multisine) {
  truth::RecordOptions options;
  options.excited = excited;
  options.noise_db = noise_db;
  options.seed = seed;
  return truth::make_records(truth::case_named(name), scale, options);
}

/// Discovery on the records of a case.
inline Discovery discover_case(const Model& model, const std::vector<Effect>& catalogue, const truth::Records& records,
                               const DiscoverOptions& options = {}) {
  return discover(model, catalogue, {record_of(records.train, "train")}, {record_of(records.test, "test")}, options);
}

/// 25 rows to a natural period of a truth of mass 1 and k = 1.
constexpr double spacing = 2 * M_PI / 25;

/// A record of the force of a motion and of y, v or a, with white noise of this deviation.
inline Record noisy_record(const truth::Motion& motion, const std::string& measured, std::vector<double> values,
                           double noise, std::uint64_t seed, double start = 0) {
  Philox random(seed, 7);
  for (double& x : values) x += noise * random.normal();
  const std::string unit = measured == "y" ? "m" : measured == "v" ? "m/s" : "m/s^2";
  return derive_motion(Record(measured + " " + std::to_string(seed), start, spacing,
                              {channel("F", "N", motion.force), channel(measured, unit, values)}));
}

inline bool warns(const Discovery& d, const std::string& text) {
  return std::any_of(d.warnings.begin(), d.warnings.end(),
                     [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

inline Model baseline(const std::string& restoring, double mass) {
  Model model;
  model.pool = std::make_shared<Pool>();
  model.mass = model.pool->constant(mass);
  model.restoring = parse(*model.pool, restoring);
  return model;
}

}  // namespace lunid::testing
