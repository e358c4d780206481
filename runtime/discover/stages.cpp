#include "discover/stages.hpp"

#include <algorithm>
#include <cmath>

#include "discover/baseline.hpp"
#include "discover/closure.hpp"
#include "discover/frame.hpp"
#include "discover/grow.hpp"
#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/locate.hpp"
#include "discover/places.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/propose.hpp"
#include "discover/sensor.hpp"
#include "expr/joined.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int set_iterations = 25;

void progress(const DiscoverOptions& options, const std::string& stage, double fraction) {
  if (options.cancelled && *options.cancelled) throw InputError("interrupted while: " + stage, {}, Fault::interrupted);
  if (options.progress) options.progress(stage, fraction);
}

/// The study of all rows: nothing is held out, since nothing is tested.
struct Stage {
  Frame frame;
  Study study;
  Candidate baseline;
  std::vector<std::string> warnings;

  Stage(const Model& given, const std::vector<Record>& records, const DiscoverOptions& options,
        const std::vector<Effect>& catalogue = {})
      : frame(given) {
    validate(options);
    check_baseline(frame.model());
    const Model model = complete(frame.model());
    if (frame.moves()) warnings.push_back(frame.note());
    const std::vector<Record> seen = frame.seen(records);
    study = prepare(model, seen, seen, options);  // nothing is held out
    progress(options, "refit the baseline", 0.1);
    baseline = fit_baseline(study, model, warnings, frame.seen(catalogue));
    warnings.insert(warnings.end(), study.warnings.begin(), study.warnings.end());
    if (!baseline.ran()) baseline.fit.theta = baseline.starts.front();  // those of the force alone
  }

  Model as_given(const Candidate& c) const { return frame.as_given(fitted(study, c)); }

