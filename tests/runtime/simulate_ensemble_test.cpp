// Ensembles: every member has the bits of simulate() on it alone, whatever runs beside it.
#include "simulate/ensemble.hpp"

#include "allocations.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using namespace lunid::testing;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

std::vector<double> three_tones(int rows, double amplitude) {
  std::vector<double> force(rows);
  for (int i = 0; i < rows; ++i)
    force[i] = amplitude * (std::sin(0.31 * i) + std::cos(0.9 * i + 1) + std::sin(0.07 * i * i / rows));
  return force;
}

/// Members whose parameters are `from` times 1 ... 2 and whose first states differ.
Ensemble spread(const System& system, const std::vector<double>& from, Index members, MemberForce force) {
  Ensemble e;
  e.system = &system;
  e.theta.resize(system.parameters(), members);
  e.x0.resize(system.states(), members);
  for (Index m = 0; m < members; ++m) {
    const double part = members > 1 ? static_cast<double>(m) / static_cast<double>(members - 1) : 0;
    for (int i = 0; i < system.parameters(); ++i) e.theta(i, m) = from[i] * (1 + part * (1 + 0.3 * i));
    for (int i = 0; i < system.states(); ++i) e.x0(i, m) = 0.01 * (part - 0.4) * (i + 1);
  }
  e.force = std::move(force);
  return e;
}

EnsembleOptions keeping(const System& system, std::vector<std::string> outputs, int substeps, int threads = 1) {
  EnsembleOptions options;
  for (const std::string& name : outputs) options.outputs.push_back(output_from(name, system));
  options.substeps = substeps;
  options.threads = threads;
  options.trajectories = true;
  return options;
}

/// y and a of every member are those of simulate(), and so are time and cause of an early stop (of `stopped` members).
void expect_single_runs(const Ensemble& e, const EnsembleOptions& options, Index stopped = 0) {
  const EnsembleResult result = run_ensemble(e, options);
  ASSERT_EQ(result.finished(), e.members());
  EXPECT_EQ(result.stopped(), stopped);
  ASSERT_EQ(result.signals, (std::vector<std::string>{"y", "a"}));
  for (Index m = 0; m < e.members(); ++m) {
    const std::span theta(e.theta.col(m).data(), static_cast<std::size_t>(e.theta.rows()));
    const Run run = simulate(*e.system, theta, e.force.excitation(m), e.x0.col(m), with_substeps(result.substeps));
    EXPECT_EQ(run.summary.completed, std::isnan(result.stopped_at[m])) << m;
    EXPECT_EQ(run.summary.cause, result.cause[static_cast<std::size_t>(m)]);
    if (!run.summary.completed) {
      EXPECT_EQ(run.summary.stopped_at, result.stopped_at[m]);
      EXPECT_TRUE(std::isnan(result.values(m, 0)));
      continue;
    }
    for (Index row = 0; row < run.x.rows(); ++row) {
      ASSERT_TRUE(same_bits(run.x(row, 0), result.trajectories[0](row, m))) << "member " << m << " row " << row;
      ASSERT_TRUE(same_bits(run.a(row, 0), result.trajectories[1](row, m))) << "member " << m << " row " << row;
    }
    EXPECT_EQ(result.values(m, 0), run.x.col(0).maxCoeff());
    EXPECT_NEAR(result.values(m, 1), std::sqrt(run.a.squaredNorm() / static_cast<double>(run.a.size())),
                1e-12 * run.a.cwiseAbs().maxCoeff());
  }
}

TEST(Ensemble, MembersHaveTheBitsOfSingleRuns) {
  const System duffing(model_of("m", "k*y + c*v + k3*y^3"));
  const std::vector<double> theta{1, 9e3, 4, 1e6};
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited})
    for (const int substeps : {1, 3}) {
      const Excitation excitation(0.25, 0.002, three_tones(120, 40), kind);
      for (const Index members : {1, 8, 67})
        expect_single_runs(spread(duffing, theta, members, MemberForce::of(excitation)),
                           keeping(duffing, {"max_y", "rms_a"}, substeps));
    }
}

