// Orders of convergence, measured: the fixed path by halving its step, SUNDIALS by its tolerance; and sensitivities
// against differences of the sixth order.
#include <ostream>

#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::force_of;
using testing::model_of;
using testing::model_of_many;
using testing::state;
using testing::StateText;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;

struct OrderCase {
  const char* name;
  std::vector<std::pair<std::string, std::string>> rows;
  std::vector<StateText> states;
  int coarsest;

  friend void PrintTo(const OrderCase& c, std::ostream* out) { *out << c.name; }
};

// Steps are split at switches, so that the order is that of smooth motion on either side.
const OrderCase ladders[] = {
    {"smooth", {{"1 + 0.2*y^2", "0.5*v + 30*y + 300*y^3"}}, {}, 1},
    {"two_degrees", {{"1", "30*y1 + 300*(y1 - y2)^3 + 0.5*v1"}, {"0.5", "300*(y2 - y1)^3 + 0.2*v2"}}, {}, 1},
    {"internal_state", {{"1", "30*y + 20*z"}}, {{"z", "v - 4*z + 0.1*z^2", "", ""}}, 1},
    {"sliding_friction", {{"1", "30*y + 0.4*sign(v)"}}, {}, 1},
    {"stop", {{"1", "30*y + 0.5*v + 400*max(y - 0.06, 0)"}}, {}, 2},
    {"elastic_slip", {{"1", "10*y + r"}}, {{"r", "60*v", "-0.8", "0.8"}}, 1},
};

class Ladder : public ::testing::TestWithParam<OrderCase> {};
INSTANTIATE_TEST_SUITE_P(Fixed, Ladder, ::testing::ValuesIn(ladders),
                         [](const auto& info) { return std::string(info.param.name); });

lunid::Run fixed_run(const OrderCase& c, int substeps) {
  const System system(model_of_many(c.rows, c.states));
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
  x0[0] = 0.1;
  x0[1] = 0.3;
  return simulate(system, {},
                  force_of(4, 0.04, [](double t) { return 4 * std::sin(5 * t) + 2 * std::sin(11 * t + 1); }), x0,
                  with_substeps(substeps));
}

TEST_P(Ladder, OfHalvedStepsFallsInTheFifthOrder) {
  const lunid::Run fine = fixed_run(GetParam(), 128);
  ASSERT_TRUE(fine.summary.completed) << fine.summary.cause;
  double first = 0, last = 0;
  const int doublings = 3;
  for (int i = 0; i <= doublings; ++i) {
    const lunid::Run run = fixed_run(GetParam(), GetParam().coarsest << i);
    last = (run.x.col(0) - fine.x.col(0)).cwiseAbs().maxCoeff();
    if (i == 0) first = last;
  }
  const double order = std::log2(first / last) / doublings;
  EXPECT_GT(order, 4.5) << first << " -> " << last;
  EXPECT_LT(order, 6.5) << first << " -> " << last;
}

// The error follows the tolerance: two decades of it are one and a half to two and a half of the error.
TEST(Ladder, OfTolerancesFallsWithThem) {
  const System system(model_of("1", "0.5*v + 30*y + 300*y^3"));
  const Excitation force = force_of(4, 0.04, [](double t) { return 4 * std::sin(5 * t); });
  const lunid::Run fine = simulate(system, {}, force, state({0.1, 0.3}), with_substeps(256));
  for (const Solver solver : all_solvers()) {
    if (solver == Solver::automatic || solver == Solver::fixed) continue;
    const auto error = [&](double rtol) {
      const lunid::Run run = simulate(system, {}, force, state({0.1, 0.3}), with_solver(solver, rtol));
      EXPECT_TRUE(run.summary.completed) << run.summary.cause;
      return (run.x.col(0) - fine.x.col(0)).cwiseAbs().maxCoeff();
    };
    const double coarse = error(1e-6), tight = error(1e-10);
    // a step of a whole sample is better than that already with the method of order 8
    EXPECT_TRUE(coarse / tight > 1e3 || coarse < 1e-9) << to_string(solver) << " " << coarse << " -> " << tight;
    EXPECT_LT(tight, 1e-7) << to_string(solver);
  }
}

// The sensitivities are those of the steps themselves, so that only rounding separates them from good differences:
// three pairs of points cancel all errors up to h^6.
TEST(Sensitivities, AreDifferencesOfTheSixthOrder) {
  struct Case {
    std::vector<std::pair<std::string, std::string>> rows;
    std::vector<StateText> states;
  };
  const Case table[] = {
      {{{"m", "c*v + k*y + b*y^3"}}, {}},
      {{{"m", "k*(y1 - y2) + b*y1^3 + c*v1"}, {"0.7*m", "k*(y2 - y1) + c*v2*y2^2"}}, {}},
      {{{"m", "k*y + b*z + c*v"}}, {{"z", "v - b*z^3 - c*z", "", ""}}},
      {{{"m", "k*y1 + b*z"}, {"m", "k*(y2 - y1) + c*v2 - b*w"}},
       {{"z", "v1 - c*z*w", "", ""}, {"w", "y2 - w", "", ""}}},
  };
  for (const auto& [rows, states] : table) {
    const System system(model_of_many(rows, states));
    const std::vector<double> theta = theta_of(system, {{"m", 1.3}, {"c", 0.4}, {"k", 40}, {"b", 9}});
    const Excitation force = force_of(2, 0.02, [](double t) { return 3 * std::sin(7 * t) + 1; });
    const int p = system.parameters(), n = system.states();
    const Eigen::VectorXd x0 = Eigen::VectorXd::LinSpaced(n, 0.3, -0.2);
    const SensitivityRun exact = simulate_sensitivities(system, theta, force, x0, with_substeps(2));
    for (int c = 0; c < p + n; ++c) {
      const double h = 1e-2 * (c < p ? theta[c] : 0.3);
      const auto run_at = [&](double step) {
        std::vector<double> moved = theta;
        Eigen::VectorXd x = x0;
        (c < p ? moved[c] : x[c - p]) += step;
        return simulate(system, moved, force, x, with_substeps(2)).x;
      };
      const auto pair = [&](double step) { return Eigen::MatrixXd(run_at(step) - run_at(-step)); };
      const Eigen::MatrixXd slope = (45 * pair(h) - 9 * pair(2 * h) + pair(3 * h)) / (60 * h);
      for (int i = 0; i < n; ++i)
        EXPECT_LT((exact.dx[i].col(c) - slope.col(i)).cwiseAbs().maxCoeff(), 1e-6 * slope.cwiseAbs().maxCoeff())
            << system.model().equation() << " state " << i << " column " << c;
    }
  }
}

}  // namespace
}  // namespace lunid
