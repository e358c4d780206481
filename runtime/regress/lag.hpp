#pragma once
// Lags: a channel as it was some samples ago, for regressions on sampled data.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "expr/expr.hpp"

namespace lunid {

struct Lag {
  std::string channel;
  int samples = 0;  ///< >= 1
};

/// The channel `y_lag3`: y three samples before. Throws InputError when `signal` is no channel or samples < 1.
Expr lag(Expr signal, int samples);
/// What a channel's name says: "y_lag3" is {y, 3}; nullopt for any other.
std::optional<Lag> lag_of(std::string_view channel);
/// The largest lag in these expressions, 0 without any.
int largest_lag(const std::vector<Expr>& expressions);
/// The first lag in an expression, such as "y_lag3", or "".
std::string first_lag(Expr expression);

}  // namespace lunid
