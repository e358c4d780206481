// Stiff models: the published test set for initial value problems, van der Pol's period, and explicit methods that stop
// and say which to take.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::state;
using testing::StateText;
using testing::theta_of;
using testing::with_solver;
using testing::zero_force;

/// A problem of first order beside an oscillator at rest.
struct Published {
  const char* name;
  std::vector<StateText> states;
  double end;
  std::vector<double> expected;
  double atol = 0;  ///< times rtol, where the end is far smaller than what came before

  friend void PrintTo(const Published& p, std::ostream* out) { *out << p.name; }
};

StateText with(const char* name, const char* rate, double initial) { return {name, rate, "", "", initial}; }

const std::vector<StateText> robertson{with("A", "-0.04*A + 1e4*B*C", 1), with("B", "0.04*A - 1e4*B*C - 3e7*B^2", 0),
                                       with("C", "3e7*B^2", 0)};

// End values: Mazzia & Magherini 2008, Test set for initial value problem solvers, release 2.4 (van der Pol, HIRES,
// Orego, Robertson at 1e11); Robertson at 40: Hindmarsh's LSODE, whose table agrees with it to the digits that it
// prints.
const Published published[] = {
    {"van_der_pol",
     {with("p", "q", 2), with("q", "((1 - p^2)*q - p)/1e-6", 0)},
     2,
     {1.706167732170483, -0.8928097010247975}},
    {"robertson_40", robertson, 40, {0.7158270687194, 9.185534764558e-6, 0.2841637457459}},
    {"robertson_1e11", robertson, 1e11, {2.083340149701255e-8, 8.333360770334713e-14, 0.9999999791665050}, 1e-14},
    {"hires",
     {with("u", "-1.71*u + 0.43*w + 8.32*r + 0.0007", 1), with("w", "1.71*u - 8.75*w", 0),
      with("r", "-10.03*r + 0.43*s + 0.035*p", 0), with("s", "8.32*w + 1.71*r - 1.12*s", 0),
      with("p", "-1.745*p + 0.43*q + 0.43*g", 0), with("q", "-280*q*h + 0.69*s + 1.71*p - 0.43*q + 0.69*g", 0),
      with("g", "280*q*h - 1.81*g", 0), with("h", "-280*q*h + 1.81*g", 0.0057)},
     321.8122,
     {7.371312573325668e-4, 1.442485726316185e-4, 5.888729740967575e-5, 1.175651343283149e-3, 2.386356198831331e-3,
      6.238968252742796e-3, 2.849998395185769e-3, 2.850001604814231e-3}},
    {"orego",
     {with("p", "77.27*(q + p*(1 - 8.375e-6*p - q))", 1), with("q", "(r - (1 + p)*q)/77.27", 2),
      with("r", "0.161*(p - r)", 3)},
     360,
     {1.000814870318523, 1228.178521549917, 132.0554942846706},
     1},
};

class TestSet : public ::testing::TestWithParam<Published> {};
constexpr auto name_of = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Problems, TestSet, ::testing::ValuesIn(published), name_of);

/// Those that explicit methods may try within the test's time: robertson_1e11 is robertson_40 for longer.
class ShortTestSet : public TestSet {};
INSTANTIATE_TEST_SUITE_P(Problems, ShortTestSet, ::testing::ValuesIn([] {
                           std::vector<Published> some;
                           for (const Published& problem : published)
                             if (problem.end <= 1e6) some.push_back(problem);
                           return some;
                         }()),
                         name_of);

constexpr int rows = 20;

lunid::Run run_of(const Published& problem, Solver solver, double rtol) {
  const System system(model_of("1", "y", problem.states));
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
  for (std::size_t i = 0; i < problem.states.size(); ++i)
    x0[2 + static_cast<Eigen::Index>(i)] = problem.states[i].initial;
  SimulateOptions options = with_solver(solver, rtol);
  options.atol = problem.atol * rtol;
  return simulate(system, {}, zero_force(problem.end, problem.end / rows), x0, options);
}

double worst_end(const Published& problem, const lunid::Run& run) {
  double worst = 0;
  for (std::size_t i = 0; i < problem.expected.size(); ++i)
    worst = std::max(worst, std::abs(run.x(rows, 2 + static_cast<Eigen::Index>(i)) / problem.expected[i] - 1));
  return worst;
}

// Errors of single steps add up and are amplified: published codes end at 10 to 1000 times their tolerance.
TEST_P(TestSet, EndsAtItsPublishedValuesByTheImplicitMethods) {
  for (const Solver solver : {Solver::bdf, Solver::esdirk})
    for (const double rtol : {1e-6, 1e-8, 1e-10}) {
      const lunid::Run run = run_of(GetParam(), solver, rtol);
      ASSERT_TRUE(run.summary.completed) << run.summary.solver << ": " << run.summary.cause;
      EXPECT_LT(worst_end(GetParam(), run), 2000 * rtol) << run.summary.solver << " at rtol " << rtol;
    }
}

