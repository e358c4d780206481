#pragma once
// Which records a study takes, and as what.
#include <string>
#include <vector>

#include "discover/study.hpp"

namespace lunid {

/// The record with all forces that the study's model is driven by: none acts in a free decay, where the motion dies
/// away; of several coordinates F is the force of the one that is driven, and what the record lacks beside others is
/// zero. A free decay ends where all has come to rest. `decays`: the training records are free decays, and so is this
/// one where it has no force. `warnings` says what was taken for what. Throws InputError for a force F that may act on
/// several.
Record with_known_forces(const Study& study, const Record& record, bool decays, std::vector<std::string>& warnings);
/// No force was measured, and all motions die away.
bool are_decays(const Study& study, const std::vector<Record>& records);

/// No force acts: each that drives the study's model is in the record, and zero throughout.
bool is_free(const Study& study, const Record& record);
bool are_free(const Study& study, const std::vector<Record>& records);

/// Of a record that a discovery trains or tests on.
inline constexpr Eigen::Index least_rows_of_record = 30;
/// Throws InputError for a record that cannot be a discovery's: rows, forces, a motion that is there and moves.
void check_record(const Study& study, const Record& record);

/// Single rows of a measured displacement or velocity that no motion can have (wild_rows) are what their neighbours
/// say, with a warning: one of five deviations outweighs the noise of a thousand. An acceleration may have them: a
/// blow.
Record without_wild_rows(const Record& record, std::vector<std::string>& warnings);

/// Of a coordinate of which more than the fitted quantity was measured (y and v, y and a, v and a): where these do not
/// go together the gain of a sensor is off, with a warning; the fits see one of them.
void compare_sensors(const Study& study, const Record& record, std::vector<std::string>& warnings);

/// Whether a test record holds rows of a training record, at the same times; each that does is a warning, and so is a
/// training record that holds rows of another one.
bool warn_of_known_rows(const std::vector<Record>& train, const std::vector<Record>& test,
                        std::vector<std::string>& warnings);

/// What free runs are held against, and what integrals lose: fills Study::measured and Study::slow, with a warning.
void choose_output(Study& study, const std::vector<Record>& train);

}  // namespace lunid
