// The rows of an HDF5 or MAT file that is larger than memory.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "record/container_plan.hpp"
#include "record/row_source.hpp"
#include "record/time_base.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

class ContainerRows : public RowSource {
 public:
  ContainerRows(const std::string& path, const ReadOptions& options, const Progress& progress)
      : path_(path), file_(open_container(path)) {
    Layout& layout = layout_;
    plan_ = plan_container(*file_, path, options);
    layout.name = path;
    layout.rows = static_cast<Index>(plan_.rows);
    layout.warnings = plan_.warnings;
    check_rows(layout.rows, path_);
    leave_out_whole(layout.warnings);
    set_time(layout);
    look_through(progress, layout);
    if (plan_.channels.empty()) fail("expected a vector of numbers beside the time");
    for (const std::size_t i : plan_.channels) layout.channels.push_back(channel_of(plan_.plans[i]));
  }

  std::vector<VectorXd> read(Index first, Index count) const override {
    std::vector<VectorXd> out;
    for (const std::size_t i : plan_.channels) {
      out.push_back(rows_of(i, first, count));
      if (plan_.plans[i].factor != 1) out.back() *= plan_.plans[i].factor;
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(message, {path_}, Fault::data); }

  /// Refuses a variable that the file gives all at once or not at all.
  void refuse_whole(std::size_t i) const {
    if (file_->variables()[plan_.choices[i].variable].whole)
      fail("variable '" + plan_.header[i].text +
           "': a MAT file gives its rows in blocks only where it is of version 7.3 and the variable is not inside a "
           "structure: save it with -v7.3, or read it whole with lunid.read");
  }

  /// The same, of the channels that matter; leaves other ones out.
  void leave_out_whole(std::vector<std::string>& warnings) {
    std::erase_if(plan_.channels, [&](std::size_t i) {
      if (plan_.plans[i].required) refuse_whole(i);
      const bool whole = file_->variables()[plan_.choices[i].variable].whole;
      if (whole) warnings.push_back("left out: variable '" + plan_.header[i].text + "': it cannot be read in blocks");
      return whole;
    });
  }

  VectorXd rows_of(std::size_t i, Index first, Index count) const {
    const std::lock_guard lock(guard_);  // HDF5 serves one at a time
    return read_choice(*file_, path_, plan_.choices[i], static_cast<std::size_t>(first),
                       static_cast<std::size_t>(count));
  }

  void set_time(Layout& layout) const {
    layout.dt = plan_.interval;
    if (!plan_.has_time()) return;
    refuse_whole(plan_.time);
    const double factor = plan_.plans[plan_.time].factor;
    const Variable& variable = file_->variables()[plan_.choices[plan_.time].variable];
    if (variable.start && variable.step && factor == 1) {
      layout.t0 = *variable.start;
      layout.dt = *variable.step;
      return;
    }
    const StampRange range{static_cast<double>(layout.rows), factor * rows_of(plan_.time, 0, 1)[0],
                           factor * rows_of(plan_.time, layout.rows - 1, 1)[0]};
    Stamps stamps;
    for (Index at = 0; at < layout.rows; at += stream_rows) {
      const VectorXd t = factor * rows_of(plan_.time, at, std::min(stream_rows, layout.rows - at));
      const VectorXd resolution = stamp_resolution(t, range, variable.single);
      std::vector<int> rows(static_cast<std::size_t>(t.size()));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const Index row = at + static_cast<Index>(i) + 1;
        rows[i] = static_cast<int>(row);
        if (!std::isfinite(t[static_cast<Index>(i)]))
          fail("variable '" + variable.name + "', the time: row " + std::to_string(row) + " is not a number");
      }
      stamps.add({t.data(), rows.size()}, {resolution.data(), rows.size()}, rows);
    }
    const TimeBase base = stamps.fit(path_, layout.warnings);
    layout.t0 = base.t0;
    layout.dt = base.dt;
  }

  /// Refuses values that are not finite, in channels that matter; leaves other channels out.
  void look_through(const Progress& progress, Layout& layout) {
    for (Index at = 0; at < layout.rows; at += stream_rows) {
      const Index count = std::min(stream_rows, layout.rows - at);
      std::vector<std::size_t> kept;
      for (const std::size_t i : plan_.channels) {
        const std::string fault = not_finite(plan_, i, static_cast<std::size_t>(at), rows_of(i, at, count));
        if (fault.empty())
          kept.push_back(i);
        else if (plan_.plans[i].required)
          fail(fault);
        else
          layout.warnings.push_back("left out: " + fault);
      }
      plan_.channels = std::move(kept);
      if (progress) progress(static_cast<double>(at + count) / static_cast<double>(layout.rows));
    }
  }

  const std::string path_;
  std::unique_ptr<Container> file_;
  ContainerPlan plan_;
  mutable std::mutex guard_;
};

}  // namespace

std::unique_ptr<RowSource> open_container_rows(const std::string& path, const ReadOptions& options,
                                               const Progress& progress) {
  return std::make_unique<ContainerRows>(path, options, progress);
}

}  // namespace lunid
