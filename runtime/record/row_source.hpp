#pragma once
// Inside record: rows that are read block by block, from a file or from other rows.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "record/stream.hpp"

namespace lunid {

/// Rows that are read and worked on together.
constexpr Eigen::Index stream_rows = 1 << 14;
/// The most rows that a filter may reach beyond a block on either side.
constexpr Eigen::Index furthest_reach = 16 * stream_rows;

/// Where the rows of a stream are: a file, or what a treatment makes of another source.
class RowSource {
 public:
  virtual ~RowSource() = default;
  /// Rows [first, first + count) of all channels, in SI, in the order of `Layout::channels`. Several threads may call
  /// it.
  virtual std::vector<Eigen::VectorXd> read(Eigen::Index first, Eigen::Index count) const = 0;
  /// Takes note that so many of these rows were worked on (StreamOptions::reading).
  virtual void count_read(Eigen::Index) const {}

  /// What is known of the rows without them.
  struct Layout {
    std::string name;
    double t0 = 0, dt = 1;
    Eigen::Index rows = 0;
    std::vector<Channel> channels;  ///< without values
    std::vector<std::string> warnings, history;
  };
  const Layout& layout() const { return layout_; }

 protected:
  Layout layout_;
};

/// Calls visit(first, columns) for all rows, in order, stream_rows at a time.
void for_each_piece(const RowSource& rows,
                    const std::function<void(Eigen::Index first, const std::vector<Eigen::VectorXd>& columns)>& visit);

using Progress = std::function<void(double fraction)>;
/// Opens a file and checks all of it that can be checked without a second look. The channels are those of the file,
/// without their noise.
std::unique_ptr<RowSource> open_csv_rows(const std::string& path, const ReadOptions& options, const Progress& progress);
std::unique_ptr<RowSource> open_container_rows(const std::string& path, const ReadOptions& options,
                                               const Progress& progress);

}  // namespace lunid
