// Frequency responses of models with slip, clearance, several masses and moving bases; bifurcations; simulated sweeps.
#include "simulate/response.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using std::numbers::pi;
using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::model_of_many;
using testing::state;
using testing::theta_of;
using testing::with_substeps;

ResponseOptions range(double from, double to, ResponseMethod method = ResponseMethod::automatic) {
  ResponseOptions options;
  options.from = from;
  options.to = to;
  options.method = method;
  return options;
}

ResponseCurve response(const System& system, const std::vector<double>& theta, double amplitude,
                       const ResponseOptions& options) {
  return frequency_response(system, theta, {{0, 1, amplitude, 0}}, options);
}

/// n masses of 1 kg between two walls, springs k and dashpots c, k3*y1^3 beside the first; driven at the first.
Model chain_of(int n) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (int i = 1; i <= n; ++i) {
    const auto channel = [&](const char* q, int j) {
      return j < 1 || j > n ? std::string("0") : q + std::to_string(j);
    };
    std::string force = i == 1 ? "k3*y1^3" : "0";
    for (const auto& [stiffness, q] : {std::pair("k", "y"), std::pair("c", "v")})
      for (const int j : {i - 1, i + 1})
        force += std::string(" + ") + stiffness + "*(" + channel(q, i) + " - " + channel(q, j) + ")";
    rows.emplace_back("1", force);
  }
  Model model = model_of_many(rows);
  model.driven = {0};
  return model;
}

std::vector<ResponsePoint> marked(const ResponseCurve& curve, const std::string& kind) {
  std::vector<ResponsePoint> list;
  for (const ResponsePoint& point : curve.points)
    if (point.mark == kind) list.push_back(point);
  return list;
}

/// Amplitude of the last period of a run from rest over `settling` [s], or 80 periods.
double amplitude_of_run(const System& system, const std::vector<double>& theta, double force, double frequency,
                        double settling) {
  const int periods = std::min(80, static_cast<int>(std::ceil(settling * frequency)));
  constexpr Eigen::Index samples = 512;
  const double dt = 1 / (frequency * samples);
  const lunid::Run run =
      simulate(system, theta,
               force_of(periods / frequency, dt, [&](double t) { return force * std::cos(2 * pi * frequency * t); }),
               Eigen::VectorXd::Zero(system.states()), with_substeps(1));
  EXPECT_TRUE(run.summary.completed) << run.summary.cause;
  const auto last = run.x.col(0).tail(samples);
  return 0.5 * (last.maxCoeff() - last.minCoeff());
}

// A bilinear slip element beside a spring (elastic_slip of the catalogue). Below slip it is a spring; beyond, the
// answer is that of long free runs. Where nothing slips the element may rest anywhere: the mean of its force is taken
// as zero.
TEST(Response, OfASlipElementIsThatOfFreeRuns) {
  const System slip(model_of("1", "c*v + k*y + r", {{"r", "k2*v", "-R", "R"}}));
  const auto theta = theta_of(slip, {{"c", 2}, {"k", 400}, {"k2", 300}, {"R", 3}});
  const ResponseCurve curve = response(slip, theta, 5, range(1, 8));
  EXPECT_TRUE(curve.complete) << curve.stopped.front();
  EXPECT_EQ(curve.method, "shooting (the model has switches)");
  int elastic = 0, slipping = 0;
  for (std::size_t i = 0; i < curve.points.size(); i += 4) {
    const ResponsePoint& point = curve.points[i];
    EXPECT_TRUE(point.stable);
    const double amplitude = point.motion[0].amplitude(), w = 2 * pi * point.frequency;
    if (300 * amplitude < 3 * 0.999) {
      EXPECT_NEAR(amplitude * std::abs(std::complex<double>(700 - w * w, 2 * w)) / 5, 1, 1e-6);
      EXPECT_NEAR(point.motion[2].harmonics[0].real(), 0, 1e-9);
      ++elastic;
    } else if (i % 16 == 0) {
      // what is left of the transient after that: exp(-c/2 t) = 1e-6
      EXPECT_NEAR(amplitude_of_run(slip, theta, 5, point.frequency, 14) / amplitude, 1, 3e-5)
          << "at " << point.frequency << " Hz";
      EXPECT_LE(point.motion[2].max, 3);
      ++slipping;
    }
  }
  EXPECT_GT(elastic, 8);
  EXPECT_GT(slipping, 3);
  EXPECT_EQ(fault_of([&] { response(slip, theta, 5, range(1, 8, ResponseMethod::harmonic_balance)); }),
            "frequency_response: the state 'r' is held at a bound, which harmonic balance cannot follow; take method "
            "'shooting'");
}