  double gap(const Candidate& c) const {
    return c.ran() ? rms_error(c.fit) / study.measured_std() : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Of the only choice.
std::vector<Parameter> own_parameters(const Candidate& candidate, const VectorXd& theta) {
  std::vector<Parameter> out;
  const auto& table = candidate.system->model().parameters;
  for (std::size_t i = candidate.first_added(); i < table.size(); ++i) {
    Parameter row = table[i];
    row.value = theta[static_cast<Index>(i)];
    row.name = own_name(*candidate.choices.front().effect, row.name);
    out.push_back(row);
  }
  return out;
}

/// From the force's regression and from the baseline with the effects at zero; the better fit.
void fit_set(const Stage& stage, Candidate& candidate) {
  const FitOptions o = full_fit(stage.study, set_iterations);
  fit(stage.study, candidate, o);
  if (!stage.baseline.ran()) return;
  VectorXd warm = candidate.starts.front();
  warm.head(stage.baseline.parameters()) = stage.baseline.fit.theta;
  for (Index j = stage.baseline.parameters(); j < warm.size(); ++j)
    if (candidate.linear[static_cast<std::size_t>(j)]) warm[j] = 0;
  FitResult again = fit_trajectory(*candidate.system, warm, stage.study.train, o);
  if (again.cost < candidate.fit.cost) candidate.fit = std::move(again);
}

/// The baseline with generic forces fitted: its free run follows the record, so that what smoothing makes of it can be
/// taken away (locate.hpp). The baseline itself where it follows to the noise, or they do not help. `place`: where
/// these forces act.
Candidate follower(const Stage& stage, std::optional<Place>& place) {
  Candidate judged = stage.baseline;
  if (!judged.ran() || !is_above_noise(stage.study, judged)) return judged;
  const Whitening whitening = residual_colour(stage.study, judged);
  judge(stage.study, judged, whitening);
  Closure closure = test_closure(stage.study, judged, whitening);
  if (closure.place) place = closure.place;
  if (!closure.system || !(closure.p_value < 0.01)) return stage.baseline;
  fit_closure(stage.study, judged, closure);
  if (!(closure.fit.cost < stage.baseline.fit.cost)) return stage.baseline;
  Candidate out = compile(stage.study, closure.system->model(), {});
  out.fit = std::move(closure.fit);
  return out;
}

/// The place of that text, "y2" or "y1 - y2".
Place place_named(const Model& model, const std::string& text) {
  std::string known;
  for (const Place& place : places_of(model)) {
    if (motion_of(place) == text) return place;
    append_item(known, motion_of(place));
  }
  throw InputError("locate: place: expected one of " + (known.empty() ? "none: there is one coordinate" : known) +
                       ", got '" + text + "'",
                   {}, Fault::usage);
}

/// The testable entries that a word means: of "cubic_stiffness" that entry at each place, of "cubic_stiffness at y2"
/// that one.
std::vector<const Effect*> meant_by(const std::string& word, const std::vector<Effect>& testable,
                                    const std::vector<std::string>& untestable) {
  std::vector<const Effect*> out;
  std::string known;
  for (const Effect& effect : testable) {
    if (effect.label() == word || effect.name == word) out.push_back(&effect);
    if (word.rfind(effect.name + " ", 0) == 0) append_item(known, effect.label());
  }
  if (!out.empty()) return out;
  for (const std::string& reason : untestable)
    if (reason.rfind(word.substr(0, word.find(' ')) + " ", 0) == 0)
      throw InputError("rank: sets: not to be tested on these records: " + reason, {}, Fault::usage);
  throw InputError("rank: sets: no effect '" + word + "'" + (known.empty() ? "" : ", there are: " + known), {},
                   Fault::usage);
}

/// Every combination of places and variants of a set; a word that stands twice is an entry and its repetition.
std::vector<Choices> ways_of(const std::vector<std::string>& set, const std::vector<Effect>& testable,
                             const std::vector<std::string>& untestable) {
  std::vector<Choices> ways{{}};
  for (const std::string& word : set) {
    std::vector<Choices> next;
    for (const Effect* effect : meant_by(word, testable, untestable))
      for (const Choices& way : ways)
        for (int variant = 0; variant < static_cast<int>(effect->variants.size()); ++variant)
          if (may_join(way, *effect)) next.push_back(with(way, {effect, variant}));
    if (next.empty())
      throw InputError("rank: sets: '" + word + "' stands in a set more often than its entry repeats", {},
                       Fault::usage);
    ways = std::move(next);
  }
  return ways;
}

}  // namespace

Located locate(const Model& baseline, const std::vector<Record>& records, const DiscoverOptions& options,
               const std::string& where) {
  const Stage stage(baseline, records, options);
  std::optional<Place> place, seen;
  if (!where.empty()) place = place_named(stage.study.model, where);
  progress(options, "map the residual", 0.7);
  Located out;
  out.baseline = stage.as_given(stage.baseline);
  out.gap = stage.gap(stage.baseline);
  const Candidate reference = follower(stage, seen);
  if (!place && stage.study.degrees() > 1) place = seen.value_or(Place{});
  out.rows = residual_rows(stage.study, stage.baseline, reference, place);
  if (!out.rows.force.allFinite()) throw InputError(std::string("locate: ") + no_residual_maps);
  out.maps = map_residual(out.rows);
  if (place) {
    out.place = motion_of(*place);
    speak_of(out.maps, *place);
  }
  out.warnings = stage.warnings;
  return out;
}

Proposed propose(const Model& baseline, const std::vector<Effect>& given, const std::vector<Record>& records,
                 const DiscoverOptions& options) {
  const Stage stage(baseline, records, options, given);
  std::vector<std::string> untested;
  const std::vector<Effect> catalogue = testable(stage.study, stage.baseline, stage.frame.seen(given), untested);
  if (!stage.baseline.ran())
    throw InputError("propose: the baseline cannot be simulated over the records (" + stage.baseline.fit.stopped + ")",
                     {}, Fault::data);
  Proposed out;
  out.baseline = stage.as_given(stage.baseline);
  out.gap = stage.gap(stage.baseline);
  out.warnings = stage.warnings;
  for (const std::string& entry : untested) out.warnings.push_back("not tried: " + entry);
  PlacedScales scales(stage.study, stage.baseline);
  std::vector<Candidate> all;
  std::vector<std::vector<Guess>> guesses;
  for (const Effect& effect : catalogue) {
    if (!may_join({}, effect)) continue;
    for (int variant = 0; variant < static_cast<int>(effect.variants.size()); ++variant) {
      all.push_back(compile(stage.study, stage.study.model, {{&effect, variant}}));
      guesses.push_back(scales.guesses({&effect, variant}));
    }
  }
  progress(options, "project the entries", 0.4);
  const Whitening whitening = residual_colour(stage.study, stage.baseline);
  std::vector<Proposal> found(all.size());
  const double force_before = stage.baseline.force_cost;
  parallel_for(static_cast<int>(all.size()), options.threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    Candidate& c = all[k];
    find_starts(stage.study, c, stage.baseline.fit.theta, {guesses[k]});
    found[k].name = c.name();
    found[k].variant = c.choices.front().variant;
    if (c.starts.empty()) {
      found[k].remark = "no first guess makes its force finite along the motion";
      return;
    }
    found[k].force_gain = 1 - std::sqrt(c.force_cost / force_before);
    found[k].parameters = own_parameters(c, c.starts.front());
    MotionGain motion = gain_on_motion(stage.study, whitening, stage.baseline, c, c.starts.front());
    found[k].gain = motion.gain;
    found[k].p_value = motion.p_value;
    found[k].remark = std::move(motion.remark);
  });
  const auto promise = [](const Proposal& p) { return p.remark.empty() ? std::max(p.gain, p.force_gain) : 0; };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Proposal& a, const Proposal& b) { return promise(a) > promise(b); });
  for (Proposal& p : found)
    if (std::none_of(out.proposals.begin(), out.proposals.end(), [&](const Proposal& q) { return q.name == p.name; }))
      out.proposals.push_back(std::move(p));
  return out;
}

