// Sensitivities by complex step (Squire & Trapp 1998, SIAM Rev. 40, 110): the same fixed steps on complex numbers, with
// 1e-30 i beside one parameter, have its exact sensitivity in their imaginary part. One model for each operation that
// continues into the complex plane; all of them are restoring forces in parallel with a spring and a dashpot.
#include <complex>

#include "simulate/dormand_prince.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;
using testing::zero_force;
using Complex = std::complex<double>;

struct Operation {
  const char* text;  ///< of p, q, y and v
  std::function<Complex(Complex p, Complex q, Complex y, Complex v)> value;
};

const Operation operations[] = {
    {"p*y - q*v", [](auto p, auto q, auto y, auto v) { return p * y - q * v; }},
    {"p*y/(2 + q*v)", [](auto p, auto q, auto y, auto v) { return p * y / (2.0 + q * v); }},
    {"-q*(-p*y)", [](auto p, auto q, auto y, auto) { return -q * (-p * y); }},
    {"q*(p*y)^3", [](auto p, auto q, auto y, auto) { return q * (p * y) * (p * y) * (p * y); }},
    {"(2 + p*y)^q", [](auto p, auto q, auto y, auto) { return std::pow(2.0 + p * y, q); }},
    {"q*sin(p*y)", [](auto p, auto q, auto y, auto) { return q * std::sin(p * y); }},
    {"q*cos(p*y)", [](auto p, auto q, auto y, auto) { return q * std::cos(p * y); }},
    {"q*tan(p*y)", [](auto p, auto q, auto y, auto) { return q * std::tan(p * y); }},
    {"q*asin(p*y)", [](auto p, auto q, auto y, auto) { return q * std::asin(p * y); }},
    {"q*acos(p*y)", [](auto p, auto q, auto y, auto) { return q * std::acos(p * y); }},
    {"q*atan(p*y)", [](auto p, auto q, auto y, auto) { return q * std::atan(p * y); }},
    {"q*sinh(p*y)", [](auto p, auto q, auto y, auto) { return q * std::sinh(p * y); }},
    {"q*cosh(p*y)", [](auto p, auto q, auto y, auto) { return q * std::cosh(p * y); }},
    {"q*tanh(p*y)", [](auto p, auto q, auto y, auto) { return q * std::tanh(p * y); }},
    {"q*exp(p*y)", [](auto p, auto q, auto y, auto) { return q * std::exp(p * y); }},
    {"q*log(2 + p*y)", [](auto p, auto q, auto y, auto) { return q * std::log(2.0 + p * y); }},
    {"q*sqrt(2 + p*y)", [](auto p, auto q, auto y, auto) { return q * std::sqrt(2.0 + p * y); }},
};

/// y and v after `steps` of the method from (y, v) under no force.
std::array<Complex, 2> steps_of(const Operation& o, Complex p, Complex q, Complex y, Complex v, double h, int steps) {
  namespace dp = dormand_prince;
  const auto acceleration = [&](Complex y, Complex v) { return -(0.3 * v + 20.0 * y + o.value(p, q, y, v)); };
  for (int i = 0; i < steps; ++i) {
    Complex ky[dp::stages], kv[dp::stages];
    const auto at = [&](int stage) {
      Complex dy = 0, dv = 0;
      for (int j = 0; j < stage; ++j) dy += dp::weight[stage][j] * ky[j], dv += dp::weight[stage][j] * kv[j];
      return std::array<Complex, 2>{y + h * dy, v + h * dv};
    };
    for (int stage = 0; stage < dp::stages; ++stage) {
      const auto [sy, sv] = at(stage);
      ky[stage] = sv;
      kv[stage] = acceleration(sy, sv);
    }
    const auto [next_y, next_v] = at(dp::stages);
    y = next_y;
    v = next_v;
  }
  return {y, v};
}

TEST(ComplexStep, HasTheSensitivitiesOfEveryOperation) {
  constexpr double dt = 0.02, tiny = 1e-30;
  constexpr int rows = 101, substeps = 2;
  for (const Operation& o : operations) {
    const System system(model_of("1", std::string("0.3*v + 20*y + ") + o.text));
    const auto theta = theta_of(system, {{"p", 1.7}, {"q", 0.6}});
    const SensitivityRun run = simulate_sensitivities(system, theta, zero_force(dt * (rows - 1), dt),
                                                      state({0.3, -0.4}), with_substeps(substeps));
    ASSERT_TRUE(run.run.summary.completed) << o.text << ": " << run.run.summary.cause;
    for (int c = 0; c < 4; ++c) {
      Complex values[] = {theta[0], theta[1], 0.3, -0.4};
      values[c] += Complex(0, tiny);
      const bool p_first = system.model().parameters[0].name == "p";
      const auto end = steps_of(o, values[p_first ? 0 : 1], values[p_first ? 1 : 0], values[2], values[3],
                                dt / substeps, (rows - 1) * substeps);
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(run.run.x(rows - 1, i), end[static_cast<std::size_t>(i)].real(), 1e-12) << o.text;
        const double exact = end[static_cast<std::size_t>(i)].imag() / tiny;
        EXPECT_NEAR(run.dx[static_cast<std::size_t>(i)](rows - 1, c), exact, 1e-11 * (1 + std::abs(exact)))
            << o.text << ", state " << i << ", column " << c;
      }
    }
  }
}

}  // namespace
}  // namespace lunid
