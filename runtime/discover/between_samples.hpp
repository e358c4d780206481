#pragma once
// What a force does between its samples: one kind of interpolation, and what it may do beyond that.
#include <functional>
#include <optional>
#include <string>

#include "discover/candidate.hpp"
#include "discover/effect.hpp"
#include "discover/study.hpp"

namespace lunid {

/// The forces of all training records look alike between their samples.
bool one_look(const Study& study);

inline constexpr auto no_free_run = "none: the motion is imposed";
/// The baseline says how its force is read (Model::interpolation): no model is asked.
bool is_said(const Study& study);
/// How the force is read: "cubic", ...
std::string words_of_interpolation(const Study& study);

/// Makes the study read the forces so, and returns it.
using ReadForce = std::function<const Study&(BetweenSamples)>;

/// Asked of a model whose misfit no longer hides what the force does between its samples; the first choice (study.cpp)
/// is made on the force alone. Where another kind is clearly likelier the study is left with it, and the model as
/// fitted beside it. Returns the relative drop of the squared error.
double rechoose_interpolation(const Study& study, Candidate& model, const ReadForce& read);

/// Part of a model's squared error that is not the sensor's noise.
double part_above_noise(const Study& study, const Candidate& model);

/// The reading under which a model that follows the motion nearly, but not down to the noise, leaves far less: a search
/// that goes on would patch the wrong one with ever more names. Not a held force, in place of another or the other way
/// round: it comes half a sample late, which an effect of its own may do.
std::optional<BetweenSamples> far_better_reading(const Study& study, const Candidate& model);

/// A part of the force that a controller holds while the rest goes on: held less straight, -kappa y - delta v is to
/// second order in the sampling interval dt the force kappa dt/2 v + (delta dt/2 + kappa dt^2/12) a. As an entry it is
/// a change of the mass of either sign, by (omega dt)^2/12 + omega dt/10 at most (kappa up to the stiffness that holds
/// the mass, delta up to a tenth of critical damping), and a lag of the force (or, which is the same, of the motion
/// that is measured) below half a sample. What is no better than these is not named. None where the motion is imposed,
/// several coordinates move or no force acts. Grows the pool: main thread only.
std::optional<Effect> between_samples(const Study& study, const Model& model);

struct Reading {
  Eigen::Vector2d parameters;  ///< of the entry: part of the mass, lag [s]
  Interpolation between;
};

/// "0.31 of a sample earlier, and a mass that is 0.9 % more"; "band-limited between its samples, ..." where the study
/// reads it otherwise.
std::string words_of_reading(const Study& study, const Reading& reading);

}  // namespace lunid
