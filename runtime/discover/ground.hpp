#pragma once
// What a search stands on, how that changes with what was found, and what was found judged anew.
#include "discover/search.hpp"
#include "discover/study.hpp"
#include "discover/verdict.hpp"

namespace lunid {

struct Ground {
  Study whole, study;  ///< of all rows, and of those that are looked at now: pieces of long records in the search
  Candidate baseline;  ///< fitted to the latter
  Searched searched = Searched::first;

  void read_force(BetweenSamples between);
  /// Several outputs weigh by their noise: the fit of the baseline is another one.
  void take_noise();
  /// More rows, for a new search of up to so many effects; false where no more are searched.
  bool take_more_rows(int most_effects);
  /// The rows as they were recorded, the force so between them, for a new search.
  void take_rows_as_recorded(Interpolation between);
};

/// Whether joined rows leave open what the model follows over the rows as they were recorded, and how the force is read
/// between these then: what sticks and slips, or strikes, within a joined row answers what the force does there, not
/// its means.
std::optional<Interpolation> joined_rows_mislead(const Ground& ground, const Candidate& model);

/// Whether the force is to be read otherwise between its samples, by so much that a new search is worth it; it is then
/// left so. The rms error that is left. Asked of what was chosen, of sets of fewer effects, which may do alone then (a
/// lag and a gain stand for half a sample beside one law), and, where that leaves anything, of the sets that follow
/// best: a model that lacks something may hide half a sample in its damper, where what it lacks would show it.
std::optional<double> reads_otherwise(Ground& ground, SearchResult& found);

/// What was found, judged on the study as it is now. The names stay; rivals are judged where they are, nearly.
void judge_again(const Study& study, SearchResult& found);

/// What was found on pieces of long records is fitted to all their rows, and decided again. The names stay, but where a
/// single effect with no more parameters follows all rows better. Nothing is done where all rows were looked at.
void fit_all_rows(Ground& ground, Round& round);

}  // namespace lunid
