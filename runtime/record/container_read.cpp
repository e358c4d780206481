// Records from MAT and HDF5 files, and to HDF5.
#include <algorithm>
#include <cmath>
#include <limits>

#include "record/atomic_file.hpp"
#include "record/columns.hpp"
#include "record/container.hpp"
#include "record/time_base.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index least_rows = 6;

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw InputError(message, {path}, Fault::data);
}

/// The part of a file that may become channels: vectors, each with the header that a CSV file would give it.
struct Candidates {
  std::vector<Choice> choices;
  std::vector<HeaderCell> header;

  void add(const Variable& variable, const Choice& choice, const std::string& name) {
    choices.push_back(choice);
    header.push_back({name, name, variable.unit});
  }
  std::size_t place(const std::string& name) const {
    return static_cast<std::size_t>(
        std::find_if(header.begin(), header.end(), [&](const HeaderCell& cell) { return cell.name == name; }) -
        header.begin());
  }
};

/// What the options ask for, under the names that they use, then all vectors beside them.
Candidates candidates_of(const Container& file, const std::string& path, ReadOptions& options) {
  Candidates found;
  for (ColumnMap& map : options.columns) {
    const Choice choice = choose_variable(file, path, map.header, "for channel '" + map.channel + "'");
    const Variable& variable = file.variables()[choice.variable];
    if (choice.column < 0) map.header = variable.name;
    if (found.place(map.header) == found.header.size()) found.add(variable, choice, map.header);
  }
  for (std::size_t i = 0; i < file.variables().size(); ++i) {
    const Variable& variable = file.variables()[i];
    const bool several = variable.is_number() && variable.is_vector() && variable.size() > 1;
    if (several && found.place(variable.name) == found.header.size())
      found.add(variable, {i, -1, variable.size()}, variable.name);
  }
  return found;
}

/// The interval between rows where the options give one or name one.
double interval_of(Container& file, const std::string& path, const ReadOptions& options) {
  const bool is_rate = !options.rate_name.empty();
  const std::string& name = is_rate ? options.rate_name : options.interval_name;
  if (name.empty()) return options.interval;
  const std::string words = is_rate ? "as the rate" : "as the interval";
  const Choice choice = choose_variable(file, path, name, words);
  if (choice.rows != 1)
    fail(path, "variable '" + name + "' " + words + ": expected a number, got " +
                   file.variables()[choice.variable].shape_text());
  const double value = read_choice(file, path, choice)[0];
  if (!(value > 0) || !std::isfinite(value))
    fail(path, "variable '" + name + "' " + words + ": expected a number > 0, got " + std::to_string(value));
  return is_rate ? 1 / value : value;
}

TimeBase even_base(double interval, std::size_t rows, const std::string& path) {
  if (static_cast<Index>(rows) < least_rows) fail(path, "expected at least 6 rows, got " + std::to_string(rows));
  return {0, interval, static_cast<Index>(rows), false};
}

/// By how much stamps may be off even time: the rounding of single precision, or that of sums t + dt + dt ..., within a
/// part in a million of a step.
VectorXd stamp_resolution(const VectorXd& t, bool single) {
  const double count = static_cast<double>(t.size());
  if (single) return t.cwiseAbs() * 1.2e-7;
  const double step = count > 1 ? std::abs(t[t.size() - 1] - t[0]) / (count - 1) : 0;
  const double sum = count * std::numeric_limits<double>::epsilon() * t.cwiseAbs().maxCoeff();
  return VectorXd::Constant(t.size(), std::min(sum, 1e-6 * step));
}

