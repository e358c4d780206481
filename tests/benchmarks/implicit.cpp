// lunid_implicit: the searches for parameters inside features on four problems, from 50 first guesses each. A search
// has succeeded when it reaches the least value that any of them found, to 1e-6 of it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "expr/tape.hpp"
#include "record/random.hpp"
#include "regress/regress.hpp"

namespace {

constexpr int starts = 50, rows = 800, evaluations = 300;

struct Problem {
  const char* name;
  std::vector<const char*> features;
  const char* truth;
  std::vector<lunid::ImplicitParameter> implicit;
};

lunid::ImplicitParameter parameter(const char* name, double min, double max) {
  lunid::ImplicitParameter p;
  p.name = name;
  p.min = min;
  p.max = max;
  return p;
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = {
      {"tanh(p*y)", {"v", "y", "tanh(p*y)"}, "10*v + 30*tanh(80*y)", {parameter("p", 1, 500)}},
      {"cos(A*y)", {"v", "y", "cos(A*y)"}, "10*v + 20*cos(900*y)", {parameter("A", 1, 2000)}},
      {"cos(A*y), sin(B*v)",
       {"v", "y", "cos(A*y)", "sin(B*v)"},
       "10*v + 20*cos(900*y) + 8*sin(7*v)",
       {parameter("A", 1, 2000), parameter("B", 0.1, 20)}},
      {"tanh(p*y), exp(-q*y^2), cos(A*v)",
       {"v", "tanh(p*y)", "y*exp(-q*y^2)", "cos(A*v)"},
       "10*v + 30*tanh(200*y) + 2000*y*exp(-3e4*y^2) + 5*cos(6*v)",
       {parameter("p", 1, 500), parameter("q", 100, 1e5), parameter("A", 0.1, 20)}},
  };
  return all;
}

/// A motion of two tones, and a force with 5 % noise.
lunid::Record record_of(lunid::Pool& pool, const char* truth) {
  std::vector<lunid::Channel> channels(3);
  for (std::size_t i = 0; i < 3; ++i) {
    channels[i].name = std::string(1, "yvF"[i]);
    channels[i].values.resize(rows);
  }
  const lunid::Expr inputs[] = {pool.channel("y"), pool.channel("v")}, force = parse(pool, truth);
  const lunid::Tape tape({&force, 1}, inputs);
  std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
  for (int i = 0; i < rows; ++i) {
    const double t = 1.25e-3 * i, w = 120;
    const double in[] = {8e-3 * std::sin(w * t) + 3e-3 * std::sin(1.7 * w * t + 1),
                         8e-3 * w * std::cos(w * t) + 5.1e-3 * w * std::cos(1.7 * w * t + 1)};
    double out = 0;
    tape.run_point(in, &out, scratch.data());
    channels[0].values[i] = in[0];
    channels[1].values[i] = in[1];
    channels[2].values[i] = out;
  }
  lunid::Philox random(1, 0);
  const double size = std::sqrt(channels[2].values.squaredNorm() / rows);
  for (double& f : channels[2].values) f += 0.05 * size * random.normal();
  return lunid::Record("two tones", 0, 1.25e-3, std::move(channels));
}

struct Run {
  double rmse, seconds;
  long passes;
};

Run solve(lunid::Pool& pool, const lunid::Record& record, const Problem& problem, lunid::SearchMethod method,
          int start) {
  lunid::RegressOptions options;
  for (const char* feature : problem.features) options.features.push_back(parse(pool, feature));
  options.implicit = problem.implicit;
  lunid::Philox random(99, static_cast<std::uint64_t>(start));
  for (lunid::ImplicitParameter& p : options.implicit) p.value = p.min + random.uniform() * (p.max - p.min);
  options.search.method = method;
  options.search.starts = 1;
  options.search.evaluations = evaluations;
  options.search.seed = static_cast<std::uint64_t>(start) + 1;
  options.blocks = 4;
  options.threads = 1;
  const auto from = std::chrono::steady_clock::now();
  const lunid::Regression result = regress({&record, 1}, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
  return {result.rmse, seconds, result.passes};
}

void compare(const Problem& problem) {
  lunid::Pool pool;
  pool.channel("y"), pool.channel("v");
  const lunid::Record record = record_of(pool, problem.truth);
  std::vector<std::vector<Run>> all;
  double least = HUGE_VAL;
  for (std::size_t method = 0; method < lunid::search_methods().size(); ++method) {
    all.emplace_back();
    for (int start = 0; start < starts; ++start) {
      all.back().push_back(solve(pool, record, problem, static_cast<lunid::SearchMethod>(method), start));
      least = std::min(least, all.back().back().rmse);
    }
  }
  std::printf("%s, %zu unknown inside\n", problem.name, problem.implicit.size());
  for (std::size_t method = 0; method < all.size(); ++method) {
    int found = 0;
    double seconds = 0, passes = 0;
    for (const Run& run : all[method]) {
      found += run.rmse <= least * (1 + 1e-6);
      seconds += run.seconds / starts;
      passes += static_cast<double>(run.passes) / starts;
    }
    std::printf("  %-20s found %2d of %d   evaluations %6.1f   %7.2f ms\n", lunid::search_methods()[method].c_str(),
                found, starts, passes, 1e3 * seconds);
  }
}

}  // namespace

int main() {
  for (const Problem& problem : problems()) compare(problem);
}
