#include "simulate/lane_summaries.hpp"

#include <algorithm>
#include <cmath>

#include "expr/kernel.hpp"

namespace lunid {
namespace {

using kernel::quad;

/// Sums are of the distance to the first value, so that a small motion far from zero keeps its digits.
LUNID_WIDE void add_row(std::size_t width, const double* x, double* const* part) {
  const auto [least, greatest, first, last, sum, squares] =
      std::array{part[0], part[1], part[2], part[3], part[4], part[5]};
  for (std::size_t l = 0; l < width; l += 4) {
    const auto value = quad(x + l), from = value - quad(first + l);
    quad(least + l) = value < quad(least + l) ? value : quad(least + l);
    quad(greatest + l) = value > quad(greatest + l) ? value : quad(greatest + l);
    quad(last + l) = value;
    quad(sum + l) = quad(sum + l) + from;
    quad(squares + l) = quad(squares + l) + from * from;
  }
}

}  // namespace

LaneSummaries::LaneSummaries(std::span<const EnsembleOutput> outputs, int width)
    : outputs_(outputs), width_(static_cast<std::size_t>(width)) {
  for (const EnsembleOutput& output : outputs) {
    const auto same = [&](const Signal& s) { return s.state == output.state && s.rate == output.rate; };
    const auto known = std::find_if(signals_.begin(), signals_.end(), same);
    signal_of_.push_back(static_cast<std::size_t>(known - signals_.begin()));
    if (known == signals_.end()) signals_.push_back({output.state, output.rate, output.signal});
  }
  memory_.resize(parts * signals_.size() * width_);
}

void LaneSummaries::add(const double* x, const double* f) noexcept {
  for (std::size_t s = 0; s < signals_.size(); ++s) {
    const double* values = (signals_[s].rate ? f : x) + width_ * static_cast<std::size_t>(signals_[s].state);
    double* const all[parts] = {part(s, least), part(s, greatest), part(s, first),
                                part(s, last),  part(s, sum),      part(s, squares)};
    if (rows_ == 0)
      for (const Part p : {least, greatest, first}) std::copy_n(values, width_, all[p]);
    add_row(width_, values, all);
  }
  ++rows_;
}

double LaneSummaries::value(int output, int lane) const {
  const std::size_t s = signal_of_[static_cast<std::size_t>(output)];
  const auto of = [&](Part p) { return part(s, p)[lane]; };
  const double n = static_cast<double>(rows_), mean = of(first) + of(sum) / n;
  const double variance = std::max(0.0, (of(squares) - of(sum) * of(sum) / n) / n);
  switch (outputs_[static_cast<std::size_t>(output)].summary) {
    case Summary::max: return of(greatest);
    case Summary::min: return of(least);
    case Summary::mean: return mean;
    case Summary::std: return std::sqrt(variance);
    case Summary::rms: return std::sqrt(mean * mean + variance);
    case Summary::amplitude: return 0.5 * (of(greatest) - of(least));
    case Summary::last: return of(last);
  }
  return 0;
}

}  // namespace lunid
