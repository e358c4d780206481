#include "discover/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "discover/places.hpp"
#include "discover/views.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "record/derive.hpp"
#include "record/motion.hpp"
#include "record/random.hpp"

namespace lunid {

namespace {

using Replacements = std::vector<std::pair<Expr, Expr>>;

constexpr std::array quantities{'y', 'v', 'a'};

std::string of_base(char quantity) { return std::string(1, quantity) + 'b'; }

std::vector<Expr*> parts_of(std::vector<InternalState>& states) {
  std::vector<Expr*> out;
  for (InternalState& state : states)
    for (Expr* part : {&state.rate, &state.min, &state.max})
      if (part->valid()) out.push_back(part);
  return out;
}

/// The forces and the rates of a model.
std::vector<Expr*> equations_of(Model& model) {
  std::vector<Expr*> out = parts_of(model.states);
  for (int i = 0; i < model.degrees(); ++i) out.push_back(&restoring_of(model, i));
  return out;
}

bool holds(const Model& given, char quantity) {
  Model model = given;
  const Expr base = model.pool->channel(of_base(quantity));
  return std::ranges::any_of(equations_of(model), [&](const Expr* part) { return depends_on(*part, base); });
}

/// Each motion of the model by itself less that of the base; differences of two stay what they are.
Replacements less_base(const Model& model) {
  Replacements out;
  for (const char quantity : {'y', 'v'}) {
    const auto own = [&](int i) { return model.pool->channel(model.channel(quantity, i)); };
    for (int i = 0; i < model.degrees(); ++i) {
      out.emplace_back(own(i), own(i) - model.pool->channel(of_base(quantity)));
      for (int j = 0; j < model.degrees(); ++j)
        if (i != j) out.emplace_back(own(i) - own(j), own(i) - own(j));
    }
  }
  return out;
}

Replacements base_at_rest(Pool& pool) {
  Replacements out;
  for (const char quantity : quantities) out.emplace_back(pool.channel(of_base(quantity)), pool.constant(0));
  return out;
}

/// Two expressions are one: they have the same values at drawn points.
bool same(Expr a, Expr b) {
  if (a == b) return true;
  const std::array both{a, b};
  std::vector<Expr> inputs = symbols(a);
  for (const Expr& more : symbols(b))
    if (std::ranges::find(inputs, more) == inputs.end()) inputs.push_back(more);
  const Tape tape(both, inputs);
  std::vector<double> scratch(static_cast<std::size_t>(tape.registers())), in(inputs.size());
  Philox random(1, 0);
  for (int draw = 0; draw < 20; ++draw) {
    for (double& x : in) x = random.normal();
    std::array<double, 2> out{};
    tape.run_point(in.data(), out.data(), scratch.data());
    const double apart = std::abs(out[0] - out[1]);
    if (std::isfinite(out[0]) && !(apart <= 1e-9 * (1 + std::abs(out[0])))) return false;
  }
  return true;
}

[[noreturn]] void refuse(const std::string& what) { throw InputError("discover: a base that moves: " + what); }

bool is_measured(const Record& record, const std::string& channel) {
  return record.has(channel) && !record.channel(channel).derived;
}

/// The acceleration of the base, as it was measured or as the derivative of what was.
Channel acceleration_of_base(const Record& record) {
  if (is_measured(record, "ab")) return record.channel("ab");
  for (int rank : {1, 0}) {
    const std::string from = of_base(quantities[static_cast<std::size_t>(rank)]);
    if (!is_measured(record, from)) continue;
    Derivative slope = differentiate(record[from], record.dt(), record.channel(from).noise, 2 - rank, FourierFilter{});
    Channel out;
    out.name = out.source = "ab";
    out.unit = motion_unit(record.channel(from).unit, 2);
    out.values = std::move(slope.values);
    out.noise = slope.noise;
    out.derived = true;
    out.derivation = "of " + from + " by " + slope.how;
    return out;
  }
  throw InputError(
      "discover: a base that moves: the record holds no motion of it; name its column, e.g. --columns "
      "\"yb=header [unit]\", or ab",
      {record.name(), 0, 0}, Fault::data);
}

/// A copy with these channels alone.
Record of_channels(const Record& record, std::vector<Channel> channels) {
  Record out(record.name(), record.start(), record.dt(), std::move(channels));
  out.take_notes(record);
  return out;
}

/// What was measured of the rig, less what was of its base.
std::vector<Channel> relative_motion(const Model& model, const Record& record) {
  std::vector<Channel> out;
  std::string has;
  for (const char quantity : quantities) {
    const std::string base = of_base(quantity);
    bool all = is_measured(record, base);
    if (all) append_item(has, base);
    for (int i = 0; i < model.degrees(); ++i) {
      const std::string own = model.channel(quantity, i);
      if (is_measured(record, own)) append_item(has, own);
      all = all && is_measured(record, own);
    }
    for (int i = 0; all && i < model.degrees(); ++i) {
      Channel difference = of_window(record, model.channel(quantity, i));
      difference.values -= as_vector(record[base]);
      difference.noise = std::hypot(difference.noise, record.channel(base).noise);
      out.push_back(std::move(difference));
    }
  }
  if (out.empty())
    throw InputError(
        "discover: a base that moves: expected one quantity of the rig and of its base (y and yb, v and "
        "vb, or a and ab), got " +
            (has.empty() ? "none" : has) +
            "; where y is measured from the base, write k*y + c*v + m*ab with the number m",
        {record.name(), 0, 0}, Fault::data);
  return out;
}

}  // namespace

Frame::Frame(const Model& given) : model_(given) {
  if (given.imposed_motion) return;
  const bool differences = holds(given, 'y') || holds(given, 'v');
  if (differences)
    kind_ = Kind::absolute;
  else if (holds(given, 'a'))
    kind_ = Kind::relative;
  else
    return;
  for (int i = 0; i < given.degrees(); ++i)
    if (!given.coordinate(i).mass.is_constant())
      refuse("expected a mass that is a number, got " + to_text(given.coordinate(i).mass) +
             ": no force shows it. With mass 1 all values are per unit of mass");
  if (differences)
    look_from_base(given);
  else
    take_inertia(given);
  driven_ = given.driven;
  model_.driven.clear();
}

void Frame::look_from_base(const Model& given) {
  if (holds(given, 'a')) refuse("expected yb and vb in differences y - yb, v - vb, got ab beside them");
  Model model = given;
  const Replacements rest = base_at_rest(*model.pool), back = less_base(model);
  for (Expr* part : equations_of(model)) {
    const Expr whole = *part;
    *part = substitute(whole, rest);
    for (int i = 0; i < model.degrees(); ++i)
      if (depends_on(whole, model.pool->channel(model.channel('a', i))))
        refuse("expected the mass alone before accelerations, got " + to_text(whole));
    if (!same(substitute(*part, back), whole))
      refuse("expected it in differences y - yb, v - vb alone, got " + to_text(whole));
  }
  model_ = std::move(model);
  for (int i = 0; i < given.degrees(); ++i) inertia_.push_back(given.coordinate(i).mass.value());
}

void Frame::take_inertia(const Model& given) {
  Model model = given;
  Pool& pool = *model.pool;
  const Expr ab = pool.channel("ab");
  const Replacements rest = base_at_rest(pool);
  for (int i = 0; i < model.degrees(); ++i) {
    Expr& force = restoring_of(model, i);
    const Expr slope = substitute(derivative(force, ab), rest);
    if (!slope.is_constant()) refuse("expected ab with a number, as m*ab, got " + to_text(slope) + "*ab");
    inertia_.push_back(slope.value());
    const Expr whole = force;
    force = substitute(whole, rest);
    if (!same(force + inertia_.back() * ab, whole)) refuse("expected ab in a term m*ab, got " + to_text(whole));
  }
  model_ = std::move(model);
}

Channel Frame::force_on(int coordinate, const Record& record, const Channel& ab) const {
  const std::string name = model_.channel('F', coordinate);
  const bool is_whole = record.has("F") && driven_ == std::vector<int>{coordinate};  // of the one that is driven
  Channel out;
  out.name = out.source = name;
  out.unit = ab.unit.rfind("rad", 0) == 0 ? "N m" : "N";
  out.values = Eigen::VectorXd::Zero(record.rows());
  if (record.has(name) || is_whole) out = of_window(record, record.has(name) ? name : "F");
  out.name = name;
  const double inertia = inertia_[static_cast<std::size_t>(coordinate)];
  out.values -= inertia * ab.values;
  out.noise = std::hypot(out.noise, inertia * ab.noise);
  return out;
}

Record Frame::seen(const Record& record) const {
  if (!moves()) return record;
  Channel ab = acceleration_of_base(record);
  if (!ab.derived) ab = of_window(record, "ab");
  std::vector<Channel> channels;
  if (kind_ == Kind::absolute) channels = relative_motion(model_, record);
  if (model_.degrees() > 1 && record.has("F") && driven_.size() != 1)
    throw InputError(
        "discover: the record has one force F, and the model several coordinates that it may act on: name "
        "its column F1 or another of them, or give the model forces = { 1 }",
        {record.name(), 0, 0}, Fault::data);
  for (int i = 0; i < model_.degrees(); ++i) channels.push_back(force_on(i, record, ab));
  channels.push_back(std::move(ab));
  const auto is_there = [&](const std::string& name) {
    return std::ranges::any_of(channels, [&](const Channel& channel) { return channel.name == name; });
  };
  const auto of_motion = [&](const std::string& name) {
    const std::string motions = "yva";
    const bool of_rig = motions.find(name[0]) != std::string::npos &&
                        (name.size() == 1 || std::isdigit(static_cast<unsigned char>(name[1])));
    return of_rig || name == "yb" || name == "vb";
  };
  for (const Channel& channel : record.channels()) {
    const bool absolute = kind_ == Kind::absolute && (of_motion(channel.name) || channel.name.ends_with("_reference"));
    if (!absolute && !is_there(channel.name)) channels.push_back(of_window(record, channel.name));
  }
  return derive_motion(of_channels(record, std::move(channels)));
}

std::vector<Record> Frame::seen(const std::vector<Record>& records) const {
  std::vector<Record> out;
  for (const Record& record : records) out.push_back(seen(record));
  return out;
}

std::vector<Effect> Frame::seen(const std::vector<Effect>& catalogue) const {
  if (!moves()) return catalogue;
  Pool& pool = *model_.pool;
  const Expr ab = pool.channel("ab");
  const Replacements against_ground{{pool.channel("a"), pool.channel("a") + ab}};
  std::vector<Effect> out = catalogue;
  std::erase_if(out, follows_base);  // what the force holds already
  for (Effect& effect : out) {
    for (EffectVariant& variant : effect.variants)
      if (variant.force.valid()) variant.force = substitute(variant.force, against_ground);
    for (Expr* part : parts_of(effect.states)) *part = substitute(*part, against_ground);
    for (InternalState& state : effect.states)
      if (std::ranges::find(effect.absolute, state.symbol.name()) != effect.absolute.end())
        state.rate = state.rate - ab;
  }
  return out;
}

Model Frame::as_given(const Model& found) const {
  if (!moves() || !found.measures.empty() || !found.acts.empty() || found.delay.valid()) return found;
  Model out = found;
  Pool& pool = *out.pool;
  out.driven = driven_;
  if (out.interpolation == Interpolation::hold)
    out.interpolation.reset();  // of -m*ab; a base moves on between its rows
  if (kind_ == Kind::relative) {
    for (int i = 0; i < out.degrees(); ++i) {
      Expr& force = restoring_of(out, i);
      force = force + inertia_[static_cast<std::size_t>(i)] * pool.channel("ab");
    }
    return out;
  }
  Replacements against_ground;
  const Expr ab = pool.channel("ab");
  for (int i = 0; i < out.degrees(); ++i) {
    const Expr a = pool.channel(out.channel('a', i));
    against_ground.emplace_back(a + ab, a);
  }
  const Replacements from_base = less_base(out);
  for (Expr* part : equations_of(out)) *part = substitute(substitute(*part, against_ground), from_base);
  return out;
}

Discovery Frame::as_given(Discovery found) const {
  if (!moves()) return found;
  std::vector<Model*> models{&found.baseline, &found.final};
  for (Rival& rival : found.rivals) models.push_back(&rival.model);
  if (found.unknown && found.unknown->closure) models.push_back(&found.unknown->closure->model);
  for (Model* model : models) *model = as_given(*model);
  found.warnings.insert(found.warnings.begin(), note());
  found.experiment.options.units.force += " of -m*ab";
  return found;
}

/// What ab stands with in the equation is the mass, or one of the two is not meant so.
std::string Frame::other_weight() const {
  for (int i = 0; i < model_.degrees(); ++i) {
    const double weight = inertia_[static_cast<std::size_t>(i)], mass = model_.coordinate(i).mass.value();
    if (weight == 0 || std::abs(weight - mass) <= 1e-9 * std::abs(mass)) continue;
    return ". The equation has " + number(weight) + "*ab beside a mass of " + number(mass) +
           ": it is taken as it is, F = -" + number(weight) +
           "*ab; of a motion that is measured from the base the two are one number";
  }
  return "";
}

std::string Frame::note() const {
  const std::string each = model_.degrees() > 1 ? " (so of y1, v1, a1 and F1, and of the others)" : "";
  switch (kind_) {
    case Kind::ground: return "";
    case Kind::absolute:
      return "the base moves: y, v and a are those relative to it (y - yb), and F is what its acceleration does to the "
             "mass, -m*ab" +
             each + ", everywhere but in the equation; base_motion is not tried beside it";
    case Kind::relative:
      return "the base moves: F is what its acceleration does to the mass, -m*ab" + each +
             ", everywhere but in the equation, where it stands on the left; base_motion is not tried beside it" +
             other_weight();
  }
  return "";
}

}  // namespace lunid
