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

/// One map: values over bins of a quantity.
struct BinnedMap {
  std::string over;          ///< "time" "y" "v" "amplitude" "harmonic" "frequency"
  std::string unit;          ///< of x
  std::string value_is;      ///< "mean" | "rms" | "amplitude" | "root density"
  Eigen::VectorXd x, value;  ///< centres of the bins; NaN in `value` where there is no data
  Eigen::VectorXd level;     ///< |value| that noise alone stays below in all bins at once, 95 %
  Eigen::VectorXd rows;      ///< in each bin
  double share = 0;          ///< of the residual's variance that a function of x explains (y, v)
  bool above(Eigen::Index i) const { return std::abs(value[i]) > level[i]; }
  bool any_above() const;
};

/// What no function of y and v explains, as offset, stiffness and damping over parts of the records.
struct SlowTime {
  Eigen::VectorXd time;                     ///< middles of the parts [s]
  Eigen::MatrixXd value, std;               ///< parts x (constant, slope in y, slope in v)
  bool changes[3] = {false, false, false};  ///< beyond chance, 5 % over all parts
};

struct ResidualMaps {
  std::vector<BinnedMap> maps;
  ResidualMap plane;  ///< `before` alone
  Eigen::MatrixXd plane_level;
  SlowTime slow;
  double rms = 0;            ///< of the residual
  double noise = 0;          ///< rms of what is no function of y and v
  bool loop = false;         ///< it differs between loading and unloading (v > 0 and v < 0 at equal y)
  double loop_share = 0;     ///< of the residual's mean square in that difference
  bool above_noise = false;  ///< some map is
  std::string sentence;      ///< what an engineer would say
  std::string no_data;       ///< where the records say nothing
  const BinnedMap& map(std::string_view over) const;
};

/// Means over bins, and levels by flipping the signs of whole blocks of what the bins leave (a wild bootstrap that
/// keeps the noise's colour; Shao 2010, J. Amer. Statist. Assoc. 105, 218), the largest over all bins at 95 %. Rms
/// values are held against block means of the squares.
ResidualMaps map_residual(const ResidualRows& rows);

/// The sentence alone, and where there is no data.
std::string sentence_of(const ResidualMaps& maps, const ResidualRows& rows);
std::string unseen(const ResidualMaps& maps, const ResidualRows& rows);

/// The residual rows of a model at a place along the smoothed training records (locate.hpp).
ResidualRows residual_rows(const Study& study, const Candidate& candidate, const Candidate& reference,
                           const std::optional<Place>& place = {});

}  // namespace lunid
