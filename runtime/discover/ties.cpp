#include "discover/ties.hpp"

#include <algorithm>
#include <cmath>

#include "discover/grow.hpp"
#include "discover/judge.hpp"
#include "discover/sensor.hpp"
#include "discover/views.hpp"

namespace lunid {

bool not_rejected(const Study& study, const Candidate& c, const Candidate& best, int tried) {
  if (within(c.choices, best.choices)) return corrected(improvement_p_value(c, best), tried) > study.options->alpha;
  return !fits_worse(study, c, best);
}

namespace {

/// Of the free runs of two fitted sets, squared.
double apart(const Candidate& a, const Candidate& b) {
  double squares = 0;
  for (std::size_t r = 0; r < a.fit.residual.size(); ++r)
    squares += (a.fit.residual[r] - b.fit.residual[r]).squaredNorm();
  return squares;
}

}  // namespace

bool same_runs(const Candidate& a, const Candidate& b) { return apart(a, b) < 1e-3 * squared_error(a.fit); }

namespace {

/// The sets differ by one entry, and these are special cases of each other, whatever place their fits ended in.
bool is_one_law(const Candidate& a, const Candidate& b) {
  const Choices of_a = beyond(a.choices, b.choices), of_b = beyond(b.choices, a.choices);
  return of_a.size() == 1 && of_b.size() == 1 && of_a.front().is_special_case(of_b.front()) &&
         of_b.front().is_special_case(of_a.front());
}

/// Two faults with the same run are two things to mend, of which one is well.
bool have_the_same_faults(const Candidate& a, const Candidate& b) {
  const auto all_physics = [](const Choices& set) { return physics_in(set) == static_cast<int>(set.size()); };
  return all_physics(beyond(a.choices, b.choices)) && all_physics(beyond(b.choices, a.choices));
}

/// By as many parameters and as much physics.
bool do_the_same(const Candidate& a, const Candidate& b) {
  return a.parameters() == b.parameters() && physics_in(a.choices) == physics_in(b.choices) &&
         (same_runs(a, b) || is_one_law(a, b));
}

}  // namespace

bool same_in_other_words(const Candidate& a, const Candidate& b) {
  return do_the_same(a, b) && have_the_same_faults(a, b);
}

namespace {

bool is_told_from(const Study& study, const Candidate& general, const Candidate& special, int tried) {
  return !same(general.choices, special.choices) && is_general_form(general.choices, special.choices) &&
         corrected(improvement_p_value(special, general), tried) <= study.options->alpha;
}

}  // namespace

bool outgrows(const Study& study, const Candidate& general, const Candidate& special, int tried) {
  return rms_error(general.fit) < (1 - study.options->minimum_gain) * rms_error(special.fit) &&
         is_told_from(study, general, special, tried);
}

bool takes_most(const Study& study, const Candidate& general, const Candidate& special, int tried) {
  return is_told_from(study, general, special, tried) && closed_share(study, special, general) > 0.5;
}

std::size_t in_the_usual_words(const Candidate& baseline, const std::vector<Candidate>& field,
                               const std::vector<std::size_t>& alike) {
  const Candidate& first = field[alike.front()];
  // What one set has and the other has not, where that is one effect; entries lie in the catalogue's order.
  const auto own = [](const Choices& set, const Choices& other) -> const Effect* {
    const Choices more = beyond(set, other);
    return more.size() == 1 ? more.front().effect : nullptr;
  };
  std::size_t pick = alike.front();
  for (const auto i : alike) {
    const Candidate& c = field[i];
    if (c.choices.size() != first.choices.size() || !do_the_same(c, first)) continue;
    const auto [usual, picked] = std::pair(own(c.choices, field[pick].choices), own(field[pick].choices, c.choices));
    const auto turned = turned_negative(baseline, c).size(),
               turned_by_pick = turned_negative(baseline, field[pick]).size();
    if (usual && picked && (turned != turned_by_pick ? turned < turned_by_pick : usual < picked)) pick = i;
  }
  return pick;
}

namespace {

/// A fault of the sensor does in this record what as many effects with more physics do: a channel's lag in a free decay
/// what relaxation does, with a parameter less.
bool is_fault_of_the_same_run(const Candidate& c, const Candidate& physics) {
  return c.choices.size() == physics.choices.size() && physics_in(c.choices) < physics_in(physics.choices) &&
         same_runs(c, physics);
}

}  // namespace

void prefer_the_same_fault(const std::vector<Candidate>& field, std::vector<std::size_t>& alike, std::size_t& pick) {
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i].parameters() != field[pick].parameters() || !is_fault_of_the_same_run(field[i], field[pick])) continue;
    if (std::ranges::find(alike, i) == alike.end()) alike.push_back(i);
    pick = i;
  }
}

