#pragma once
// Inside record: files whose rows are read block by block.
#include <functional>
#include <memory>

#include "record/stream.hpp"

namespace lunid {

/// Rows that are read and worked on together.
constexpr Eigen::Index stream_rows = 1 << 14;

using Progress = std::function<void(double fraction)>;
/// Opens a file and checks all of it that can be checked without a second look: `layout` gets the time base and the
/// channels of the file, without their noise.
std::unique_ptr<RowSource> open_csv_rows(const std::string& path, const ReadOptions& options, const Progress& progress,
                                         RowSource::Layout& layout);
std::unique_ptr<RowSource> open_container_rows(const std::string& path, const ReadOptions& options,
                                               const Progress& progress, RowSource::Layout& layout);

}  // namespace lunid
