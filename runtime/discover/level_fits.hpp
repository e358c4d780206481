#pragma once
// Fits of all sets of one size on the trajectory: short ones of every offer, long ones of the best.
#include <span>
#include <vector>

#include "discover/offers.hpp"
#include "discover/proposal_fits.hpp"

namespace lunid {

class LevelFits {
 public:
  /// `out`: the sets that were grown before; what of the channels' faults was tried and left aside is noted there.
  /// Holds references to all.
  LevelFits(const Study& study, const Model& model, const Candidate& baseline, const Offers& offers, const Grown& known,
            Grown& out)
      : study_(study),
        model_(model),
        baseline_(baseline),
        offers_(offers),
        known_(known),
        out_(out),
        fits_(study, baseline, offers.rows()) {}

  /// The listed offers, of one size, and faults of channels beside these parents where the set has fewer than so many
  /// parameters of effects; with the known sets of that size, each set once, least cost first. Main thread only.
  std::vector<Candidate> fit(const std::vector<Offer>& offers, const std::vector<std::size_t>& list, int size,
                             std::span<const Candidate> parents = {}, std::size_t fewest = SIZE_MAX);

  /// Of the best single effects, and of their special cases: noise may have led the force to a minimum that is far from
  /// the trajectory's.
  void leave_minima(std::vector<Candidate>& sorted) const;
  /// Of the best sets of several: where friction sticks, or a wave is passed in a few rows, a fit over whole records
  /// ends where any small step meets other events.
  void begin_in_short_runs(std::vector<Candidate>& sorted) const;

 private:
  void add_faults(const Candidate& parent, std::size_t fewest, std::vector<Candidate>& level,
                  std::vector<const Candidate*>& grown_from);
  void go_on(std::vector<Candidate>& sorted) const;
  std::vector<std::size_t> to_the_end(const std::vector<Candidate>& sorted) const;
  void leave_limits(Candidate& c, double to_beat) const;
  const Candidate* parent_of(const Candidate& c) const;

  const Study& study_;
  const Model& model_;
  const Candidate& baseline_;
  const Offers& offers_;
  const Grown& known_;
  Grown& out_;
  const ProposalFits fits_;
};

void sort_by_cost(std::vector<Candidate>& sets);
/// A set grows from each of its members, and may end in two fits: the better one. `sorted` by cost.
std::vector<Candidate> once_each(std::vector<Candidate> sorted);

}  // namespace lunid