// Kinks: harmonic balance with many harmonics comes near what shooting has exactly.
TEST(Response, OfAClearanceByHarmonicBalanceIsThatByShooting) {
  const System gap(model_of("1", "c*v + k*y + kc*(max(y - g, 0) + min(y + g, 0))"));
  const auto theta = theta_of(gap, {{"c", 2}, {"k", 100}, {"kc", 900}, {"g", 0.1}});
  const ResponseCurve exact = response(gap, theta, 15, range(2, 6));
  ResponseOptions options = range(2, 6, ResponseMethod::harmonic_balance);
  options.harmonics = 25;
  const ResponseCurve series = response(gap, theta, 15, options);
  EXPECT_EQ(exact.method, "shooting (the model has switches)");
  EXPECT_TRUE(series.truncated);
  const auto folds = marked(exact, "fold"), near = marked(series, "fold");
  ASSERT_EQ(folds.size(), 2U);
  ASSERT_EQ(near.size(), 2U);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(near[i].frequency / folds[i].frequency, 1, 1e-4);
}

// Van der Pol's oscillator under a force is entrained between two Neimark-Sacker points; outside, the answer is
// unstable and a stepped run does not settle.
TEST(Response, OfVanDerPolIsEntrainedBetweenNeimarkSackerPoints) {
  const System system(model_of("1", "-mu*(1 - y^2)*v + y"));
  const ResponseCurve curve = response(system, {0.3}, 0.6, range(0.1, 0.25));
  EXPECT_TRUE(curve.complete) << curve.stopped.front();
  const auto ends = marked(curve, "neimark_sacker");
  ASSERT_EQ(ends.size(), 2U);
  for (const ResponsePoint& end : ends) {
    EXPECT_NEAR(std::abs(end.multipliers[0]), 1, 2e-6);
    EXPECT_GT(std::abs(end.multipliers[0].imag()), 0.1);
    EXPECT_NEAR(end.motion[0].amplitude(), std::sqrt(2.0), 0.01);  // averaging: the trace vanishes at A^2 = 2
  }
  ResponseOptions stepped = range(ends[0].frequency * 0.97, ends[0].frequency * 1.03, ResponseMethod::stepped_up);
  stepped.points = 2;
  stepped.max_periods = 1000;
  const ResponseCurve run = response(system, {0.3}, 0.6, stepped);
  EXPECT_FALSE(run.complete);
  EXPECT_FALSE(run.points[0].stable);
  EXPECT_EQ(run.points[0].periods, 0);
  EXPECT_TRUE(run.points[1].stable);
  EXPECT_NE(run.stopped[0].find("; at 1 frequencies not steady within 1000 periods"), std::string::npos);
}

// y'' + 0.1 y' + y^3 = 7.5 cos w t (Ueda 1979): its symmetric answer loses stability to a pair of unsymmetric ones on
// the way to chaos. Both methods place that alike, as far as multipliers of both are known (1e-6 of one).
TEST(Response, OfUedasOscillatorHasTheSameSpecialPointsByBothMethods) {
  const System system(model_of("1", "c*v + y^3"));
  const ResponseCurve a = response(system, {0.1}, 7.5, range(0.1, 0.5, ResponseMethod::shooting));
  const ResponseCurve b = response(system, {0.1}, 7.5, range(0.1, 0.5, ResponseMethod::harmonic_balance));
  for (const char* kind : {"fold", "branch_point", "period_doubling"}) {
    const auto in_a = marked(a, kind), in_b = marked(b, kind);
    ASSERT_EQ(in_a.size(), in_b.size()) << kind;
    for (std::size_t i = 0; i < in_a.size(); ++i) EXPECT_NEAR(in_a[i].frequency / in_b[i].frequency, 1, 1e-5) << kind;
  }
  EXPECT_FALSE(marked(a, "fold").empty());
  EXPECT_FALSE(marked(a, "branch_point").empty());
}

