#pragma once
// External functions for tests, out of lambdas.
#include <cmath>
#include <functional>
#include <string>

#include "expr/external.hpp"

namespace lunid::testing {

class Given final : public ExternalFunction {
 public:
  using Value = std::function<double(const double*)>;
  using Gradient = std::function<void(const double*, double*)>;
  Given(std::string name, int arity, Value value, Gradient gradient = {}, bool safe = true)
      : ExternalFunction(std::move(name), arity),
        value_(std::move(value)),
        gradient_(std::move(gradient)),
        safe_(safe) {}
  bool has_gradient() const override { return static_cast<bool>(gradient_); }
  bool thread_safe() const override { return safe_; }
  mutable std::atomic<int> calls{0};

 protected:
  double value(const double* x) const override { return ++calls, value_(x); }
  void gradient(const double* x, double* slopes) const override { gradient_(x, slopes); }

 private:
  Value value_;
  Gradient gradient_;
  bool safe_;
};

/// f(a, b) = sin(a) exp(b), with its gradient or without.
inline std::shared_ptr<const Given> sine_growth(bool with_gradient, const std::string& name = "f") {
  Given::Gradient gradient = [](const double* x, double* d) {
    d[0] = std::cos(x[0]) * std::exp(x[1]);
    d[1] = std::sin(x[0]) * std::exp(x[1]);
  };
  return std::make_shared<Given>(
      name, 2, [](const double* x) { return std::sin(x[0]) * std::exp(x[1]); },
      with_gradient ? gradient : Given::Gradient{});
}

}  // namespace lunid::testing
