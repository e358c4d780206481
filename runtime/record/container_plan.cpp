// Which variables of a MAT or HDF5 file are the channels of a record.
#include "record/container_plan.hpp"
#include "expr/digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "record/method_parts.hpp"

namespace lunid {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw InputError(message, {path}, Fault::data);
}

void add(ContainerPlan& plan, const Variable& variable, const ContainerChoice& choice, const std::string& name) {
  plan.choices.push_back(choice);
  plan.header.push_back({name, name, variable.unit});
}

bool has(const ContainerPlan& plan, const std::string& name) {
  return std::any_of(plan.header.begin(), plan.header.end(), [&](const HeaderCell& cell) { return cell.name == name; });
}

/// What the options ask for, under the names that they use, then all vectors beside them.
ContainerPlan candidates_of(const Container& file, const std::string& path, ReadOptions& options) {
  ContainerPlan found;
  for (ColumnMap& map : options.columns) {
    if (constant_of(map)) continue;
    const ContainerChoice choice = choose_variable(file, path, map.header, "for channel '" + map.channel + "'");
    const Variable& variable = file.variables()[choice.variable];
    if (choice.column < 0) map.header = variable.name;
    if (!has(found, map.header)) add(found, variable, choice, map.header);
  }
  for (std::size_t i = 0; i < file.variables().size(); ++i) {
    const Variable& variable = file.variables()[i];
    const bool several = variable.is_number() && variable.is_vector() && variable.size() > 1;
    if (several && !has(found, variable.name)) add(found, variable, {i, -1, variable.size()}, variable.name);
  }
  return found;
}

/// The interval between rows where the options give one or name one.
double interval_of(Container& file, const std::string& path, const ReadOptions& options) {
  const bool is_rate = !options.rate_name.empty();
  const std::string& name = is_rate ? options.rate_name : options.interval_name;
  if (name.empty()) return options.interval;
  const std::string words = is_rate ? "as the rate" : "as the interval";
  const ContainerChoice choice = choose_variable(file, path, name, words);
  if (choice.rows != 1)
    fail(path, "variable '" + name + "' " + words + ": expected a number, got " +
                   file.variables()[choice.variable].shape_text());
  const double value = read_choice(file, path, choice)[0];
  if (!(value > 0) || !std::isfinite(value))
    fail(path, "variable '" + name + "' " + words + ": expected a number > 0, got " + number(value));
  return is_rate ? 1 / value : value;
}

std::string names_of(const ContainerPlan& plan) {
  std::string text;
  for (const HeaderCell& cell : plan.header) text += (text.empty() ? "'" : ", '") + cell.text + "'";
  return text.empty() ? "no vectors of numbers" : text;
}

/// The variable whose length counts: the time, else the first channel that was asked for or found by name.
std::size_t measure_of(const ContainerPlan& plan) {
  if (plan.has_time()) return plan.time;
  const bool any = std::any_of(plan.plans.begin(), plan.plans.end(), [](const ColumnPlan& p) { return p.required; });
  for (std::size_t i = 0; i < plan.plans.size(); ++i)
    if (!plan.plans[i].channel.empty() && (plan.plans[i].required || !any)) return i;
  return plan.plans.size();
}

}  // namespace

ContainerPlan plan_container(Container& file, const std::string& path, ReadOptions options) {
  ContainerPlan plan = candidates_of(file, path, options);
  plan.interval = options.interval = interval_of(file, path, options);
  plan.plans = plan_columns(plan.header, options, {path}, plan.warnings, false);
  const auto is_time = [](const ColumnPlan& p) { return p.channel == "t"; };
  plan.time =
      static_cast<std::size_t>(std::find_if(plan.plans.begin(), plan.plans.end(), is_time) - plan.plans.begin());
  if (!plan.has_time() && !(plan.interval > 0))
    fail(path, "no time: expected a variable named 't' or 'time'; the file has " + names_of(plan) +
                   "; name it as time = \"...\" (--columns \"t=...\"), or give rate or interval (--rate)");
  const std::size_t measure = measure_of(plan);
  if (measure < plan.plans.size()) plan.rows = plan.choices[measure].rows;
  // What was asked for must have as many rows; other vectors of another length are no channels.
  for (std::size_t i = 0; i < plan.plans.size(); ++i) {
    if (i == plan.time || plan.plans[i].channel.empty()) continue;
    if (plan.choices[i].rows == plan.rows)
      plan.channels.push_back(i);
    else if (plan.plans[i].required)
      fail(path, "variable '" + plan.header[i].text + "' has " + std::to_string(plan.choices[i].rows) + " values, '" +
                     plan.header[measure].text + "' has " + std::to_string(plan.rows));
  }
  return plan;
}

Eigen::VectorXd stamp_resolution(const Eigen::VectorXd& t, const StampRange& all, bool single) {
  if (single) return t.cwiseAbs() * 1.2e-7;
  const double step = all.count > 1 ? std::abs(all.last - all.first) / (all.count - 1) : 0;
  const double largest = std::max(std::abs(all.first), std::abs(all.last));
  const double sum = all.count * std::numeric_limits<double>::epsilon() * largest;
  return Eigen::VectorXd::Constant(t.size(), std::min(sum, 1e-6 * step));
}

std::string not_finite(const ContainerPlan& plan, std::size_t channel, std::size_t first,
                       const Eigen::VectorXd& values) {
  for (Eigen::Index row = 0; row < values.size(); ++row)
    if (!(std::abs(values[row]) <= largest_measurement))
      return "variable '" + plan.header[channel].text + "': row " +
             std::to_string(first + static_cast<std::size_t>(row) + 1) + ": expected a finite number, got " +
             (std::isnan(values[row])   ? "NaN"
              : std::isinf(values[row]) ? "infinity"
                                        : short_number(values[row]) + ", beyond 1e60");
  return {};
}

}  // namespace lunid
