#pragma once
// Inside record: derived channels of a stream, which are made block by block, each with some rows more on either side.
#include <span>
#include <string>
#include <vector>

#include "record/derive.hpp"
#include "record/row_source.hpp"

namespace lunid {

/// Channels that a method makes of others.
struct BlockwiseChannels {
  std::vector<std::size_t> from;    ///< among the channels of the file: one, or for a Kalman smoother several
  std::vector<int> ranks;           ///< of each: 0 displacement, 1 velocity, 2 acceleration
  std::vector<double> noise;        ///< of each
  std::vector<int> derivatives;     ///< of the first that are made; 0: smoothed
  std::vector<std::size_t> places;  ///< of these among the channels of the stream
  DerivativeMethod method;          ///< nothing left to choose
  Eigen::Index reach = 0;  ///< rows that it needs on either side, at the ends of the record twice as many on one
  bool still = false;      ///< the first is constant, and its derivatives are zero

  /// Their values over some rows of the file's channels: rows x derivatives.
  Eigen::MatrixXd values(const std::vector<Eigen::VectorXd>& columns, double dt) const;
};

/// Looks through the rows: notes the noise of each channel in the layout, chooses what the method leaves open and adds
/// the derived channels. Throws InputError as open_stream().
std::vector<BlockwiseChannels> derive_blockwise(const RowSource& source, RowSource::Layout& layout,
                                                const StreamOptions& options, const Progress& progress);

// ---- how far a method sees [blockwise_reach.cpp] ----

/// A method with nothing left to choose.
struct SettledReach {
  DerivativeMethod method;
  Eigen::Index reach = 0;  ///< rows on either side beyond which its weights are under 1e-12 of the largest
};
/// `noise`: standard deviations of the channels of these ranks, the lowest first; `dt` [s]. Throws InputError where a
/// parameter is open still and for a method whose weights have no end.
SettledReach settled_reach(const DerivativeMethod& method, std::span<const int> ranks, std::span<const double> noise,
                           double dt, int derivative);

}  // namespace lunid
