// The force between its samples. Band-limited: a Kaiser-windowed sinc (Harris 1978, Proc. IEEE 66, 51) on the samples
// less the straight line between the first and the last, continued oddly at both ends, so that neither a step nor a
// kink at an end rings into the record.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>

#include "expr/digits.hpp"
#include "record/extension.hpp"
#include "simulate/dormand_prince.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Half-width of the sinc kernel in samples and its Kaiser shape: flat to 1e-6 up to 0.87 of the Nyquist frequency.
constexpr int half_width = 32;
constexpr double kaiser_beta = 12.3;

double bessel_i0(double x) {
  double sum = 1, term = 1;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= (x / (2 * k)) * (x / (2 * k));
    sum += term;
  }
  return sum;
}

/// Weights of the samples -half_width+1 ... half_width round a point at `fraction` past sample 0. They sum to 1.
VectorXd kernel(double fraction) {
  VectorXd w(2 * half_width);
  for (int i = 0; i < 2 * half_width; ++i) {
    const double x = fraction - (i - half_width + 1);
    const double inside = std::max(0.0, 1 - (x / half_width) * (x / half_width));
    const double sinc = x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
    w[i] = sinc * bessel_i0(kaiser_beta * std::sqrt(inside));
  }
  return w / w.sum();
}

/// The samples less their end-to-end line, with `half_width` odd reflections on either side.
VectorXd continued(const VectorXd& f, double slope) {
  const Index n = f.size(), period = 2 * (n - 1);
  VectorXd g(n + 2 * half_width);
  for (Index i = 0; i < g.size(); ++i) {
    Index k = (i - half_width) % period;
    if (k < 0) k += period;
    const Index mirror = k < n ? k : period - k;
    const double value = f[mirror] - f[0] - slope * static_cast<double>(mirror);
    g[i] = k < n ? value : -value;
  }
  return g;
}

/// Fills what lies between the samples of `out`, which has one value per sample and place.
void refine_band_limited(const VectorXd& f, std::span<const double> places, VectorXd& out) {
  const double slope = (f[f.size() - 1] - f[0]) / static_cast<double>(f.size() - 1);
  const VectorXd g = continued(f, slope);
  const auto count = static_cast<Index>(places.size());
  for (Index i = 1; i < count; ++i) {
    const VectorXd w = kernel(places[i]);
    for (Index row = 0; row + 1 < f.size(); ++row)
      out[row * count + i] =
          w.dot(g.segment(row + 1, 2 * half_width)) + f[0] + slope * (static_cast<double>(row) + places[i]);
  }
}

/// The cubic through the four samples nearest to an interval (fewer where there are fewer), at a part of it.
class LocalCubic {
 public:
  explicit LocalCubic(const VectorXd& f) : f_(f), points_(std::min<Index>(4, f.size())) {}

  double operator()(Index row, double fraction) {
    const Index first = std::clamp<Index>(row - 1, 0, f_.size() - points_);
    if (const double x = static_cast<double>(row - first) + fraction; x != x_) weigh(x);
    double value = 0;
    for (Index i = 0; i < points_; ++i) value += weight_[i] * f_[first + i];
    return value;
  }

 private:
  /// Lagrange's weights at x samples from the first; the same in all inner intervals.
  void weigh(double x) {
    x_ = x;
    for (Index i = 0; i < points_; ++i) {
      weight_[i] = 1;
      for (Index j = 0; j < points_; ++j)
        if (j != i) weight_[i] *= (x - static_cast<double>(j)) / static_cast<double>(i - j);
    }
  }

  const VectorXd& f_;
  const Index points_;
  double weight_[4] = {}, x_ = std::numeric_limits<double>::quiet_NaN();
};

/// What a cubic has beyond the straight line between its ends: u*(1 - u)*(even + odd*(u - 1/2)) at the part u of the
/// way.
struct Bubble {
  double even = 0, odd = 0;
  double operator()(double u) const { return u * (1 - u) * (even + odd * (u - 0.5)); }
};

/// That of this integral and first moment about the middle over an interval of length 1: its own are even/6, odd/120.
Bubble bubble_of(double from, double to, double integral, double moment) {
  return {6 * (integral - 0.5 * (from + to)), 120 * (moment - (to - from) / 12)};
}

constexpr int quarters = 4;

