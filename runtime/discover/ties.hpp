#pragma once
// Which of several judged sets is taken where the records allow more than one, and what is said beside it.
#include <string>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// Not rejected against the best: nested sets by the likelihood ratio, corrected for so many sets that were tried,
/// others by Vuong's test (fits_worse).
bool not_rejected(const Study& study, const Candidate& c, const Candidate& best, int tried);
/// Their free runs differ by less than a thirtieth of what they leave open: one force in two notations.
bool same_runs(const Candidate& a, const Candidate& b);

/// A more general form of a set, which the likelihood ratio tells from it (one of `tried`) and which takes the least
/// gain off its error.
bool outgrows(const Study& study, const Candidate& general, const Candidate& special, int tried);
/// So told, and takes more than half of what the special one leaves above the sensor's noise, however little that is
/// beside the noise itself.
bool takes_most(const Study& study, const Candidate& general, const Candidate& special, int tried);

/// Sets of as many parameters with the same faults and the same runs, or whose entries are one law.
bool same_in_other_words(const Candidate& a, const Candidate& b);

/// Of one force in two notations, alone or beside the same other effects, the one that turns no parameter of the
/// baseline negative, a spring that pushes say, and of equals the one that the catalogue has first. `alike`: of the
/// field, the simplest first.
std::size_t in_the_usual_words(const Candidate& baseline, const std::vector<Candidate>& field,
                               const std::vector<std::size_t>& alike);

/// A fault of a channel comes before physics that does the same, also where a larger set that holds the fault rejects
/// it: a larger one that holds the physics would. Changes `pick`, and adds it to those that are alike.
void prefer_the_same_fault(const std::vector<Candidate>& field, std::vector<std::size_t>& alike, std::size_t& pick);

struct Ties {
  /// That the record cannot tell from the chosen set: of equal simplicity, or physics that does just what a fault does.
  std::vector<Choices> rivals;
  std::vector<std::string> aliases;  ///< whose free runs are those of the chosen set: the same in other words
  /// Of what is named beside these.
  Verdict verdict() const { return rivals.empty() ? Verdict::explained : Verdict::ambiguous; }
};

/// What of these judged sets the records cannot tell from the chosen one.
Ties find_ties(const Study& study, const Candidate& baseline, const Candidate& chosen,
               const std::vector<const Candidate*>& among);

/// Of sets with the same runs those that another channel of the training records bears out, the nearest to it first:
/// where v was measured beside y, a gain of y is none of the force. Empty where no further channel was measured, none
/// follows it, or all do alike.
std::vector<const Candidate*> borne_out_by_other_channels(const Study& study,
                                                          const std::vector<const Candidate*>& sets);

/// What a fitted set leaves of the other channels does not follow, linearly, what it leaves of the fitted one: none was
/// computed from it, and its noise with it.
bool were_measured_apart(const Study& study, const Candidate& c);

/// How far the free runs of two fitted sets lie apart, over what the second leaves open.
double share_apart(const Candidate& a, const Candidate& b);

}  // namespace lunid
