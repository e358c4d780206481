// What the terminal shows: every number with its meaning (DESIGN section 4).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "discover/discover.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"

namespace lunid {

namespace {

/// "20.9(3)", "8.806(37)e5": the value to the last digit that its standard deviation leaves standing, and that
/// deviation in units of it: one digit, two where it begins with 1, or where no digit of the value would be seen.
std::string value_with_std(const Parameter& p) {
  if (!(p.std > 0) || !std::isfinite(p.std) || p.value == 0) return number(p.value, 4);
  const int exponent = static_cast<int>(std::floor(std::log10(std::max(std::abs(p.value), p.std))));
  int last = static_cast<int>(std::floor(std::log10(p.std)));
  if (p.std < 2 * std::pow(10.0, last) || std::abs(p.value) < 0.5 * std::pow(10.0, last)) --last;
  const double unit = std::pow(10.0, last);
  const auto digits = std::lround(p.std / unit);
  const double value = std::round(p.value / unit) * unit + 0.0;  // + 0.0: no "-0"
  char text[96];
  if (exponent < -3 || exponent > 5 || last > 0)
    std::snprintf(text, sizeof text, "%.*f(%ld)e%d", std::max(0, exponent - last), value / std::pow(10.0, exponent),
                  digits, exponent);
  else
    std::snprintf(text, sizeof text, "%.*f(%ld)", -last, value, digits);
  return text;
}

std::string list(const std::vector<Parameter>& table) {
  std::string out;
  for (const auto& p : table) {
    append_item(out, p.name + " = " + value_with_std(p));
    if (!p.unit.empty()) out += " " + p.unit;
  }
  return out.empty() ? "no parameters" : out;
}

std::string gap(const Gap& g) {
  char text[160];
  if (std::isfinite(g.value))
    std::snprintf(text, sizeof text, "%.3g", g.value);
  else
    std::snprintf(text, sizeof text, "none (stopped at t = %.4g s: %s)", g.stopped_at, g.cause.c_str());
  return text;
}

/// Of a run that is told elsewhere, where it stops and why.
std::string gap(double value) { return std::isfinite(value) ? number(value, 3) : "none (the run explodes)"; }

/// The best sets that were not named; why not is in discovery.json and the report.
std::string rivals(const Discovery& d) {
  constexpr std::size_t most = 3;
  std::string out;
  for (std::size_t i = 0; i < std::min(most, d.rivals.size()); ++i)
    out += (i == 0 ? "" : " | ") + d.rivals[i].name + " " + gap(d.rivals[i].gap);
  if (d.rivals.size() > most) out += " | " + std::to_string(d.rivals.size() - most) + " more";
  return out;
}

/// "cubic_stiffness in 97 of 100 resamples, nothing in 3"
std::string resampled(const Naming& naming) {
  std::string out;
  for (const auto& [name, count] : naming.counts)
    out +=
        (out.empty() ? name + " in " + std::to_string(count) + " of " + std::to_string(naming.resamples) + " resamples"
                     : ", " + name + " in " + std::to_string(count));
  return out;
}

/// Whether the loop was closed, the instruments' parameters and the other gaps: three lines at most.
std::string words_of(const ClosedLoop& loop) {
  std::string out = sentence_of(loop);
  if (!loop.by_instruments.empty()) out += "\nwith " + loop.reference + " as instrument: " + list(loop.by_instruments);
  const auto both = [](double before, double after) { return number(before, 3) + " -> " + number(after, 3); };
  if (std::isfinite(loop.final_test.force))
    out += "\ngap  force, test " + both(loop.baseline_test.force, loop.final_test.force);
  if (std::isfinite(loop.final_test.one_step))
    out += "   one step, test " + both(loop.baseline_test.one_step, loop.final_test.one_step);
  return out;
}

constexpr std::size_t widest = 240;  // an equation that is shown whole

/// The baseline's equation with each force that was named in it by its name; empty where that would not be all: several
/// coordinates, a fault of a channel.
std::string equation_in_names(const Discovery& d) {
  const std::string baseline = d.baseline.equation();
  const std::size_t equals = baseline.find(" = ");
  std::string out = baseline.substr(0, equals);
  for (const NamedEffect& e : d.effects) {
    if (!e.place.empty() || e.family == "sensor" || e.family == "input") return {};
    out += " + " + e.label;
  }
  out += baseline.substr(equals, baseline.find('\n') - equals);
  return d.baseline.degrees() == 1 && !d.effects.empty() && out.size() <= widest ? out : std::string();
}

/// The equation, and of its states no more than can be read: an iwan has twenty, each with limits of 200 characters.
std::string short_equation(const Discovery& d) {
  constexpr std::size_t most_states = 3, widest_state = 160;
  const std::string elsewhere = " (whole in model.lua and the report)";
  std::istringstream whole(d.final.equation());
  std::string out, line;
  const std::size_t most = static_cast<std::size_t>(d.final.degrees()) + most_states;
  for (std::size_t lines = 0; std::getline(whole, line); ++lines) {
    if (lines < most && line.size() <= (lines == 0 ? widest : widest_state)) {
      out += (lines > 0 ? "\n" : "") + line;
      continue;
    }
    if (lines > 0) return out + "\n..." + elsewhere;
    const std::string named = equation_in_names(d);
    return (named.empty() ? line.substr(0, widest - 1) + " ..." : named) + elsewhere;
  }
  return out;
}

}  // namespace

std::string to_terminal(const Discovery& d) {
  std::ostringstream out;
  auto line = [&](const char* head, std::string text) {
    char label[16];
    std::snprintf(label, sizeof label, "%-11s", head);
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
      text.insert(at + 1, 11, ' ');
    out << label << text << '\n';
  };
  for (const auto& r : d.records) {
    char text[160];
    std::snprintf(text, sizeof text, ": %s, %ld rows, %.4g s at %.4g Hz", r.role.c_str(), static_cast<long>(r.rows),
                  r.seconds, r.rate);
    std::string words = r.record + r.part + text;
    if (r.joined > 1) words += "; fits take " + std::to_string(r.joined) + " rows for one";
    if (d.run_length > 0) words += ", in " + std::to_string(r.runs) + " runs of " + number(d.run_length, 3) + " s";
    line("record", words);
  }
  for (const auto& w : d.warnings) line("note", w);
  line("baseline", list(d.baseline.parameters));
  line("gap", "train " + gap(d.baseline_train) + "   test " + gap(d.baseline_test) + "   (noise alone: train " +
                  gap(d.final_train.floor) + ", test " + gap(d.final_test.floor) + ")");
  for (const auto& o : d.outputs)
    line("", o.output + ": train " + gap(o.baseline_train) + " -> " + gap(o.final_train) + "   test " +
                 gap(o.baseline_test) + " -> " + gap(o.final_test) + "   (noise alone: train " +
                 number(o.final_train.floor, 3) + ", test " + number(o.final_test.floor, 3) + ")");
  line("where", d.where);
  const bool joined = std::ranges::any_of(d.records, [](const RecordUsed& r) { return r.joined > 1; });
  const std::string of_means = joined ? " (of means of rows)" : "";
  if (!d.rivals.empty())
    line("rivals", rivals(d) + "   (gap on train after the fit" + (joined ? ", of means of rows" : "") + "; " +
                       (d.effects.empty() ? "baseline " : "named ") + gap(d.gap_fit) + ")");
  double train = d.baseline_train.value, test = d.baseline_test.value;
  for (const auto& e : d.effects) {
    line("named", e.label + "  " + e.formula + ", " + list(e.parameters));
    line("",
         "gap  train " + gap(train) + " -> " + gap(e.gap_train) + "   test " + gap(test) + " -> " + gap(e.gap_test));
    std::string rivals, same;
    for (const auto& n : e.indistinguishable) {
      std::string& names = std::ranges::find(e.same_force, n) == e.same_force.end() ? rivals : same;
      append_item(names, n);
    }
    if (!rivals.empty()) line("", "this record cannot tell it from: " + rivals);
    if (!same.empty()) line("", "the same force in another notation: " + same);
    train = e.gap_train;
    test = e.gap_test;
  }
  if (d.naming.resamples > 0) line("", resampled(d.naming));
  for (const auto& r : d.removable) line("absent?", r.term + ": " + r.reason + "; it may be removed from the baseline");
  line("equation", short_equation(d));
  if (!d.effects.empty()) line("", list(d.final.parameters));
  line("gap", std::string(d.output == "F" ? "of the force" : "free run") + ", left-out blocks of train " +
                  gap(d.gap_left_out_before) + " -> " + gap(d.gap_left_out_after) + of_means + "   test " +
                  gap(d.baseline_test) + " -> " + gap(d.final_test));
  if (d.short_test.seconds > 0)
    line("", "test, in runs of " + number(d.short_test.seconds, 3) + " s " + gap(d.short_test.baseline) + " -> " +
                 gap(d.short_test.final) + "   (noise alone: " + number(d.short_test.final.floor, 3) + ")");
  if (d.loop) line("loop", words_of(*d.loop));
  line("verdict", std::string(to_string(d.verdict)) + ": " + d.sentence);
  return out.str();
}

}  // namespace lunid
