#pragma once
// Channels that do not show what they are named after (Model::measures, Model::acts), undone where that is possible:
// what the force of an imposed motion needs. Internal to this room and to discovery.
#include <utility>
#include <vector>

#include "simulate/model.hpp"

namespace lunid {

/// The place in the state of a channel such as y, v2; -1 when it is none.
int state_of(const Model& model, std::string_view channel);

/// The true y, v, a of the coordinates by those that the channels show: replacements for expressions of the motion.
/// A displacement that shows A*y + B with A and B of t and parameters alone is undone, with its derivatives; so is a
/// velocity or an acceleration of constant A, with its integrals, in which B (slow) is not looked for. What is not (a
/// limit, a lag) is left as its channel shows it. One channel of a coordinate at most. Changes the pool.
std::vector<std::pair<Expr, Expr>> undo_measures(const Model& model);

/// The force that the channel of a coordinate shows while `acting` acts on it. Where the rate of the channel takes part
/// it is left as it is. Changes the pool.
Expr undo_acts(const Model& model, int coordinate, Expr acting);

/// True when a model with these channels says all of them by the motion alone: undo_measures and undo_acts leave
/// nothing.
bool can_be_undone(const Model& model);

/// The model without states that neither its force nor the states of that force depend on.
Model without_unfelt_states(Model model);

}  // namespace lunid