Ties find_ties(const Study& study, const Candidate& baseline, const Candidate& chosen,
               const std::vector<const Candidate*>& among) {
  Ties out;
  for (const Candidate* other : among) {
    const Candidate& c = *other;
    if (!c.ran() || same(c.choices, chosen.choices) || c.name() == chosen.name()) continue;
    if (related(c.choices, chosen.choices) && !is_one_law(c, chosen)) continue;
    if (c.parameters() != chosen.parameters()) {
      if (is_fault_of_the_same_run(chosen, c)) out.rivals.push_back(c.choices);
      continue;
    }
    // Another notation of the same force is no doubt; a fault of a channel in place of physics or of another channel
    // is.
    if (same_in_other_words(c, chosen))
      out.aliases.push_back(c.name());
    else if (!fits_worse(study, c, chosen) && !fits_worse(study, chosen, c) &&
             improvement_p_value(baseline, c) < study.options->alpha)
      out.rivals.push_back(c.choices);
  }
  return out;
}

namespace {

/// A channel that was measured beside the fitted one of its coordinate, and what a set's run leaves of both.
struct OtherChannel {
  Eigen::VectorXd measured, left, left_of_fitted;
};

/// Of all training records; empty where there are none, or a run stops.
std::vector<OtherChannel> other_channels(const Study& study, const Candidate& c) {
  std::vector<OtherChannel> out;
  const SimulateOptions options = steps_of(study, c.fit);
  for (const FitSegment& segment : c.fit.segments) {
    const FitData& data = study.train[static_cast<std::size_t>(segment.record)];
    if (segment.first != 0 || segment.count != data.record.rows()) return {};
    const std::span<const double> theta = view(c.fit.theta);
    const Run run = simulate(*c.system, theta, data.excitation, segment.x0, options);
    if (!run.summary.completed) return {};
    const auto left = [&](const std::string& channel) -> Eigen::VectorXd {
      return as_vector(data.record[channel]) - shown(*c.system, theta, run, channel);
    };
    for (int i = 0; i < study.degrees(); ++i)
      for (const char quantity : std::string(study.measured == "y" ? "va" : study.measured == "v" ? "a" : "")) {
        const std::string channel = study.channel(quantity, i);
        if (!data.record.has(channel) || data.record.channel(channel).derived) continue;
        out.push_back({as_vector(data.record[channel]), left(channel), left(study.channel(study.measured[0], i))});
      }
  }
  return out;
}

/// Squared error of what a set says of these channels, over their squares about the mean; NaN where there are none.
double error_of(const std::vector<OtherChannel>& others) {
  double error = 0, power = 0;
  for (const OtherChannel& o : others) {
    error += o.left.squaredNorm() / o.measured.squaredNorm();
    power += (o.measured.array() - o.measured.mean()).square().sum() / o.measured.squaredNorm();
  }
  return power > 0 ? error / power : NAN;
}

}  // namespace

std::vector<const Candidate*> borne_out_by_other_channels(const Study& study,
                                                          const std::vector<const Candidate*>& sets) {
  constexpr double follows = 0.1, clearly = 4;  // squared: of the channel; times the least
  std::vector<std::pair<double, const Candidate*>> heard;
  for (const Candidate* c : sets)
    if (const double error = study.imposed ? NAN : error_of(other_channels(study, *c)); std::isfinite(error))
      heard.emplace_back(error, c);
  std::ranges::stable_sort(heard, {}, [](const auto& h) { return h.first; });
  if (heard.empty() || !(heard.front().first < follows) || !(heard.back().first > clearly * heard.front().first))
    return {};
  std::vector<const Candidate*> out;
  for (const auto& [error, c] : heard)
    if (error <= clearly * heard.front().first) out.push_back(c);
  return out;
}

bool were_measured_apart(const Study& study, const Candidate& c) {
  constexpr Eigen::Index least_rows = 200;
  constexpr double most = 0.5;
  const std::vector<OtherChannel> others = other_channels(study, c);
  return !others.empty() && std::ranges::all_of(others, [&](const OtherChannel& o) {
    return o.left.size() >= least_rows && driven_part(view(o.left), {view(o.left_of_fitted)}) < most;
  });
}

double share_apart(const Candidate& a, const Candidate& b) { return std::sqrt(apart(a, b) / squared_error(b.fit)); }

}  // namespace lunid
