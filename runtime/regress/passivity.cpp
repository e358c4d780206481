#include "regress/passivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "expr/digits.hpp"

namespace lunid {

void validate(const PassiveOptions& options) {
  for (const int points : {options.points_y, options.points_v})
    if (points < 2 || points > 100)
      throw InputError("passive: points: expected 2 to 100 along each axis, got " + std::to_string(points),
                       options.where);
}

namespace detail {

MotionRange motion_range(std::span<const Stream> records) {
  constexpr double most = std::numeric_limits<double>::infinity();
  MotionRange range{most, -most, most, -most};
  for (const Stream& record : records)
    record.for_each_block([&](Eigen::Index, const Record& rows) {
      const auto y = rows["y"], v = rows["v"];
      const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
      const auto [v_low, v_high] = std::minmax_element(v.begin(), v.end());
      range = {std::min(range.y_low, *y_low), std::max(range.y_high, *y_high), std::min(range.v_low, *v_low),
               std::max(range.v_high, *v_high)};
    });
  return range;
}

Dissipation::Dissipation(const std::vector<Expr>& features, Expr known, const std::map<std::string, double>& values,
                         const SourceSpan& where) {
  Pool& pool = features.front().pool();
  std::vector<Expr> outputs = features, inputs = {pool.channel("y"), pool.channel("v")};
  outputs.push_back(known.valid() ? known : pool.constant(0));
  for (const Expr& f : outputs)
    for (const Expr& s : symbols(f)) {
      if (std::find(inputs.begin(), inputs.end(), s) != inputs.end()) continue;
      const auto value = values.find(s.name());
      if (s.kind() != SymbolKind::parameter || value == values.end())
        throw InputError("passive: '" + to_text(f) + "' depends on " + s.name() +
                             ": passivity is looked at over displacement and velocity alone",
                         where);
      inputs.push_back(s);
      values_.push_back(value->second);
    }
  tape_ = Tape(outputs, inputs);
}

std::vector<double> Dissipation::at(double y, double v) const {
  const std::size_t n = static_cast<std::size_t>(tape_.outputs());
  std::vector<double> in = {y, v}, scratch(static_cast<std::size_t>(tape_.registers())), moving(n), still(n);
  in.insert(in.end(), values_.begin(), values_.end());
  tape_.run_point(in.data(), moving.data(), scratch.data());
  in[1] = 0;
  tape_.run_point(in.data(), still.data(), scratch.data());
  for (std::size_t j = 0; j < n; ++j) moving[j] = v * (moving[j] - still[j]);
  return moving;
}

namespace {

/// Calls visit(y, v) over the grid; the lines nearest to v = 0 leave it out.
template <class Visit>
void over_grid(const MotionRange& range, int points_y, int points_v, Visit visit) {
  for (int i = 0; i < points_y; ++i)
    for (int k = 0; k < points_v; ++k) {
      const double y = range.y_low + (range.y_high - range.y_low) * i / (points_y - 1);
      const double v = range.v_low + (range.v_high - range.v_low) * k / (points_v - 1);
      if (v != 0) visit(y, v);
    }
}

}  // namespace

std::vector<Constraint> passive_constraints(const Dissipation& dissipation, const MotionRange& range,
                                            const PassiveOptions& options) {
  std::vector<Constraint> out;
  over_grid(range, options.points_y, options.points_v, [&](double y, double v) {
    const std::vector<double> power = dissipation.at(y, v);
    Constraint c;
    for (std::size_t j = 0; j + 1 < power.size(); ++j)
      if (power[j] != 0 && std::isfinite(power[j])) c.terms.emplace_back(static_cast<int>(j), power[j]);
    c.lower = -power.back();
    c.where = options.where;
    c.label = "no energy created at y = " + number(y, 3) + ", v = " + number(v, 3);
    if (!c.terms.empty()) out.push_back(std::move(c));
  });
  return out;
}

Passivity look_at(const Dissipation& dissipation, const MotionRange& range, const PassiveOptions& options,
                  std::span<const double> coefficients) {
  Passivity out;
  out.imposed = options.impose;
  out.least_power = std::numeric_limits<double>::infinity();
  over_grid(range, 4 * options.points_y, 4 * options.points_v, [&](double y, double v) {
    const std::vector<double> power = dissipation.at(y, v);
    double sum = power.back();
    for (std::size_t j = 0; j < coefficients.size(); ++j)
      if (coefficients[j] != 0) sum += coefficients[j] * power[j];
    if (sum < out.least_power) out = {sum, y, v, options.impose};
  });
  return out;
}

}  // namespace detail
}  // namespace lunid
