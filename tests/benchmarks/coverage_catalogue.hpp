#pragma once
// Entries with shape parameters, exponents and internal states for lunid_coverage, each beside the small catalogue.
#include <string>
#include <vector>

#include "runtime/discover_catalogue.hpp"

namespace lunid::testing {

/// Parameters of an entry that are not negative.
inline std::vector<Parameter> rows_of(const std::string& entry, const std::vector<std::string>& names) {
  std::vector<Parameter> rows;
  for (const std::string& name : names) rows.push_back(row(entry + "_" + name, 0));
  return rows;
}

inline Effect stop_entry(Pool& pool) {
  Effect effect = entry(pool, "one_sided_stop", "one_sided_stop_k*max(y - one_sided_stop_g, 0)",
                        {row("one_sided_stop_k", 0), row("one_sided_stop_g")});
  effect.guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.5, 0.65, 0.8, 0.92})
      guesses.push_back({{"one_sided_stop_g", s.y_min + part * (s.y_max - s.y_min)}});
    return guesses;
  };
  effect.range = [](const RecordScales& s, int) { return Ranges{{"one_sided_stop_g", {s.y_min, s.y_max}}}; };
  return effect;
}

inline Effect power_entry(Pool& pool) {
  Effect effect = entry(pool, "power_law_damping", "power_law_damping_c*abs(v)^power_law_damping_p*sign(v)",
                        rows_of("power_law_damping", {"c", "p"}));
  effect.parameters[1].max = 6;
  effect.guess = [](const RecordScales&, int) {
    std::vector<Guess> guesses;
    for (const double p : {0.3, 0.7, 1.5, 2.5}) guesses.push_back({{"power_law_damping_p", p}});
    return guesses;
  };
  effect.range = [](const RecordScales&, int) { return Ranges{{"power_law_damping_p", {0.01, 5}}}; };
  return effect;
}

inline Effect maxwell_entry(Pool& pool) {
  Effect effect = entry_with_state(pool, "maxwell_relaxation", "z", "maxwell_relaxation_k*v - z/maxwell_relaxation_tau",
                                   rows_of("maxwell_relaxation", {"k", "tau"}));
  effect.guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.1, 1.0, 10.0})
      for (const double stiffer : {0.1, 1.0})
        guesses.push_back({{"maxwell_relaxation_k", stiffer * s.stiffness},
                           {"maxwell_relaxation_tau", s.interval / 4 + part / s.omega}});
    return guesses;
  };
  effect.range = [](const RecordScales& s, int) {
    return Ranges{{"maxwell_relaxation_k", {1e-4 * s.stiffness, 1e5 * s.stiffness}},
                  {"maxwell_relaxation_tau", {s.interval / 4, s.interval / 4 + 1e3 / s.omega}}};
  };
  return effect;
}

inline Effect slip_entry(Pool& pool) {
  Effect effect = entry_with_state(pool, "elastic_slip", "z", "elastic_slip_k*v", rows_of("elastic_slip", {"k", "Fs"}),
                                   "elastic_slip_Fs");
  effect.guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.03, 0.1, 0.3})
      for (const double force : {0.2, 0.6})
        guesses.push_back({{"elastic_slip_Fs", force * s.force_std},
                           {"elastic_slip_k", force * s.force_std / (part * (s.y_max - s.y_min))}});
    return guesses;
  };
  effect.range = [](const RecordScales& s, int) {
    return Ranges{{"elastic_slip_k", {1e-3 * s.stiffness, 1e5 * s.stiffness}},
                  {"elastic_slip_Fs", {1e-4 * s.force_std, 30 * s.force_std}}};
  };
  return effect;
}

inline Effect bouc_wen_entry(Pool& pool) {
  Effect effect =
      entry_with_state(pool, "bouc_wen", "bouc_wen_k*z",
                       "v - abs(z/bouc_wen_zy)^bouc_wen_n*(bouc_wen_rho*abs(v)*sign(z) + (1 - bouc_wen_rho)*v)",
                       rows_of("bouc_wen", {"k", "zy", "rho", "n"}));
  effect.parameters[3].min = 1, effect.parameters[3].max = 4;
  effect.guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.03, 0.1, 0.3})
      for (const double rho : {0.5, 0.9})
        guesses.push_back({{"bouc_wen_zy", part * (s.y_max - s.y_min)}, {"bouc_wen_rho", rho}, {"bouc_wen_n", 1.2}});
    return guesses;
  };
  effect.range = [](const RecordScales& s, int) {
    const double range = s.y_max - s.y_min;
    return Ranges{{"bouc_wen_zy", {1e-4 * range, range}}, {"bouc_wen_rho", {0.1, 100}}};
  };
  return effect;
}

inline Effect mode_entry(Pool& pool) {
  const Expr x = pool.state("x"), u = pool.state("u");
  const std::string pull = "hidden_mode_kh*(y - x) + hidden_mode_ch*(v - u)";
  Effect effect = entry(pool, "hidden_mode", pull, rows_of("hidden_mode", {"mh", "kh", "ch"}));
  effect.states.push_back({x, parse(pool, "u"), 0, {}, {}});
  effect.states.push_back({u, parse(pool, "(" + pull + ")/hidden_mode_mh"), 0, {}, {}});
  effect.guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    const double mass = 0.1 * s.stiffness / (s.omega * s.omega);
    for (int i = -12; i <= 12; ++i) {
      const double omega = std::pow(1.1, i) * s.omega;
      guesses.push_back(
          {{"hidden_mode_mh", mass}, {"hidden_mode_kh", mass * omega * omega}, {"hidden_mode_ch", 0.1 * mass * omega}});
    }
    return guesses;
  };
  effect.range = [](const RecordScales& s, int) {
    const double mass = s.stiffness / (s.omega * s.omega);
    return Ranges{{"hidden_mode_mh", {1e-4 * mass, 1e3 * mass}},
                  {"hidden_mode_kh", {1e-6 * s.stiffness, 1e4 * s.stiffness}}};
  };
  return effect;
}

/// The small catalogue, and beside it the entry of this name if that is one of those here.
inline std::vector<Effect> catalogue_with(Pool& pool, const std::string& name) {
  std::vector<Effect> all = small_catalogue(pool);
  if (name == "one_sided_stop") all.push_back(stop_entry(pool));
  if (name == "power_law_damping") all.push_back(power_entry(pool));
  if (name == "maxwell_relaxation") all.push_back(maxwell_entry(pool));
  if (name == "elastic_slip") all.push_back(slip_entry(pool));
  if (name == "bouc_wen") all.push_back(bouc_wen_entry(pool));
  if (name == "hidden_mode") all.push_back(mode_entry(pool));
  return all;
}

}  // namespace lunid::testing
