// Other rates and delays, by band-limited interpolation.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/checks.hpp"
#include "record/extension.hpp"
#include "record/method_parts.hpp"
#include "record/spectrum.hpp"
#include "record/treat_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double half_lobes = 32;  // zero crossings of the sinc on either side
constexpr double shape = 10;       // Kaiser's beta: side lobes under -100 dB

double cut_off(double step) { return step > 1 ? 0.9 / step : 1.0; }  // of the old Nyquist frequency

double kaiser(double u) {
  static const double whole = std::cyl_bessel_i(0.0, shape);
  return std::abs(u) >= 1 ? 0 : std::cyl_bessel_i(0.0, shape * std::sqrt(1 - u * u)) / whole;
}

constexpr double parts = 4096;  // of a row, between which the kernel is straight: 1e-7 off at most

VectorXd values_between(const BandLimited& between, std::span<const double> x, double first, double step, Index count) {
  const Extended extended = extend(x, between.margin());
  const double origin = extended.line[0];
  VectorXd result(count);
  for (Index i = 0; i < count; ++i) {
    const double at = first + step * static_cast<double>(i);
    result[i] = between(extended.values, -extended.reach, at) + origin + extended.slope * at;
  }
  return result;
}

/// All channels at other positions: rows first + i*step.
Record at_positions(const Record& record, const char* where, double first, double step, Index count, double t0,
                    double dt) {
  const BandLimited between(step);
  std::vector<Channel> channels;
  for (const Channel& old : record.channels()) {
    const auto x = numbers(record, old.name, where);
    channels.push_back(with_values(record, old.name, values_between(between, x, first, step, count)));
    channels.back().noise *= between.noise_passed();
  }
  return remade(record, t0, dt, std::move(channels));
}

Record at_rate(const Record& record, const char* where, const NewRate& rate) {
  Record result = at_positions(record, where, 0, rate.step, rate.rows, record.start(), rate.dt);
  result.note(rate.note);
  return result;
}

}  // namespace

BandLimited::BandLimited(double step)
    : cutoff_(cut_off(step)), reach_(half_lobes / cutoff_), table_(static_cast<Index>(reach_ * parts) + 3) {
  for (Index i = 0; i < table_.size(); ++i) {
    const double at = static_cast<double>(i) / parts, u = std::numbers::pi * cutoff_ * at;
    table_[i] = (i == 0 ? 1 : std::sin(u) / u) * cutoff_ * kaiser(at / reach_);
  }
}

double BandLimited::kernel(double at) const {
  const double place = std::abs(at) * parts;
  const auto below = static_cast<Index>(place);
  if (below + 1 >= table_.size()) return 0;
  return table_[below] + (place - static_cast<double>(below)) * (table_[below + 1] - table_[below]);
}

double BandLimited::operator()(const VectorXd& x, Index low, double at) const {
  const Index first = std::max(static_cast<Index>(std::ceil(at - reach_)), low),
              last = std::min(static_cast<Index>(std::floor(at + reach_)), low + x.size() - 1);
  double sum = 0;
  for (Index k = first; k <= last; ++k) sum += kernel(static_cast<double>(k) - at) * x[k - low];
  return sum;
}

VectorXd band_limited(std::span<const double> x, double first, double step, Index count) {
  return values_between(BandLimited(step), x, first, step, count);
}

NewRate decimated(Index rows, double dt, int factor) {
  const Index most = (rows - 1) / 5;
  if (factor < 1 || factor > most)
    refuse("decimate", "factor: expected 1 to " + std::to_string(most) + " for " + std::to_string(rows) +
                           " rows, got " + std::to_string(factor));
  const double slow = factor * dt;
  return {static_cast<double>(factor), slow, (rows - 1) / factor + 1,
          "decimate: every row of " + std::to_string(factor) + ", without what lies above " + short_number(0.5 / slow) +
              " Hz"};
}

NewRate resampled(Index rows, double dt, double rate) {
  const double least = 5 / (dt * static_cast<double>(rows - 1)), step = 1 / (rate * dt);
  if (!(rate >= least))
    refuse("resample",
           "rate: expected >= " + short_number(least) + " Hz, which leaves 6 rows, got " + short_number(rate));
  const double count = std::floor(static_cast<double>(rows - 1) / step + 1e-9) + 1;
  return {step, 1 / rate, static_cast<Index>(std::min(count, 1e18)),
          "resample: from " + short_number(1 / dt) + " to " + short_number(rate) + " Hz"};
}

Record decimate(const Record& record, int factor) {
  return at_rate(record, "decimate", decimated(record.rows(), record.dt(), factor));
}

Record resample(const Record& record, double rate) {
  const NewRate made = resampled(record.rows(), record.dt(), rate);
  if (made.rows > 100000000)
    refuse("resample",
           "rate: " + short_number(rate) + " Hz would make " + short_number(static_cast<double>(made.rows)) + " rows");
  return at_rate(record, "resample", made);
}

