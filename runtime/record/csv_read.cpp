#include <algorithm>

#include "record/csv_table.hpp"
#include "record/time_base.hpp"

namespace lunid {
namespace {

/// The time base of a table whose column `time` holds the stamps, which become seconds.
TimeBase time_base(CsvTable& table, std::size_t time, const std::string& path, bool resample,
                   std::vector<std::string>& warnings) {
  const double factor = table.plans[time].factor;
  std::vector<double>& t = table.columns[time];
  std::vector<double> resolution(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    resolution[i] = factor * table.time_digits.resolution(t[i]);
    t[i] *= factor;
  }
  return fit_time_base(t, resolution, table.lines, path, resample, warnings);
}

}  // namespace

Record read_csv(const std::string& path, const ReadOptions& options) {
  std::vector<std::string> warnings;
  CsvTable table = parse_table(path, read_text(path), options, warnings);
  const auto is_time = [](const ColumnPlan& plan) { return plan.channel == "t"; };
  const auto time =
      static_cast<std::size_t>(std::find_if(table.plans.begin(), table.plans.end(), is_time) - table.plans.begin());
  const auto is_signal = [](const ColumnPlan& plan) { return plan.channel != "t" && !plan.channel.empty(); };
  if (std::ranges::none_of(table.plans, is_signal))
    throw InputError("expected a column of numbers beside the time", {path, table.header_line}, Fault::data);
  const auto column = [&](std::size_t i) -> Eigen::VectorXd {
    return Eigen::Map<const Eigen::VectorXd>(table.columns[i].data(), std::ssize(table.columns[i]));
  };
  if (options.interval > 0) compare_clock(table.plans, options.interval, column, warnings);
  const TimeBase base = options.interval > 0 ? even_base(std::ssize(table.lines), options.interval, path)
                                             : time_base(table, time, path, options.resample, warnings);

  std::vector<Channel> channels;
  for (std::size_t i = 0; i < table.plans.size(); ++i) {
    if (i == time || table.plans[i].channel.empty()) continue;
    channels.push_back(
        channel_of(table.plans[i], table.columns[i], base.resampled ? table.columns[time] : table.columns[i], base));
    std::vector<double>().swap(table.columns[i]);
  }
  Record record(path, base.t0, base.dt, std::move(channels));
  for (std::string& warning : warnings) record.warn(std::move(warning));
  if (time < table.plans.size() && table.plans[time].source_unit.empty()) record.note_time_without_unit();
  record.note_gaps(base.gaps);
  return has_motion(record) ? derive_motion(record) : record;
}

}  // namespace lunid
