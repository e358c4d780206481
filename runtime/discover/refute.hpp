#pragma once
// What the test records take back of a verdict, and what they bear out.
#include <optional>
#include <string>
#include <vector>

#include "discover/verdict.hpp"

namespace lunid {

/// Remark of names that the test records take back.
inline constexpr auto not_confirmed = "not confirmed by the test record";

/// The test records do not bear out what generic forces saw in the training records beside the chosen model: the gap on
/// them does not fall by these, nor do they show such forces of their own. False where these cannot be run there.
/// `before`: the model's runs over the test records.
bool gone_on_test(const Study& study, const Round& round, const std::vector<FreeRun>& before);

/// Forces that follow the training motion need not hold beyond it: whether the test records show some of their own
/// beside the same model, fitted to them.
bool test_shows_structure(const Study& study, const Candidate& model, const Whitening& whitening);

/// A model that follows the training records leaves no more open on the test than three deviations of its parameters
/// make of it there: a sweep through a jump hangs on a damping that the training records show to a percent.
bool hangs_on_parameters(const Study& study, const Candidate& model, const Gap& train, const Gap& test);

/// That the named model is better than the baseline on the test records, by their runs over these.
double test_p_value(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// Why the test records take the names back; empty when they do not.
std::string refuted(const Study& study, const Round& round, double p_value, const std::vector<FreeRun>& before,
                    const std::vector<FreeRun>& after);

/// Nothing is named, and the training records show an effect by less than the least gain (two tones, a low level): the
/// round in which it is named, where the test records, on which far more hangs on it, bear it out whole. Not where what
/// the baseline leaves there hangs on its parameters.
std::optional<Round> borne_out(const Study& study, const Round& round);

/// A single effect that the training records cannot tell from the chosen one, and what it does.
struct TiedRival {
  Candidate model;
  Left left;
  std::vector<FreeRun> train, test;
  double test_p_value;
};

/// Of those, and of the same force in other words there, in the order of the rivals: the ones that the test records do
/// not take back, and which none of these betters there beyond chance. None of several names.
/// `tested`: the study as the test records are judged, `before` the baseline's runs in it.
std::vector<TiedRival> tied_that_stand(const Study& study, const Study& tested, const Round& round,
                                       const std::vector<FreeRun>& before);

/// The named model fitted to training and test records together.
struct FitToAll {
  Gap test;  ///< the gap there
  /// Where parameters were open that no step of the training fit changes: the fit to the training records with those of
  /// the fit to all.
  std::optional<FitResult> settled;
};
/// Where that is down to the noise of both, the training records allow these parameters, and the names lower the test
/// gap as they are, or have parameters that no step of the training fit changes: the training records leave the
/// parameters open, not the name (two single tones before a sweep through the resonance). Not of several springs at one
/// place, which bend as a series does.
std::optional<FitToAll> fit_to_all(const Study& study, const Round& round, double p_value,
                                   const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// How many of the first steps the test records confirm for themselves where they do not confirm all: what a single
/// record has of its own (a drift of its sensor) must not take the others' names. They have to close nearly all of the
/// gap, to leave little, to be told from zero, and to leave above one and a half floors no force that the test
/// records show for themselves. `before`: the baseline's runs over the test records.
std::size_t steps_that_stand(const Study& study, const Round& round, const std::vector<FreeRun>& before);
/// The same where they confirm all together: without the last ones whose step has raised the gap, or closed less than
/// half of what the steps before it leave above the noise. `after`: the final model's runs over the test records.
std::size_t steps_that_help(const Study& study, const Round& round, const std::vector<FreeRun>& after);

}  // namespace lunid
