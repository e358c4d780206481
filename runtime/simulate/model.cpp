#include "simulate/model.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "simulate/inertia.hpp"

namespace lunid {
namespace {

/// One expression of a model, what it is called in messages, and the quantities whose channels it may hold.
struct Part {
  Expr expression;
  std::string where;
  std::string_view quantities;  ///< of "y v a F" and t; b: the motion of base and shaft; r: force_rate
};

std::vector<Part> parts_of(const Model& model) {
  std::vector<Part> parts;
  for (int i = 0; i < model.degrees(); ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    const std::string which = model.degrees() > 1 ? " of y" + std::to_string(i + 1) : "";
    parts.push_back({mass, "mass" + which, "yvt"});
    parts.push_back({restoring, "restoring" + which, "yvatb"});
  }
  if (model.delay.valid()) parts.push_back({model.delay, "delay", ""});
  for (const auto& [channel, map] : model.measures) parts.push_back({map, "measures: " + channel, "yvat"});
  for (const auto& [channel, map] : model.acts) parts.push_back({map, "acts: " + channel, "Ftryv"});
  for (const InternalState& z : model.states) {
    const std::string name = "state '" + z.symbol.name() + "'";
    parts.push_back({z.rate, name + ": rate", "yvaFtb"});
    if (z.min.valid()) parts.push_back({z.min, name + ": min", "yvt"});
    if (z.max.valid()) parts.push_back({z.max, name + ": max", "yvt"});
  }
  return parts;
}

/// "y v t" of "yvt"; with two coordinates "y1 y2 v1 v2 t"; with more "y1 ... y9 v1 ... v9 t".
std::string channel_words(const Model& model, std::string_view quantities) {
  std::string words;
  const auto add = [&](const std::string& word) { words += (words.empty() ? "" : " ") + word; };
  for (const char quantity : quantities) {
    if (quantity == 'b')
      add("yb vb ab");
    else if (quantity == 'r') {
      if (model.driven.size() == 1) add("force_rate");
    } else if (quantity == 't')
      add("t");
    else if (model.degrees() > 2)
      add(model.channel(quantity, 0) + " ... " + model.channel(quantity, model.degrees() - 1));
    else
      for (int i = 0; i < model.degrees(); ++i) add(model.channel(quantity, i));
  }
  return words;
}

constexpr const char* force_rate = "force_rate";

/// What else than forces can drive a model.
constexpr const char* side_inputs[] = {"yb", "vb", "ab", "shaft_angle", "shaft_speed", "shaft_rate"};

bool is_side_input(const std::string& name) {
  return std::find(std::begin(side_inputs), std::end(side_inputs), name) != std::end(side_inputs);
}

/// The channels that an expression of this model may hold: those of these quantities.
bool may_hold(const Model& model, const std::string& name, std::string_view quantities) {
  if (is_side_input(name)) return quantities.find('b') != std::string_view::npos;
  if (name == force_rate) return quantities.find('r') != std::string_view::npos && model.driven.size() == 1;
  if (quantities.find(name[0]) == std::string_view::npos) return false;
  if (name == "t" || model.degrees() == 1) return name.size() == 1;
  return name.size() > 1 && std::stol(name.substr(1, 9)) <= model.degrees();
}

/// With one degree of freedom y1 v1 a1 F1 are other words for y v a F.
void drop_numbers(Model& model) {
  if (model.degrees() > 1) return;
  std::vector<std::pair<Expr, Expr>> names;
  for (const char* quantity : {"y", "v", "a", "F"})
    names.emplace_back(model.pool->channel(quantity + std::string("1")), model.pool->channel(quantity));
  const auto rename = [&](Expr& f) {
    if (f.valid()) f = substitute(f, names);
  };
  for (auto* maps : {&model.measures, &model.acts})
    for (auto& [channel, map] : *maps) {
      if (channel == "y1" || channel == "v1" || channel == "F1") channel.pop_back();
      rename(map);
    }
  rename(model.mass);
  rename(model.restoring);
  for (InternalState& z : model.states) {
    rename(z.rate);
    rename(z.min);
    rename(z.max);
  }
}

void check_driven(Model& model) {
  const std::string count = std::to_string(model.degrees());
  if (model.driven.empty())
    for (int i = 0; i < model.degrees(); ++i) model.driven.push_back(i);
  std::sort(model.driven.begin(), model.driven.end());
  for (std::size_t i = 0; i < model.driven.size(); ++i) {
    if (model.driven[i] < 0 || model.driven[i] >= model.degrees())
      throw InputError("model: forces: expected coordinates from 1 to " + count + ", got " +
                       std::to_string(model.driven[i] + 1));
    if (i > 0 && model.driven[i] == model.driven[i - 1])
      throw InputError("model: forces: coordinate " + std::to_string(model.driven[i] + 1) + " is given twice");
  }
  if (static_cast<int>(model.driven.size()) > max_inputs - 3)
    throw InputError("model: " + std::to_string(model.driven.size()) + " coordinates with a force each: at most " +
                     std::to_string(max_inputs - 3) + " can be driven; name them, as in forces = { 1 }");
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

/// Each channel once, and one that is there; forces affine in their channels, so that they can be undone.
void check_maps(const Model& model) {
  const auto check = [&](const std::vector<ChannelMap>& maps, const char* field, std::string_view quantities,
                         const char* expected) {
    std::vector<std::string> known, given;
    for (const char quantity : quantities)
      for (int i = 0; i < model.degrees(); ++i) known.push_back(model.channel(quantity, i));
    for (const auto& [channel, map] : maps) {
      const std::string where = std::string("model: ") + field + ": ";
      if (std::find(known.begin(), known.end(), channel) == known.end())
        throw InputError(where + "expected " + expected + " of the model, got '" + channel + "'");
      if (std::find(given.begin(), given.end(), channel) != given.end())
        throw InputError(where + "channel '" + channel + "' is given twice");
      given.push_back(channel);
      if (!map.valid()) throw InputError(where + channel + ": no expression is given");
    }
  };
  check(model.measures, "measures", "yva", "a displacement, velocity or acceleration");
  check(model.acts, "acts", "F", "a force");
  for (const auto& [channel, map] : model.acts) {
    const Expr slope = derivative(map, model.pool->channel(channel));
    if (slope.is_constant(0) || depends_on(slope, model.pool->channel(channel)))
      throw InputError("model: acts: " + channel + ": expected a force that is affine in " + channel + ", got " +
                       to_text(map));
    if (model.delay.valid() && depends_on(map, model.pool->channel(force_rate)))
      throw InputError("model: acts: " + channel + ": holds force_rate, which does not go with a delay");
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
  for (const Expr& symbol : symbols(part.expression)) {
    if (symbol.kind() == SymbolKind::channel && !may_hold(model, symbol.name(), part.quantities)) {
      std::string_view allowed = part.quantities;
      throw InputError("model: " + part.where + ": cannot hold the channel '" + symbol.name() + "' (it may hold " +
                       (allowed.empty() ? "parameters alone" : channel_words(model, allowed)) + ")");
    }
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
  for (int i = 0; i < model.degrees(); ++i) {
    const double mass = known_value(model, model.coordinate(i).mass);
    if (!(model.imposed_motion ? mass < 0 : mass <= 0)) continue;
    throw InputError("model: mass" + (model.degrees() > 1 ? " of y" + std::to_string(i + 1) : std::string()) +
                     ": expected " + (model.imposed_motion ? ">= 0" : "> 0") + ", got " + number(mass) +
                     (model.imposed_motion || model.degrees() > 1 ? "" : " (a mass of 0 needs imposed motion)"));
  }
  if (model.delay.valid() && model.imposed_motion) throw InputError("model: delay: no force drives an imposed motion");
  if (const double delay = model.delay.valid() ? known_value(model, model.delay) : 0; delay < 0)
    throw InputError("model: delay: expected >= 0, got " + number(delay));
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

/// The force on a coordinate, of what its channel shows.
std::string acting_text(const Model& model, int i, Format format) {
  const std::string channel = model.channel('F', i);
  for (const auto& acting : model.acts)
    if (acting.channel == channel) return to_text(acting.map, format);
  return to_text(model.pool->channel(channel), format);
}

}  // namespace

std::string Parameter::words() const {
  if (std::isnan(value))
    return name + (unit.empty() ? "" : " [" + unit + "]") + ": to fit, discover reads the first guess off the data";
  return name + " = " + number(value, 6) + (std::isfinite(std) ? " +- " + number(std, 2) : "") +
         (unit.empty() ? "" : " " + unit) + (fixed ? " (fixed)" : "");
}

std::vector<std::string> Model::inputs() const {
  std::vector<std::string> channels;
  for (const int i : driven)
    if (!imposed_motion) channels.push_back(channel('F', i));
  std::vector<Expr> parts;
  for (int i = 0; i < degrees(); ++i) parts.push_back(coordinate(i).restoring);
  for (const InternalState& z : states) parts.push_back(z.rate);
  const auto add = [&](const char* name) {
    const Expr symbol = pool->channel(name);
    if (std::any_of(parts.begin(), parts.end(), [&](Expr f) { return depends_on(f, symbol); }))
      channels.emplace_back(name);
  };
  for (const char* name : side_inputs) add(name);
  parts.clear();
  for (const auto& acting : acts) parts.push_back(acting.map);
  if (!imposed_motion) add(force_rate);
  return channels;
}

std::vector<std::string> Model::sides() const {
  std::vector<std::string> channels = inputs();
  std::erase_if(channels, [](const std::string& input) { return input[0] == 'F' || input == force_rate; });
  return channels;
}

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

std::string Model::channel(char quantity, int i) const {
  return degrees() == 1 ? std::string(1, quantity) : quantity + std::to_string(i + 1);
}

std::string Model::equation(Format format) const {
  std::string text;
  for (int i = 0; i < degrees(); ++i) {
    const auto [mass, restoring] = coordinate(i);
    Expr left = restoring;
    if (!mass.is_constant(0)) {  // one sum, without a pair of parentheses round the restoring force
      left = mass * pool->channel(channel('a', i));
      if (!restoring.is_constant(0))
        for (const Expr& term : summands(restoring)) left = plus(left, term);
    }
    const bool forced = driven.empty() || std::find(driven.begin(), driven.end(), i) != driven.end();
    text += (i > 0 ? "\n" : "") + to_text(left, format) + " = " + (forced ? acting_text(*this, i, format) : "0");
    if (forced && delay.valid()) text += "(t - " + to_text(delay, format) + ")";
  }
  for (const InternalState& z : states) text += "\n" + state_line(z, format);
  for (const auto& [name, map] : measures)
    text += "\n" + (format == Format::latex ? name + "_{\\text{measured}}" : name + " measured") + " = " +
            to_text(map, format);
  return text;
}

Model complete(Model model) {
  if (!model.pool) throw InputError("model: no pool of expressions");
  for (int i = 0; i < model.degrees(); ++i) {
    const std::string which = model.degrees() > 1 ? " of y" + std::to_string(i + 1) : "";
    if (!model.coordinate(i).mass.valid()) throw InputError("model: no mass" + which + " is given");
    if (!model.coordinate(i).restoring.valid()) throw InputError("model: no restoring force" + which + " is given");
  }
  if (model.imposed_motion && 3 * model.degrees() > max_inputs)
    throw InputError("model: motion can be imposed on " + std::to_string(max_inputs / 3) +
                     " coordinates at most, got " + std::to_string(model.degrees()));
  drop_numbers(model);
  check_driven(model);
  check_states(model);
  if (const auto drive = 3 * static_cast<std::size_t>(model.degrees()) + model.sides().size();
      model.imposed_motion && !model.states.empty() && drive > max_inputs)
    throw InputError("model: the states of an imposed motion can follow " + std::to_string(max_inputs) +
                     " channels at most, got " + std::to_string(drive) + " of coordinates, base and shaft");
  check_maps(model);
  const std::vector<Part> parts = parts_of(model);
  for (const Part& part : parts) check_symbols(model, part);
  inertia_rows(model);
  complete_table(model, parts);
  check_values(model);
  return model;
}

}  // namespace lunid
