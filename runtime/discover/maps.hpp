#pragma once
// Maps of a residual force, in plain values.
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace lunid {

/// A rectangle of the (y, v) plane and the mean residual force there, before and after; NaN where there is no data.
struct ResidualMap {
  Eigen::VectorXd y, v;           ///< cell centres
  Eigen::MatrixXd before, after;  ///< mean residual force [N], (y index, v index)
  Eigen::MatrixXd count;
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
  std::string sentence;      ///< where it is above the level, and by how much
  bool above(Eigen::Index i) const { return std::abs(value[i]) > level[i]; }
  bool any_above() const;
};

/// What no function of y and v explains, as offset, stiffness and damping over parts of the records.
struct SlowTime {
  static constexpr const char* names[] = {"constant", "stiffness", "damping"};
  Eigen::VectorXd time;                     ///< middles of the parts [s]
  Eigen::MatrixXd value, std;               ///< parts x (constant, slope in y, slope in v)
  bool changes[3] = {false, false, false};  ///< beyond chance, 5 % over all parts
  std::string sentence;
};

/// Why a model has no maps.
constexpr const char* no_residual_maps = "the model's force is not finite along the measured motion";

struct ResidualMaps {
  std::vector<BinnedMap> maps;
  ResidualMap plane;  ///< `before` alone
  Eigen::MatrixXd plane_level;
  std::string plane_sentence;
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

}  // namespace lunid
