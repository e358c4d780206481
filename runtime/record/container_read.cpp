// Records from MAT and HDF5 files, and to them.
#include <algorithm>
#include <cmath>

#include "expr/words.hpp"
#include "record/atomic_file.hpp"
#include "record/container_plan.hpp"
#include "record/time_base.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw InputError(message, {path}, Fault::data);
}

/// The time base of stamps `t`, which become seconds.
TimeBase base_of(const Variable& variable, const ColumnPlan& plan, VectorXd& t, const std::string& path, bool resample,
                 std::vector<std::string>& warnings) {
  if (variable.start && variable.step && plan.factor == 1) {
    TimeBase base = even_base(t.size(), *variable.step, path);
    base.t0 = *variable.start;
    return base;
  }
  t *= plan.factor;
  const Index last = t.size() - 1;
  const StampRange range{static_cast<double>(t.size()), last < 0 ? 0 : t[0], last < 0 ? 0 : t[last]};
  const VectorXd resolution = stamp_resolution(t, range, variable.single);
  std::vector<int> rows(static_cast<std::size_t>(t.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = static_cast<int>(i + 1);
    if (!std::isfinite(t[static_cast<Index>(i)]))
      fail(path, "variable '" + variable.name + "', the time: row " + std::to_string(i + 1) + " is not a number");
  }
  return fit_time_base({t.data(), rows.size()}, {resolution.data(), rows.size()}, rows, path, resample, warnings);
}

/// The time base of the rows that a plan found; `t`: the stamps where there are any.
TimeBase time_base_of(Container& file, const ContainerPlan& plan, const std::string& path, bool resample, VectorXd& t,
                      std::vector<std::string>& warnings) {
  if (!plan.has_time()) return even_base(static_cast<Index>(plan.rows), plan.interval, path);
  t = read_choice(file, path, plan.choices[plan.time]);
  const Variable& variable = file.variables()[plan.choices[plan.time].variable];
  return base_of(variable, plan.plans[plan.time], t, path, resample, warnings);
}

}  // namespace

Record read_container(const std::string& path, const ReadOptions& options) {
  const auto file = open_container(path);
  ContainerPlan plan = plan_container(*file, path, options);
  std::vector<std::string>& warnings = plan.warnings;
  const auto column = [&](std::size_t i) { return read_choice(*file, path, plan.choices[i]); };
  const auto span = [](const VectorXd& x) { return std::span(x.data(), static_cast<std::size_t>(x.size())); };
  compare_clock(plan.plans, plan.interval, column, warnings);
  VectorXd t;
  const TimeBase base = time_base_of(*file, plan, path, options.resample, t, warnings);
  std::vector<Channel> channels;
  for (const std::size_t i : plan.channels) {
    const VectorXd values = column(i);
    const std::string fault = not_finite(plan, i, 0, values);
    if (fault.empty())
      channels.push_back(channel_of(plan.plans[i], span(values), span(t), base));
    else if (plan.plans[i].required)
      fail(path, fault);
    else
      warnings.push_back("left out: " + fault);
  }
  if (channels.empty()) fail(path, "expected a vector of numbers beside the time");
  Record record(path, base.t0, base.dt, std::move(channels));
  for (std::string& warning : warnings) record.warn(std::move(warning));
  record.note_gaps(base.gaps);
  return has_motion(record) ? derive_motion(record) : record;
}

namespace {

/// Numbers of which none is the language's own.
Record with_warning_of_names(Record record) {
  const auto is_known = [](const Channel& channel) { return is_channel_name(channel.name); };
  if (std::ranges::none_of(record.channels(), is_known))
    record.warn(
        "no column is known as a motion (y, v, a) or a force (F): name them with columns = \"y=header [unit], "
        "F=header [unit]\" (--columns)");
  return record;
}

}  // namespace

Record read_record(const std::string& path, const ReadOptions& options) {
  if (is_container(path)) return with_warning_of_names(with_constants(read_container(path, options), options.columns));
  if (!options.interval_name.empty() || !options.rate_name.empty())
    fail(path, "rate and interval: expected a number for a CSV file, got the name '" +
                   (options.rate_name.empty() ? options.interval_name : options.rate_name) + "'");
  return with_warning_of_names(with_constants(read_csv(path, options), options.columns));
}

namespace {

/// The time `t`, made here, and the channels.
std::vector<StoredColumn> stored_columns(const Record& record, VectorXd& t) {
  t = VectorXd::NullaryExpr(record.rows(), [&](Index i) { return record.time(i); });
  const auto rows = static_cast<std::size_t>(record.rows());
  std::vector<StoredColumn> columns{{"t", "s", t.data(), rows, record.start(), record.dt()}};
  for (const Channel& channel : record.channels())
    columns.push_back({name_in_files(channel), channel.unit, record[channel.name].data(), rows, {}, {}});
  return columns;
}

}  // namespace

void write_mat(const Record& record, const std::string& path, MatVersion version) {
  VectorXd t;
  const std::vector<StoredColumn> columns = stored_columns(record, t);
  make_file_atomically(path, [&](const std::string& name) {
    std::string error;
    container_module().write_mat(name, columns, version, error);
    if (!error.empty()) fail(path, error);
  });
}

void write_hdf5(const Record& record, const std::string& path) {
  VectorXd t;
  std::string error;
  const std::string bytes = container_module().encode_hdf5(stored_columns(record, t), error);
  if (!error.empty()) fail(path, error);
  write_file_atomically(path, bytes);
}

}  // namespace lunid
