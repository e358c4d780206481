#pragma once
// What an entry would explain, told before any free run: its force along the measured motion against the force that a
// parent leaves open.
#include <algorithm>
#include <map>
#include <optional>

#include "discover/candidate.hpp"
#include "discover/receptance.hpp"

namespace lunid {

/// An entry's contribution alone, compiled once for the whole search.
struct Shape {
  Choice choice;
  std::shared_ptr<const System> system;  ///< mass 0, motion imposed, the entry's own parameters
  std::vector<std::uint8_t> linear;      ///< per own parameter
  std::vector<Guess> guesses;            ///< at least one
  /// Weighted column of each linear parameter at each guess and, with `rest`, of what remains with those at zero; no
  /// rows where it is not finite.
  std::vector<Eigen::MatrixXd> columns = {};
  bool rest = false;
  std::vector<int> substeps = {};  ///< per guess, of the internal states along the motion
  /// The power of newton in each parameter's unit, with which the rest scales; empty where it does not.
  std::vector<int> force_powers = {};

  /// Those of the same entry under other names.
  void take_runs_of(const Shape& other) {
    columns = other.columns;
    rest = other.rest;
    substeps = other.substeps;
    force_powers = other.force_powers;
  }
};

/// Where an entry beside a parent stands on the force.
struct Standing {
  const Shape* shape = nullptr;
  Eigen::VectorXd own, parent;  ///< parameters of the entry, and those of the parent moved along
  double cost = 0;              ///< weighted squared misfit, as a displacement [m^2] ([N^2] with imposed motion)
  int substeps = 1;             ///< of the internal states
  bool shown = false;           ///< its force is no combination of the parent's on this record
  bool refined = false;
};

/// The records' scales at a place with what a model leaves open of them, for the guesses of the entries beside it.
RecordScales scales_beside(const Study& study, const Candidate& model, const std::optional<Place>& place = {});

/// The same at each place that was asked for, worked out once.
class PlacedScales {
 public:
  PlacedScales(const Study& study, const Candidate& model) : study_(study), model_(model) {}
  /// Good until the next place is asked for.
  const RecordScales& at(const std::optional<Place>& place);
  /// First guesses of a choice where it stands; none where its entry has none.
  std::vector<Guess> guesses(const Choice& choice);
  /// In the order in which they were asked for.
  std::vector<std::optional<Place>> places() const;

 private:
  const Study& study_;
  const Candidate& model_;
  std::vector<std::pair<std::optional<Place>, RecordScales>> all_;
};

/// Free runs of such an entry cost more than those of all others together.
inline bool many_states(std::size_t states) { return states > 4; }
inline bool many_states(const Choices& set) {
  return std::ranges::any_of(set, [](const Choice& c) { return many_states(c.effect->states.size()); });
}
inline bool many_states(const Shape& shape) { return many_states(shape.system->model().states.size()); }

/// Compares forces as the trajectory feels them: behind the receptance of the linear system.
class Proposer {
 public:
  /// `weigh` false: forces as they are, for what a drifting free run would hide.
  Proposer(const Study& study, const Candidate& baseline, bool weigh = true);

  /// Compiles a variant of an entry. Changes the pool: main thread only.
  Shape shape(const Model& model, const Choice& choice, const RecordScales& scales) const;
  /// Runs it once per guess along the motion.
  void run(Shape& shape) const;

  /// A parent's tangent space and what it leaves open.
  struct Parent {
    Eigen::VectorXd theta, residual;  ///< residual: weighted, tangent space projected out
    Eigen::MatrixXd jacobian, basis;  ///< weighted; basis: orthonormal
    Eigen::MatrixXd back;             ///< from weighted forces to steps of theta
    double cost = 0;
    std::vector<Parameter> table;  ///< of theta, with the bounds that it moves in
    Eigen::VectorXd start, open;   ///< theta of the jacobian; weighted, what is open there
  };
  Parent parent(const Candidate& candidate, const Eigen::VectorXd& theta) const;

  /// The best guess, its linear parameters solved for; nothing shown of a shape that has not been run.
  Standing score(const Shape& shape, const Parent& parent) const;
  /// What each two of the shapes leave together, each at one of its guesses and as `score` has it; what one leaves
  /// alone on the diagonal. Infinite where a shape shows nothing.
  Eigen::MatrixXd pair_costs(const std::vector<const Shape*>& shapes, const Parent& parent) const;
  /// Gauss-Newton on all its parameters from there.
  void refine(Standing& standing, const Parent& parent, int iterations) const;

  Eigen::Index rows() const { return rows_; }

 private:
  Eigen::VectorXd weighted(const Eigen::VectorXd& force) const;
  int evaluate(const System& system, const Eigen::VectorXd& theta, Eigen::VectorXd& force) const;
  bool evaluate(const System& system, const Eigen::VectorXd& theta, Eigen::VectorXd& force, Eigen::MatrixXd* jacobian,
                int substeps) const;
  Eigen::MatrixXd columns_at(Shape& shape, const Guess& guess) const;
  void span(Parent& parent) const;
  /// The parent with those of its parameters held at their bounds that the values would take beyond; nothing where
  /// none would be.
  std::optional<Parent> held_at_bounds(const Parent& parent, const Eigen::VectorXd& values) const;
  bool scales_with_force(const Shape& shape, const std::vector<int>& powers) const;

  std::vector<FitData> data_;
  Eigen::Index rows_ = 0, degrees_ = 1;  ///< rows: of all coordinates
  Eigen::VectorXd measured_;             ///< the forces, all coordinates and then all records in a row, not weighted
  Receptance receptance_;
};

}  // namespace lunid