TEST(Ensemble, AnyNumberOfStatesAndTimeInTheModel) {
  const Excitation excitation(0, 0.002, three_tones(150, 40));
  const System three(model_of("1", "k*y + z*tanh(40*y)", {{"z", "(e*y - z)*(1 + 0.3*sin(7*t))", "", "", 0.1}}));
  expect_single_runs(spread(three, {9e3, 60}, 11, MemberForce::of(excitation)), keeping(three, {"max_y", "rms_a"}, 2));
  const System four(model_of("1", "k*y + z - w", {{"z", "e*v - 3*z", "", ""}, {"w", "z - w*exp(-t)", "", ""}}));
  expect_single_runs(spread(four, {9e3, 60}, 11, MemberForce::of(excitation)), keeping(four, {"max_y", "rms_a"}, 1));
}

TEST(Ensemble, MembersMayDifferInTheirExcitation) {
  const System system(model_of("1", "k*y + c*v"));
  const MemberForce force = MemberForce::of(90, [](Index member) {
    return Excitation(0.1 * static_cast<double>(member), 0.002 + 1e-4 * static_cast<double>(member),
                      three_tones(90, 1 + static_cast<double>(member)), Interpolation::linear);
  });
  expect_single_runs(spread(system, {9e3, 4}, 13, force), keeping(system, {"max_y", "rms_a"}, 2));
}

/// amplitude*cos(omega*t) with a grid of its own for each member.
MemberForce harmonics(Pool& pool, const VectorXd& amplitude, const VectorXd& omega, Index rows, double samples) {
  const Expr t = pool.channel("t"), a = pool.parameter("amplitude"), w = pool.parameter("omega");
  const Expr force = a * pool.apply(Op::cos, {w * t}), inputs[] = {t, a, w};
  MatrixXd q(2, amplitude.size());
  q.row(0) = amplitude;
  q.row(1) = omega;
  return MemberForce::of({"F"}, TimeTape(std::span(&force, 1), inputs), q, 0,
                         (2 * std::numbers::pi / samples * omega.cwiseInverse()).eval(), rows);
}

TEST(Ensemble, AnExpressionOfTimeIsExactBetweenTheSamples) {
  const Model model = model_of("1", "k*y + c*v + k3*y^3");
  const System system(model);
  const VectorXd omega = VectorXd::LinSpaced(19, 50, 150), amplitude = VectorXd::LinSpaced(19, 1, 40);
  for (const int substeps : {1, 2})
    expect_single_runs(spread(system, {9e3, 4, 1e6}, 19, harmonics(*model.pool, amplitude, omega, 130, 24)),
                       keeping(system, {"max_y", "rms_a"}, substeps));
}

TEST(Ensemble, ModelsWithSwitchesAndBounds) {
  const System friction(model_of("1", "k*y + Fc*sign(v) + kc*max(y - 0.004, 0)"));
  const System slider(model_of("1", "k*y + z", {{"z", "e*v", "-2", "2"}}));
  const Excitation excitation(0, 0.002, three_tones(150, 40));
  expect_single_runs(spread(friction, {9e3, 6, 1e5}, 9, MemberForce::of(excitation)),
                     keeping(friction, {"max_y", "rms_a"}, 2, 2));
  expect_single_runs(spread(slider, {9e3, 700}, 9, MemberForce::of(excitation)),
                     keeping(slider, {"max_y", "rms_a"}, 2, 2));
}

// Every kind of switch, so often met that lanes are outside the bundle about as long as in it.
TEST(Ensemble, LanesLeaveAtTheirSwitchesAndComeBack) {
  const Excitation smooth(0, 0.002, three_tones(220, 40), Interpolation::cubic);
  const Excitation jumps(0, 0.002, three_tones(120, 40), Interpolation::hold);
  const std::pair<Model, std::vector<double>> models[] = {
      {model_of("1", "k*y + c*v + Fc*sign(v)"), {9e3, 3, 12}},                  // sticks
      {model_of("1", "k*y + h*max(y - 0.002, 0)^2 + 2*abs(v)*v"), {9e3, 1e7}},  // a stop and drag
      {model_of("1", "k*y + where(y > 0.001, h*y, min(3*v, 1))"), {9e3, 1e3}},  // conditions of both kinds
      {model_of("1", "k*y + P*sign(y)"), {9e3, 5}},                             // rests on a preload
      {model_of("1", "k*y + sqrt(abs(v) + 0.01) + z", {{"z", "e*v", "-2", "2"}}), {9e3, 700}},  // yields at bounds
      {model_of("1", "k*y + c*v*tanh(30*y) + Fc*sign(v - 0.05*sin(40*t))"), {9e3, 3, 8}},  // no machine code; moves
      {model_of("1", "k*y + h*max(y - 0.1*y^3 - 0.001, 0)"), {9e3, 1e5}}};                 // its gradient moves
  for (const auto& [model, theta] : models)
    for (const int substeps : {1, 3}) {
      const System system(model);
      expect_single_runs(spread(system, theta, 21, MemberForce::of(smooth)),
                         keeping(system, {"max_y", "rms_a"}, substeps));
      expect_single_runs(spread(system, theta, 9, MemberForce::of(jumps)),
                         keeping(system, {"max_y", "rms_a"}, substeps));
    }
}

