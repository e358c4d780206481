// Fits on the trajectory: several channels, records and coordinates, outliers, profiles. The truth comes from a
// hand-written Runge-Kutta method at a sixteenth of the sample time, not from the code under test.
#include <array>
#include <random>

#include "simulate/fit.hpp"
#include "simulate/fit_check.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::model_of_many;
using testing::theta_of;

constexpr double dt = 0.002;
constexpr int rows = 1500;

double push(double t) { return 60 * std::sin(31 * t) + 40 * std::sin(73 * t + 1); }

/// x' = f(t, x) of the hand-written truth, sampled at dt.
template <std::size_t N, class Rate>
std::vector<std::array<double, N>> truth(std::array<double, N> x, Rate rate) {
  std::vector<std::array<double, N>> out{x};
  constexpr int substeps = 16;
  const double h = dt / substeps;
  const auto moved = [](const auto& a, const auto& d, double s) {
    auto b = a;
    for (std::size_t i = 0; i < N; ++i) b[i] += s * d[i];
    return b;
  };
  for (int i = 1; i < rows; ++i) {
    for (int j = 0; j < substeps; ++j) {
      const double t = dt * (i - 1) + h * j;
      const auto k1 = rate(t, x), k2 = rate(t + h / 2, moved(x, k1, h / 2));
      const auto k3 = rate(t + h / 2, moved(x, k2, h / 2)), k4 = rate(t + h, moved(x, k3, h));
      for (std::size_t n = 0; n < N; ++n) x[n] += h / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n]);
    }
    out.push_back(x);
  }
  return out;
}

auto duffing(double k, double c, double k3) {
  return truth<2>({0.001, 0}, [=](double t, const std::array<double, 2>& x) {
    return std::array<double, 2>{x[1], push(t) - k * x[0] - c * x[1] - k3 * x[0] * x[0] * x[0]};
  });
}