namespace {

/// Correlation of x[i + lag] with y[i] over their overlap for all lags from -(rows of y - 1), by transforms.
VectorXd correlations(const VectorXd& x, const VectorXd& y) {
  const Index n = x.size(), m = y.size(), length = power_of_two_above(n + m);
  const auto spectrum = [&](const VectorXd& s) {
    return half_spectrum({s.data(), static_cast<std::size_t>(s.size())}, length);
  };
  const VectorXd products = inverse_half_spectrum(spectrum(x).cwiseProduct(spectrum(y).conjugate()), length);
  VectorXd square_x = VectorXd::Zero(n + 1), square_y = VectorXd::Zero(m + 1);
  for (Index i = 0; i < n; ++i) square_x[i + 1] = square_x[i] + x[i] * x[i];
  for (Index i = 0; i < m; ++i) square_y[i + 1] = square_y[i] + y[i] * y[i];
  VectorXd result(n + m - 1);
  for (Index lag = -(m - 1); lag < n; ++lag) {
    const Index first = std::max<Index>(0, lag), last = std::min(n, m + lag);  // rows of x
    const double both = (square_x[last] - square_x[first]) * (square_y[last - lag] - square_y[first - lag]);
    result[lag + m - 1] = both > 0 ? products[(lag + length) % length] / std::sqrt(both) : 0;
  }
  return result;
}

/// The part of a row by which x comes later than y, from the phases of windowed spectra: the maximum of their
/// correlation, by golden sections within one row.
double fine_delay(const VectorXd& x, const VectorXd& y) {
  const Index n = x.size(), length = power_of_two_above(n);
  const VectorXd window = VectorXd::NullaryExpr(n, [&](Index i) {
    return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
  });
  const auto spectrum = [&](const VectorXd& s) {
    const VectorXd part = s.cwiseProduct(window);
    return half_spectrum({part.data(), static_cast<std::size_t>(n)}, length);
  };
  const Eigen::VectorXcd cross = spectrum(x).cwiseProduct(spectrum(y).conjugate());
  const auto less = [&](double delay) {
    double sum = 0;
    for (Index k = 0; k < cross.size(); ++k)
      sum += (cross[k] *
              std::polar(1.0, 2 * std::numbers::pi * static_cast<double>(k) * delay / static_cast<double>(length)))
                 .real();
    return -sum;
  };
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = -1, b = 1;
  for (int i = 0; i < 36; ++i) {
    const double c = b - golden * (b - a), d = a + golden * (b - a);
    (less(c) < less(d) ? b : a) = less(c) < less(d) ? d : c;
  }
  return 0.5 * (a + b);
}

struct Delay {
  double rows, correlation;
};

Delay delay_of(const VectorXd& x, const VectorXd& y, double from, double to) {
  const VectorXd r = correlations(x, y);
  const Index zero = y.size() - 1;
  const Index low = std::clamp<Index>(zero + static_cast<Index>(std::ceil(from)), 0, r.size() - 1),
              high = std::clamp<Index>(zero + static_cast<Index>(std::floor(to)), low, r.size() - 1);
  Index best = low;
  r.segment(low, high - low + 1).maxCoeff(&best);
  const Index lag = best + low - zero;
  // The overlap, shifted by what is known so far: windows then cut both at the same places of the motion.
  const Index first = std::max<Index>(0, lag), count = std::min(x.size(), y.size() + lag) - first;
  const VectorXd other = y.segment(first - lag, count);
  double fine = 0;
  VectorXd moved = x.segment(first, count);
  for (int pass = 0; pass < 4; ++pass) {
    fine += fine_delay(moved, other);
    moved = band_limited({x.data(), static_cast<std::size_t>(x.size())}, static_cast<double>(first) + fine, 1, count);
  }
  return {static_cast<double>(lag) + fine, moved.dot(other) / (moved.norm() * other.norm())};
}

}  // namespace

Aligned align(const Record& record, const Record& other, const AlignOptions& options) {
  const std::string where = "align";
  const auto x = varying(record, options.channel, where), y = varying(other, options.channel, where);
  const double dt = record.dt();
  if (std::abs(other.dt() / dt - 1) > 1e-9)
    refuse(where, "the records have " + short_number(1 / dt) + " and " + short_number(1 / other.dt()) +
                      " Hz: resample one of them first");
  const double shorter = static_cast<double>(std::min(record.rows(), other.rows())) * dt;
  const double most = options.most > 0 ? options.most : 0.5 * shorter;
  const double apart = (other.start() - record.start()) / dt;  // rows of x before the first of y, by the clocks
  const Delay delay =
      delay_of(without_polynomial(x, 1), without_polynomial(y, 1), apart - most / dt, apart + most / dt);
  // Row i of the other is at i + delay.rows of this record.
  const auto first = static_cast<Index>(std::max(0.0, std::ceil(-delay.rows)));
  const auto last = static_cast<Index>(
      std::min(static_cast<double>(other.rows() - 1), std::floor(static_cast<double>(record.rows() - 1) - delay.rows)));
  if (last - first + 1 < 6) refuse(where, "the records overlap by fewer than 6 rows");
  Aligned result{at_positions(record, "align", static_cast<double>(first) + delay.rows, 1, last - first + 1,
                              other.time(first), dt),
                 (delay.rows - apart) * dt, delay.correlation};
  result.record.note("align: moved by " + short_number(-result.delay) + " s onto the time of " + other.name());
  return result;
}

}  // namespace lunid
