#pragma once
// A small catalogue in C++ and records of the independent generator, for tests of the discover room alone.
#include <string>
#include <vector>

#include "discover/discover.hpp"
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
  effect.formula = force;
  for (const auto& p : parameters) pool.parameter(p.name);
  effect.variants.push_back(parse(pool, force));
  effect.parameters = std::move(parameters);
  return effect;
}

inline std::vector<Effect> small_catalogue(Pool& pool) {
  return {entry(pool, "cubic_stiffness", "cubic_stiffness_k3*y^3", {row("cubic_stiffness_k3")}),
          entry(pool, "quadratic_stiffness", "quadratic_stiffness_k2*y^2", {row("quadratic_stiffness_k2")}),
          entry(pool, "constant_force", "constant_force_F0", {row("constant_force_F0")}),
          entry(pool, "viscous_damping", "viscous_damping_c*v", {row("viscous_damping_c", 0)}),
          entry(pool, "coulomb_friction", "coulomb_friction_Fc*sign(v)", {row("coulomb_friction_Fc", 0)})};
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

inline Model baseline(const std::string& restoring, double mass) {
  Model model;
  model.pool = std::make_shared<Pool>();
  model.mass = model.pool->constant(mass);
  model.restoring = parse(*model.pool, restoring);
  return model;
}

}  // namespace lunid::testing
