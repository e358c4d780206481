// Switches against closed forms: Den Hartog's friction, with and without stops; a ball and an oscillator against a
// spring; infinitely many switches in a finite time.
#include <optional>

#include "simulate_models.hpp"
#include "simulate_pieces.hpp"

namespace lunid {
namespace {

using testing::first_fall;
using testing::force_of;
using testing::LinearPiece;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::zero_force;

constexpr double pi = std::numbers::pi;

SimulateOptions precise(Solver solver) {
  SimulateOptions options = with_solver(solver, 1e-10);
  if (solver == Solver::fixed || solver == Solver::automatic) options.substeps = 8;
  return options;
}

/// y'' + y + f sign(v) = cos(b t + phase), between two stops (Den Hartog 1931, Trans. ASME 53, APM-107): amplitude and
/// phase of the motion without stops that is at its largest at t = 0, and the friction beyond which it stops.
struct DenHartog {
  DenHartog(double b, double f) {
    const double V = 1 / (1 - b * b), H = std::sin(pi / b) / (b * (1 + std::cos(pi / b)));
    double S = 1 / (b * b);  // its limit at both ends of the half cycle
    for (double s = 1e-3; s < pi - 1e-4; s += 1e-4)
      S = std::max(S, (std::sin(s / b) / b + H * (std::cos(s) - std::cos(s / b))) / std::sin(s));
    limit = std::abs(V) / std::sqrt(H * H + S * S);
    amplitude = std::sqrt(V * V - f * f * H * H);
    phase = std::atan2(-f * H / V, amplitude / V);
  }
  double amplitude, phase, limit;
};

TEST(DenHartog, HarmonicFrictionWithoutStopsIsItsClosedFormByEverySolver) {
  for (const double b : {0.55, 0.8, 1.4, 2.5}) {
    const double f = 0.8 * DenHartog(b, 0).limit;
    const DenHartog exact(b, f);
    const System system(model_of("1", "y + f*sign(v)"));
    const double dt = 2 * pi / b / 100;
    const Excitation force = force_of(600 * dt, dt, [&](double t) { return std::cos(b * t + exact.phase); });
    for (const Solver solver : all_solvers()) {
      const lunid::Run run =
          simulate(system, std::vector<double>{f}, force, state({exact.amplitude, 0}), precise(solver));
      ASSERT_TRUE(run.summary.completed) << run.summary.cause;
      for (Eigen::Index i = 0; i < run.x.rows(); i += 50) {  // the ends of the half cycles
        EXPECT_NEAR(run.x(i, 0), (i % 100 == 0 ? 1 : -1) * exact.amplitude, 3e-6) << run.summary.solver << " b " << b;
        EXPECT_NEAR(run.x(i, 1), 0, 1e-5) << run.summary.solver << " b " << b;
      }
      EXPECT_NEAR(run.summary.stuck, 0, 1e-4) << run.summary.solver;
      EXPECT_NEAR(static_cast<double>(run.summary.events), 12, 1)
          << run.summary.solver;  // two per period, ends included
    }
  }
}

/// From any start the motion finds Den Hartog's: friction damps the rest away where the frequencies differ enough.
TEST(DenHartog, MotionStopsOrNotOnTheSideOfHisLimit) {
  const System system(model_of("1", "y + f*sign(v)"));
  for (const double b : {0.3, 0.45, 0.7, 1.3, 2.0}) {
    const double limit = DenHartog(b, 0).limit, dt = 2 * pi / b / 100;
    const Excitation force = force_of(10000 * dt, dt, [&](double t) { return std::cos(b * t); });
    const auto stuck_late = [&](double f) {
      const lunid::Run early =
          simulate(system, std::vector<double>{f}, force.part(0, 8001), state({0.3, 0}), precise(Solver::fixed));
      const lunid::Run whole = simulate(system, std::vector<double>{f}, force, state({0.3, 0}), precise(Solver::fixed));
      EXPECT_TRUE(whole.summary.completed) << whole.summary.cause;
      return whole.summary.stuck - early.summary.stuck;
    };
    EXPECT_NEAR(stuck_late(0.95 * limit), 0, 1e-9) << "b " << b << " limit " << limit;
    EXPECT_GT(stuck_late(1.05 * limit), 0.01) << "b " << b << " limit " << limit;
  }
}

/// y'' + y + f sign(v) = cos(b t) in exact pieces: slides until v = 0, then turns or rests until the force breaks it
/// loose.
class FrictionPieces {
 public:
  FrictionPieces(double b, double f, double y, double v) : b_(b), f_(f), y_(y), v_(v) { decide(); }
  int stops = 0;
  double stuck_until(double t) const { return stuck_ - (side_ == 0 ? end_ - t : 0); }