/// The other methods end where these problems end, or stop early and say which to take; none is silently wrong.
TEST_P(ShortTestSet, IsNeverSilentlyWrongByTheOthers) {
  for (const Solver solver : {Solver::rk23, Solver::rk45, Solver::rk78, Solver::adams}) {
    const lunid::Run run = run_of(GetParam(), solver, 1e-6);
    if (run.summary.completed)
      EXPECT_LT(worst_end(GetParam(), run), 0.02) << run.summary.solver;
    else
      EXPECT_TRUE(run.summary.cause.ends_with("; take solver = \"bdf\" or \"esdirk\"")) << run.summary.cause;
  }
}

System van_der_pol() { return System(model_of("1", "y - mu*(1 - y^2)*v")); }

/// Times at which y rises through zero.
std::vector<double> rises(const lunid::Run& run) {
  std::vector<double> times;
  for (Eigen::Index i = 0; i + 1 < run.x.rows(); ++i) {
    const double y0 = run.x(i, 0), y1 = run.x(i + 1, 0);
    if (y0 < 0 && y1 >= 0) times.push_back(run.dt * (static_cast<double>(i) - y0 / (y1 - y0)));
  }
  return times;
}

// The period of the relaxation oscillation at mu = 1000, by Dorodnitsyn's series (1947, Prikl. Mat. Mekh. 11, 313):
// (3 - 2 ln 2) mu + 7.01432 mu^(-1/3) - 22/9 ln(mu)/mu + 0.0087/mu. The jumps last 1 / mu, so that they are known
// to a sample.
TEST(VanDerPol, HasItsPublishedPeriodAtMuOfAThousand) {
  const double mu = 1000;
  const double period =
      (3 - 2 * std::log(2.0)) * mu + 7.01432 * std::pow(mu, -1.0 / 3) - 22.0 / 9 * std::log(mu) / mu + 0.0087 / mu;
  const System system = van_der_pol();
  for (const auto& [solver, dt] :
       {std::pair(Solver::bdf, 0.05), std::pair(Solver::esdirk, 0.1), std::pair(Solver::automatic, 0.25)}) {
    const lunid::Run run = simulate(system, theta_of(system, {{"mu", mu}}), zero_force(3500, dt), state({2, 0}),
                                    with_solver(solver, 1e-9));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    const std::vector<double> at = rises(run);
    ASSERT_EQ(at.size(), 2) << run.summary.solver;
    EXPECT_NEAR(at[1] - at[0], period, dt) << run.summary.solver;
  }
}

TEST(VanDerPol, StopsExplicitMethodsWhichSayWhatToTake) {
  const System system = van_der_pol();
  for (const Solver solver : {Solver::rk23, Solver::rk45, Solver::rk78})
    for (const double dt : {1.0, 500.0}) {  // many steps in each of many samples; too many in one
      const lunid::Run run =
          simulate(system, theta_of(system, {{"mu", 1000}}), zero_force(1500, dt), state({2, 0}), with_solver(solver));
      ASSERT_FALSE(run.summary.completed) << run.summary.solver;
      EXPECT_LT(run.summary.steps, 30000) << run.summary.solver;
      EXPECT_EQ(run.summary.cause.substr(0, 42), "the model is stiff: its fastest decay, 0.0") << run.summary.cause;
      EXPECT_NE(run.summary.cause.find(" s, holds the steps of " + run.summary.solver + " down to 0.0"),
                std::string::npos);
      EXPECT_TRUE(run.summary.cause.ends_with(" s; take solver = \"bdf\" or \"esdirk\"")) << run.summary.cause;
    }
  const lunid::Run fixed =
      simulate(system, theta_of(system, {{"mu", 1e5}}), zero_force(1500, 1), state({2, 0}), with_solver(Solver::fixed));
  EXPECT_FALSE(fixed.summary.completed);
  EXPECT_EQ(fixed.summary.cause,
            "steps of 1/4096 sample are unstable: the model is stiff; take solver = \"bdf\" or \"esdirk\"");
}

// Many steps are no stiffness: those of a fast oscillation, of a tight tolerance, of an early transient.
TEST(Stiffness, IsNotSaidOfWhatIsMerelyFast) {
  const System fast(model_of("1", "1e6*y + 0.5*v"));
  const System transient(model_of("1", "y + v + z", {{"z", "-3000*z", "", "", 1}}));
  for (const Solver solver : {Solver::rk23, Solver::rk45, Solver::rk78}) {
    const lunid::Run run = simulate(fast, {}, zero_force(30, 1), state({1, 0}), with_solver(solver, 1e-6));
    EXPECT_TRUE(run.summary.completed) << run.summary.cause;
    EXPECT_GT(run.summary.steps, 20000);
    EXPECT_TRUE(simulate(transient, {}, zero_force(1, 0.01), state({1, 0, 1}), with_solver(solver)).summary.completed);
  }
}

}  // namespace
}  // namespace lunid