/// That of so many intervals of a grid with their quarters (Boole: exact for a cubic's first moment).
Bubble bubble_over(const VectorXd& grid, Index first, Index rows, bool held) {
  constexpr double weights[quarters + 1] = {7.0 / 90, 32.0 / 90, 12.0 / 90, 32.0 / 90, 7.0 / 90};
  const double from = grid[quarters * first], to = grid[quarters * (first + rows)], own = static_cast<double>(rows);
  double integral = 0, moment = 0;
  for (Index i = 0; i < rows; ++i)
    for (int j = 0; j <= quarters; ++j) {
      const double value = grid[quarters * (first + i) + (held && j == quarters ? 0 : j)];
      integral += weights[j] / own * value;
      moment += weights[j] / own * value * ((static_cast<double>(i) + 0.25 * j) / own - 0.5);
    }
  return bubble_of(from, to, integral, moment);
}

/// Samples f at `places` (parts of an interval, the first 0) of each interval, then the last one.
VectorXd interpolate(const VectorXd& f, std::span<const double> places, Interpolation interpolation) {
  const auto count = static_cast<Index>(places.size());
  VectorXd out((f.size() - 1) * count + 1);
  for (Index row = 0; row < f.size(); ++row) out[row * count] = f[row];
  if (interpolation == Interpolation::band_limited) {
    refine_band_limited(f, places, out);
    return out;
  }
  for (Index i = 1; i < count; ++i) {
    LocalCubic cubic(f);
    for (Index row = 0; row + 1 < f.size(); ++row) {
      const double from = f[row], to = f[row + 1];
      out[row * count + i] = interpolation == Interpolation::hold     ? from
                             : interpolation == Interpolation::linear ? from + places[i] * (to - from)
                                                                      : cubic(row, places[i]);
    }
  }
  return out;
}

/// The ends and middles of `substeps` equal parts of an interval, without its end.
std::vector<double> even_places(int substeps) {
  std::vector<double> places(static_cast<std::size_t>(2 * substeps));
  for (int i = 0; i < 2 * substeps; ++i) places[static_cast<std::size_t>(i)] = static_cast<double>(i) / (2 * substeps);
  return places;
}

VectorXd at_samples(const TimeFunction& f, double t0, double dt, Index rows) {
  VectorXd out(rows);
  f.on_grid(t0, dt, 0, {out.data(), static_cast<std::size_t>(rows)});
  return out;
}

TimeFunction times(const TimeFunction& f, double factor) {
  const auto scale = [factor](std::span<double> out) {
    for (double& value : out) value *= factor;
  };
  TimeFunction g = [f, scale](std::span<const double> t, std::span<double> out) {
    f(t, out);
    scale(out);
  };
  g.grid = [f, scale](double t0, double dt, double place, std::span<double> out) {
    f.on_grid(t0, dt, place, out);
    scale(out);
  };
  return g;
}

/// Six-point Lagrange on an even grid.
double sextic(const VectorXd& f, double position) {
  const Index points = std::min<Index>(6, f.size());
  const Index first = std::clamp<Index>(static_cast<Index>(position) - 2, 0, f.size() - points);
  const double x = position - static_cast<double>(first);
  double value = 0;
  for (Index i = 0; i < points; ++i) {
    double weight = 1;
    for (Index j = 0; j < points; ++j)
      if (j != i) weight *= (x - static_cast<double>(j)) / static_cast<double>(i - j);
    value += weight * f[first + i];
  }
  return value;
}

/// A time nearer to a sample than this part of the interval is on it: a held force has jumped.
constexpr double on_sample = 1e-9;

/// Samples that differ from a formula by less than this part of the peak are those of the formula.
constexpr double rounding = 1e-12;

constexpr Index most_early = 1024;  ///< rows that are predicted before the first
constexpr Index early_ahead = 3;    ///< rows of the signal itself behind them

/// Parts per sample of the grid on which at() reads a band-limited force.
constexpr int at_substeps = 8;

void check(double t0, double dt, Index rows) {
  if (!std::isfinite(t0)) throw InputError("excitation: t0: expected a finite value, got " + number(t0));
  if (!(dt > 0) || !std::isfinite(dt)) throw InputError("excitation: dt: expected > 0, got " + number(dt));
  if (rows < 2) throw InputError("excitation: expected 2 rows or more, got " + std::to_string(rows));
}

void check_finite(const VectorXd& force) {
  for (Index i = 0; i < force.size(); ++i)
    if (!std::isfinite(force[i]))
      throw InputError("excitation: force: row " + std::to_string(i + 1) + ": expected a finite value, got " +
                       number(force[i]));
}

