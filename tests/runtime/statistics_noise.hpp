#pragma once
// Coloured noise of known colour, the share of false alarms of a test, and what an error says. The random numbers are
// the standard library's, not those of the code under test.
#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "expr/error.hpp"

namespace lunid::test {

inline std::span<const double> span_of(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// x_t = sum coefficients x_(t-i) + e_t with e of standard deviation 1, after a start-up of 500 rows.
inline Eigen::VectorXd autoregressive(int rows, const std::vector<double>& coefficients, std::uint64_t seed) {
  std::mt19937_64 random(1000003 * seed + 17);
  std::normal_distribution<double> normal;
  const int start_up = 500;
  std::vector<double> x(static_cast<std::size_t>(rows + start_up));
  for (std::size_t t = 0; t < x.size(); ++t) {
    x[t] = normal(random);
    for (std::size_t i = 0; i < coefficients.size() && i < t; ++i) x[t] += coefficients[i] * x[t - 1 - i];
  }
  return Eigen::Map<Eigen::VectorXd>(x.data() + start_up, rows);
}

/// Share of draws whose p-value is at most 5 %.
template <class Test>
double alarms(int draws, Test test) {
  int count = 0;
  for (int draw = 1; draw <= draws; ++draw) count += test(static_cast<std::uint64_t>(draw)) <= 0.05;
  return static_cast<double>(count) / draws;
}

/// The text of the InputError that `body` throws, "" for none.
template <class Body>
std::string message_of(Body body) {
  try {
    body();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace lunid::test