/// A record of the truth with noise of a standard deviation per channel.
template <std::size_t N>
Record record_of(const std::vector<std::array<double, N>>& x, const std::vector<std::string>& names,
                 const std::vector<double>& noise, unsigned seed, const std::string& force = "F",
                 double force_noise = 0) {
  std::mt19937_64 bits(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Channel> channels;
  const auto add = [&](const std::string& name, auto value, double std) {
    Channel c;
    c.name = name;
    c.values.resize(rows);
    for (int i = 0; i < rows; ++i) c.values[i] = value(i) + std * normal(bits);
    c.noise = std;
    channels.push_back(std::move(c));
  };
  add(
      force, [](int i) { return push(dt * i); }, force_noise);
  for (std::size_t n = 0; n < names.size(); ++n)
    if (!names[n].empty())
      add(
          names[n], [&](int i) { return x[i][n]; }, noise[n]);
  return derive_motion(Record("truth", 0, dt, std::move(channels)));
}

FitData data_of(const System& system, const Record& record) {
  return {record, excitations_of(system, record, Interpolation::cubic), {}};
}

Eigen::VectorXd vector(std::initializer_list<double> values) { return testing::state(values); }

/// m y'' + c y' + k y = 0 says k/m and c/m, and no more.
TEST(FitTrajectory, OfAFreeDecayDoesNotTellMassSpringAndDamperApart) {
  const auto decay = truth<2>({0.01, 0}, [](double, const std::array<double, 2>& x) {
    return std::array<double, 2>{x[1], -1e4 * x[0] - 4 * x[1]};
  });
  const Record measured = record_of(decay, {"y"}, {1e-5}, 3);
  Channel none = measured.channel("F");
  none.values.setZero();
  const Record record = measured.with(none);
  const auto fitted = [&](const char* mass, std::initializer_list<double> start) {
    const System system(model_of(mass, "k*y + c*v"));
    return fit_trajectory(system, vector(start), {data_of(system, record)});
  };
  const FitResult open = fitted("m", {1.3, 1.2e4, 6}), known = fitted("1", {1.2e4, 6});
  ASSERT_EQ(open.theta.size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(open.identifiable(i)) << i;
    EXPECT_TRUE(std::isnan(open.deviation(i))) << i;
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(known.identifiable(i)) << i;
    EXPECT_LT(std::abs(known.theta[i] - (i == 0 ? 1e4 : 4)), 4 * known.deviation(i)) << i;
  }
}

TEST(FitTrajectory, OfDisplacementAndVelocityIsSharperThanOfEither) {
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const Record record = record_of(duffing(2e4, 10, 1e8), {"y", "v"}, {2e-5, 3e-3}, 1);
  const std::vector<FitData> data{data_of(system, record)};
  std::vector<FitResult> fits;
  for (const std::vector<std::string>& channels :
       {std::vector<std::string>{"y"}, std::vector<std::string>{"v"}, std::vector<std::string>{"y", "v"}}) {
    FitOptions options;
    options.channels = channels;
    fits.push_back(fit_trajectory(system, vector({1.95e4, 14, 0.9e8}), data, options));
    ASSERT_TRUE(fits.back().converged) << fits.back().stopped;
    for (int i = 0; i < 3; ++i) {
      const double expected[] = {2e4, 10, 1e8};
      EXPECT_NEAR(fits.back().theta[i], expected[i], 4 * std::sqrt(fits.back().covariance(i, i))) << i;
    }
  }
  EXPECT_EQ(fits[2].rows, 2 * rows);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(fits[2].covariance(i, i), 1.1 * std::min(fits[0].covariance(i, i), fits[1].covariance(i, i))) << i;
}

// A bristle as stiff as the truth's is beyond what one step to a sample can follow: such runs explode, and a fit stops
// at that wall as at a bound.
TEST(FitTrajectory, GoesOnWithShorterStepsWhereLongOnesExplode) {
  const auto bristle = truth<3>({0.001, 0, 0}, [](double t, const std::array<double, 3>& x) {
    return std::array<double, 3>{x[1], push(t) - 2000 * x[0] - 4 * x[1] - 3e4 * x[2],
                                 x[1] - 3e4 * std::abs(x[1]) * x[2] / 10};
  });
  const System system(model_of("1", "k*y + c*v + s0*z", {{"z", "v - s0*abs(v)*z/Fc"}}));
  const Record record = record_of(bristle, {"y", "v", ""}, {1e-5, 2e-3, 0}, 1);
  const std::vector<FitData> data{data_of(system, record)};
  Eigen::VectorXd start(system.parameters()), expected(system.parameters());
  for (int i = 0; i < system.parameters(); ++i) {
    const std::string& name = system.model().parameters[static_cast<std::size_t>(i)].name;
    expected[i] = name == "k" ? 2000 : name == "c" ? 4 : name == "s0" ? 3e4 : 10;
    start[i] = name == "s0" ? 5e3 : 0.95 * expected[i];
  }
  FitOptions options;
  options.substeps = 1;
  EXPECT_GT(fit_trajectory(system, start, data, options).cost, 3 * rows * 1e-10);
  options.shorten_steps = true;
  const FitResult fit = fit_trajectory(system, start, data, options);
  EXPECT_LT(fit.cost, 1.1 * 2 * rows * 1e-10);
  EXPECT_GT(fit.substeps, 1);
  for (int i = 0; i < system.parameters(); ++i)
    EXPECT_NEAR(fit.theta[i], expected[i], 5 * std::sqrt(fit.covariance(i, i))) << i;
}

// A relay that would swing some hundred times between two samples: a free run of it takes its million switches, which a
// fit does not wait for.
/// A spring that softens with the path (here the sum of v^2) that it has gone: k where the first record begins and the
/// path before it take each other's place.
TEST(FitTrajectory, TakesAnAnchoredStateToBeginWhereTheFirstRecordDoes) {
  const auto softening = [](double gone) {
    return truth<3>({0.001, 0, gone}, [](double t, const std::array<double, 3>& x) {
      return std::array<double, 3>{x[1], push(t) - 900 * std::exp(-x[2] / 20) * x[0] - 4 * x[1], x[1] * x[1]};
    });
  };
  Model model = model_of("1", "k*exp(-w/s)*y + c*v", {{"w", "v^2"}});
  for (const bool anchored : {true, false})
    for (const Gradient gradient : {Gradient::forward, Gradient::adjoint}) {
      model.states[0].anchored = anchored;
      const System system(model);
      std::vector<FitData> data;
      for (const double gone : {0.0, 3.0})
        data.push_back(data_of(system, record_of(softening(gone), {"y"}, {1e-4}, 5)));
      const std::vector<double> start = theta_of(system, {{"k", 850}, {"s", 18}, {"c", 4.4}});
      FitOptions options;
      options.gradient = gradient;
      options.max_iterations = 200;
      const FitResult fit = fit_trajectory(system, Eigen::Map<const Eigen::VectorXd>(start.data(), 3), data, options);
      const auto k = static_cast<Eigen::Index>(system.model().find("k") - system.model().parameters.data());
      ASSERT_EQ(fit.segments.size(), 2u);
      if (anchored) {
        EXPECT_EQ(fit.segments[0].x0[2], 0);
        EXPECT_NEAR(fit.segments[1].x0[2], 3, 0.1);
        EXPECT_LT(fit.deviation(k), 1);
        EXPECT_NEAR(fit.theta[k], 900, 5 * fit.deviation(k));
      } else {
        EXPECT_NE(fit.segments[0].x0[2], 0);
        EXPECT_FALSE(fit.deviation(k) < 1);
      }
    }
}

TEST(FitTrajectory, GivesUpOnARunThatChattersBetweenItsSamples) {
  const System system(model_of("1", "k*y + R*sign(y)"));
  const Record record = record_of(duffing(2e4, 10, 0), {"y"}, {2e-5}, 1);
  const std::vector<FitData> data{data_of(system, record)};
  FitOptions options;
  options.solver = Solver::fixed;
  const FitResult fit = fit_trajectory(system, vector({2e4, 1e8}), data, options);
  EXPECT_FALSE(std::isfinite(fit.cost));
  EXPECT_NE(fit.stopped.find("more than 2500 switches: the motion chatters"), std::string::npos) << fit.stopped;
  EXPECT_TRUE(std::isfinite(fit_trajectory(system, vector({2e4, 10}), data, options).cost));
  const std::vector<FitData> few{data[0].part(0, 30)};  // 100 switches, and 2 a row
  const std::string stopped = fit_trajectory(system, vector({2e4, 1e8}), few, options).stopped;
  EXPECT_NE(stopped.find("more than 160 switches"), std::string::npos) << stopped;
}

/// Forty elements that slip one after another twice a period make more switches than there are rows.
TEST(FitTrajectory, FollowsAllSlipsOfManyElements) {
  constexpr int elements = 40;
  constexpr double k = 800, limit = 0.05;
  std::array<double, 2 + elements> rest{0.001};
  const auto x = truth<2 + elements>(rest, [](double t, const std::array<double, 2 + elements>& z) {
    std::array<double, 2 + elements> rate{z[1], push(t) - 2e3 * z[0] - 6 * z[1]};
    for (int i = 0; i < elements; ++i) {
      const double most = limit * (i + 1), force = std::clamp(z[2 + i], -most, most);
      rate[1] -= force;
      rate[2 + i] = std::abs(z[2 + i]) >= most && z[2 + i] * z[1] > 0 ? 0 : k * z[1];
    }
    return rate;
  });
  std::string sum = "2000*y + 6*v";
  std::vector<testing::StateText> states;
  for (int i = 1; i <= elements; ++i) {
    const std::string z = "z" + std::to_string(i), most = "R*" + std::to_string(i);
    sum += " + " + z;
    states.push_back({z, "k*v", "-" + most, most});
  }
  const System system(model_of("1", sum, states));
  const FitData data = data_of(system, record_of(x, {"y"}, {1e-5}, 6));
  FitOptions options;
  options.solver = Solver::fixed;
  options.max_iterations = 3;
  const std::vector<double> start = theta_of(system, {{"k", 790}, {"R", 0.0505}});
  const FitResult fit = fit_trajectory(system, Eigen::Map<const Eigen::VectorXd>(start.data(), 2), {data}, options);
  ASSERT_TRUE(std::isfinite(fit.cost)) << fit.stopped;
  const std::vector<double> found = theta_of(system, {{"k", k}, {"R", limit}});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(fit.theta.data()[i], found[i], 0.01 * found[i]) << i;
  const lunid::Run run = simulate(system, std::span(fit.theta.data(), 2), data.excitation, fit.segments[0].x0);
  EXPECT_GT(run.summary.events, rows + 1000);
}

/// Multiple shooting on several threads, with a start from which the later runs do not come to their end, too.
TEST(FitTrajectory, HasTheSameBitsOnAnyNumberOfThreads) {
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const std::vector<FitData> data{data_of(system, record_of(duffing(2e4, 10, 1e8), {"y"}, {2e-5}, 1)),
                                  data_of(system, record_of(duffing(2e4, 10, 1e8), {"y"}, {2e-5}, 2))};
  for (const double k3 : {0.9e8, -1e12}) {
    std::vector<FitResult> fits;
    for (const int threads : {1, 2, 7}) {
      FitOptions options;
      options.segment = 500;
      options.substeps = 2;
      options.threads = threads;
      fits.push_back(fit_trajectory(system, vector({1.95e4, 15, k3}), data, options));
      const FitResult &one = fits.front(), &own = fits.back();
      EXPECT_EQ(own.cost, one.cost);
      EXPECT_EQ(own.runs, one.runs);
      EXPECT_EQ(own.stopped, one.stopped);
      EXPECT_EQ(own.theta, one.theta);
      EXPECT_EQ(own.covariance, one.covariance);
    }
    EXPECT_EQ(std::isfinite(fits.front().cost), k3 > 0);
  }
}

TEST(FitTrajectory, OfTwoRecordsSharesWhatIsNotSeparate) {
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const std::vector<FitData> data{data_of(system, record_of(duffing(2e4, 10, 1e8), {"y"}, {2e-5}, 1)),
                                  data_of(system, record_of(duffing(2e4, 25, 1e8), {"y"}, {2e-5}, 2))};
  FitOptions options;
  options.separate = {1};
  const FitResult fit = fit_trajectory(system, vector({1.95e4, 15, 0.9e8}), data, options);
  ASSERT_TRUE(fit.converged) << fit.stopped;
  ASSERT_EQ(fit.theta.size(), 4);  // k, c of the first, k3, c of the second
  const double expected[] = {2e4, 10, 1e8, 25};
  for (int i = 0; i < 4; ++i) {
    const double std = std::sqrt(fit.covariance(i, i));
    EXPECT_NEAR(fit.theta[i], expected[i], 4 * std) << i;
    EXPECT_LT(std, 0.02 * expected[i]) << i;
  }
  const FitLayout layout(3, 2, options.separate);
  EXPECT_EQ(layout.of_record(fit.theta, 1)[1], fit.theta[3]);
  EXPECT_EQ(layout.of_record(fit.theta, 1)[2], fit.theta[2]);
}

// One row in twenty is off by 40 standard deviations, always upwards.
TEST(FitTrajectory, WithHubersLossIsNotPulledByOutliers) {
  const System system(model_of("1", "k*y + c*v"));
  Record record = record_of(duffing(2e4, 10, 0), {"y"}, {2e-5}, 3);
  Channel y = record.channel("y");
  for (int i = 7; i < rows; i += 20) y.values[i] += 8e-4;
  Record spoiled("spoiled", 0, dt, {record.channel("F"), y});
  const std::vector<FitData> data{data_of(system, derive_motion(spoiled))};
  FitOptions options;
  options.loss = Loss::huber;
  const FitResult robust = fit_trajectory(system, vector({1.95e4, 14}), data, options);
  const FitResult plain = fit_trajectory(system, vector({1.95e4, 14}), data);
  ASSERT_TRUE(robust.converged && plain.converged);
  EXPECT_GE(robust.outliers, rows / 20 - 1);
  EXPECT_LT(robust.outliers, rows / 4);  // of a Gaussian 18 % lie beyond 1.345 deviations
  EXPECT_LT(robust.covariance(0, 0), 0.2 * plain.covariance(0, 0));
  EXPECT_NEAR(robust.theta[0], 2e4, 4 * std::sqrt(robust.covariance(0, 0)));
  EXPECT_NEAR(robust.theta[1], 10, 4 * std::sqrt(robust.covariance(1, 1)));
}

// Of two records the one with a fifth of the noise has five times the weight; the scale that tells outliers is that of
// the weighted residuals, so that 18 % of the rows of both lie beyond the clip.
TEST(FitTrajectory, WithHubersLossKnowsTheScaleOfRecordsOfUnlikeNoise) {
  const System system(model_of("1", "k*y + c*v"));
  std::vector<FitData> data{data_of(system, record_of(duffing(2e4, 10, 0), {"y"}, {2e-5}, 3)),
                            data_of(system, record_of(duffing(2e4, 10, 0), {"y"}, {4e-6}, 4))};
  data[1].weight = 5;
  FitOptions options;
  options.loss = Loss::huber;
  const FitResult fit = fit_trajectory(system, vector({1.95e4, 14}), data, options);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(static_cast<double>(fit.outliers) / (2 * rows), 0.18, 0.03);
}

TEST(FitTrajectory, ProfileIsTheNormalIntervalWhereTheModelIsNearlyLinear) {
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const std::vector<FitData> data{data_of(system, record_of(duffing(2e4, 10, 1e8), {"y"}, {2e-5}, 4))};
  const FitResult fit = fit_trajectory(system, vector({1.95e4, 14, 0.9e8}), data);
  for (int i = 0; i < 3; ++i) {
    const Profile profile = profile_likelihood(system, fit, data, {}, i);
    const double std = std::sqrt(fit.covariance(i, i));
    EXPECT_NEAR(profile.low, fit.theta[i] - 1.96 * std, 0.1 * std) << i;
    EXPECT_NEAR(profile.high, fit.theta[i] + 1.96 * std, 0.1 * std) << i;
    ASSERT_GE(profile.points.size(), 7u);
    for (std::size_t k = 1; k < profile.points.size(); ++k)
      EXPECT_LT(profile.points[k - 1].value, profile.points[k].value);
  }
}

TEST(FitTrajectory, ProfileIsOpenAtABound) {
  const Record record = record_of(duffing(2e4, 10, 0), {"y"}, {2e-5}, 5);
  const System free(model_of("1", "k*y + c*v"));
  const FitResult first = fit_trajectory(free, vector({1.99e4, 12}), {data_of(free, record)});
  Model model = model_of("1", "k*y + c*v");
  Parameter k, c;
  k.name = "k";
  c.name = "c";
  c.min = first.theta[1] - std::sqrt(first.covariance(1, 1));
  model.parameters = {k, c};
  const System system(model);
  const std::vector<FitData> data{data_of(system, record)};
  const FitResult fit = fit_trajectory(system, vector({1.99e4, 12}), data);
  const Profile profile = profile_likelihood(system, fit, data, {}, 1);
  EXPECT_EQ(profile.low, -std::numeric_limits<double>::infinity());
  EXPECT_LT(profile.high, 3 * std::sqrt(fit.covariance(1, 1)) + fit.theta[1]);
  FitOptions held;
  held.hold = {1};
  const FitResult still = fit_trajectory(system, vector({1.99e4, 12}), data, held);
  EXPECT_EQ(still.theta[1], 12);
  EXPECT_EQ(fault_of([&] { profile_likelihood(system, still, data, {}, 1); }),
            "profile: the parameter has no standard deviation: it is fixed, sits at a bound, or is not seen");
}

// 60 periods, k 30 % off: one long run would lock into a neighbouring phase.
TEST(FitTrajectory, FromFarGrowsTheRuns) {
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const std::vector<FitData> data{data_of(system, record_of(duffing(2e4, 10, 1e8), {"y"}, {2e-5}, 6))};
  const FitResult fit = fit_progressively(system, vector({1.4e4, 40, 0.1e8}), data);
  ASSERT_TRUE(fit.converged) << fit.stopped;
  EXPECT_NEAR(fit.theta[0], 2e4, 4 * std::sqrt(fit.covariance(0, 0)));
  EXPECT_NEAR(fit.theta[2], 1e8, 4 * std::sqrt(fit.covariance(2, 2)));
}

TEST(FitTrajectory, FromFarIsGivenUpWhereShortRunsLeaveTooMuch) {
  const std::vector<FitData> data{
      data_of(System(model_of("1", "k*y + c*v")), record_of(duffing(2e4, 10, 1e9), {"y"}, {2e-5}, 6))};
  const System without(model_of("1", "k*y + c*v")), with(model_of("1", "k*y + c*v + k3*y^3"));
  const FitResult all = fit_progressively(without, vector({2e4, 10}), data);
  ASSERT_GT(std::sqrt(all.cost / static_cast<double>(all.rows)), 1e-4);
  const FitResult given_up = fit_progressively(without, vector({2e4, 10}), data, {}, 3e-5);
  EXPECT_EQ(given_up.cost, INFINITY);
  EXPECT_TRUE(given_up.stopped.ends_with("rows leave too much")) << given_up.stopped;
  EXPECT_LT(given_up.runs, all.runs);
  EXPECT_TRUE(std::isfinite(fit_progressively(with, vector({2e4, 10, 0.9e9}), data, {}, 3e-5).cost));
}

// Noise of the force's channel moves the body near its resonance, hidden under the sensor's white noise.
TEST(FitTrajectory, CountsTheNoiseOfTheForceWhereAsked) {
  constexpr int draws = 40;
  const System system(model_of("1", "k*y + c*v"));
  const auto motion = duffing(2e4, 10, 0);
  double with = 0, without = 0;  // mean squares of the misses over their deviations
  for (int draw = 0; draw < draws; ++draw) {
    const Record record = record_of(motion, {"y"}, {5e-5}, 100 + static_cast<unsigned>(draw), "F", 0.3);
    const std::vector<FitData> data{data_of(system, record)};
    for (double* sum : {&with, &without}) {
      FitOptions options;
      options.force_noise = sum == &with;
      const FitResult fit = fit_trajectory(system, vector({2e4, 10}), data, options);
      for (int i = 0; i < 2; ++i)
        *sum += std::pow(fit.theta[i] - (i == 0 ? 2e4 : 10), 2) / fit.covariance(i, i) / (2 * draws);
    }
  }
  EXPECT_GT(without, 2);
  EXPECT_GT(with, 0.6);
  EXPECT_LT(with, 1.5);
}

// Wind that nobody measured, under the sensor's white noise, and under some noise of the force's channel too; and none.
TEST(FitTrajectory, CountsADisturbanceOfTheForceByWhatTheResidualShows) {
  constexpr int draws = 40;
  const System system(model_of("1", "k*y + c*v"));
  const auto misses = [&](double wind, bool counted, double noise = 0) {  // their mean square over their variances
    double sum = 0;
    for (int draw = 0; draw < draws; ++draw) {
      std::mt19937_64 bits(500 + static_cast<unsigned>(draw));
      std::normal_distribution<double> normal(0, wind);
      std::array<double, rows + 1> gusts{};
      for (double& gust : gusts) gust = normal(bits);
      const auto motion = truth<2>({0.001, 0}, [&](double t, const std::array<double, 2>& x) {
        const double gust = gusts.at(static_cast<std::size_t>(t / dt));
        return std::array<double, 2>{x[1], push(t) + gust - 2e4 * x[0] - 10 * x[1]};
      });
      const Record record = record_of(motion, {"y"}, {5e-5}, 100 + static_cast<unsigned>(draw), "F", noise);
      FitOptions options;
      options.force_noise = counted;
      const FitResult fit = fit_trajectory(system, vector({2e4, 10}), {data_of(system, record)}, options);
      for (int i = 0; i < 2; ++i)
        sum += std::pow(fit.theta[i] - (i == 0 ? 2e4 : 10), 2) / fit.covariance(i, i) / (2 * draws);
    }
    return sum;
  };
  EXPECT_GT(misses(0.3, false), 2);
  EXPECT_LT(misses(0.3, true), 1.5);
  EXPECT_GT(misses(0.3, true), 0.5);
  EXPECT_LT(misses(0.3, true, 0.1), 1.5);
  EXPECT_GT(misses(0.3, true, 0.1), 0.5);
  EXPECT_LT(misses(0, true), 1.4);
  EXPECT_GT(misses(0, true), 0.6);
}

// A longer wave of another height has nearly the same slope and bend: straight steps creep along that valley.
TEST(FitTrajectory, FollowsABentValley) {
  const auto wave = truth<2>({0.001, 0}, [](double t, const std::array<double, 2>& x) {
    return std::array<double, 2>{x[1], push(t) - 2e4 * x[0] - 10 * x[1] - 10 * std::sin(600 * x[0])};
  });
  const System system(model_of("1", "k*y + c*v + h*sin(p*y)"));
  const std::vector<FitData> data{data_of(system, record_of(wave, {"y"}, {2e-6}, 8))};
  FitOptions options;
  options.max_iterations = 15;
  const FitResult fit = fit_trajectory(system, vector({1.1e4, 10, 55, 300}), data, options);
  ASSERT_TRUE(fit.converged) << fit.stopped << ", h = " << fit.theta[2];
  EXPECT_NEAR(fit.theta[2], 10, 4 * std::sqrt(fit.covariance(2, 2)));
  EXPECT_NEAR(fit.theta[3], 600, 4 * std::sqrt(fit.covariance(3, 3)));
}

TEST(FitTrajectory, OfTwoCoordinatesUsesBothSensors) {
  const auto x = truth<4>({0, 0, 0, 0}, [](double t, const std::array<double, 4>& s) {
    const double d = s[2] - s[0], inner = 1e4 * d + 5e8 * d * d * d;
    return std::array<double, 4>{s[1], push(t) - 2e4 * s[0] - 8 * s[1] + inner, s[3], (-inner - 3 * s[3]) / 0.5};
  });
  const System system(model_of_many(
      {{"1", "k*y1 + c*v1 - (kc*(y2 - y1) + k3*(y2 - y1)^3)"}, {"0.5", "kc*(y2 - y1) + k3*(y2 - y1)^3 + 3*v2"}}));
  const Record record = record_of(x, {"y1", "", "y2"}, {2e-5, 0, 2e-5}, 7, "F1");
  const std::vector<FitData> data{data_of(system, record)};
  const std::vector<double> start = testing::theta_of(system, {{"k", 1.9e4}, {"c", 10}, {"kc", 1.05e4}, {"k3", 4e8}});
  const std::vector<double> expected = testing::theta_of(system, {{"k", 2e4}, {"c", 8}, {"kc", 1e4}, {"k3", 5e8}});
  const FitResult fit = fit_progressively(system, Eigen::Map<const Eigen::VectorXd>(start.data(), 4), data);
  ASSERT_TRUE(fit.converged) << fit.stopped;
  EXPECT_EQ(fit.rows, 2 * rows);
  ASSERT_EQ(fit.residual.size(), 2u);  // of y1, then of y2
  EXPECT_NEAR(fit.residual[0].squaredNorm() + fit.residual[1].squaredNorm(), fit.cost, 1e-9 * fit.cost);
  for (int i = 0; i < 4; ++i) {
    const double std = std::sqrt(fit.covariance(i, i));
    EXPECT_NEAR(fit.theta[i], expected[i], 4 * std) << system.model().parameters[i].name;
    EXPECT_LT(std, 0.05 * expected[i]) << system.model().parameters[i].name;
  }
}

TEST(FitTrajectory, FaultsNameTheChannel) {
  const System system(model_of("1", "k*y + c*v"));
  const Record record = record_of(duffing(2e4, 10, 0), {"y"}, {2e-5}, 1);
  const std::vector<FitData> data{data_of(system, record)};
  FitOptions options;
  options.channels = {"F"};
  EXPECT_EQ(fault_of([&] {
              fit_trajectory(system, vector({2e4, 10}), data, options);
            }),
            "fit_trajectory: channels: expected displacements, velocities or accelerations of the model, got 'F'");
  options.channels = {};
  options.separate = {2};
  EXPECT_EQ(fault_of([&] {
              fit_trajectory(system, vector({2e4, 10}), data, options);
            }),
            "fit_trajectory: separate: expected parameters from 0 to 1, got 2");
}

/// A spring of the fifth power that is pulled far and released: far faster where the record begins than in its middle.
/// Steps that are right there miss the motion by 4 permille.
TEST(FitTrajectory, TakesItsStepsFromWhereTheMotionIsFastest) {
  const auto x = truth<2>({3, 0}, [](double t, const std::array<double, 2>& s) {
    return std::array<double, 2>{s[1], push(t) - 11000 * s[0] - 6.5 * s[1] - 560 * std::pow(s[0], 5)};
  });
  const System system(model_of("1", "k*y + c*v + k5*y^5"));
  const Record record = record_of(x, {"y"}, {0.01}, 3);
  const FitOptions options;
  const std::vector<FitData> data{data_of(system, record)};
  const FitResult result = fit_trajectory(system, vector({11000, 6.5, 560}), data, options);
  ASSERT_TRUE(result.converged) << result.stopped;
  EXPECT_LT(check_by_sundials(system, result, data, options), 1e-3);
  EXPECT_NEAR(result.theta[2], 560, 3 * std::sqrt(result.covariance(2, 2)));
}

/// Between two wells small differences grow some million times: parameters and first states move the run alike, and
/// what tells them apart is less than 1e-5 of what either does.
TEST(FitTrajectory, TellsParametersFromFirstStatesWhereSmallDifferencesGrow) {
  const std::array<double, 3> values{-2300, 2, 3e6};
  const auto x = truth<2>({0.03, 0}, [=](double t, const std::array<double, 2>& s) {
    return std::array<double, 2>{s[1], push(t) - values[0] * s[0] - values[1] * s[1] - values[2] * std::pow(s[0], 3)};
  });
  const System system(model_of("1", "k*y + c*v + k3*y^3"));
  const std::vector<FitData> data{data_of(system, record_of(x, {"y"}, {1e-4}, 5))};
  const FitResult result = fit_trajectory(system, vector({values[0], values[1], values[2]}), data, {});
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_FALSE(result.unseen[i]) << i;
    EXPECT_NEAR(result.theta[k], values[i], 4 * result.deviation(k)) << i;
  }
}

/// A steep spring under little damping: a first state that is read off noisy data loses its motion within a few turns,
/// whatever the parameters, and the whole run does not find it again (it ended at 9 to 40 times the noise).
TEST(FitTrajectory, FindsTheFirstStateOfAMotionThatHangsOnIt) {
  const double k = 1600, c = 0.4, k5 = 3.15e8;
  const auto x = truth<2>({0, 0}, [=](double t, const std::array<double, 2>& s) {
    return std::array<double, 2>{s[1], push(t) - k * s[0] - c * s[1] - k5 * std::pow(s[0], 5)};
  });
  const System system(model_of("1", "k*y + c*v + k5*y^5"));
  for (const unsigned seed : {1, 2, 3, 4}) {
    constexpr double noise = 2e-3;
    const std::vector<FitData> data{data_of(system, record_of(x, {"y"}, {noise}, seed))};
    const FitResult result = fit_trajectory(system, vector({k, c, k5}), data, {});
    EXPECT_LT(std::sqrt(result.cost / static_cast<double>(result.rows)), 1.1 * noise);
    EXPECT_NEAR(result.theta[2], k5, 4 * std::sqrt(result.covariance(2, 2)));
  }
}

}  // namespace
}  // namespace lunid