std::vector<Ranked> rank_sets(const Model& baseline, const std::vector<Effect>& given,
                              const std::vector<std::vector<std::string>>& sets, const std::vector<Record>& records,
                              const DiscoverOptions& options) {
  const Stage stage(baseline, records, options, given);
  std::vector<std::string> untestable;
  const std::vector<Effect> catalogue = testable(stage.study, stage.baseline, stage.frame.seen(given), untestable);
  PlacedScales scales(stage.study, stage.baseline);
  std::vector<Candidate> all{stage.baseline};
  std::vector<std::vector<std::vector<Guess>>> guesses{{}};
  for (const auto& set : sets)
    for (const Choices& way : ways_of(set, catalogue, untestable)) {
      all.push_back(compile(stage.study, stage.study.model, way));
      guesses.emplace_back();
      for (const Choice& choice : way) guesses.back().push_back(scales.guesses(choice));
    }
  progress(options, "fit the sets", 0.3);
  parallel_for(static_cast<int>(all.size()) - 1, options.threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i) + 1;
    find_starts(stage.study, all[k], stage.baseline.fit.theta, guesses[k]);
    if (!all[k].starts.empty()) fit_set(stage, all[k]);
  });
  std::vector<Candidate> kept;
  for (Candidate& c : all) {
    if (c.starts.empty()) c.fit.cost = INFINITY;
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Candidate& k) { return k.name() == c.name(); });
    if (same == kept.end())
      kept.push_back(std::move(c));
    else if (c.fit.cost < same->fit.cost)
      *same = std::move(c);
  }
  const auto best = std::min_element(kept.begin(), kept.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.fit.cost < b.fit.cost; });
  if (!best->ran())
    throw InputError("rank: neither the baseline nor any of the sets can be simulated over the records", {},
                     Fault::data);
  const Whitening whitening = residual_colour(stage.study, *best);
  progress(options, "free runs over left-out blocks", 0.6);
  parallel_for(static_cast<int>(kept.size()), options.threads, [&](int i) {
    Candidate& c = kept[static_cast<std::size_t>(i)];
    if (!c.ran()) return;
    judge(stage.study, c, whitening);
    run_left_out(stage.study, c);
  });
  std::vector<Ranked> out;
  std::size_t likeliest = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Candidate& c = kept[i];
    Ranked row;
    row.name = c.name();
    row.gap = stage.gap(c);
    row.bic = row.left_out_gap = std::numeric_limits<double>::infinity();
    if (!c.ran()) {
      row.remark = c.starts.empty() ? "no first guess makes its force finite along the motion" : c.fit.stopped;
      row.log_likelihood = -INFINITY;
    } else {
      row.left_out_gap = c.left_out_gap;
      row.log_likelihood = c.log_likelihood;
      row.bic = bic(c);
      row.p_value = i > 0 && kept[0].ran() ? improvement_p_value(kept[0], c) : 1;
      if (c.degenerate()) row.remark = "a parameter sits where the effect is another one, or none";
      row.model = stage.as_given(c);
    }
    out.push_back(std::move(row));
    if (out[i].bic < out[likeliest].bic) likeliest = i;
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i == likeliest || !kept[i].ran()) continue;
    const bool holds_it = within(kept[likeliest].choices, kept[i].choices);
    out[i].z = holds_it ? std::numeric_limits<double>::quiet_NaN() : vuong_z(kept[likeliest], kept[i]);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Ranked& a, const Ranked& b) { return a.left_out_gap < b.left_out_gap; });
  return out;
}

}  // namespace lunid