void check_substeps(int substeps) {
  if (substeps < 1) throw InputError("excitation: substeps: expected >= 1, got " + std::to_string(substeps));
}

}  // namespace

namespace {

/// What an excitation is made of.
struct Content {
  double t0 = 0, dt = 1;
  Interpolation interpolation = Interpolation::linear;
  VectorXd samples;
  TimeFunction function;
  std::vector<Bubble> bubbles;  ///< of each interval of joined samples, beyond the straight lines; empty: not joined
  VectorXd rest;                ///< what the samples have beyond the function, interpolated; empty: nothing
};

}  // namespace

/// What all parts of an excitation share.
struct Excitation::Source : Content {
  Source() = default;
  explicit Source(Content content) : Content(std::move(content)) {}
  std::mutex mutex;                                 ///< guards the grids
  std::map<int, VectorXd> even_grids, stage_grids;  ///< by substeps
  VectorXd fine_grid;                               ///< of what is interpolated, for at()
  VectorXd early;  ///< of what is interpolated: rows before the first, and the first three

  /// The samples that are interpolated.
  const VectorXd& interpolated() const { return function ? rest : samples; }
  double beyond_lines(Index row, double fraction) const {
    return bubbles.empty() ? 0 : bubbles[static_cast<std::size_t>(row)](fraction);
  }
  VectorXd refine(std::span<const double> places) const;
  const VectorXd& even_grid(int substeps);
  const VectorXd& interpolated_grid();
  const VectorXd& early_rows();
  const VectorXd& stage_grid(int substeps);
};

Excitation::Excitation(double t0, double dt, std::span<const double> force, Interpolation interpolation)
    : t0_(t0),
      dt_(dt),
      rows_(static_cast<Index>(force.size())),
      interpolation_(interpolation),
      source_(std::make_shared<Source>()) {
  check(t0, dt, rows_);
  source_->t0 = t0;
  source_->dt = dt;
  source_->interpolation = interpolation;
  source_->samples = Eigen::Map<const VectorXd>(force.data(), rows_);
  check_finite(source_->samples);
}

void TimeFunction::on_grid(double t0, double dt, double place, std::span<double> out) const {
  if (grid) return grid(t0, dt, place, out);
  std::vector<double> time(out.size());
  for (std::size_t row = 0; row < time.size(); ++row) time[row] = t0 + dt * (static_cast<double>(row) + place);
  values(time, out);
}

Excitation::Excitation(double t0, double dt, Index rows, std::function<double(double)> force)
    : Excitation(t0, dt, rows,
                 force ? TimeFunction([force](std::span<const double> t, std::span<double> out) {
                   std::transform(t.begin(), t.end(), out.begin(), force);
                 })
                       : TimeFunction()) {}

Excitation::Excitation(double t0, double dt, Index rows, TimeFunction force)
    : t0_(t0), dt_(dt), rows_(rows), interpolation_(Interpolation::cubic), source_(std::make_shared<Source>()) {
  check(t0, dt, rows_);
  check_memory("excitation", static_cast<double>(rows), 1);
  if (!force) throw InputError("excitation: no function of time is given");
  source_->t0 = t0;
  source_->dt = dt;
  source_->interpolation = interpolation_;
  source_->samples = at_samples(force, t0, dt, rows);
  check_finite(source_->samples);
  source_->function = std::move(force);
}

Excitation::Excitation(double t0, double dt, std::span<const double> force, Interpolation interpolation,
                       TimeFunction formula)
    : Excitation(t0, dt, force, interpolation) {
  if (!formula) return;
  VectorXd rest = source_->samples - at_samples(formula, t0, dt, rows_);
  check_finite(rest);
  // A jump at a sample would need two values of the formula's other parts there: it becomes a ramp of one interval.
  source_->interpolation = interpolation == Interpolation::hold ? Interpolation::linear : interpolation;
  interpolation_ = Interpolation::cubic;
  if (rest.cwiseAbs().maxCoeff() > rounding * source_->samples.cwiseAbs().maxCoeff()) source_->rest = std::move(rest);
  source_->function = std::move(formula);
}

bool Excitation::analytic() const { return source_ && source_->function && source_->rest.size() == 0; }

double Excitation::at(double t) const { return within(std::clamp(t, t0_, t0_ + static_cast<double>(rows_ - 1) * dt_)); }

