#pragma once
// Inside regress: the least value of a function in the box [0, 1]^n.
#include <functional>
#include <string>
#include <vector>

#include "regress/search.hpp"

namespace lunid::detail {

/// What is minimised. May throw: no exception crosses a library's frame.
struct Objective {
  int size = 0;
  /// Value at x (`size` entries in [0, 1]); the gradient too where it is not null.
  std::function<double(const double* x, double* gradient)> value;
  int blocks = 1;  ///< parts of which the value is the mean
  std::function<double(const double* x, double* gradient, int block)> part;
};

struct Minimum {
  std::vector<double> x;
  double value = 0;
};

/// The least value found, by the method asked for.
Minimum minimise(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);

/// NLopt's method of this name, from one start; `global` ones stop after options.evaluations.
Minimum minimise_by_nlopt(const Objective& objective, std::vector<double> start, const SearchOptions& options);
/// A local descent (SLSQP).
Minimum descend(const Objective& objective, std::vector<double> start);

// Our own, where NLopt has none.
Minimum anneal(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);
Minimum swarm(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);
Minimum jump_puddles(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);
Minimum scatter(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);
Minimum drift(const Objective& objective, const std::vector<double>& start, const SearchOptions& options);

}  // namespace lunid::detail
