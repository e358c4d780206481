#pragma once
// What a sensor does to a signal: noise of several kinds, outliers, lost samples, steps and limits.
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "record/random.hpp"

namespace lunid {

/// One fault of a sensor. Sizes are in the channel's unit, or `relative`: to the standard deviation of the channel
/// (clipped and quantised ones: to its largest magnitude).
struct SensorFault {
  enum class Kind {
    gaussian,        ///< + size * N(0, 1)
    uniform,         ///< + size * U(-1, 1)
    coloured,        ///< + noise of rms `size`, power density 1/f^exponent, or of the autoregression `ar`
    multiplicative,  ///< * (1 + size * N(0, 1)); size is a factor
    poisson,         ///< counts of `size` each: sign(x) * size * Poisson(|x| / size)
    outliers,        ///< a `fraction` of the rows is off by +size or -size
    dropped,         ///< a `fraction` of the rows is lost and filled as `fill` says
    quantised,       ///< rounded to whole multiples of `size`, or to 2^bits values over -size to size
    clipped          ///< held within -size to size
  };
  enum class Fill { hold, linear, gap };  ///< the value before it, a straight line, or NaN
  Kind kind = Kind::gaussian;
  double size = 0;  ///< > 0
  bool relative = false;
  double exponent = 0;     ///< -4 to 4
  std::vector<double> ar;  ///< of a stationary series; empty: the exponent is meant
  double fraction = 0;     ///< 0 to 1
  Fill fill = Fill::hold;
  int bits = 0;  ///< 1 to 52; 0: size is the step
};

/// Changes `x` and returns how many rows were hit (0 for noise on every row). Throws InputError for options out of
/// range; a relative fault of a channel that is constant has size 0 and does nothing.
Eigen::Index apply(const SensorFault& fault, Eigen::VectorXd& x, Philox& random);

}  // namespace lunid