/// The time base of stamps `t`, which become seconds.
TimeBase base_of(const Variable& variable, const ColumnPlan& plan, VectorXd& t, const std::string& path, bool resample,
                 std::vector<std::string>& warnings) {
  if (variable.start && variable.step && plan.factor == 1)
    return [&] {
      TimeBase base = even_base(*variable.step, static_cast<std::size_t>(t.size()), path);
      base.t0 = *variable.start;
      return base;
    }();
  t *= plan.factor;
  const VectorXd resolution = stamp_resolution(t, variable.single);
  std::vector<int> rows(static_cast<std::size_t>(t.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = static_cast<int>(i + 1);
    if (!std::isfinite(t[static_cast<Index>(i)]))
      fail(path, "variable '" + variable.name + "', the time: row " + std::to_string(i + 1) + " is not a number");
  }
  return fit_time_base({t.data(), rows.size()}, {resolution.data(), rows.size()}, rows, path, resample, warnings);
}

Channel channel_of(const ColumnPlan& plan, const VectorXd& values, const VectorXd& t, const TimeBase& base) {
  Channel channel;
  channel.name = plan.channel;
  channel.unit = plan.unit;
  channel.source = plan.header.text;
  channel.source_unit = plan.header.unit;
  const auto span = [](const VectorXd& x) { return std::span(x.data(), static_cast<std::size_t>(x.size())); };
  channel.values = base.resampled ? resample(span(t), span(values), base) : values;
  if (plan.factor != 1) channel.values *= plan.factor;
  channel.noise = noise_level(span(channel.values));
  return channel;
}

/// Builds the record out of an open file.
class Reader {
 public:
  Reader(Container& file, const std::string& path, ReadOptions options)
      : file_(file), path_(path), options_(std::move(options)) {}

  Record read() {
    candidates_ = candidates_of(file_, path_, options_);
    options_.interval = interval_of(file_, path_, options_);
    plans_ = plan_columns(candidates_.header, options_, {path_}, warnings_, false);
    find_time();
    const TimeBase base = time_base();
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < plans_.size(); ++i)
      if (i != time_ && !plans_[i].channel.empty() && belongs(i)) add(channels, i, base);
    if (channels.empty()) fail(path_, "expected a vector of numbers beside the time");
    Record record(path_, base.t0, base.dt, std::move(channels));
    for (std::string& warning : warnings_) record.warn(std::move(warning));
    return has_motion(record) ? derive_motion(record) : record;
  }

 private:
  void find_time() {
    const auto is_time = [](const ColumnPlan& plan) { return plan.channel == "t"; };
    time_ = static_cast<std::size_t>(std::find_if(plans_.begin(), plans_.end(), is_time) - plans_.begin());
    const bool given = options_.interval > 0;
    if (time_ == plans_.size() && !given)
      fail(path_, "no time: expected a variable named 't' or 'time'; the file has " + names() +
                      "; name it as time = \"...\", or give rate or interval");
  }

  std::string names() const {
    std::string text;
    for (const HeaderCell& cell : candidates_.header) text += (text.empty() ? "'" : ", '") + cell.text + "'";
    return text.empty() ? "no vectors of numbers" : text;
  }

  /// How many rows the record has: those of the time, else of the first channel that was asked for or found by name.
  TimeBase time_base() {
    if (time_ < plans_.size()) {
      rows_ = candidates_.choices[time_].rows;
      of_ = candidates_.header[time_].text;
      t_ = read_choice(file_, path_, candidates_.choices[time_]);
      const Variable& variable = file_.variables()[candidates_.choices[time_].variable];
      return base_of(variable, plans_[time_], t_, path_, options_.resample, warnings_);
    }
    for (std::size_t i = 0; i < plans_.size() && of_.empty(); ++i) {
      if (plans_[i].channel.empty()) continue;
      if (!plans_[i].required && std::any_of(plans_.begin(), plans_.end(), [](auto& p) { return p.required; }))
        continue;
      rows_ = candidates_.choices[i].rows;
      of_ = candidates_.header[i].text;
    }
    return even_base(options_.interval, rows_, path_);
  }

  /// What was asked for must have as many rows; other vectors of another length are no channels.
  bool belongs(std::size_t i) const {
    if (candidates_.choices[i].rows == rows_) return true;
    if (plans_[i].required)
      fail(path_, "variable '" + candidates_.header[i].text + "' has " + std::to_string(candidates_.choices[i].rows) +
                      " values, '" + of_ + "' has " + std::to_string(rows_));
    return false;
  }

  void add(std::vector<Channel>& channels, std::size_t i, const TimeBase& base) {
    const VectorXd values = read_choice(file_, path_, candidates_.choices[i]);
    for (Index row = 0; row < values.size(); ++row) {
      if (std::isfinite(values[row])) continue;
      const std::string text = "variable '" + candidates_.header[i].text + "': row " + std::to_string(row + 1) +
                               ": expected a finite number, got " + (std::isnan(values[row]) ? "NaN" : "infinity");
      if (plans_[i].required) fail(path_, text);
      warnings_.push_back("left out: " + text);
      return;
    }
    channels.push_back(channel_of(plans_[i], values, t_, base));
  }

  Container& file_;
  const std::string& path_;
  ReadOptions options_;
  Candidates candidates_;
  std::vector<ColumnPlan> plans_;
  std::vector<std::string> warnings_;
  std::size_t time_ = 0, rows_ = 0;
  std::string of_;  ///< the variable whose length counts
  VectorXd t_;
};

}  // namespace

Record read_container(const std::string& path, const ReadOptions& options) {
  const auto file = open_container(path);
  return Reader(*file, path, options).read();
}

Record read_record(const std::string& path, const ReadOptions& options) {
  if (is_container(path)) return read_container(path, options);
  if (!options.interval_name.empty() || !options.rate_name.empty())
    fail(path, "rate and interval: expected a number for a CSV file, got the name '" +
                   (options.rate_name.empty() ? options.interval_name : options.rate_name) + "'");
  return read_csv(path, options);
}

void write_hdf5(const Record& record, const std::string& path) {
  const VectorXd t = VectorXd::NullaryExpr(record.rows(), [&](Index i) { return record.time(i); });
  const auto rows = static_cast<std::size_t>(record.rows());
  std::vector<StoredColumn> columns{{"t", "s", t.data(), rows, record.start(), record.dt()}};
  for (const Channel& channel : record.channels())
    columns.push_back({channel.name, channel.unit, record[channel.name].data(), rows, {}, {}});
  std::string error;
  const std::string bytes = container_module().encode_hdf5(columns, error);
  if (!error.empty()) fail(path, error);
  write_file_atomically(path, bytes);
}

}  // namespace lunid