TEST(Ensemble, LanesWithSwitchesMayDifferInTheirExcitation) {
  const Model model = model_of("1", "k*y + c*v + Fc*sign(v)");
  const System system(model);
  const VectorXd omega = VectorXd::LinSpaced(67, 50, 150), amplitude = VectorXd::LinSpaced(67, 1, 60);
  expect_single_runs(spread(system, {9e3, 4, 6}, 67, harmonics(*model.pool, amplitude, omega, 130, 24)),
                     keeping(system, {"max_y", "rms_a"}, 2, 2));
}

TEST(Ensemble, ALaneWithSwitchesThatStopsLeavesTheOthersAlone) {
  const System system(model_of("1", "k*y + c*v - k3*y^3 + Fc*sign(v)"));
  Ensemble e = spread(system, {100, 1, 1, 2}, 21, MemberForce::of(Excitation(0, 0.01, three_tones(300, 20))));
  for (const Index m : {0, 7, 8, 20}) e.theta(2, m) = 4e4;
  expect_single_runs(e, keeping(system, {"max_y", "rms_a"}, 2), 4);
}

TEST(Ensemble, SeveralDegreesOfFreedomAndInputs) {
  const System system(model_of_many({{"1", "k*y1 + c*v1 + h*(y1 - y2)^3"}, {"2", "h*(y2 - y1)^3 + k*y2"}}));
  const Excitation first(0, 0.002, three_tones(150, 40)), second(0, 0.002, three_tones(150, -7));
  Excitations both;
  both.add("F1", first).add("F2", second);
  for (const MemberForce& force : {MemberForce::of(both), MemberForce::of(first)}) {
    const Ensemble e = spread(system, {9e3, 4, 1e6}, 21, force);
    const EnsembleResult result = run_ensemble(e, keeping(system, {"max_y2", "rms_a1"}, 2));
    for (Index m = 0; m < 21; ++m) {
      const std::span theta(e.theta.col(m).data(), 3);
      const lunid::Run run = simulate(system, theta, e.force.excitation(m), e.x0.col(m), with_substeps(2));
      EXPECT_EQ((run.x.col(2) - result.trajectories[0].col(m)).cwiseAbs().maxCoeff(), 0);
      EXPECT_EQ((run.a.col(0) - result.trajectories[1].col(m)).cwiseAbs().maxCoeff(), 0);
    }
  }
}

TEST(Ensemble, AMemberThatExplodesIsAResultAndLeavesTheOthersAlone) {
  const Model model = model_of("1", "k*y + c*v - k3*y^3");
  const System system(model);
  Ensemble e = spread(system, {100, 1, 1}, 21, MemberForce::of(Excitation(0, 0.01, three_tones(300, 20))));
  for (const Index m : {0, 7, 8, 20}) e.theta(2, m) = 4e4;
  e.theta(1, 3) = -500;  // grows past the bound and stays finite for a while
  expect_single_runs(e, keeping(system, {"max_y", "rms_a"}, 2), 5);
  e.force = harmonics(*model.pool, VectorXd::Constant(21, 30), VectorXd::LinSpaced(21, 5, 20), 300, 40);
  expect_single_runs(e, keeping(system, {"max_y", "rms_a"}, 2), 5);
  e.theta.row(2).setConstant(4e6);
  e.x0.row(0).setConstant(1);
  EXPECT_EQ(run_ensemble(e, keeping(system, {"max_y"}, 2)).stopped(), 21);
}

TEST(Ensemble, AnExcitationWithoutAValueIsTheCause) {
  const Model model = model_of("1", "k*y + c*v");
  const System system(model);
  Pool& pool = *model.pool;
  const Expr t = pool.channel("t"), b = pool.parameter("b"), inputs[] = {t, b};
  const Expr force = pool.apply(Op::sqrt, {b - t});
  const MatrixXd q = Eigen::RowVectorXd::LinSpaced(9, 0.1, 0.9);
  const Ensemble e =
      spread(system, {9e3, 4}, 9,
             MemberForce::of({"F"}, TimeTape(std::span(&force, 1), inputs), q, 0, VectorXd::Constant(9, 0.01), 51));
  const EnsembleResult result = run_ensemble(e, keeping(system, {"max_y"}, 1));
  EXPECT_EQ(result.stopped(), 4);  // b = 0.1 ... 0.4 end before 0.5 s
  EXPECT_NEAR(result.stopped_at[1], 0.21, 1e-9);
  EXPECT_EQ(result.cause[1], "the excitation F has no finite value at t = 0.20125 s");
}

