#pragma once
// Several coordinates: an entry of the catalogue, which speaks of y, v and a, stands at each place where a force may
// act, and is a candidate of its own there.
#include <vector>

#include "discover/effect.hpp"

namespace lunid {

/// Each coordinate against the ground, and the joints: pairs whose motion is in one of their equations together; all
/// pairs of no more than three coordinates. None of a single coordinate.
std::vector<Place> places_of(const Model& model);

/// The entries as they are with a single coordinate, and else at each place of the model: y, v, a, F become those
/// there, parameters and states get the place behind their names. A fault of a sensor stands at each coordinate, one of
/// the input where a force drives. Changes the pool.
std::vector<Effect> at_places(const Model& model, const std::vector<Effect>& catalogue);

/// An entry that speaks of the channel y as it speaks of v or a, where that was measured (Effect::any_motion): maps,
/// states, guesses, units and formula.
Effect of_channel(const Model& model, const Effect& effect, char measured);

/// The restoring force in the equation of a coordinate.
Expr& restoring_of(Model& model, int coordinate);

/// Adds a force to the equations of the coordinates that it acts on; without a place to that of the first.
void add_force(Model& model, const std::optional<Place>& place, Expr force);

/// The motion at a place as expressions: y, v or a of the coordinate, or the difference of two.
Expr motion_at(const Model& model, const std::optional<Place>& place, char quantity);

/// A sentence that speaks of |y| and |v|, in the words of a place: "grows with |y1 - y2|".
std::string sizes_at(std::string sentence, const Place& place);

/// An entry's formula in the words of a model: "k3*y^3" is "k3*(y1 - y2)^3" in a joint.
std::string formula_at(const std::string& formula, const std::optional<Place>& place);

}  // namespace lunid