double Excitation::within(double t) const {
  double exact = 0;
  if (source_->function) source_->function({&t, 1}, {&exact, 1});
  const VectorXd& f = source_->interpolated();
  if (f.size() == 0) return exact;
  const double position = std::max(0.0, static_cast<double>(first_) + (t - t0_) / dt_);
  const Index row = std::min<Index>(static_cast<Index>(position), f.size() - 2);
  const double fraction = position - static_cast<double>(row);
  switch (source_->interpolation) {
    case Interpolation::hold: return exact + (fraction < 1 - on_sample ? f[row] : f[row + 1]);
    case Interpolation::linear:
      return exact + (f[row] + fraction * (f[row + 1] - f[row])) + source_->beyond_lines(row, fraction);
    case Interpolation::cubic: return exact + LocalCubic(f)(row, fraction);
    case Interpolation::band_limited: return exact + sextic(source_->interpolated_grid(), position * 2 * at_substeps);
  }
  return 0;
}

double Excitation::also_before(double t) const {
  if (t >= t0_) return at(t);
  const double position = static_cast<double>(first_) + (t - t0_) / dt_;
  if (position >= 0) return within(t);
  double exact = 0;
  if (source_->function) {
    source_->function({&t, 1}, {&exact, 1});
    if (!std::isfinite(exact)) source_->function({&source_->t0, 1}, {&exact, 1});
  }
  const VectorXd& f = source_->early_rows();
  if (f.size() == 0) return exact;
  const double at = std::max(0.0, position + static_cast<double>(f.size() - early_ahead));
  const Index row = std::min<Index>(static_cast<Index>(at), f.size() - 2);
  const double fraction = at - static_cast<double>(row);
  switch (source_->interpolation) {
    case Interpolation::hold: return exact + f[row];
    case Interpolation::linear: return exact + f[row] + fraction * (f[row + 1] - f[row]);
    default: return exact + LocalCubic(f)(row, fraction);
  }
}

/// The force at `places` (parts of an interval, the first 0) of each interval, then the last sample.
VectorXd Excitation::Source::refine(std::span<const double> places) const {
  const auto count = static_cast<Index>(places.size());
  const Index rows = samples.size();
  const VectorXd& f = interpolated();
  VectorXd out = f.size() ? interpolate(f, places, interpolation) : VectorXd::Zero((rows - 1) * count + 1);
  for (Index row = 0; row < rows; ++row) out[row * count] = samples[row];
  if (!bubbles.empty())
    for (Index i = 1; i < count; ++i)
      for (Index row = 0; row + 1 < rows; ++row) out[row * count + i] += beyond_lines(row, places[i]);
  if (!function) return out;
  VectorXd exact(rows - 1);
  for (Index i = 1; i < count; ++i) {
    function.on_grid(t0, dt, places[i], {exact.data(), static_cast<std::size_t>(exact.size())});
    for (Index row = 0; row + 1 < rows; ++row) out[row * count + i] += exact[row];
  }
  return out;
}

const VectorXd& Excitation::Source::even_grid(int substeps) {
  const std::lock_guard lock(mutex);
  VectorXd& entry = even_grids[substeps];  // a map's entries stay where they are
  if (entry.size() == 0) entry = refine(even_places(substeps));
  return entry;
}

const VectorXd& Excitation::Source::interpolated_grid() {
  const std::lock_guard lock(mutex);
  if (fine_grid.size() == 0) fine_grid = interpolate(interpolated(), even_places(at_substeps), interpolation);
  return fine_grid;
}

const VectorXd& Excitation::Source::early_rows() {
  const std::lock_guard lock(mutex);
  const VectorXd& f = interpolated();
  if (early.size() || f.size() == 0) return early;
  if (f.size() < early_ahead) return early = VectorXd::Constant(early_ahead + 1, f[0]);  // too few say nothing more
  const Index reach = std::min(f.size(), most_early);
  const Extended whole = extend({f.data(), static_cast<std::size_t>(f.size())}, 2 * reach);  // half of it falls to zero
  early.resize(reach + early_ahead);
  for (Index i = 0; i < reach; ++i)
    early[i] = whole.values[reach + i] + whole.line[0] - whole.slope * static_cast<double>(reach - i);
  early.tail(early_ahead) = f.head(early_ahead);
  return early;
}

const VectorXd& Excitation::Source::stage_grid(int substeps) {
  const std::lock_guard lock(mutex);
  VectorXd& entry = stage_grids[substeps];
  if (entry.size() == 0) {
    std::vector<double> places;
    for (int j = 0; j < substeps; ++j)
      for (int i = 0; i < dormand_prince::nodes; ++i) places.push_back((j + dormand_prince::place[i]) / substeps);
    entry = refine(places);
  }
  return entry;
}

