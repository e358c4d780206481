#include "record/time_base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "expr/digits.hpp"
#include "record/median.hpp"

namespace lunid {
namespace {

/// What to do about time that stands or runs backwards.
constexpr const char* mend_time =
    "; delete the rows that are out of order, or where all are evenly spaced give their rate in place of the time: "
    "rate = HZ (--rate HZ)";

/// Least-squares line t[i] = t0 + row(i)*dt; the last row is row(t.size() - 1).
template <class Row>
TimeBase fit_line(std::span<const double> t, const Row& row) {
  const double n = static_cast<double>(t.size());
  double centre = 0, mean = 0, square = 0, moment = 0;
  for (std::size_t i = 0; i < t.size(); ++i) centre += row(i) / n, mean += (t[i] - t[0]) / n;
  for (std::size_t i = 0; i < t.size(); ++i) {
    square += (row(i) - centre) * (row(i) - centre);
    moment += (row(i) - centre) * (t[i] - t[0] - mean);
  }
  const double dt = moment / square;
  return {t[0] + mean - dt * centre, dt, static_cast<Eigen::Index>(row(t.size() - 1)) + 1, false};
}

struct Deviation {
  double largest = 0, rms = 0;
};

Deviation deviation(std::span<const double> t, const TimeBase& base) {
  Deviation result;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double d = std::abs(t[i] - base.t0 - base.dt * static_cast<double>(i));
    result.largest = std::max(result.largest, d);
    result.rms += d * d / static_cast<double>(t.size());
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

double rounded(double value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return std::stod(text.str());
}

using Corner = Stamps::Corner;

/// Half of what a stamp was rounded by; double precision has a part in it.
double half_of(double t, double resolution) { return 0.5 * resolution + 4e-16 * std::abs(t); }

/// The start for which every stamp is t0 + i*dt, rounded as printed; nullopt when there is none. Of the
/// possible ones the first stamp itself, else the one of the fewest digits. `low`, `high`: the stamps that bound it
/// from below and from above.
std::optional<double> start_of(double first, std::span<const Corner> lower, std::span<const Corner> upper, double dt) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  const double slack = 1e-9 * dt;  // double precision
  for (const Corner& c : lower) low = std::max(low, c.t - dt * c.row - (c.half + slack));
  for (const Corner& c : upper) high = std::min(high, c.t - dt * c.row + (c.half + slack));
  if (low > high) return std::nullopt;
  if (low <= first && first <= high) return first;
  for (int digits = 1; digits < 17; ++digits) {
    const double start = rounded((low + high) / 2, digits);
    if (low <= start && start <= high) return start;
  }
  return (low + high) / 2;
}

/// The even base of the roundest step (in its own digits, or as a rate: 0.00125, 1/300) of which the stamps
/// are roundings; nullopt when they are not. `line` is the least-squares line.
std::optional<TimeBase> even_base(double first, std::span<const Corner> lower, std::span<const Corner> upper,
                                  double resolution, const TimeBase& line) {
  if (!(line.dt > 0)) return std::nullopt;
  const double slack = std::max(resolution, 1e-9 * line.dt) / static_cast<double>(line.rows - 1);
  for (int digits = 1; digits <= 17; ++digits)
    for (double dt : {rounded(line.dt, digits), 1 / rounded(1 / line.dt, digits)})
      if (std::abs(dt - line.dt) <= slack)
        if (const auto start = start_of(first, lower, upper, dt)) return TimeBase{*start, dt, line.rows, false};
  return std::nullopt;
}

std::string list_lines(const std::vector<std::size_t>& rows, std::span<const int> lines) {
  constexpr std::size_t shown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(rows.size(), shown); ++i)
    text += (i ? ", " : "") + std::to_string(lines[rows[i]]);
  if (rows.size() > shown) text += ", ... (" + std::to_string(rows.size()) + " places)";
  return text;
}

/// Where free runs do not go through, since too much of the force is not known there (Record::pieces).
std::string list_cuts(const std::vector<std::pair<double, double>>& gaps) {
  if (gaps.empty()) return {};
  const std::string first = "; free runs begin anew at t = " + number(gaps.front().second) + " s";
  const std::string others = gaps.size() > 1 ? ", ... (" + std::to_string(gaps.size()) + " places)" : "";
  return first + others + ", where three rows or more are missing";
}

void check_increasing(std::span<const double> t, std::span<const int> lines, const std::string& path) {
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] > t[i - 1]) continue;
    const std::string stamps = "t = " + number(t[i]) + " s after t = " + number(t[i - 1]) + " s";
    throw InputError((t[i] < t[i - 1] ? "time runs backwards: " : "time is repeated: ") + stamps + mend_time,
                     {path, lines[i]}, Fault::data);
  }
}

