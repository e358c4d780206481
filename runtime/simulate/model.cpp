#include "simulate/model.hpp"

#include <algorithm>
#include <cmath>

#include "simulate/inertia.hpp"

namespace lunid {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// One expression of a model, what it is called in messages, and the channels that it may hold.
struct Part {
  Expr expression;
  std::string where;
  std::string_view channels;
};

std::vector<Part> parts_of(const Model& model) {
  std::vector<Part> parts{{model.mass, "mass", "y v t"}, {model.restoring, "restoring", "y v a t"}};
  for (const InternalState& z : model.states) {
    const std::string name = "state '" + z.symbol.name() + "'";
    parts.push_back({z.rate, name + ": rate", "y v a F t"});
    if (z.min.valid()) parts.push_back({z.min, name + ": min", "y v t"});
    if (z.max.valid()) parts.push_back({z.max, name + ": max", "y v t"});
  }
  return parts;
}

void check_states(const Model& model) {
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    const InternalState& z = model.states[i];
    if (!z.symbol.valid() || !z.symbol.is_symbol() || z.symbol.kind() != SymbolKind::state)
      throw InputError("model: states: entry " + std::to_string(i + 1) + " has no state symbol");
    if (!z.rate.valid()) throw InputError("model: state '" + z.symbol.name() + "': no rate is given");
    if (!std::isfinite(z.initial))
      throw InputError("model: state '" + z.symbol.name() + "': initial: expected a finite value, got " +
                       number(z.initial));
    for (std::size_t j = 0; j < i; ++j)
      if (model.states[j].symbol == z.symbol)
        throw InputError("model: state '" + z.symbol.name() + "' is declared twice");
  }
}

/// A bound may follow the motion, but not another bounded state: which of the two holds first would be undecided.
void check_bound(const Model& model, const InternalState& z, Expr bound, const char* side) {
  if (!bound.valid()) return;
  for (const InternalState& other : model.states)
    if ((other.min.valid() || other.max.valid()) && depends_on(bound, other.symbol))
      throw InputError("model: state '" + z.symbol.name() + "': " + side + ": depends on the state '" +
                       other.symbol.name() + "', which is bounded itself");
}

void check_symbols(const Model& model, const Part& part) {
  const std::string padded = " " + std::string(part.channels) + " ";
  for (const Expr& symbol : symbols(part.expression)) {
    if (symbol.kind() == SymbolKind::channel && padded.find(" " + symbol.name() + " ") == std::string::npos)
      throw InputError("model: " + part.where + ": cannot hold the channel '" + symbol.name() + "' (it may hold " +
                       std::string(part.channels) + ")");
    if (symbol.kind() == SymbolKind::state && std::none_of(model.states.begin(), model.states.end(),
                                                           [&](const InternalState& z) { return z.symbol == symbol; }))
      throw InputError("model: " + part.where + ": the state '" + symbol.name() + "' has no rate");
  }
}

void check_parameter(const Parameter& p) {
  const std::string name = "model: parameter '" + p.name + "': ";
  if (std::isnan(p.min) || std::isnan(p.max) || p.min > p.max)
    throw InputError(name + "min " + number(p.min) + " is above max " + number(p.max));
  if (std::isinf(p.value)) throw InputError(name + "expected a finite first guess, got " + number(p.value));
  if (p.value < p.min || p.value > p.max)
    throw InputError(name + "the first guess " + number(p.value) + " is outside its bounds " + number(p.min) + " to " +
                     number(p.max));
}

/// Appends a row for each parameter that has none yet, and refuses rows that nothing uses.
void complete_table(Model& model, const std::vector<Part>& parts) {
  std::vector<std::string> used;
  for (const Part& part : parts)
    for (const Expr& symbol : symbols(part.expression, SymbolKind::parameter)) {
      used.push_back(symbol.name());
      if (!model.find(symbol.name())) {
        Parameter row;
        row.name = symbol.name();
        model.parameters.push_back(std::move(row));
      }
    }
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const Parameter& p = model.parameters[i];
    check_parameter(p);
    for (std::size_t j = 0; j < i; ++j)
      if (model.parameters[j].name == p.name) throw InputError("model: parameter '" + p.name + "' is given twice");
    if (std::find(used.begin(), used.end(), p.name) == used.end())
      throw InputError("model: parameter '" + p.name + "' is in no expression of the model");
  }
}

