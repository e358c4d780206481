#pragma once
// A regression in Lua: its options, and what it gives.
#include <optional>
#include <string>

#include "regress/regress.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A regression with what its features' symbols were declared as, and the model that it gives.
struct SolvedRegression {
  Regression result;
  DeclarationsPtr declared;
  std::optional<Model> model;  ///< none with lags
  std::string why_none;        ///< why there is no model
};

template <>
struct Bound<SolvedRegression> {
  static constexpr const char* key = "lunid.regression";
  static constexpr const char* words = "a regression";
};

/// Fills in what a study says of constraints, groups, passivity, weak form, solver, objective and search: the table at
/// `index`, as stdlib/regression.lua made it.
void regress_options(lua_State* L, int index, RegressOptions& options);

/// Methods of a regression.
int regression_field(lua_State* L);
int regression_text(lua_State* L);

}  // namespace lunid::lua
