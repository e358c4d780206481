// Every further entry of the catalogue that a forced record can identify, and shapes that no entry has.
#include <cmath>

#include "truth/truth.hpp"

namespace truth {
namespace {

const char* const linear = "k*y + c*v";

double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
double place(double x, double) { return x; }
double speed(double, double v) { return v; }
double above(double x) { return x > 0 ? x : 0; }

Case law_case(const char* name, Kind kind, Law law, double k = 1, const char* baseline = linear) {
  Case each;
  each.name = name;
  each.kind = kind;
  each.baseline = baseline;
  if (kind == Kind::effect) each.effects = {name};
  each.physics.law = std::make_shared<const Law>(std::move(law));
  each.physics.k = k;
  return each;
}

Case effect(const char* name, Law law, double k = 1, const char* baseline = linear) {
  return law_case(name, Kind::effect, std::move(law), k, baseline);
}

/// The same with what its parameters are.
Case knowing(Case each, std::vector<TrueParameter> parameters) {
  each.parameters = std::move(parameters);
  return each;
}

Case that_only_a_force_shows(Case each) {
  each.in_decay = false;
  return each;
}

/// Dry friction that is rounded at rest, over a twentieth of the speed.
Case rounded_friction() {
  Case each = law_case("rounded_friction", Kind::effect,
                       laws::of_motion([](double, double v) { return 0.2 * std::tanh(v / 0.1); }));
  each.effects = {"coulomb_friction"};
  each.parameters = {{"coulomb_friction", "Fc", 0.2, 1, 0, 0}, {"coulomb_friction", "vr", 0.1, 0, 0, 1}};
  return each;
}

std::vector<Case> of_the_motion() {
  using laws::of_motion;
  return {
      effect("linear_stiffness", of_motion([](double x, double) { return 0.4 * x; }), 0, "c*v"),
      knowing(effect("quintic_stiffness", of_motion([](double x, double) { return 0.012 * std::pow(x, 5); })),
              {{"quintic_stiffness", "k5", 0.012, 1, -5, 0}}),
      effect("bilinear_stiffness", of_motion([](double x, double) { return 0.6 * above(x - 0.3); })),
      effect("saturating_stiffness", of_motion([](double x, double) { return 0.5 * std::tanh(2 * x); }), 0.7),
      effect("preload", of_motion([](double x, double) { return 0.25 * sign(x); }, place)),
      effect("sinusoidal_stiffness", of_motion([](double x, double) { return 0.25 * std::sin(3.5 * x); })),
      effect("odd_quadratic_stiffness", of_motion([](double x, double) { return 0.15 * std::abs(x) * x; })),
      effect("impact_hunt_crossley",
             of_motion([](double x, double v) { return std::pow(above(x - 0.7), 1.5) * above(1 + 0.5 * v); })),
      knowing(effect("cubic_damping", of_motion([](double, double v) { return 0.05 * v * v * v; })),
              {{"cubic_damping", "c3", 0.05, 1, 0, -3}}),
      knowing(effect("power_law_damping",
                     of_motion([](double, double v) { return 0.2 * std::sqrt(std::abs(v)) * sign(v); }, speed)),
              {{"power_law_damping", "c", 0.2, 1, 0, -0.5}, {"power_law_damping", "p", 0.5}}),
      effect("van_der_pol_damping", of_motion([](double x, double v) { return 0.12 * x * x * v; })),
      effect("asymmetric_damping", of_motion([](double, double v) { return 0.25 * above(v); })),
      rounded_friction(),
      effect("position_dependent_friction",
             of_motion([](double x, double v) { return (0.05 + 0.15 * std::abs(x)) * sign(v); }, speed)),
      effect("stribeck_friction",
             of_motion([](double, double v) { return (0.15 + 0.25 * std::exp(-v * v / 0.06)) * sign(v); }, speed)),
      effect("hyperbolic_soil", of_motion([](double x, double) { return x / (1 + std::abs(x) / 0.6); }), 0.5),
  };
}

/// In units of g it differs from machine to machine: at 32 g (micrometres and kHz) and at 3 g nothing is left of its
/// limit from the first period on, and at 0.4 g it follows the vibration.
Case liquefied_sand() {
  const Scale& scale = scale_named("metre");
  const double g = 9.80665 / (scale.omega() * scale.omega() * scale.length);
  Case each = effect("vibro_liquefaction", laws::liquefaction(2, 0.9, 0.1, g, 12), 0.8);
  each.only_at = scale.name;
  return each;
}

std::vector<Case> with_memory() {
  using namespace laws;
  Wear wear{0.6, 0.6, 0.7, 1};
  wear.weaker = 1e-3, wear.softer = 2e-3;
  wear.pinched = 0.8, wear.q = 0.1, wear.p = 0.2;
  const auto softening = [](double z, double, double path) { return (0.15 + 0.35 * std::exp(-path / 150)) * z; };
  return {
      effect("fractional_damping", fractional(0.25, 0.5)),
      knowing(effect("elastic_slip", slip(1, [](double, double, double) { return 0.35; }), 0.8),
              {{"elastic_slip", "k", 1, 1, -1, 0}, {"elastic_slip", "Fs", 0.35, 1, 0, 0}}),
      effect("iwan", masing([](double x) { return 0.9 * x / std::pow(1 + std::pow(1.5 * x, 2.0), 0.5); }, 20), 0.8),
      effect("dahl_friction", dahl(1.5, 0.35)),
      effect("lugre_friction", lugre(3, 0.15, 0.2, 0.4, 0.4)),
      knowing(effect("maxwell_relaxation", maxwell(0.5, 1)),
              {{"maxwell_relaxation", "k", 0.5, 1, -1, 0}, {"maxwell_relaxation", "tau", 1, 0, 1, -1}}),
      effect("friction_lift_off", slip(1, [](double x, double, double) { return above(0.35 + 0.25 * x); }), 0.8),
      effect("masing_soil", masing([](double x) { return x / (1 + std::abs(x) / 0.5); }, 60), 0.8),
      effect("smith_shaft", quake(0.3, [](double z, double v, double) { return 0.25 * (z + 0.5 * std::abs(z) * v); })),
      effect("smith_toe", toe(1.2, 1.0, 0.3)),
      effect("rate_power_law",
             quake(0.3, [](double z, double v,
                           double) { return 0.2 * (z + 0.8 * std::abs(z) * std::pow(std::abs(v), 0.3) * sign(v)); })),
      effect("shaft_softening", that_ages(quake(0.25, softening))),
      effect("soil_plug", plug(0.4, 2, 0.25)),
      effect("degrading_resistance",
             that_ages(slip(2, [](double, double, double work) { return 0.5 * (0.3 + 0.7 * std::exp(-work / 40)); }))),
      effect("setup_recovery", recovery(2, 0.1, 0.5, 250)),
      knowing(effect("hidden_mode", hidden_mass(0.12, 0.2, 0.02)), {{"hidden_mode", "mh", 0.12, 1, 1, -2},
                                                                    {"hidden_mode", "kh", 0.2, 1, -1, 0},
                                                                    {"hidden_mode", "ch", 0.02, 1, 0, -1}}),
      effect("pinching_degrading_hysteresis", that_ages(pinching(wear)), 0.7),
      effect("depth_resistance", depth(2, 0.35, 0.5, 4), 0.8),
      liquefied_sand(),
  };
}

std::vector<Case> of_inertia_and_time() {
  using namespace laws;
  return {
      that_only_a_force_shows(
          effect("added_mass", inertia([](double, double) { return 0.25; }, [](double, double) { return 0.0; }))),
      effect("velocity_dependent_mass",
             inertia([](double, double v) { return 0.12 * v; }, [](double, double) { return 0.0; })),
      effect("displacement_dependent_mass",
             inertia([](double x, double) { return 0.1 * x * x; }, [](double x, double v) { return 0.1 * x * v * v; })),
      effect("stiffness_drift", of_time([](double tau, double x, double) { return 4e-4 * tau * x; }), 0.8),
      effect("damping_drift", of_time([](double tau, double, double v) { return 4.4e-4 * tau * v; })),
      effect("parametric_stiffness",
             of_time([](double tau, double x, double) { return 0.25 * std::cos(0.37 * tau) * x; })),
      effect("missing_harmonic", of_time([](double tau, double, double) { return 0.2 * std::cos(1.73 * tau + 0.4); })),
      effect("crane_lowering", of_time([](double tau, double x, double) { return 0.6 * above(x + 0.2 - 1e-3 * tau); })),
  };
}

Case pair(const char* name, const char* first, const char* second, const Law& a, const Law& b, double k = 1) {
  Case each = law_case(name, Kind::pair, laws::both(a, b), k);
  each.effects = {first, second};
  return each;
}

/// Two entries of different families.
std::vector<Case> pairs_of_laws() {
  using laws::of_motion;
  const Law cubic = of_motion([](double x, double) { return 0.06 * x * x * x; });
  const Law even = of_motion([](double x, double) { return 0.12 * x * x; });
  const Law drag = of_motion([](double, double v) { return 0.1 * std::abs(v) * v; });
  return {
      pair("maxwell+cubic", "maxwell_relaxation", "cubic_stiffness", laws::maxwell(0.5, 1), cubic),
      pair("slip+quadratic", "elastic_slip", "quadratic_stiffness",
           laws::slip(1, [](double, double, double) { return 0.35; }), even, 0.8),
      that_only_a_force_shows(
          pair("mass+cubic", "added_mass", "cubic_stiffness",
               laws::inertia([](double, double) { return 0.25; }, [](double, double) { return 0.0; }), cubic)),
      pair("harmonic+drag", "missing_harmonic", "quadratic_drag",
           laws::of_time([](double tau, double, double) { return 0.2 * std::cos(1.73 * tau + 0.4); }), drag),
  };
}

std::vector<Case> beyond_the_catalogue() {
  using laws::of_motion;
  const auto outside = [](const char* name, Law law) { return law_case(name, Kind::outside, std::move(law)); };
  return {
      outside("outside_damping_in_a_gap", of_motion([](double x, double v) { return 0.6 * (x > 0.6 && x < 1.4) * v; },
                                                    [](double x, double) { return (x - 0.6) * (x - 1.4); })),
      outside("outside_y_abs_v", of_motion([](double x, double v) { return 0.25 * x * std::abs(v); })),
  };
}

}  // namespace

std::vector<Case> catalogue_cases() {
  std::vector<Case> all;
  for (const auto& part :
       {of_the_motion(), with_memory(), of_inertia_and_time(), pairs_of_laws(), beyond_the_catalogue()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace truth