VectorXd Excitation::samples() const { return source_->samples.segment(first_, rows_); }

double Excitation::peak() const { return source_->samples.segment(first_, rows_).cwiseAbs().maxCoeff(); }

VectorXd Excitation::refined(int substeps) const {
  check_substeps(substeps);
  const Index parts = 2 * substeps;
  return source_->even_grid(substeps).segment(first_ * parts, (rows_ - 1) * parts + 1);
}

std::span<const double> Excitation::stage_grid(int substeps) const {
  check_substeps(substeps);
  const Index parts = dormand_prince::nodes * substeps;
  return {source_->stage_grid(substeps).data() + first_ * parts, static_cast<std::size_t>((rows_ - 1) * parts + 1)};
}

Excitation Excitation::scaled(double factor) const {
  Excitation out = *this;
  out.source_ = std::make_shared<Source>(Content(*source_));
  Source& to = *out.source_;
  to.samples *= factor;
  to.rest *= factor;
  for (Bubble& bubble : to.bubbles) bubble = {factor * bubble.even, factor * bubble.odd};
  if (source_->function) to.function = times(source_->function, factor);
  return out;
}

Excitation Excitation::plus(std::span<const double> more) const {
  if (std::ssize(more) != rows_)
    throw InputError("excitation: expected " + std::to_string(rows_) + " values to add, got " +
                     std::to_string(more.size()));
  const Eigen::Map<const VectorXd> added(more.data(), rows_);
  Excitation out = *this;
  out.source_ = std::make_shared<Source>(Content(*source_));
  Source& to = *out.source_;
  to.samples.segment(first_, rows_) += added;
  check_finite(to.samples);
  if (to.function && to.rest.size() == 0) to.rest = VectorXd::Zero(to.samples.size());
  if (to.function) to.rest.segment(first_, rows_) += added;
  return out;
}

Excitation Excitation::joined(Index rows) const {
  if (rows < 1 || (rows_ - 1) / rows < 1)
    throw InputError("excitation: joined: expected 1 to " + std::to_string(rows_ - 1) + " rows, got " +
                     std::to_string(rows));
  if (rows == 1) return *this;
  const Index count = (rows_ - 1) / rows + 1;
  const VectorXd grid = refined(quarters / 2), own = samples();
  const VectorXd joined = own(Eigen::seqN(0, count, rows));
  Excitation out(t0_, dt_ * static_cast<double>(rows), {joined.data(), static_cast<std::size_t>(count)},
                 Interpolation::linear);
  for (Index i = 0; i + 1 < count; ++i)
    out.source_->bubbles.push_back(bubble_over(grid, i * rows, rows, interpolation_ == Interpolation::hold));
  out.interpolation_ = Interpolation::cubic;
  return out;
}

std::pair<Excitation, Excitation> Excitation::held_later(double delay) const {
  const double whole = std::ceil(delay / dt_ - on_sample);
  const double jump = delay / dt_ - whole + 1;  // where in an interval the value changes: above 0, to 1
  VectorXd held(rows_);
  for (Index i = 0; i < rows_; ++i) held[i] = also_before(t0_ + dt_ * (static_cast<double>(i) - whole));
  const VectorXd still = VectorXd::Zero(rows_);
  const auto curved = [&](const VectorXd& samples) {
    Excitation out(t0_, dt_, {samples.data(), static_cast<std::size_t>(rows_)}, Interpolation::linear);
    out.interpolation_ = Interpolation::cubic;
    return out;
  };
  std::pair out{curved(held), curved(still)};
  for (Index i = 0; i + 1 < rows_; ++i) {
    const double from = held[i], to = held[i + 1], step = to - from;
    const double integral = from + (1 - jump) * step, moment = 0.5 * jump * (1 - jump) * step;
    out.first.source_->bubbles.push_back(bubble_of(from, to, integral, moment));
    out.second.source_->bubbles.push_back(bubble_of(0, 0, step / dt_, (jump - 0.5) * step / dt_));
  }
  return out;
}

Excitation Excitation::part(Index first, Index count) const {
  if (first < 0 || count < 2 || first + count > rows_)
    throw InputError("excitation: rows " + std::to_string(first + 1) + " to " + std::to_string(first + count) +
                     " are not within its " + std::to_string(rows_) + " rows");
  Excitation cut = *this;
  cut.first_ += first;
  cut.rows_ = count;
  cut.t0_ += dt_ * static_cast<double>(first);
  return cut;
}

}  // namespace lunid
