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

/// A time beside which an interval is given may tell of another.
void compare_clock(const CsvTable& table, double interval, std::vector<std::string>& warnings) {
  const auto clock = std::ranges::find_if(table.plans, &ColumnPlan::clock);
  if (clock == table.plans.end()) return;
  std::vector<double> t = table.columns[static_cast<std::size_t>(clock - table.plans.begin())];
  for (double& stamp : t) stamp *= clock->factor;
  if (std::string text = other_clock(clock->header.text, t, interval); !text.empty())
    warnings.push_back(std::move(text));
}

/// Rows that stand so far apart, from 0 s on.
TimeBase even_base(const CsvTable& table, const std::string& path, double interval) {
  const std::size_t rows = table.lines.size();
  if (rows < 6) throw InputError("expected at least 6 rows, got " + std::to_string(rows), {path}, Fault::data);
  return {0, interval, static_cast<Eigen::Index>(rows), false};
}

Channel make_channel(const ColumnPlan& plan, std::span<const double> values, std::span<const double> t,
                     const TimeBase& base) {
  Channel channel = channel_of(plan);
  channel.values =
      base.resampled ? resample(t, values, base) : Eigen::Map<const Eigen::VectorXd>(values.data(), base.rows).eval();
  if (plan.factor != 1) channel.values *= plan.factor;
  channel.noise = noise_level({channel.values.data(), static_cast<std::size_t>(channel.values.size())});
  return channel;
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
  if (options.interval > 0) compare_clock(table, options.interval, warnings);
  const TimeBase base = options.interval > 0 ? even_base(table, path, options.interval)
                                             : time_base(table, time, path, options.resample, warnings);

  std::vector<Channel> channels;
  for (std::size_t i = 0; i < table.plans.size(); ++i) {
    if (i == time || table.plans[i].channel.empty()) continue;
    channels.push_back(
        make_channel(table.plans[i], table.columns[i], base.resampled ? table.columns[time] : table.columns[i], base));
    std::vector<double>().swap(table.columns[i]);
  }
  Record record(path, base.t0, base.dt, std::move(channels));
  for (std::string& warning : warnings) record.warn(std::move(warning));
  if (time < table.plans.size() && table.plans[time].source_unit.empty()) record.note_time_without_unit();
  record.note_gaps(base.gaps);
  return has_motion(record) ? derive_motion(record) : record;
}

}  // namespace lunid
