// A model's table, its equation, its faults, and terms in the acceleration.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;

std::string fault_in(const Model& model) {
  return fault_of([&] { complete(model); });
}

TEST(Model, TableGetsARowForEachParameterInOrderOfAppearance) {
  Model model = model_of("m", "c*v + k*z", {{"z", "v - b*z", "", "zmax"}});
  Parameter k;
  k.name = "k";
  k.value = 3;
  k.min = 0;
  model.parameters.push_back(k);
  const Model whole = complete(model);
  std::vector<std::string> names;
  for (const Parameter& p : whole.parameters) names.push_back(p.name);
  EXPECT_EQ(names, (std::vector<std::string>{"k", "m", "c", "b", "zmax"}));
  EXPECT_EQ(whole.find("k")->value, 3);
  EXPECT_TRUE(std::isnan(whole.find("m")->value));
  EXPECT_EQ(whole.find("q"), nullptr);
  const System system(whole);
  EXPECT_EQ(system.parameters(), 5);
  EXPECT_EQ(system.states(), 3);
}

TEST(Model, EquationIsReadable) {
  EXPECT_EQ(model_of("49", "k*y + c*v").equation(), "49*a + k*y + c*v = F");
  EXPECT_EQ(model_of("0", "c*v", {}, true).equation(), "c*v = F");
  EXPECT_EQ(model_of("m", "k*z", {{"z", "v", "-1", "1"}}).equation(), "m*a + k*z = F\ndz/dt = v, -1 <= z <= 1");
}

TEST(Model, FaultsNameWhatIsWrong) {
  EXPECT_EQ(fault_in(Model{}), "model: no pool of expressions");
  EXPECT_EQ(fault_in(model_of("-1", "k*y")), "model: mass: expected > 0, got -1 (a mass of 0 needs imposed motion)");
  EXPECT_EQ(fault_in(model_of("0", "k*y")), "model: mass: expected > 0, got 0 (a mass of 0 needs imposed motion)");
  EXPECT_EQ(fault_in(model_of("0", "k*y", {}, true)), "");
  EXPECT_EQ(fault_in(model_of("-2", "k*y", {}, true)), "model: mass: expected >= 0, got -2");
  EXPECT_EQ(fault_in(model_of("1", "k*y + b*a^2")),
            "model: restoring: terms in a must be a times something without a, got a^2");
  EXPECT_EQ(fault_in(model_of("1", "k*y + b*abs(a)")),
            "model: restoring: terms in a must be a times something without a, got abs(a)");
  EXPECT_EQ(fault_in(model_of("1", "k*y + b*sign(a)")),
            "model: restoring: terms in a must be a times something without a, got sign(a)");
  EXPECT_EQ(fault_in(model_of("1", "k*y + g*F")),
            "model: restoring: cannot hold the channel 'F' (it may hold y v a t yb vb ab)");
  EXPECT_EQ(fault_in(model_of("m*a", "k*y")), "model: mass: cannot hold the channel 'a' (it may hold y v t)");

  Model model = model_of("1", "k*y");
  Parameter p;
  p.name = "q";
  model.parameters = {p};
  EXPECT_EQ(fault_in(model), "model: parameter 'q' is in no expression of the model");
  p.name = "k";
  p.min = 5;
  p.max = 3;
  model.parameters = {p};
  EXPECT_EQ(fault_in(model), "model: parameter 'k': min 5 is above max 3");
  p.max = 8;
  p.value = 10;
  model.parameters = {p};
  EXPECT_EQ(fault_in(model), "model: parameter 'k': the first guess 10 is outside its bounds 5 to 8");
  p.value = std::numeric_limits<double>::infinity();
  model.parameters = {p};
  EXPECT_EQ(fault_in(model), "model: parameter 'k': expected a finite first guess, got inf");
  p.value = 6;
  model.parameters = {p, p};
  EXPECT_EQ(fault_in(model), "model: parameter 'k' is given twice");
  EXPECT_EQ(fault_of([&] { model.set_values({1}); }), "model: expected 2 parameter values, got 1");
}