/// Rows before which whole rows are missing, where the other steps are even; else empty.
std::vector<std::size_t> find_gaps(std::span<const double> t, std::span<const double> resolution, double step,
                                   bool rounded) {
  std::vector<std::size_t> gaps;
  std::size_t odd = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double d = t[i] - t[i - 1];
    if (d > 1.5 * step + (rounded ? resolution[i] : 0))
      gaps.push_back(i);
    else if (std::abs(d - step) > 0.05 * step + resolution[i])
      ++odd;
  }
  if (odd * 20 > t.size() || gaps.size() * 5 > t.size()) gaps.clear();
  return gaps;
}

/// No step is off by more than 2 % and what stamps are rounded by: what adds up to half a step and more is a clock that
/// goes now faster, now slower.
bool drifts(double least, double most, double step, double resolution) {
  const double off = 0.02 * step + resolution;
  return least > step - off && most < step + off;
}

/// The even base of stamps between which whole rows are missing, as even_base() has it; nullopt when the stamps are not
/// roundings of it. The median step alone is a rounded one: rows that lie between stamps would all be interpolated.
std::optional<TimeBase> even_base_with_gaps(std::span<const double> t, std::span<const double> resolution,
                                            double step) {
  std::vector<Corner> all{{0, t[0], half_of(t[0], resolution[0])}};
  for (std::size_t i = 1; i < t.size(); ++i)
    all.push_back({all.back().row + std::round((t[i] - t[i - 1]) / step), t[i], half_of(t[i], resolution[i])});
  const TimeBase line = fit_line(t, [&](std::size_t i) { return all[i].row; });
  return even_base(t[0], all, all, resolution.back(), line);
}

}  // namespace