  double y_at(double t) {
    while (t > end_) next();
    return side_ == 0 ? y_ : piece_->y(t);
  }

 private:
  double pull(double t) const { return std::cos(b_ * t) - y_; }
  void decide() {
    side_ = v_ > 0 ? 1 : v_ < 0 ? -1 : std::abs(pull(t_)) <= f_ ? 0 : pull(t_) > 0 ? 1 : -1;
    const double horizon = t_ + 20 / b_, stride = 0.002;
    if (side_ == 0) {
      end_ = first_fall([&](double s) { return f_ - std::abs(pull(s)); }, t_, horizon, stride);
      stuck_ += end_ - t_;
      ++stops;
      return;
    }
    piece_.emplace(LinearPiece::Law{.k = 1, .P = 1, .w = b_, .A = -side_ * f_}, t_, y_, v_);
    end_ = first_fall([&](double s) { return side_ * piece_->v(s); }, t_ + 1e-7, horizon, stride);
  }
  void next() {
    const int leaving = side_ == 0 ? (pull(end_) > 0 ? 1 : -1) : 0;
    if (side_ != 0) y_ = piece_->y(end_);
    t_ = end_;
    v_ = leaving * 1e-300;
    decide();
  }

  double b_, f_, y_, v_, t_ = 0, end_ = 0, stuck_ = 0;
  int side_ = 0;
  std::optional<LinearPiece> piece_;
};

// Slow forcing: the motion stops once, or several times, in each half cycle.
TEST(DenHartog, MotionWithStopsIsThatOfExactPieces) {
  const System system(model_of("1", "y + f*sign(v)"));
  struct Case {
    double b, f;
    int stops;  ///< within five periods
  };
  for (const auto& [b, f, stops] : {Case{0.5, 0.7, 10}, Case{0.8, 0.85, 5}, Case{0.2, 0.4, 18}, Case{0.05, 0.5, 45}}) {
    const double dt = 2 * pi / b / 200;
    const Excitation force = force_of(1000 * dt, dt, [b = b](double t) { return std::cos(b * t); });
    for (const Solver solver : all_solvers()) {
      FrictionPieces exact(b, f, 0, 0);
      const lunid::Run run = simulate(system, std::vector<double>{f}, force, state({0, 0}), precise(solver));
      ASSERT_TRUE(run.summary.completed) << run.summary.cause;
      double worst = 0;
      for (Eigen::Index i = 0; i < run.x.rows(); ++i)
        worst = std::max(worst, std::abs(run.x(i, 0) - exact.y_at(dt * static_cast<double>(i))));
      EXPECT_LT(worst, 2e-6) << run.summary.solver << " b " << b;
      EXPECT_NEAR(run.summary.stuck, exact.stuck_until(1000 * dt), 1e-3) << run.summary.solver << " b " << b;
      EXPECT_GE(exact.stops, stops) << b;
    }
  }
}

/// A ball that falls on a spring at y = 0 and leaves it as fast as it came: the exact motion within one bounce.
double bouncing(double height, double g, double w, double t) {
  const double fall = std::sqrt(2 * height / g), v0 = g * fall, contact = 2 * (pi - std::atan(v0 * w / g)) / w;
  t = std::fmod(t + fall, 2 * fall + contact);  // 0: leaving the spring
  if (t < 2 * fall) return v0 * t - 0.5 * g * t * t;
  const double s = w * (t - 2 * fall);
  return -v0 / w * std::sin(s) - g / (w * w) * (1 - std::cos(s));
}

TEST(Ball, BouncesOnASpringAsItsPiecesSayByEverySolver) {
  const System system(model_of("m", "9.81*m - k*max(-y, 0)"));
  const double k = 1e5, m = 0.5, w = std::sqrt(k / m);
  const auto theta = theta_of(system, {{"m", m}, {"k", k}});
  for (const Solver solver : all_solvers()) {
    const lunid::Run run = simulate(system, theta, zero_force(10, 0.002), state({0.3, 0}), precise(solver));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    EXPECT_EQ(run.summary.events, 40) << run.summary.solver;  // twenty bounces
    double worst = 0;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i)
      worst = std::max(worst, std::abs(run.x(i, 0) - bouncing(0.3, 9.81, w, 0.002 * static_cast<double>(i))));
    EXPECT_LT(worst, 1e-5) << run.summary.solver;
  }
}

// With a damper in the contact the restitution is exp(-pi z / sqrt(1 - z^2)) (z: damping ratio), but for gravity during
// the contact; bounces come ever faster and end at t = sqrt(2 h / g) (1 + e) / (1 - e), where the ball lies on the
// spring.
TEST(Ball, ComesToRestAtTheTimeOfItsRestitution) {
  const System system(model_of("1", "9.81 + where(y < 0, k*y + c*v, 0)"));
  const double g = 9.81, h = 0.5, z = 0.1, e = std::exp(-pi * z / std::sqrt(1 - z * z));
  for (const double w : {3e3, 1e4}) {
    const auto theta = theta_of(system, {{"k", w * w}, {"c", 2 * z * w}});
    const double end = std::sqrt(2 * h / g) * (1 + e) / (1 - e);
    for (const Solver solver : {Solver::automatic, Solver::bdf, Solver::rk45, Solver::esdirk}) {
      const lunid::Run run = simulate(system, theta, zero_force(1.5 * end, 0.005), state({h, 0}), with_solver(solver));
      ASSERT_TRUE(run.summary.completed) << run.summary.cause;
      const Eigen::Index last = run.x.rows() - 1;
      EXPECT_NEAR(run.x(last, 0), -g / (w * w), 1e-3 * g / (w * w)) << run.summary.solver;
      EXPECT_LT(std::abs(run.x(last, 1)), 1e-6) << run.summary.solver;
      Eigen::Index rest = last;
      while (rest > 0 && run.x(rest, 0) < 1e-4) --rest;
      // the last flights, those below 0.1 mm, last 9 ms each and their sum; contacts count pi / w each
      EXPECT_NEAR(0.005 * static_cast<double>(rest), end, 0.1 * end) << run.summary.solver << " w " << w;
      EXPECT_LT(run.summary.events, 200) << run.summary.solver;
    }
  }
}

/// m y'' + c y' + k y + kc max(y - g, 0) = P cos(w t) in exact pieces.
class ImpactPieces {
 public:
  using Law = LinearPiece::Law;
  ImpactPieces(Law free, double kc, double gap, double y, double v) : free_(free), touching_(free), gap_(gap) {
    touching_.k += kc;
    touching_.A += kc * gap;
    begin(y, v);
  }
  int impacts = 0;
  double y_at(double t) {
    while (t > end_) {
      const double y = piece_->y(end_), v = piece_->v(end_);
      t_ = end_;
      touch_ = !touch_;
      impacts += touch_;
      begin(y, v);
    }
    return piece_->y(t);
  }