/// The value of an expression of parameters alone at the table's values; NaN when it depends on more.
double known_value(const Model& model, Expr f) {
  std::vector<Expr> inputs;
  std::vector<double> values;
  for (const Expr& symbol : symbols(f)) {
    if (symbol.kind() != SymbolKind::parameter) return std::numeric_limits<double>::quiet_NaN();
    inputs.push_back(symbol);
    values.push_back(model.find(symbol.name())->value);
  }
  const Tape tape(std::span(&f, 1), inputs);
  std::vector<double> scratch(tape.registers());
  double value = 0;
  tape.run_point(values.data(), &value, scratch.data());
  return value;
}

void check_values(const Model& model) {
  const double mass = known_value(model, model.mass);
  if (model.imposed_motion ? mass < 0 : mass <= 0)
    throw InputError("model: mass: expected " + std::string(model.imposed_motion ? ">= 0" : "> 0") + ", got " +
                     number(mass) + (model.imposed_motion ? "" : " (a mass of 0 needs imposed motion)"));
  for (const InternalState& z : model.states) {
    check_bound(model, z, z.min, "min");
    check_bound(model, z, z.max, "max");
    if (!z.min.valid() || !z.max.valid()) continue;
    const double low = known_value(model, z.min), high = known_value(model, z.max);
    if (low > high)
      throw InputError("model: state '" + z.symbol.name() + "': min " + number(low) + " is above max " + number(high));
  }
}

/// sum + term, written as a difference where the term is negative.
Expr plus(Expr sum, Expr term) {
  if (term.op() == Op::neg) return sum - term.arguments()[0];
  if (term.is_constant() && term.value() < 0) return sum - -term.value();
  return sum + term;
}

std::string state_line(const InternalState& z, Format format) {
  const std::string name = to_text(z.symbol, format);
  std::string line = format == Format::latex ? "\\dot{" + name + "}" : "d" + name + "/dt";
  line += " = " + to_text(z.rate, format);
  const std::string at_most = format == Format::latex ? " \\le " : " <= ";
  if (z.min.valid() || z.max.valid()) {
    line += ", ";
    if (z.min.valid()) line += to_text(z.min, format) + at_most;
    line += name;
    if (z.max.valid()) line += at_most + to_text(z.max, format);
  }
  return line;
}

}  // namespace

const Parameter* Model::find(std::string_view name) const {
  const auto row = std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
  return row == parameters.end() ? nullptr : &*row;
}

Parameter* Model::find(std::string_view name) {
  return const_cast<Parameter*>(static_cast<const Model*>(this)->find(name));
}

std::vector<double> Model::values() const {
  std::vector<double> theta;
  theta.reserve(parameters.size());
  for (const Parameter& p : parameters) theta.push_back(p.value);
  return theta;
}

void Model::set_values(const std::vector<double>& theta) {
  if (theta.size() != parameters.size())
    throw InputError("model: expected " + std::to_string(parameters.size()) + " parameter values, got " +
                     std::to_string(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i) parameters[i].value = theta[i];
}

std::string Model::equation(Format format) const {
  const Expr a = pool->channel("a");
  Expr left = mass.is_constant(0) ? restoring : mass * a;
  if (!mass.is_constant(0))  // one sum, without a pair of parentheses round the restoring force
    for (const Expr& term : summands(restoring)) left = plus(left, term);
  std::string text = to_text(left, format) + " = " + to_text(pool->channel("F"), format);
  for (const InternalState& z : states) text += "\n" + state_line(z, format);
  return text;
}

Model complete(Model model) {
  if (!model.pool) throw InputError("model: no pool of expressions");
  if (!model.mass.valid()) throw InputError("model: no mass is given");
  if (!model.restoring.valid()) throw InputError("model: no restoring force is given");
  check_states(model);
  const std::vector<Part> parts = parts_of(model);
  for (const Part& part : parts) check_symbols(model, part);
  split_inertia(model.restoring, model.pool->channel("a"));
  complete_table(model, parts);
  check_values(model);
  return model;
}

}  // namespace lunid
