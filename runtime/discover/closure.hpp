#pragma once
// Is anything left that a function of the motion would explain? Generic forces beside the model, without a name.
#include "discover/candidate.hpp"

namespace lunid {

struct Closure {
  double p_value = 1;  ///< that generic forces of y, v, slow time and fading memory explain nothing
  double gain = 0;     ///< relative drop of the RMS of the whitened residual on left-out blocks, <= 1; < 0: none
  std::string shape;   ///< the feature that explains most, in words
  std::optional<Place> place;  ///< with several coordinates: where these forces act
  std::string words() const { return place ? shape + ", " + words_of(*place) : shape; }
  std::shared_ptr<const System> system;  ///< the model with the generic forces; null where they could not be run
  FitResult fit;                         ///< filled by fit_closure
};

/// Adds generic forces (products of y and v up to degree 5 and with their sizes, saturations, a fading memory of v,
/// slow changes of stiffness and damping) with coefficient zero to the model and asks what their exact sensitivities
/// explain of the residual beside the model's own parameters and first states. With several coordinates at each place,
/// of which the one that explains most is told. Changes the pool: main thread only.
Closure test_closure(const Study& study, const Candidate& candidate, const Whitening& whitening);

/// Fits the model with its generic forces on the trajectory, from the candidate's parameters or from what the force
/// along the motion says of all: a nonparametric closure that can be simulated. Changes the pool: main thread only.
void fit_closure(const Study& study, const Candidate& candidate, Closure& closure);

/// Where a fitted closure is not down to the sensor's noise, further forces are asked for along its own run, twice at
/// most, and kept where they lower the cost by a tenth. Changes the pool: main thread only.
void refine_closure(const Study& study, const Whitening& whitening, Closure& closure);

/// A model with generic forces that are added one by one, each along the run with those before it, until it is down to
/// the sensor's noise or the cost falls no more by a tenth; those that are then not told from zero are taken out.
/// Changes the pool: main thread only.
Closure grow_closure(const Study& study, const Candidate& candidate, const Whitening& whitening,
                     const std::optional<Place>& place);

}  // namespace lunid
