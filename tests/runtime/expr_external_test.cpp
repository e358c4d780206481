// External functions: values in every kind of run, derivatives against those of the language, printing, errors.
#include "expr_external.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "expr/tape.hpp"
#include "message.hpp"

namespace lunid {
namespace {

using testing::Given;
using testing::sine_growth;

class External : public ::testing::Test {
 protected:
  Expr call(const std::shared_ptr<const ExternalFunction>& f, std::vector<Expr> arguments) {
    return pool.call(f, arguments);
  }
  double at(Expr f, double y_value, double v_value) {
    const Expr inputs[] = {y, v};
    const Tape tape(std::span(&f, 1), inputs);
    std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
    const double in[] = {y_value, v_value};
    double out = 0;
    tape.run_point(in, &out, scratch.data());
    return out;
  }
  Pool pool;
  Expr y = pool.channel("y"), v = pool.channel("v");
};

TEST_F(External, every_kind_of_run_gives_the_same_bits) {
  // Four arguments, one of them used twice, beside a switch and products that are fused.
  const auto f = std::make_shared<Given>("f", 4, [](const double* x) { return x[0] - 2 * x[1] * x[2] + x[3]; });
  const Expr expression = 3.0 * call(f, {y, v, y * v, pool.constant(5)}) * v + pool.apply(Op::abs, {y});
  const Expr inputs[] = {y, v};
  const Tape tape(std::span(&expression, 1), inputs);
  EXPECT_EQ(tape.switches(), 1);
  constexpr int rows = 300;  // more than a block
  std::vector<double> in_y(rows), in_v(rows), out(rows), scratch(static_cast<std::size_t>(tape.registers()));
  for (int i = 0; i < rows; ++i) in_y[i] = std::sin(i), in_v[i] = std::cos(3 * i);
  const double* in[] = {in_y.data(), in_v.data()};
  const int stride[] = {1, 1};
  double* const to[] = {out.data()};
  tape.run_columns(in, stride, rows, to);

  constexpr int lanes = Tape::lane_group;
  std::vector<double> memory(static_cast<std::size_t>(tape.registers()) * lanes);
  std::vector<double*> place;
  for (int r = 0; r < tape.registers(); ++r) place.push_back(memory.data() + r * lanes);
  tape.prepare_lanes(place.data(), lanes);
  std::copy_n(in_y.data(), lanes, place[0]);
  std::copy_n(in_v.data(), lanes, place[1]);
  tape.run_lanes(place.data(), lanes);

  for (int i = 0; i < rows; ++i) {
    const double a = in_y[i], b = in_v[i];
    const double expected = 3 * (a - 2 * b * (a * b) + 5) * b + std::fabs(a);
    double point = 0, frozen = 0, g = 0;
    const double x[] = {a, b};
    tape.run_point(x, &point, scratch.data());
    EXPECT_EQ(point, expected);
    EXPECT_EQ(out[i], expected);
    if (i < lanes) {
      EXPECT_EQ(place[static_cast<std::size_t>(tape.output_place())][i], expected);
    }
    const std::int8_t mode = a > 0 ? 1 : -1;
    tape.run_frozen(x, &mode, &frozen, &g, scratch.data());
    EXPECT_EQ(frozen, expected);
    EXPECT_EQ(g, a);
  }
  EXPECT_TRUE(tape.reads(0) && tape.reads(1));
}

TEST_F(External, derivatives_are_those_of_the_same_formula_in_the_language) {
  const Expr formula = parse(pool, "sin(y*v)*exp(v^2)");
  for (const bool with_gradient : {true, false}) {
    const Expr called = call(sine_growth(with_gradient, with_gradient ? "f" : "g"), {y * v, pow(v, 2)});
    for (const Expr by : {y, v})
      for (const double a : {-1.2, 0.0, 0.7})
        for (const double b : {-0.4, 0.9}) {
          const double expected = at(derivative(formula, by), a, b);
          // Central differences: h^2/6 of the third derivative and eps/h of the value, with h = 6e-6.
          EXPECT_NEAR(at(derivative(called, by), a, b), expected,
                      with_gradient ? 1e-14 : 2e-9 + 1e-8 * std::fabs(expected));
        }
  }
}

TEST_F(External, second_derivatives_are_differences_of_the_gradient) {
  const Expr formula = parse(pool, "sin(y)*exp(v)"), called = call(sine_growth(true), {y, v});
  for (const Expr first : {y, v})
    for (const Expr second : {y, v}) {
      const Expr twice = derivative(derivative(called, first), second);
      EXPECT_NEAR(at(twice, 0.3, 0.4), at(derivative(derivative(formula, first), second), 0.3, 0.4), 1e-9);
      EXPECT_EQ(message([&] { derivative(twice, y); }), "function 'f': has no third derivative");
    }
  EXPECT_EQ(derivative(derivative(called, y), v), derivative(derivative(called, v), y));
  const Expr plain = call(sine_growth(false, "g"), {y, v});
  EXPECT_EQ(message([&] { derivative(derivative(plain, y), v); }),
            "function 'g': has no second derivative, because its gradient is not known: give it one");
}

TEST_F(External, calls_are_consed_printed_and_substituted) {
  const auto f = sine_growth(true), g = sine_growth(true, "g_1");
  const Expr called = call(f, {y, v});
  EXPECT_EQ(called, call(f, {y, v}));
  EXPECT_NE(called, call(f, {v, y}));
  EXPECT_NE(called, call(g, {y, v}));
  EXPECT_EQ(to_text(2.0 * called - y), "2*f(y, v) - y");
  EXPECT_EQ(to_text(called, Format::lua), "f(y, v)");
  EXPECT_EQ(to_text(pow(call(g, {y, v}), 2), Format::latex),
            "\\left(\\operatorname{g\\_1}\\left(y, v\\right)\\right)^{2}");
  EXPECT_EQ(to_text(derivative(called, v)), "f_d2(y, v)");
  EXPECT_EQ(to_text(derivative(derivative(called, v), y)), "f_d12(y, v)");
  EXPECT_EQ(to_text(derivative(called, y), Format::latex), "\\partial_{1}\\operatorname{f}\\left(y, v\\right)");
  const std::pair<Expr, Expr> swap[] = {{y, v}, {v, y}};
  EXPECT_EQ(substitute(called, swap), call(f, {v, y}));
  EXPECT_EQ(substitute(derivative(called, y), swap), derivative(call(f, {v, y}), v));
  const Expr parts[] = {called + y, call(g, {y, y})};
  EXPECT_EQ(external_functions(parts).size(), 2u);
}

TEST_F(External, what_cannot_be_called_is_refused) {
  EXPECT_EQ(message([] { Given("f", 5, [](const double*) { return 0.0; }); }),
            "function 'f': expected 1 to 4 arguments, got 5");
  EXPECT_EQ(message([] { Given("f", 0, [](const double*) { return 0.0; }); }),
            "function 'f': expected 1 to 4 arguments, got 0");
  EXPECT_EQ(message([] { Given("2f", 1, [](const double*) { return 0.0; }); }),
            "name '2f': expected a letter or _, then letters, digits or _");
  EXPECT_EQ(message([&] { call(sine_growth(true), {y}); }), "f: takes 2 arguments, got 1");
  const Expr condition = pool.apply(Op::greater, {y, v});
  EXPECT_EQ(message([&] {
              call(sine_growth(true), {condition, v});
            }),
            "f: a comparison may stand only in the first argument of where(condition, a, b)");
  EXPECT_EQ(message([&] {
              call(sine_growth(true, "sin"), {y, v});
            }),
            "name 'sin': is a word of the language, choose another");
  call(sine_growth(true), {y, v});
  EXPECT_EQ(message([&] {
              call(sine_growth(true), {y, v});
            }),
            "name 'f': is taken already, choose another for the function");
  EXPECT_EQ(message([&] { pool.parameter("f"); }), "name 'f': is a function already, not a parameter");
  EXPECT_EQ(pool.free_name("f"), "f2");
  EXPECT_EQ(pool.free_name("g"), "g");
  EXPECT_EQ(message([&] { pool.add(sine_growth(true, pool.free_name("y"))); }),
            "name 'y': is a channel, not a function; choose another name");
}

TEST_F(External, an_error_gives_nan_until_it_is_rethrown) {
  const auto f = std::make_shared<Given>("f", 2, [](const double* x) -> double {
    if (x[0] > 1) throw InputError("y is above 1");
    return x[0];
  });
  const Expr called = call(f, {y, v});
  EXPECT_EQ(at(called, 0.5, 0), 0.5);
  EXPECT_TRUE(std::isnan(at(called, 2, 0)));
  const int calls = f->calls;
  EXPECT_TRUE(std::isnan(at(called, 0.5, 0)));  // it is not called again
  EXPECT_EQ(f->calls, calls);
  const Expr inputs[] = {y, v};
  const Tape tape(std::span(&called, 1), inputs);
  EXPECT_EQ(message([&] { tape.rethrow(); }), "y is above 1");
  EXPECT_EQ(message([&] { tape.rethrow(); }), "no error");
  EXPECT_EQ(at(called, 0.5, 0), 0.5);
  at(called, 2, 0);
  const ExternalWatch watch(pool);  // forgets what was before it
  EXPECT_EQ(at(called, 0.5, 0), 0.5);
  EXPECT_EQ(message([&] { watch.rethrow(); }), "no error");
}

TEST_F(External, what_is_not_finite_is_not_handed_on) {
  const auto f = std::make_shared<Given>("f", 2, [](const double*) { return 1.0; });
  const Expr called = call(f, {y, v});
  EXPECT_TRUE(std::isnan(at(called, std::nan(""), 0)));
  EXPECT_TRUE(std::isnan(at(called, 0, INFINITY)));
  EXPECT_EQ(f->calls, 0);
}

TEST_F(External, a_watch_tells_derivatives_by_differences) {
  const Expr called = call(sine_growth(false), {y, v});
  const ExternalWatch watch(pool);
  EXPECT_TRUE(watch.notes().empty());
  at(derivative(called, y), 0.1, 0.2);
  ASSERT_EQ(watch.notes().size(), 1u);
  EXPECT_EQ(watch.notes()[0], "function 'f': 1 derivatives by central differences, for want of a gradient");
}

}  // namespace
}  // namespace lunid