 private:
  void begin(double y, double v) {
    piece_.emplace(touch_ ? touching_ : free_, t_, y, v);
    end_ = first_fall([&](double s) { return (touch_ ? 1 : -1) * (piece_->y(s) - gap_); }, t_ + 1e-7, t_ + 50, 2e-4);
  }
  Law free_, touching_;
  double gap_, t_ = 0, end_ = 0;
  bool touch_ = false;
  std::optional<LinearPiece> piece_;
};

TEST(ImpactOscillator, IsThatOfExactPiecesByEverySolver) {
  const System system(model_of("m", "c*v + k*y + kc*max(y - g, 0)"));
  const double m = 1.2, c = 0.8, k = 60, P = 20, w = 5;
  const Excitation force = force_of(8, 0.01, [=](double t) { return P * std::cos(w * t); });
  for (const double kc : {600.0, 3e4}) {
    const auto theta = theta_of(system, {{"m", m}, {"c", c}, {"k", k}, {"kc", kc}, {"g", 0.1}});
    for (const Solver solver : all_solvers()) {
      ImpactPieces exact({.m = m, .c = c, .k = k, .P = P, .w = w}, kc, 0.1, 0, 0.2);
      const lunid::Run run = simulate(system, theta, force, state({0, 0.2}), precise(solver));
      ASSERT_TRUE(run.summary.completed) << run.summary.cause;
      double worst = 0;
      for (Eigen::Index i = 0; i < run.x.rows(); ++i)
        worst = std::max(worst, std::abs(run.x(i, 0) - exact.y_at(0.01 * static_cast<double>(i))));
      EXPECT_GE(exact.impacts, 5);
      EXPECT_LT(worst, 1e-5) << run.summary.solver << " kc " << kc;
    }
  }
}

// m y'' = -F sign(y) - f sign(v), f < F: each half swing is (F - f) / (F + f) of the last and quicker by its root, so
// that infinitely many switches are over in a finite time, and the mass lies still from then on.
struct Zeno {
  double F = 3, f = 1, A = 0.5;
  double ratio() const { return (F - f) / (F + f); }
  double end() const {
    return (std::sqrt(2 * A / (F - f)) + std::sqrt(2 * A * ratio() / (F + f))) / (1 - std::sqrt(ratio()));
  }
  double y(double t) const {
    double from = A, side = 1;
    for (; from > 1e-15 * A; from *= ratio(), side = -side) {
      const double in = std::sqrt(2 * from / (F - f)), out = std::sqrt(2 * from * ratio() / (F + f));
      if (t < in) return side * (from - 0.5 * (F - f) * t * t);
      t -= in;
      if (t < out) return -side * ((F - f) * in * t - 0.5 * (F + f) * t * t);
      t -= out;
    }
    return 0;
  }
};

TEST(Zeno, InfinitelyManySwitchesEndInRestByEverySolver) {
  const System system(model_of("1", "F0*sign(y) + f*sign(v)"));
  const Zeno exact;
  const auto theta = theta_of(system, {{"F0", exact.F}, {"f", exact.f}});
  for (const Solver solver : all_solvers()) {
    const lunid::Run run = simulate(system, theta, zero_force(6, 0.01), state({exact.A, 0}), precise(solver));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    double worst = 0;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i)
      worst = std::max(worst, std::abs(run.x(i, 0) - exact.y(0.01 * static_cast<double>(i))));
    EXPECT_LT(worst, 1e-6) << run.summary.solver;
    EXPECT_EQ(run.x(run.x.rows() - 1, 0), 0) << run.summary.solver;
    EXPECT_EQ(run.x(run.x.rows() - 1, 1), 0) << run.summary.solver;
    EXPECT_NEAR(run.summary.stuck, 6 - exact.end(), 1e-3) << run.summary.solver;
    EXPECT_LT(run.summary.events, 2000) << run.summary.solver;
  }
}

TEST(Zeno, EndsWithAMessageWhereSwitchesAreLimited) {
  const System system(model_of("1", "F0*sign(y) + f*sign(v)"));
  const Zeno exact;
  const auto theta = theta_of(system, {{"F0", exact.F}, {"f", exact.f}});
  for (const Solver solver : all_solvers()) {
    SimulateOptions options = precise(solver);
    options.max_events = 6;
    const lunid::Run run = simulate(system, theta, zero_force(6, 0.01), state({exact.A, 0}), options);
    EXPECT_FALSE(run.summary.completed) << run.summary.solver;
    EXPECT_EQ(run.summary.cause.substr(0, 53), "more than 6 switches: the motion chatters at y = 0")
        << run.summary.solver;
    EXPECT_LT(run.summary.stopped_at, exact.end()) << run.summary.solver;
  }
}

}  // namespace
}  // namespace lunid
