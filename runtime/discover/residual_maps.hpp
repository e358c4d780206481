#pragma once
// Where the residual force is larger than its noise: over time, displacement, velocity, amplitude, harmonic order,
// frequency and slow time, each with a level that noise of any colour stays below.
#include "discover/candidate.hpp"

namespace lunid {

/// A residual force along a motion; all records in a row.
struct ResidualRows {
  Eigen::VectorXd t, y, v, force;           ///< force: measured - model [N]
  std::vector<Eigen::Index> row_of_record;  ///< first row of each record, and behind them the number of rows
  double dt = 1, omega = 0;                 ///< time step, dominant angular frequency
  Eigen::Index block = 1;                   ///< rows over which the noise may be correlated
  std::uint64_t seed = 1;
  Units units;
};

/// Means over bins, and levels by flipping the signs of whole blocks of what the bins leave (a wild bootstrap that
/// keeps the noise's colour; Shao 2010, J. Amer. Statist. Assoc. 105, 218), the largest over all bins at 95 %. Rms
/// values are held against block means of the squares.
ResidualMaps map_residual(const ResidualRows& rows);

/// The sentence alone, that of each map, and where there is no data.
std::string sentence_of(const ResidualMaps& maps, const ResidualRows& rows);
void say_each(ResidualMaps& maps, const Units& units);
std::string unseen(const ResidualMaps& maps, const ResidualRows& rows);

/// Whether a row of a smoothed training record counts in maps: not where it is smoothed over an end, nor, of a motion
/// that was integrated, near the ends, where the high pass leaves many times the drift that it leaves elsewhere.
bool is_mapped(const Study& study, std::size_t record, Eigen::Index row);

/// The residual rows of a model at a place along the smoothed training records (locate.hpp).
ResidualRows residual_rows(const Study& study, const Candidate& candidate, const Candidate& reference,
                           const std::optional<Place>& place = {});

}  // namespace lunid
