// What the automatic choice costs beside the better of its two methods: counted work, no time.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::force_of;
using testing::model_of;
using testing::state;
using testing::StateText;
using testing::theta_of;
using testing::with_solver;
using testing::zero_force;

/// Evaluations of the rate, those on the way included; a step of SUNDIALS counts as 20 more (docs/methods.md).
double work(const RunSummary& s) {
  const bool sundials = s.solver.starts_with("CVODE");
  return static_cast<double>(s.evaluations + s.tried) + (sundials ? 20.0 * static_cast<double>(s.steps) : 0);
}

struct Case {
  const char* name;
  Model model;
  std::vector<double> x0;
  double force;  ///< [N] of a sampled force
  double duration, dt;
  const char* solver;  ///< that should be taken
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  return {
      {"stiff_from_the_start",
       model_of("1", "y - 1000*(1 - y^2)*v"),
       {2, 0},
       0,
       200,
       0.05,
       "CVODE BDF (auto: fast decays hold explicit steps down)"},
      {"stiff_later",
       model_of("1", "y + 0.1*v + 0.1*z", {{"z", "(1 + 2000*max(t - 2, 0)^2)*(y - z)", "", ""}}),
       {1, 0, 1},
       0,
       5,
       0.01,
       "CVODE BDF (auto: "},
      {"fast_decay_and_explicit",
       model_of("1", "100*y + v + z", {{"z", "400*(v - z)", "", ""}}),
       {0.1, 0, 0},
       3,
       20,
       0.01,
       "fixed DP5, "},
      {"not_stiff", model_of("1", "100*y + v"), {0.1, 0}, 3, 20, 0.01, "fixed DP5, "},
  };
}

class Automatic : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, Automatic, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(Automatic, CostsAtMostTwiceTheBetterMethod) {
  const Case& c = GetParam();
  const System system(c.model);
  std::vector<double> samples;
  for (int i = 0; i <= static_cast<int>(std::lround(c.duration / c.dt)); ++i)
    samples.push_back(c.force * std::sin(0.05 * i + 0.3 * std::sin(0.4 * i)));
  const Excitation force(0, c.dt, samples);
  const Eigen::VectorXd x0 = Eigen::Map<const Eigen::VectorXd>(c.x0.data(), static_cast<Eigen::Index>(c.x0.size()));
  const auto run = [&](Solver solver) { return simulate(system, {}, force, x0, with_solver(solver)); };
  const lunid::Run fixed = run(Solver::fixed), bdf = run(Solver::bdf), automatic = run(Solver::automatic);
  ASSERT_TRUE(automatic.summary.completed) << automatic.summary.cause;
  EXPECT_EQ(automatic.summary.solver.substr(0, std::string(c.solver).size()), c.solver);
  const double better = std::min(fixed.summary.completed ? work(fixed.summary) : HUGE_VAL, work(bdf.summary));
  // explicit runs before the first sign of stiffness are two of one substep at most
  EXPECT_LT(work(automatic.summary), 2.1 * better) << "fixed " << work(fixed.summary) << " bdf " << work(bdf.summary);
  EXPECT_LT((automatic.x - bdf.x).cwiseAbs().maxCoeff(), 1e-3 * bdf.x.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace lunid
