#pragma once
// Faults of sensors and of the input: they compete with physics for the same misfit, and win where the record cannot
// tell (docs/discovery.md). What they say of a channel is data of their entries; here is what that asks of the search.
#include <string>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// True for an entry that says something of the thing itself: of any family but sensor and input.
bool is_physics(const Effect& effect);
/// How many of the chosen effects are physics.
int physics_in(const Choices& choices);

/// The entries whose channels all records hold, and that motion of this kind can show, at each place of the model
/// (places.hpp), without parameters that are one number with the (fitted) baseline's (twins.hpp). `left` gets the rest,
/// with the reason.
std::vector<Effect> testable(const Study& study, const Candidate& baseline, const std::vector<Effect>& catalogue,
                             std::vector<std::string>& left);

/// Adds a variant of an entry to a model: its force, or what it makes of a channel after what the model makes of it
/// already, with the states that it leads to. Parameters are left to the caller. Changes the pool.
void add_variant(Model& model, const Effect& effect, int variant);

/// False of a delay of the force beside a map that holds the force's rate, which a delayed force does not have, and
/// beside another delay.
bool goes_with(const Choices& set, const Choice& more);

/// Orders the starts of a candidate whose fault the force along the measured motion does not show (a lag, a limit) by
/// short fits on the trajectory. `theta`: the parameters of the model without it.
void order_by_motion(const Study& study, Candidate& candidate, const Eigen::VectorXd& theta);

/// Starts of a set that adds a channel's fault to one that runs: the parameters of that with each guess, best free run
/// first.
void start_beside(const Study& study, Candidate& candidate, const Candidate& parent, const std::vector<Guess>& guesses);

/// False when what a fault of a channel adds to the force (as the record shows it) is a combination of what the
/// parent's parameters do: a gain where the mass and all coefficients are free. True where the force does not show the
/// fault.
bool shows_beside(const Study& study, const Candidate& candidate, const Candidate& parent);

/// A record with a channel `phase` or `shaft_angle` [rad], `speed` or `shaft_speed` [rad/s or Hz] of a shaft gets
/// shaft_angle, shaft_speed and shaft_rate; another is returned as it is.
Record with_shaft(const Record& record);

/// What in the data looks like a faulty sensor, in words to be put behind where the model fails; "" where nothing does.
std::string sensor_hint(const Study& study, const Candidate& baseline);

}  // namespace lunid