TEST(Ensemble, AMassThatIsNotPositiveIsAResult) {
  const System system(model_of("m - 100*y", "k*y"));
  Ensemble e = spread(system, {1, 9e3}, 9, MemberForce::of(zero_force(0.1, 0.002)));
  e.x0(0, 4) = 0.5;
  expect_single_runs(e, keeping(system, {"max_y", "rms_a"}, 1), 1);
}

TEST(Ensemble, IsTheSameForAnyNumberOfThreads) {
  const System system(model_of("1", "k*y + c*v + 30*tanh(50*y)"));
  const Ensemble e = spread(system, {9e3, 4}, 203, MemberForce::of(Excitation(0, 0.002, three_tones(200, 40))));
  const EnsembleResult one = run_ensemble(e, keeping(system, {"rms_y", "std_a", "last_v"}, 1, 1));
  for (const int threads : {2, 3, 7}) {
    const EnsembleResult many = run_ensemble(e, keeping(system, {"rms_y", "std_a", "last_v"}, 1, threads));
    EXPECT_EQ((one.values - many.values).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ((one.trajectories[1] - many.trajectories[1]).cwiseAbs().maxCoeff(), 0);
  }
}

TEST(Ensemble, SummariesAreThoseOfTheRowsThatAreKept) {
  const System system(model_of("1", "k*y + c*v"));
  const Ensemble e = spread(system, {9e3, 4}, 5, MemberForce::of(Excitation(0, 0.002, three_tones(201, 40))));
  EnsembleOptions options = keeping(system, {"max_v", "min_v", "mean_v", "std_v", "rms_v", "amplitude_v", "last_v"}, 1);
  options.settled = 0.5;
  const EnsembleResult result = run_ensemble(e, options);
  for (Index m = 0; m < 5; ++m) {
    const VectorXd v = result.trajectories[0].col(m).tail(101);
    const double mean = v.mean(), square = v.squaredNorm() / 101;
    const double expected[] = {v.maxCoeff(),
                               v.minCoeff(),
                               mean,
                               std::sqrt(square - mean * mean),
                               std::sqrt(square),
                               0.5 * (v.maxCoeff() - v.minCoeff()),
                               v[100]};
    for (Index j = 0; j < 7; ++j) EXPECT_NEAR(result.values(m, j), expected[j], 1e-12) << options.outputs[j].name;
  }
}

// The settled amplitude of a linear oscillator is its frequency response.
TEST(Ensemble, AFrequencySweepGivesTheFrequencyResponse) {
  const Model model = model_of("1", "k*y + c*v");
  const System system(model);
  const VectorXd omega = VectorXd::LinSpaced(40, 50, 200);
  Ensemble e = spread(system, {0, 0}, 40, harmonics(*model.pool, VectorXd::Constant(40, 10), omega, 64 * 120, 64));
  e.theta.colwise() = Eigen::Map<const VectorXd>(theta_of(system, {{"k", 1e4}, {"c", 8}}).data(), 2);
  e.x0.setZero();
  EnsembleOptions options;
  options.outputs = {output_from("amplitude_y", system)};
  options.settled = 0.9;
  options.threads = 2;
  const EnsembleResult result = run_ensemble(e, options);
  EXPECT_LT(result.change, 1e-5);
  for (Index m = 0; m < 40; ++m) {
    const double w = omega[m], exact = 10 / std::hypot(1e4 - w * w, 8 * w);
    EXPECT_NEAR(result.values(m, 0), exact, 3e-3 * exact) << w;  // 64 samples per period meet the peak to cos(pi/64)
  }
}

TEST(Ensemble, CtrlCKeepsWhatIsDoneAndTheRestMayFollow) {
  const System system(model_of("1", "k*y + c*v"));
  const Ensemble e = spread(system, {9e3, 4}, 300, MemberForce::of(Excitation(0, 0.002, three_tones(100, 40))));
  std::atomic<bool> cancelled{false};
  EnsembleOptions options = keeping(system, {"rms_y"}, 1);
  options.cancelled = &cancelled;
  options.finished = [&](std::span<const Index> members) { cancelled = members.front() > 0; };
  EnsembleResult result = run_ensemble(e, options);
  const Index before = result.finished();
  EXPECT_GT(before, 0);
  EXPECT_LT(before, 300);
  EXPECT_TRUE(std::isnan(result.values(299, 0)));
  cancelled = false;
  options.finished = {};
  std::vector<Index> all(300);
  for (Index m = 0; m < 300; ++m) all[m] = m;
  run_members(e, options, all, result);
  EXPECT_EQ(result.finished(), 300);
  EXPECT_EQ((result.values - run_ensemble(e, options).values).cwiseAbs().maxCoeff(), 0);
}

TEST(Ensemble, TakesNoMemoryWhileItSteps) {
  const Model model = model_of("1", "k*y + c*v + k3*y^3");
  const System system(model);
  EnsembleOptions options = keeping(system, {"rms_y", "max_a"}, 2);
  options.trajectories = false;
  const auto taken = [&](const MemberForce& force) {
    const Ensemble e = spread(system, {9e3, 4, 1e6}, 100, force);
    EnsembleResult result = prepare_ensemble(e, options);
    std::vector<Index> all(100);
    for (Index m = 0; m < 100; ++m) all[m] = m;
    force.is_expression() ? 0.0 : force.excitation(0)[0].stage_grid(2)[0];  // made once, for all members
    const long before = allocations();
    run_members(e, options, all, result);
    return allocations() - before;
  };
  const auto record = [](int rows) { return MemberForce::of(Excitation(0, 0.002, three_tones(rows, 40))); };
  const VectorXd same = VectorXd::Constant(100, 20);
  EXPECT_GT(taken(record(100)), 0);
  EXPECT_EQ(taken(record(1000)), taken(record(100)));
  EXPECT_EQ(taken(harmonics(*model.pool, same, same, 1000, 24)), taken(harmonics(*model.pool, same, same, 100, 24)));
}

TEST(Ensemble, RefusesWhatCannotBe) {
  const System system(model_of("1", "k*y + c*v"));
  const Ensemble good = spread(system, {9e3, 4}, 10, MemberForce::of(zero_force(1, 0.01)));
  const EnsembleOptions options = keeping(system, {"rms_y"}, 1);
  const auto fault = [&](auto change) {
    Ensemble e = good;
    EnsembleOptions o = options;
    change(e, o);
    return fault_of([&] { run_ensemble(e, o); });
  };
  EXPECT_EQ(fault([](Ensemble& e, auto&) { e.theta(1, 6) = std::nan(""); }),
            "ensemble: member 7: parameter 'c': expected a finite value, got nan");
  EXPECT_EQ(fault([](Ensemble& e, auto&) { e.x0(1, 2) = INFINITY; }),
            "ensemble: member 3: x0: v: expected a finite value, got inf");
  EXPECT_EQ(fault([](Ensemble& e, auto&) { e.theta.resize(2, 0); }), "ensemble: expected 1 member or more, got 0");
  EXPECT_EQ(fault([](Ensemble& e, auto&) { e.x0.conservativeResize(2, 9); }),
            "ensemble: columns of x0: expected 10, got 9");
  EXPECT_EQ(fault([](auto&, EnsembleOptions& o) { o.outputs.clear(); }), "ensemble: outputs: expected 1 or more");
  EXPECT_EQ(fault([](auto&, EnsembleOptions& o) { o.settled = 1; }), "ensemble: settled: expected >= 0 and < 1, got 1");
  EXPECT_EQ(fault([](auto&, EnsembleOptions& o) { o.memory = 1000; }),
            "ensemble: the trajectories of 10 members, 101 rows and 1 signals need 8.08e-06 GB, more than the 1e-06 GB "
            "allowed; keep summaries, or run fewer members at a time");
  EXPECT_EQ(fault([](Ensemble& e, EnsembleOptions& o) {
              e.theta.row(0).setConstant(1e10);
              o.substeps = 0;
            }),
            "ensemble: member 1 needs more than 64 substeps per sample; take a smaller dt, or lunid.simulate with "
            "solver = 'bdf' for each");
  EXPECT_EQ(fault_of([&] { output_from("rsm_y", system); }),
            "outputs: expected max, min, mean, std, rms, amplitude or last, '_' and a signal (y, v, a), got 'rsm_y', "
            "did you mean 'rms_y'?");
}

}  // namespace
}  // namespace lunid
