#include "simulate/lane_summaries.hpp"

#include <algorithm>
#include <cmath>

#include "expr/kernel.hpp"

namespace lunid {
namespace {

using kernel::quad;

LUNID_WIDE void add_extremes(std::size_t width, const double* x, double* least, double* greatest) {
  for (std::size_t l = 0; l < width; l += 4) {
    const auto value = quad(x + l);
    quad(least + l) = value < quad(least + l) ? value : quad(least + l);
    quad(greatest + l) = value > quad(greatest + l) ? value : quad(greatest + l);
  }
}

/// Sums are of the distance to the first value, so that a small motion far from zero keeps its digits.
LUNID_WIDE void add_sums(std::size_t width, const double* x, const double* first, double* sum, double* squares) {
  for (std::size_t l = 0; l < width; l += 4) {
    const auto from = quad(x + l) - quad(first + l);
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
    Signal& signal = signals_[signal_of_.back()];
    switch (output.summary) {
      case Summary::max:
      case Summary::min:
      case Summary::amplitude: signal.extremes = true; break;
      case Summary::last: signal.last = true; break;
      default: signal.sums = true;
    }
  }
  memory_.resize(parts * signals_.size() * width_);
}

void LaneSummaries::add(const double* x, const double* f) noexcept {
  for (std::size_t s = 0; s < signals_.size(); ++s) {
    const double* values = (signals_[s].rate ? f : x) + width_ * static_cast<std::size_t>(signals_[s].state);
    if (rows_ == 0)
      for (const Part p : {least, greatest, first}) std::copy_n(values, width_, part(s, p));
    if (signals_[s].extremes) add_extremes(width_, values, part(s, least), part(s, greatest));
    if (signals_[s].sums) add_sums(width_, values, part(s, first), part(s, sum), part(s, squares));
    if (signals_[s].last) std::copy_n(values, width_, part(s, last));
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