// Towards 0.05 Hz its unsymmetric answers double their period: there a multiplier is -1, and the other what Liouville's
// theorem leaves for it, exp(-c T).
TEST(Response, OfUedasOscillatorDoublesItsPeriodWhereAMultiplierIsMinusOne) {
  const System system(model_of("1", "c*v + y^3"));
  const ResponseCurve curve = response(system, {0.1}, 7.5, range(0.05, 0.06, ResponseMethod::shooting));
  const auto places = marked(curve, "period_doubling");
  EXPECT_GE(places.size(), 3U);
  for (const ResponsePoint& point : places) {
    EXPECT_LT(std::abs(point.multipliers[0] + 1.0), 1e-4);
    EXPECT_NEAR(point.multipliers[1].real(), -std::exp(-0.1 / point.frequency), 1e-4);
  }
}

// Dry friction below its resonance: the mass stops twice and more in a period. Long runs are the witness.
TEST(Response, OfDryFrictionWithStopsIsThatOfFreeRuns) {
  const System system(model_of("1", "c*v + k*y + Fc*sign(v)"));
  const auto theta = theta_of(system, {{"c", 1}, {"k", 400}, {"Fc", 4}});
  const ResponseCurve curve = response(system, theta, 8, range(0.5, 5));
  EXPECT_TRUE(curve.complete) << curve.stopped.front();
  int compared = 0;
  for (std::size_t i = 0; i < curve.points.size(); i += 24) {
    EXPECT_NEAR(
        amplitude_of_run(system, theta, 8, curve.points[i].frequency, 28) / curve.points[i].motion[0].amplitude(), 1,
        3e-5)
        << "at " << curve.points[i].frequency << " Hz";
    ++compared;
  }
  EXPECT_GT(compared, 2);
  const ResponseCurve series = response(system, theta, 8, range(0.5, 5, ResponseMethod::harmonic_balance));
  EXPECT_FALSE(series.complete);
  EXPECT_NE(series.stopped[0].find(": the model switches at v = 0; method 'shooting' follows it exactly"),
            std::string::npos)
      << series.stopped[0];
}

// A spring in series with a dashpot beside a spring: k + i w e tau / (1 + i w tau) in the transfer function.
TEST(Response, OfAnInternalStateIsItsTransferFunction) {
  const System system(model_of("1", "k*y + z", {{"z", "e*v - z/tau", "", ""}}));
  const auto theta = theta_of(system, {{"k", 400}, {"e", 100}, {"tau", 0.05}});
  for (const auto method : {ResponseMethod::harmonic_balance, ResponseMethod::shooting}) {
    const ResponseCurve curve = response(system, theta, 2, range(0.5, 12, method));
    EXPECT_TRUE(curve.complete) << curve.stopped.front();
    for (const ResponsePoint& point : curve.points) {
      const std::complex<double> s(0, 2 * pi * point.frequency);
      const std::complex<double> exact = 2.0 / (s * s + 400.0 + s * 100.0 * 0.05 / (1.0 + s * 0.05));
      EXPECT_LT(std::abs(point.motion[0].harmonics[1] - exact) / std::abs(exact), 3e-6);
      EXPECT_EQ(point.multipliers.size(), 3U);
    }
  }
}

TEST(Response, OfAStiffModelByShootingSaysSo) {
  const System system(model_of("1", "c*v + 1e8*abs(v)*v + k*y"));
  const ResponseCurve curve = response(system, theta_of(system, {{"c", 1e9}, {"k", 100}}), 1, range(0.5, 2));
  EXPECT_FALSE(curve.complete);
  EXPECT_EQ(curve.stopped[0],
            "no periodic answer was found at 0.5 Hz: a period would need more than 65536 explicit steps: the model is "
            "too stiff, or the frequency too low, for this method");
}

// Where the force does not overcome friction nothing moves, and no step is lost on it.
TEST(Response, OfAMassThatSticksIsNothing) {
  const System system(model_of("1", "c*v + k*y + Fc*sign(v)"));
  const auto theta = theta_of(system, {{"c", 1}, {"k", 400}, {"Fc", 4}});
  const ResponseCurve curve = response(system, theta, 3, range(0.3, 5));
  EXPECT_TRUE(curve.complete) << curve.stopped.front();
  for (const ResponsePoint& point : curve.points) EXPECT_EQ(point.motion[0].amplitude(), 0);
}

