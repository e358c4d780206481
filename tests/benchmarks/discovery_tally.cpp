#include "discovery_tally.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

namespace matrix {
namespace {

using nlohmann::json;
using truth::Kind;

void compare_parameters(const Setting& setting, const json& effects, Outcome& outcome) {
  for (const truth::TrueParameter& truth : setting.which->parameters) {
    for (const json& effect : effects) {
      if (effect.value("name", "") != truth.effect || !effect["parameters"].contains(truth.name)) continue;
      const json& found = effect["parameters"][truth.name];
      const double wanted = truth.in(*setting.scale), off = number(found, "value") - wanted;
      // No deviation is stated for a parameter at its bound: it must then be the truth.
      const double std = number(found, "std");
      const double error = std > 0 ? off / std : std::abs(off) <= 1e-6 * std::abs(wanted) ? 0 : INFINITY;
      ++outcome.parameters;
      outcome.inside += std::abs(error) <= 1.96;
      if (!(std::abs(error) <= std::abs(outcome.worst))) outcome.worst = error;
    }
  }
}

/// The names of an effect: what it was called, and what it is in a tie with.
std::vector<std::string> names_of(const json& effect) {
  std::vector<std::string> names = effect.value("indistinguishable", std::vector<std::string>{});
  names.insert(names.begin(), effect.value("name", ""));
  return names;
}

void judge_fault(const std::string& fault, const json& effects, Outcome& outcome) {
  for (const json& effect : effects) {
    const std::vector<std::string> names = names_of(effect);
    outcome.right = outcome.right || names.front() == fault;
    outcome.tie = outcome.tie || std::find(names.begin(), names.end(), fault) != names.end();
  }
  outcome.tie = outcome.tie && !outcome.right;
  outcome.physics =
      !effects.empty() && effects.front().value("is", "physics") == "physics" && !outcome.right && !outcome.tie;
}

void judge_effects(const std::vector<std::string>& hidden, const json& effects, Outcome& outcome) {
  std::multiset<std::string> names, class_names;
  for (const json& effect : effects) {
    names.insert(effect.value("name", ""));
    for (const std::string& name : names_of(effect)) class_names.insert(name);
  }
  const std::multiset<std::string> wanted(hidden.begin(), hidden.end());
  outcome.right = names == wanted;
  outcome.tie = !outcome.right && effects.size() == wanted.size() &&
                std::includes(class_names.begin(), class_names.end(), wanted.begin(), wanted.end());
  outcome.some =
      !outcome.right && !names.empty() && std::includes(wanted.begin(), wanted.end(), names.begin(), names.end());
}

const char* heading(const Setting& setting) {
  if (setting.fault) return "faults";
  switch (setting.which->kind) {
    case Kind::effect: return "effects";
    case Kind::pair: return "pairs";
    case Kind::null: return "nothing missing";
    case Kind::outside: return "outside";
    default: return "ties";
  }
}

template <class Outcome, class Visit>
void each_field(Outcome& o, const Visit& visit) {
  visit("verdict", o.verdict), visit("named", o.named);
  visit("right", o.right), visit("tie", o.tie), visit("equivalent", o.equivalent), visit("physics", o.physics);
  visit("some", o.some), visit("tells", o.tells), visit("share", o.share), visit("class_size", o.class_size);
  visit("parameters", o.parameters), visit("inside", o.inside), visit("worst", o.worst);
  visit("before", o.before), visit("after", o.after), visit("floor", o.floor), visit("seconds", o.seconds);
  visit("noise", o.noise), visit("rows", o.rows);
}

void count(Counts& counts, Answer answer, double closed) {
  ++counts.of[static_cast<int>(answer)];
  if (std::isfinite(closed)) counts.closures.push_back(closed);
}

void print_counts(const std::string& name, const Counts& counts) {
  char closed[16] = "-";
  if (!counts.closures.empty()) std::snprintf(closed, sizeof closed, "%.1f %%", 100 * median(counts.closures));
  std::printf("%-34s %5d %6d %6d %6d %7d %7d  %8s\n", name.c_str(), counts.all(), counts.of[0], counts.of[1],
              counts.of[2], counts.of[3], counts.of[4], closed);
}

}  // namespace

double number(const json& object, const char* field) {
  return object.contains(field) && object[field].is_number() ? object[field].get<double>() : NAN;
}

const char* to_string(Answer answer) {
  switch (answer) {
    case Answer::first: return "first";
    case Answer::in_class: return "class";
    case Answer::wrong: return "wrong";
    case Answer::silent: return "silent";
    default: return "failed";
  }
}

Answer Outcome::answer() const {
  if (verdict == "failed") return Answer::failed;
  if (right) return Answer::first;
  if (tie || equivalent) return Answer::in_class;
  if (named.empty() || (some && verdict == "unknown-effect")) return Answer::silent;
  return Answer::wrong;
}

Outcome judge(const Setting& setting, const json& discovery) {
  Outcome outcome;
  if (!discovery.is_object()) return outcome;
  outcome.verdict = discovery.value("verdict", "none");
  const json effects = discovery.value("effects", json::array());
  for (const json& effect : effects) {
    outcome.named += outcome.named.empty() ? "" : "+";
    for (const std::string& name : names_of(effect))
      outcome.named += (name == effect.value("name", "") ? "" : "~") + name;
  }
  outcome.before = number(discovery.value("baseline", json::object()), "gap_test");
  outcome.after = number(discovery.value("final", json::object()), "gap_test");
  outcome.floor = number(discovery.value("noise_floor", json::object()), "gap_test");
  if (setting.fault) {
    judge_fault(setting.fault->effect, effects, outcome);
    return outcome;
  }
  switch (setting.which->kind) {
    case Kind::null: outcome.right = outcome.verdict == "nothing-missing"; break;
    case Kind::outside: outcome.right = outcome.verdict == "unknown-effect"; break;
    case Kind::tie: break;
    default: judge_effects(setting.which->effects, effects, outcome);
  }
  compare_parameters(setting, effects, outcome);
  return outcome;
}

void judge_tie(const Setting& setting, const json& discovery, const std::vector<std::string>& equals,
               Outcome& outcome) {
  outcome.class_size = 1 + static_cast<int>(equals.size());
  outcome.tells = equals.empty();
  if (!discovery.is_object() || outcome.verdict != "ambiguous") return;
  std::set<std::string> said;
  for (const json& effect : discovery.value("effects", json::array()))
    for (const std::string& name : names_of(effect)) said.insert(name);
  const auto is_said = [&](const std::string& name) { return said.count(name) > 0; };
  outcome.right = is_said(setting.which->effects.front()) && std::any_of(equals.begin(), equals.end(), is_said);
  outcome.tie = !outcome.right;
}

json kept(const Outcome& outcome) {
  json out;
  each_field(outcome, [&](const char* name, const auto& value) { out[name] = value; });
  return out;
}

Outcome outcome_of(const json& kept) {
  Outcome out;
  each_field(out, [&](const char* name, auto& value) {
    if constexpr (std::is_same_v<decltype(value), double&>)
      value = number(kept, name);
    else
      value = kept.value(name, value);
  });
  return out;
}

double chance(int rows) { return 3 / std::sqrt(static_cast<double>(std::max(rows, 9))); }

double closure(const Outcome& outcome) {
  // A baseline that cannot be run leaves all of the motion open, and so does a final model that cannot.
  const auto at_most_all = [](double gap) { return gap < 1 ? gap : 1.0; };
  const double before = at_most_all(outcome.before), after = at_most_all(outcome.after);
  if (!(before > outcome.noise * (1 + chance(outcome.rows)))) return NAN;
  return (before - after) / (before - outcome.noise);
}

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double upper_limit(int count, int all) {
  if (all == 0 || count >= all) return 1;
  double low = 0, high = 1;  // the root of the binomial tail, by bisection
  for (int pass = 0; pass < 60; ++pass) {
    const double p = 0.5 * (low + high);
    double tail = 0, term = std::pow(1 - p, all);
    for (int i = 0; i <= count; ++i) {
      tail += term;
      term *= static_cast<double>(all - i) / (i + 1) * p / (1 - p);
    }
    (tail > 0.05 ? low : high) = p;
  }
  return high;
}

int Counts::all() const {
  int sum = 0;
  for (const int n : of) sum += n;
  return sum;
}

void Tally::add(const Setting& setting, const Outcome& outcome) {
  longest_ = std::max(longest_, outcome.seconds);
  if (outcome.tells) {
    ++tells_;
    return;
  }
  const Answer answer = outcome.answer();
  const bool hidden = setting.is(Kind::effect) || setting.is(Kind::pair);
  const double closed = hidden ? closure(outcome) : NAN;
  count(entries_[setting.name()], answer, closed);
  count(levels_[heading(setting)][setting.options.noise_db], answer, closed);
  if (setting.is(Kind::effect)) count(excitations_[to_string(setting.options.excited)], answer, closed);
  count(setting.fault ? faults_ : kinds_[static_cast<int>(setting.which->kind)], answer, closed);
  if (std::isfinite(closed)) closures_.push_back(closed);
  physics_ += outcome.physics;
  false_names_ += setting.is(Kind::null) && !outcome.named.empty();
  classes_ += outcome.class_size > 0;
  members_ += outcome.class_size;
  if (std::isfinite(outcome.after) && !setting.fault) {
    ++gaps_;
    below_floor_ += outcome.after < outcome.floor * (1 - chance(outcome.rows));
    below_noise_ += outcome.after < outcome.noise * (1 - chance(outcome.rows));
  }
  if (!outcome.right || !hidden) return;
  if (std::isfinite(closed)) closures_of_named_.push_back(closed);
  parameters_ += outcome.parameters;
  inside_ += outcome.inside;
  ++closable_;
  closed_ += outcome.after <= 1.3 * outcome.floor;
  wild_ += !(std::abs(outcome.worst) < 4);  // of a few parameters, one beyond 4 sd means a wrong interval
}

bool Tally::clean() const {
  for (int kind = 0; kind < truth::kinds; ++kind) {
    const Counts& counts = kinds_[kind];
    const bool class_will_do = kind == static_cast<int>(Kind::pair);  // a tie of one of two is told
    if ((class_will_do ? counts.good() : counts.of[0]) != counts.all()) return false;
  }
  return closed_ == closable_ && wild_ == 0;
}

void Tally::print_table() const {
  std::printf("\n%-34s %5s %6s %6s %6s %7s %7s  %8s\n", "", "runs", "first", "class", "wrong", "silent", "failed",
              "closure");
  for (const auto& [name, counts] : entries_) print_counts(name, counts);
  std::printf("\n");
  for (const auto& [kind, levels] : levels_)
    for (const auto& [noise, counts] : levels) {
      char name[60];
      std::snprintf(name, sizeof name, "%s at %.0f dB", kind.c_str(), noise);
      print_counts(name, counts);
    }
  for (const auto& [name, counts] : excitations_) print_counts("effects under " + name, counts);
  std::printf("\n");
}

void Tally::print_gaps() const {
  if (!closures_.empty()) {
    std::printf("closed of what the noise allows, in the median: %.1f %% of %zu records with one or two hidden effects",
                100 * median(closures_), closures_.size());
    if (!closures_of_named_.empty())
      std::printf(", %.1f %% of %zu where they were named", 100 * median(closures_of_named_),
                  closures_of_named_.size());
    std::printf("\n");
  }
  if (gaps_ > 0)
    std::printf(
        "final gaps below the stated floor by more than chance (3/sqrt(rows)): %d of %d; below the noise that was put "
        "on: %d\n",
        below_floor_, gaps_, below_noise_);
  if (closable_ > 0)
    std::printf("where named right: parameters within their 95 %% interval %d/%d, test gap within 1.3 floors %d/%d\n",
                inside_, parameters_, closed_, closable_);
}

void Tally::print_notes(const std::string& alpha) const {
  const Counts& ties = kinds_[static_cast<int>(Kind::tie)];
  if (faults_.all() > 0) std::printf("faulty sensors and inputs: called physics %d of %d\n", physics_, faults_.all());
  if (ties.all() + tells_ > 0)
    std::printf("records that cannot tell: said so %d, silent %d, one name %d, of %d; %d can, and are not counted\n",
                ties.good(), ties.of[3], ties.of[2], ties.all(), tells_);
  if (classes_ > 0)
    std::printf("members of a class, of the truth, the answer and the confusers: %.2f\n",
                static_cast<double>(members_) / classes_);
  const int nulls = kinds_[static_cast<int>(Kind::null)].all();
  if (nulls > 0)
    std::printf("nulls at alpha %s: false names %d of %d, 95 %% limit of the rate %.3f\n", alpha.c_str(), false_names_,
                nulls, upper_limit(false_names_, nulls));
  std::printf("longest run %.1f s\n", longest_);
}

void Tally::print(const std::string& alpha) const {
  print_table();
  print_gaps();
  print_notes(alpha);
  const auto of = [this](Kind kind) -> const Counts& { return kinds_[static_cast<int>(kind)]; };
  const Counts &effects = of(Kind::effect), &nulls = of(Kind::null), &pairs = of(Kind::pair),
               &outside = of(Kind::outside);
  std::printf("named %d/%d nulls-false %d/%d pairs %d/%d outside %d/%d sensors %d/%d\n", effects.of[0], effects.all(),
              nulls.all() - nulls.of[0], nulls.all(), pairs.good(), pairs.all(), outside.of[0], outside.all(),
              faults_.good(), faults_.all());
}

}  // namespace matrix