TimeBase fit_time_base(std::span<const double> t, std::span<const double> resolution, std::span<const int> lines,
                       const std::string& path, bool resample, std::vector<std::string>& warnings) {
  check_rows(std::ssize(t), path);
  std::vector<double> steps(t.size() - 1);
  for (std::size_t i = 1; i < t.size(); ++i) steps[i - 1] = t[i] - t[i - 1];
  const double step = middle_value(steps);

  const TimeBase line = fit_line(t, [](std::size_t i) { return static_cast<double>(i); });
  const Deviation found = deviation(t, line);
  // Stamps as coarse as the step: a lone 0 or 2 steps is a repeated or lost row. Four or more that all lie on
  // one line are rounding: lost rows would have to be evenly spaced.
  const bool coarse = resolution.back() > 0.6 * step;
  std::size_t unusual = 0;
  for (double d : steps) unusual += std::abs(d - step) > 0.5 * step;
  if (!coarse || unusual == 0 || unusual >= 4) {
    std::vector<Corner> all;
    for (std::size_t i = 0; i < t.size(); ++i)
      all.push_back({static_cast<double>(i), t[i], half_of(t[i], resolution[i])});
    if (const auto base = even_base(t[0], all, all, resolution.back(), line)) {
      if (found.largest > 1e-3 * line.dt)
        warnings.push_back("time stamps are rounded by up to " + number(found.largest) + " s: taken as even");
      return *base;
    }
  }

  check_increasing(t, lines, path);
  const std::vector<std::size_t> gaps = find_gaps(t, resolution, step, unusual * 20 > t.size());
  const double even_rows = std::floor((t.back() - t[0]) / step + 1e-6) + 1;
  if (resample && even_rows > 10 * static_cast<double>(t.size()))  // a wild stamp, or hardly a record
    throw InputError("time has too few rows to resample: " + number(even_rows) + " steps of " + number(step) +
                         " s between the first and the last stamp, but " + std::to_string(t.size()) + " rows",
                     {path}, Fault::data);
  TimeBase even{t[0], step, static_cast<Eigen::Index>(std::min(even_rows, 1e15)), true};
  for (const std::size_t row : gaps)
    if (t[row] - t[row - 1] > 3.5 * step) even.gaps.push_back({t[row - 1], t[row]});
  if (!gaps.empty()) {
    const std::size_t row = gaps[0];
    const double missing = std::round((t[row] - t[row - 1]) / step) - 1;
    const std::string text = "gap: " + number(missing) + (missing == 1 ? " row is" : " rows are") +
                             " missing before t = " + number(t[row]) + " s";
    const std::string where = gaps.size() > 1 ? "; gaps before lines " + list_lines(gaps, lines) : "";
    if (!resample)
      throw InputError(text + where + "; set resample = true (--resample) to interpolate, or cut the file there",
                       {path, lines[row]}, Fault::data);
    warnings.push_back("line " + std::to_string(lines[row]) + ": " + text + where + ": interpolated" +
                       list_cuts(even.gaps));
    if (const auto base = even_base_with_gaps(t, resolution, step)) {
      even.t0 = base->t0;
      even.dt = base->dt;
      even.rows = base->rows;
    }
    return even;
  }
  if (found.rms < 0.02 * line.dt && found.largest < 0.5 * line.dt) {
    warnings.push_back("time stamps jitter by " + number(found.rms) + " s rms (" + number(100 * found.rms / line.dt) +
                       " % of the step): taken as even");
    return line;
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  if (drifts(*least, *most, step, resolution.back()) && found.largest < 1e-4 * (t.back() - t[0])) {
    warnings.push_back("time stamps drift from even ones by up to " + number(found.largest) + " s (" +
                       number(100 * found.largest / (t.back() - t[0])) + " % of the record): taken as even");
    return line;
  }
  const std::string text =
      "time is uneven: steps from " + number(*least) + " to " + number(*most) + " s, median " + number(step) + " s";
  if (!resample) {
    const auto row = static_cast<std::size_t>(most - steps.begin()) + 1;
    throw InputError(
        text + "; the largest ends here; set resample = true (--resample) to interpolate to the median step",
        {path, lines[row]}, Fault::data);
  }
  warnings.push_back(text + ": resampled to the median step");
  return even;
}

namespace {

/// Adds a corner to the hull of the points (row, t + side*half); side -1 keeps the upper hull, +1 the lower one: those
/// that can bound the start.
void add_corner(std::vector<Corner>& hull, const Corner& corner, double side) {
  const auto height = [&](const Corner& c) { return c.t + side * c.half; };
  while (hull.size() >= 2) {
    const Corner &a = hull[hull.size() - 2], &b = hull.back();
    const double turn = (height(b) - height(a)) * (corner.row - b.row) - (height(corner) - height(b)) * (b.row - a.row);
    if (side * turn < 0) break;
    hull.pop_back();
  }
  hull.push_back(corner);
  // A clock that drifts makes a corner of every stamp: then every second one says the same.
  constexpr std::size_t most = 1 << 17;
  if (hull.size() < most) return;
  for (std::size_t i = 0; i < most / 2; ++i) hull[i] = hull[2 * i];
  hull[most / 2] = hull.back();
  hull.resize(most / 2 + 1);
}

}  // namespace

void Stamps::add(std::span<const double> t, std::span<const double> resolution, std::span<const int> lines) {
  if (rows_ == 0 && t.size() > 1) {
    first_ = t[0];
    std::vector<double> steps(t.size() - 1);
    for (std::size_t i = 1; i < t.size(); ++i) steps[i - 1] = t[i] - t[i - 1];
    step_ = middle_value(std::move(steps));
  }
  for (std::size_t i = 0; i < t.size(); ++i, ++rows_) {
    const double row = static_cast<double>(rows_), d = t[i] - last_;
    if (rows_ > 0) {
      unusual_ += std::abs(d - step_) > 0.5 * step_;
      if (d > most_) most_line_ = lines[i];
      least_ = std::min(least_, d);
      most_ = std::max(most_, d);
      if (d <= 0 && backward_.empty()) {
        backward_ = (d < 0 ? "time runs backwards: t = " : "time is repeated: t = ") + number(t[i]) +
                    " s after t = " + number(last_) + " s";
        backward_line_ = lines[i];
      }
    }
    const long double off = t[i] - first_ - row * step_;
    sum_ += off, moment_ += off * row, square_ += off * off;
    last_ = t[i];
    resolution_ = resolution[i];
    const Corner corner{row, t[i], half_of(t[i], resolution[i])};
    add_corner(low_, corner, -1);
    add_corner(high_, corner, 1);
  }
}

TimeBase Stamps::fit(const std::string& path, std::vector<std::string>& warnings) const {
  check_rows(rows_, path);
  const long double n = rows_, centre = (n - 1) / 2, spread = n * (n * n - 1) / 12;
  const long double slope = (moment_ - centre * sum_) / spread, mean = sum_ / n;
  const TimeBase line{first_ + static_cast<double>(mean - slope * centre), step_ + static_cast<double>(slope), rows_,
                      false};
  double largest = 0;
  for (const std::vector<Corner>* hull : {&low_, &high_})
    for (const Corner& c : *hull) largest = std::max(largest, std::abs(c.t - line.t0 - line.dt * c.row));
  const bool coarse = resolution_ > 0.6 * step_;
  if (!coarse || unusual_ == 0 || unusual_ >= 4) {
    if (const auto base = even_base(first_, low_, high_, resolution_, line)) {
      if (largest > 1e-3 * line.dt)
        warnings.push_back("time stamps are rounded by up to " + number(largest) + " s: taken as even");
      return *base;
    }
  }
  if (!backward_.empty()) throw InputError(backward_ + mend_time, {path, backward_line_}, Fault::data);
  const double rms =
      static_cast<double>(std::sqrt(std::max(0.0L, (square_ - n * mean * mean - slope * slope * spread) / n)));
  if (rms < 0.02 * line.dt && largest < 0.5 * line.dt) {
    warnings.push_back("time stamps jitter by " + number(rms) + " s rms (" + number(100 * rms / line.dt) +
                       " % of the step): taken as even");
    return line;
  }
  throw InputError(
      "time is uneven: steps from " + number(least_) + " to " + number(most_) + " s, median " + number(step_) +
          " s; the largest ends here; a stream is not resampled: cut the file there, or read it whole with "
          "lunid.read and resample = true",
      {path, most_line_}, Fault::data);
}

TimeBase even_base(Eigen::Index rows, double interval, const std::string& path) {
  check_rows(rows, path);
  return {0, interval, rows, false};
}

void compare_clock(const std::vector<ColumnPlan>& plans, double interval,
                   const std::function<Eigen::VectorXd(std::size_t)>& column, std::vector<std::string>& warnings) {
  constexpr double alike = 0.01;
  const auto clock = std::ranges::find_if(plans, &ColumnPlan::clock);
  if (clock == plans.end()) return;
  const Eigen::VectorXd t = clock->factor * column(static_cast<std::size_t>(clock - plans.begin()));
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  if (steps.empty()) return;
  const double step = middle_value(std::move(steps));
  if (!(step > 0) || std::abs(step / interval - 1) < alike) return;
  warnings.push_back("the time '" + clock->header.text + "' has " + number(1 / step) +
                     " rows per second, the rate that is given " + number(1 / interval));
}

Eigen::VectorXd resample(std::span<const double> t, std::span<const double> x, const TimeBase& base) {
  Eigen::VectorXd result(base.rows);
  const std::size_t last = t.size() - 1;
  std::size_t k = 0;  // t[k] <= time < t[k + 1]
  for (Eigen::Index i = 0; i < base.rows; ++i) {
    const double time = base.t0 + base.dt * static_cast<double>(i);
    while (k + 1 < last && t[k + 1] <= time) ++k;
    const std::size_t first = std::min(k > 0 ? k - 1 : 0, last - 3);
    double sum = 0;
    for (std::size_t p = first; p < first + 4; ++p) {
      double weight = 1;
      for (std::size_t q = first; q < first + 4; ++q)
        if (q != p) weight *= (time - t[q]) / (t[p] - t[q]);
      sum += weight * x[p];
    }
    result[i] = sum;
  }
  return result;
}

Channel channel_of(const ColumnPlan& plan, std::span<const double> values, std::span<const double> t,
                   const TimeBase& base) {
  Channel channel = channel_of(plan);
  channel.values =
      base.resampled ? resample(t, values, base) : Eigen::Map<const Eigen::VectorXd>(values.data(), base.rows).eval();
  if (plan.factor != 1) channel.values *= plan.factor;
  channel.noise = noise_level({channel.values.data(), static_cast<std::size_t>(channel.values.size())});
  return channel;
}

}  // namespace lunid