// Four masses in a chain with a cubic spring at the first: two resonances by both methods, a fold at the first.
TEST(Response, OfAChainIsThatByShooting) {
  const System system(chain_of(4));
  const auto theta = theta_of(system, {{"k", 1e4}, {"c", 4}, {"k3", 1e8}});
  const ResponseCurve series = response(system, theta, 10, range(6, 22, ResponseMethod::harmonic_balance));
  const ResponseCurve exact = response(system, theta, 10, range(6, 22, ResponseMethod::shooting));
  EXPECT_TRUE(series.complete) << series.stopped.front();
  EXPECT_TRUE(exact.complete) << exact.stopped.front();
  for (const char* kind : {"peak", "fold"}) {
    const auto a = marked(series, kind), b = marked(exact, kind);
    ASSERT_EQ(a.size(), b.size()) << kind;
    EXPECT_GE(a.size(), 2U) << kind;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i].frequency / b[i].frequency, 1, 1e-5) << kind;
      EXPECT_NEAR(a[i].motion[6].amplitude() / b[i].motion[6].amplitude(), 1, 1e-4) << kind;  // y4
    }
  }
}

// A base that moves as Y cos(w t) under a mass: m a = -k (y - yb) - c (v - vb). Written with a force whose amplitude is
// k Y + c Y i w, that is two inputs of which one is a derivative.
TEST(Response, OfAMovingBaseIsItsTransmissibility) {
  const System system(model_of("1", "k*y + c*v"));
  const double k = 900, c = 6, base = 0.01;
  const auto theta = theta_of(system, {{"k", k}, {"c", c}});
  const std::vector<HarmonicInput> inputs{{0, 1, k * base, 0}, {0, 1, c * base, 1}};
  for (const auto method : {ResponseMethod::harmonic_balance, ResponseMethod::shooting}) {
    const ResponseCurve curve = frequency_response(system, theta, inputs, range(1, 30, method));
    EXPECT_TRUE(curve.complete) << curve.stopped.front();
    for (const ResponsePoint& point : curve.points) {
      const std::complex<double> s(0, 2 * pi * point.frequency);
      const std::complex<double> exact = base * (k + c * s) / (s * s + c * s + k);
      EXPECT_LT(std::abs(point.motion[0].harmonics[1] - exact) / std::abs(exact), 3e-6);
    }
  }
}

// Duffing up and down by simulation: on the branch of harmonic balance, jumping at its folds (hysteresis).
TEST(Response, SteppedUpAndDownJumpAtTheFolds) {
  const System system(model_of("1", "c*v + k*y + k3*y^3"));
  const auto theta = theta_of(system, {{"c", 10}, {"k", 2e4}, {"k3", 1e6}});
  const ResponseCurve branch = response(system, theta, 300, range(20, 40));
  const auto folds = marked(branch, "fold");
  ASSERT_EQ(folds.size(), 2U);
  for (const auto method : {ResponseMethod::stepped_up, ResponseMethod::stepped_down}) {
    ResponseOptions options = range(24, 34, method);
    options.points = 21;
    const ResponseCurve curve = response(system, theta, 300, options);
    EXPECT_TRUE(curve.complete);
    const bool up = method == ResponseMethod::stepped_up;
    EXPECT_EQ(curve.method, up ? "stepped sine, up" : "stepped sine, down");
    EXPECT_EQ(curve.stopped[0], up ? "reached 34 Hz" : "reached 24 Hz");
    const double jump = folds[up ? 0 : 1].frequency;
    for (const ResponsePoint& point : curve.points) {
      const bool upper = point.frequency < jump;
      // the answer of the branch at this frequency, between its points
      double least = 1;
      for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
        const ResponsePoint &a = branch.points[i], &b = branch.points[i + 1];
        if (!a.stable || !b.stable || (a.frequency - point.frequency) * (b.frequency - point.frequency) > 0) continue;
        const double part = (point.frequency - a.frequency) / (b.frequency - a.frequency);
        const double y = a.motion[0].amplitude() * (1 - part) + b.motion[0].amplitude() * part;
        least = std::min(least, std::abs(y / point.motion[0].amplitude() - 1));
      }
      EXPECT_LT(least, 2e-2) << "at " << point.frequency << " Hz";
      const bool both = point.frequency > folds[1].frequency && point.frequency < folds[0].frequency;
      EXPECT_TRUE(!both || (point.motion[0].amplitude() > 0.075) == upper) << "at " << point.frequency << " Hz";
    }
  }
}