TEST(Model, FaultsOfStatesNameTheState) {
  Model model = model_of("1", "k*z", {{"z", "v", "", ""}});
  model.states[0].rate = Expr();
  EXPECT_EQ(fault_in(model), "model: state 'z': no rate is given");
  model = model_of("1", "k*z", {{"z", "v", "", ""}});
  model.states.clear();
  EXPECT_EQ(fault_in(model), "model: restoring: the state 'z' has no rate");
  model = model_of("1", "k*z", {{"z", "v", "2", "1"}});
  EXPECT_EQ(fault_in(model), "model: state 'z': min 2 is above max 1");
  model = model_of("1", "k*z", {{"z", "v", "", "", std::nan("")}});
  EXPECT_EQ(fault_in(model), "model: state 'z': initial: expected a finite value, got nan");
  model = model_of("1", "k*z", {{"w", "v", "-1", "1"}, {"z", "v", "", "w"}});
  EXPECT_EQ(fault_in(model), "model: state 'z': max: depends on the state 'w', which is bounded itself");
  model.states.push_back(model.states[0]);
  EXPECT_EQ(fault_in(model), "model: state 'w' is declared twice");
}

TEST(Model, RatesMayHoldTheForceOnlyWhereTheMotionIsFree) {
  EXPECT_EQ(fault_of([] { System(model_of("1", "z", {{"z", "F - z", "", ""}})); }), "");
  EXPECT_EQ(fault_of([] {
              System(model_of("1", "z", {{"z", "F - z", "", ""}}, true));
            }),
            "model: the rate of a state holds F, which is the output where the motion is imposed");
}

TEST(Model, StatesOfAnImposedMotionFollowSoManyChannels) {
  Model model = model_of("0", "z*y1", {{"z", "yb - z", "", ""}}, true);
  for (int i = 2; i <= 5; ++i)
    model.further.push_back({parse(*model.pool, "0"), parse(*model.pool, "y" + std::to_string(i))});
  EXPECT_EQ(fault_of([&] { System{model}; }), "");
  model.restoring = model.restoring + model.pool->channel("vb");
  EXPECT_EQ(fault_of([&] { System{model}; }),
            "model: the states of an imposed motion can follow 16 channels at most, got 17 of coordinates, base and "
            "shaft");
}

// Terms affine in a are mass: the same motion as with the heavier mass.
TEST(Model, AddedMassIsMass) {
  const Excitation force = force_of(3, 0.01, [](double t) { return std::sin(7 * t) + 0.5; });
  const auto run_of = [&](const char* mass, const char* restoring) {
    const System system(model_of(mass, restoring));
    return simulate(system, std::vector<double>(system.parameters(), 0.7), force, state({0.1, 0.2}), with_substeps(4));
  };
  const lunid::Run heavy = run_of("2 + p", "30*y + 0.4*v");
  EXPECT_LT((run_of("2", "30*y + p*a + 0.4*v").x - heavy.x).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((run_of("2", "-(-(30*y) - p*a) + 0.4*v").x - heavy.x).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((run_of("2", "where(t > 100, y, (60*y + 2*a*p)/2) + 0.4*v").x - heavy.x).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((run_of("2", "30*y + p*a + 0.4*v").a - heavy.a).cwiseAbs().maxCoeff(), 1e-13);
}

// m1 (y^2 a + y v^2) is the force of the energy m1 y^2 v^2 / 2 (a mass on a curve): energy is kept.
TEST(Model, DisplacementDependentMassKeepsItsEnergy) {
  const System system(model_of("1", "k*y + m1*(y^2*a + y*v^2)"));
  const auto theta = theta_of(system, {{"k", 40}, {"m1", 2}});
  const lunid::Run run = simulate(system, theta, testing::zero_force(5, 0.005), state({0.8, 0}), with_substeps(4));
  const auto y = run.x.col(0).array(), v = run.x.col(1).array();
  const Eigen::ArrayXd energy = 0.5 * (1 + 2 * y.square()) * v.square() + 20 * y.square();
  EXPECT_LT((energy - energy[0]).abs().maxCoeff(), 1e-7 * energy[0]);  // far above the method at 1/800 of the period
}

}  // namespace
}  // namespace lunid
