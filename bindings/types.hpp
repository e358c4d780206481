#pragma once
// The bound types: what each userdata holds, its key and its words. The one list of what is bound is in types.cpp.
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "record/record.hpp"
#include "simulate/fit.hpp"
#include "simulate/model.hpp"
#include "simulate/response.hpp"
#include "simulate/simulate.hpp"
#include "support.hpp"

namespace lunid::lua {

/// A function of the language that the runtime or Lua computes (expr/external.hpp).
using FunctionPtr = std::shared_ptr<const ExternalFunction>;
/// Pushes the function of the arguments from index `first` on: an expression, or of numbers alone a number.
int call_external(lua_State* L, const FunctionPtr& function, int first);

/// A parameter as the user declared it, and where.
struct DeclaredParameter {
  Parameter parameter;
  std::string place;  ///< "study.lua:3", "" when the text of an option declared it
};
struct DeclaredState {
  InternalState state;
  std::string place;
};
/// What an expression's symbols were declared as. Immutable and shared between expressions.
struct Declarations {
  std::vector<DeclaredParameter> parameters;
  std::vector<DeclaredState> states;
};
using DeclarationsPtr = std::shared_ptr<const Declarations>;

/// An expression in Lua: the node, which holds identity only, and what its symbols were declared as.
struct Value {
  Expr expr;
  DeclarationsPtr declared;  ///< null: nothing declared
};
/// Joins two sets. Throws InputError when a name is declared twice with different values.
DeclarationsPtr join(const DeclarationsPtr& a, const DeclarationsPtr& b);
/// The row of a parameter as it was declared, or null.
const Parameter* find_declared(const DeclarationsPtr& declared, const std::string& name);
/// A Value or a number as a Value; throws InputError otherwise.
Value check_value(lua_State* L, int index);
Value field_value(lua_State* L, int index, const char* field);  ///< empty Expr when absent
/// The rows of a model's table as declarations, so that its expressions can be used again.
DeclarationsPtr declarations_of(const Model& model);
/// A parameter as a Lua table {name, value, min, max, unit, std, fixed}; what is not finite is left out.
void push_parameter(lua_State* L, const Parameter& parameter);
/// List of parameters, each also under its name.
void push_parameters(lua_State* L, const std::vector<Parameter>& parameters);

/// A column of numbers, shared and read-only.
struct Column {
  std::shared_ptr<const Eigen::VectorXd> values;
};
void push_column(lua_State* L, const Eigen::VectorXd& values);
/// A Column or a list of numbers.
Eigen::VectorXd check_column(lua_State* L, int index);

/// The field `interpolation`; without it a record's own.
std::optional<Interpolation> interpolation_field(lua_State* L, int index);

/// A free run, with the excitation that drove it.
struct FreeRun {
  Run run;
  std::vector<Channel> inputs;                 ///< F, or F1 F2 ..., yb vb ab: what they did between samples, too
  std::vector<std::string> states;             ///< names of the columns of x: y v z..., or y1 v1 ...
  std::vector<std::string> accelerations;      ///< of the columns of a: a, or a1 a2 ...
  std::vector<Eigen::MatrixXd> sensitivities;  ///< SensitivityRun::dx, where they were asked for
  std::vector<std::string> parameters;         ///< of its first columns
  std::string name;
  std::string place;  ///< "study.lua:14", which asked for it
  /// The run up to a time between its rows.
  std::function<Run(const Run&, double t)> up_to;
};

/// A fit on the trajectory, with what its profiles need.
struct TrajectoryFit {
  std::shared_ptr<const System> system;
  std::vector<FitData> data;
  FitOptions options;
  FitResult result;
  std::vector<std::string> notes;                             ///< on external functions: what they cost
  double checked = std::numeric_limits<double>::quiet_NaN();  ///< as check_by_sundials
};

template <>
struct Bound<TrajectoryFit> {
  static constexpr const char* key = "lunid.trajectory_fit";
  static constexpr const char* words = "a trajectory fit";
};
template <>
struct Bound<Value> {
  static constexpr const char* key = "lunid.expression";
  static constexpr const char* words = "an expression";
};
template <>
struct Bound<FunctionPtr> {
  static constexpr const char* key = "lunid.function";
  static constexpr const char* words = "a function of the language";
};
template <>
struct Bound<Column> {
  static constexpr const char* key = "lunid.column";
  static constexpr const char* words = "a column";
};
template <>
struct Bound<Record> {
  static constexpr const char* key = "lunid.record";
  static constexpr const char* words = "a record";
};
template <>
struct Bound<Model> {
  static constexpr const char* key = "lunid.model";
  static constexpr const char* words = "a model";
};
template <>
struct Bound<FreeRun> {
  static constexpr const char* key = "lunid.run";
  static constexpr const char* words = "a run";
};
template <>
struct Bound<ResponseCurve> {
  static constexpr const char* key = "lunid.response_curve";
  static constexpr const char* words = "a response curve";
};
template <>
struct Bound<Backbone> {
  static constexpr const char* key = "lunid.backbone";
  static constexpr const char* words = "a backbone";
};

/// Makes a type's metatable and adds its functions to the module table on top of the stack.
using Opener = void (*)(lua_State* L);
/// The one list of what is bound, in order.
std::span<const Opener> openers();

}  // namespace lunid::lua