// At 0.1 Hz/s the resonance of 0.16 Hz half-width lags by less than a hundredth of the amplitude.
TEST(Response, SweptSlowlyFollowsALinearOscillator) {
  const System system(model_of("1", "c*v + k*y"));
  const auto theta = theta_of(system, {{"c", 20}, {"k", 4e3}});
  for (const auto method : {ResponseMethod::swept_up, ResponseMethod::swept_down}) {
    ResponseOptions options = range(4, 20, method);
    options.rate = 0.1;
    const ResponseCurve curve = response(system, theta, 100, options);
    EXPECT_TRUE(curve.complete) << curve.stopped.front();
    EXPECT_GT(curve.points.size(), 1000U);
    for (std::size_t i = 20; i < curve.points.size(); i += 50) {
      const double w = 2 * pi * curve.points[i].frequency;
      const double exact = 100 / std::abs(std::complex<double>(4e3 - w * w, 20 * w));
      EXPECT_NEAR(curve.points[i].motion[0].amplitude() / exact, 1, 1e-2) << "at " << curve.points[i].frequency;
    }
  }
}

TEST(Response, RefusesWhatHasNoAnswer) {
  const System system(model_of("1", "k*y"));
  const auto fault = [&](const System& s, std::vector<double> theta, ResponseOptions options) {
    return fault_of([&] { response(s, theta, 1, options); });
  };
  EXPECT_EQ(fault(system, {1}, range(0, 2)), "frequency_response: from: expected > 0 Hz, got 0");
  EXPECT_EQ(fault(system, {1}, range(3, 2)), "frequency_response: to: expected > from, which is 3 Hz, got 2");
  ResponseOptions options = range(1, 2);
  options.harmonics = -1;
  EXPECT_EQ(fault(system, {1}, options), "frequency_response: harmonics: expected 1 to 500, got -1");
  options = range(1, 2);
  options.accuracy = 1;
  EXPECT_EQ(fault(system, {1}, options), "frequency_response: accuracy: expected > 0 and < 1, got 1");
  EXPECT_EQ(fault(system, {1}, range(1, 2, ResponseMethod::swept_up)),
            "frequency_response: rate: a swept run needs a rate > 0 Hz/s, got 0");
  EXPECT_EQ(fault(system, {std::nan("")}, range(1, 2)), "frequency_response: parameter 'k' has no value; give it one");
  const System timed(model_of("1", "k*y*(1 + 0.1*sin(t))"));
  EXPECT_EQ(fault(timed, {1}, range(1, 2)),
            "frequency_response: the model holds the time t itself, so its answers do not repeat with the excitation; "
            "use simulate and poincare");
  const System imposed(model_of("1", "k*y", {}, true));
  EXPECT_EQ(fault(imposed, {1}, range(1, 2)),
            "frequency_response: the motion of this model is imposed: nothing is free to answer a force");
  const System massless(model_of("m - 2", "k*y"));
  EXPECT_EQ(fault(massless, theta_of(massless, {{"m", 1}, {"k", 1}}), range(1, 2)),
            "frequency_response: the mass is -1 kg at y = 0 m, v = 0 m/s; it must stay above 0");
  EXPECT_EQ(fault_of([&] {
              frequency_response(system, std::vector<double>{1}, {{3, 1, 1, 0}}, range(1, 2));
            }),
            "frequency_response: inputs: expected an input 0 to 0, got 3");
  EXPECT_EQ(fault_of([] { response_method_from("steped_up"); }),
            "method: expected auto, harmonic_balance, shooting, stepped_up, stepped_down, swept_up or swept_down, got "
            "'steped_up', did you mean 'stepped_up'?");
}

// Not converging is a result that says where.
TEST(Response, WithoutDampingEndsAtItsResonance) {
  const System system(model_of("1", "k*y"));
  const ResponseCurve curve = response(system, {400}, 1, range(1, 8));
  EXPECT_FALSE(curve.complete);
  ASSERT_EQ(curve.stopped.size(), 2U);
  for (const std::string& stopped : curve.stopped)
    EXPECT_EQ(stopped.substr(0, 38), "the answer grows without bound at 3.18") << stopped;
  EXPECT_EQ(curve.points.back().branch, 2);
}

TEST(Response, StopsAtItsMostPoints) {
  const System system(model_of("1", "c*v + k*y"));
  ResponseOptions options = range(1, 8);
  options.max_points = 5;
  const ResponseCurve curve = response(system, {1, 400}, 1, options);
  EXPECT_FALSE(curve.complete);
  EXPECT_EQ(curve.stopped[0].substr(0, 37), "max_points = 5 were not enough: stopp");
}

}  // namespace
}  // namespace lunid
