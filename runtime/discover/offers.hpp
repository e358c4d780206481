#pragma once
// Which entries of the catalogue are worth free runs beside a fitted set: told by what each makes of the force along
// the measured motion.
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "discover/grow.hpp"
#include "discover/propose.hpp"

namespace lunid {

/// An entry beside a fitted set.
struct Offer {
  const Candidate* parent;
  const Proposer::Parent* space;
  Standing standing;
  double misfit = INFINITY;  ///< of the force as it is, behind no receptance

  Choices set() const;
};

/// A fault of a channel is no force to be proposed.
struct ChannelFault {
  Choice choice;
  std::vector<Guess> guesses;
};

/// Of physics that is sought together: more follow whatever there is, and take minutes. An effect alone may have more.
constexpr std::size_t most_parameters = 12;
inline bool are_too_many(const Candidate& parent, const Shape& added) {
  return !parent.choices.empty() && parent.added() + added.linear.size() > most_parameters;
}

class Offers {
 public:
  /// Compiles the entries that are no elements of the baseline. Changes the pool: main thread only. `out`: where it is
  /// noted how many start points were tried, and which entries the record cannot show. Holds references to all.
  Offers(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
         const Grown& known, Grown& out);

  /// Runs the entries of few states along the motion. Those of many states follow where they are asked for.
  void run_along_the_motion();

  /// What is offered beside sets of one size.
  struct Round {
    std::vector<Proposer::Parent> spaces;  ///< of each set
    std::vector<Offer> all;
    std::vector<std::size_t> worth_runs;  ///< the best first
    std::vector<std::size_t> slow;        ///< worth them where no other reaches the noise: of many states
  };
  /// `fewest`: sets of so many parameters of effects and more are not asked for. `parents` has to outlive the round.
  Round beside(const std::vector<Candidate>& parents, std::size_t fewest);
  /// Those that are wanted beside one set, shape parameters refined; in the catalogue's order.
  std::vector<Offer> beside(const Candidate& parent, const Proposer::Parent& space,
                            const std::function<bool(const Shape&)>& wanted);

  /// The force along a noisy motion, or along one that was integrated, may not show what the free run does: of those
  /// that were not fitted, the best on the motion to first order. Says nothing where the parent's run is not near.
  /// `open`: something is left by what was fitted; else entries without states are asked alone, of a parent above the
  /// noise. Compiles sets: main thread only.
  std::vector<std::size_t> best_on_motion(const std::vector<Offer>& offers, const std::vector<std::size_t>& fitted,
                                          const Candidate& parent, bool open = true) const;

  /// Masking: of two effects that together leave far less than any of them beside a parent, the one that leaves less
  /// alone; null where the parents lead as far. Entries of few states.
  const Shape* half_of_a_masked_pair(const Proposer::Parent& space, const std::vector<Candidate>& parents) const;

  const std::vector<Shape>& shapes() const { return shapes_; }
  /// Null of a fault.
  const Shape* shape_of(const Choice& choice) const;
  const std::vector<ChannelFault>& faults() const { return faults_; }
  Proposer::Parent space_of(const Candidate& candidate, const Eigen::VectorXd& theta) const {
    return proposer_.parent(candidate, theta);
  }
  Eigen::Index rows() const { return proposer_.rows(); }
  /// So many fits of records as these where long ones allow `usual`.
  int as_affordable(int usual) const;

 private:
  bool is_known(const Candidate& parent, const Choice& added) const;
  void run_shapes(const std::function<bool(const Shape&)>& wanted);
  const Shape* first_of(const Shape& repetition) const;
  void add(std::vector<Offer>& offers, const Candidate& parent, const Proposer::Parent& space, const Shape& shape);
  void each(std::vector<Offer>& offers, const std::vector<std::size_t>& list,
            const std::function<void(Offer&)>& job) const;
  void score_many_states(std::vector<Offer>& offers, const std::vector<std::size_t>& all);
  bool memory_comes_near(const std::vector<Offer>& offers, const std::optional<Place>& place) const;
  double misfit(const Shape& shape, const Proposer::Parent& space) const;
  void leave_aside(const std::vector<Offer>& offers);
  void refine_the_best(std::vector<Offer>& offers, const std::vector<std::size_t>& sorted, bool single) const;
  void shortlist(Round& round, const std::vector<std::size_t>& order, bool single) const;

  const Study& study_;
  const Model& model_;
  const Grown& known_;
  Grown& out_;
  const Proposer proposer_, plain_;
  const int per_size_;  ///< proposals of one number of parameters that are run
  PlacedScales scales_;
  std::vector<Shape> shapes_;
  std::vector<ChannelFault> faults_;
};

}  // namespace lunid
