#include "simulate/modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/fixed.hpp"

namespace lunid {
namespace {

/// The width of a surface: this part of the step's time at the greatest speed with which it was met.
constexpr double surface_width = 1e-13;
/// Solves a (k x k, row-major) x = b in place by Gaussian elimination with pivoting; false when singular.
bool solve_small(double* a, double* b, int k) noexcept {
  for (int col = 0; col < k; ++col) {
    int pivot = col;
    for (int row = col + 1; row < k; ++row)
      if (std::abs(a[row * k + col]) > std::abs(a[pivot * k + col])) pivot = row;
    if (!(std::abs(a[pivot * k + col]) > 0)) return false;
    if (pivot != col) {
      std::swap_ranges(a + col * k, a + col * k + k, a + pivot * k);
      std::swap(b[col], b[pivot]);
    }
    for (int row = col + 1; row < k; ++row) {
      const double factor = a[row * k + col] / a[col * k + col];
      for (int j = col; j < k; ++j) a[row * k + j] -= factor * a[col * k + j];
      b[row] -= factor * b[col];
    }
  }
  for (int row = k - 1; row >= 0; --row) {
    for (int j = row + 1; j < k; ++j) b[row] -= a[row * k + j] * b[j];
    b[row] /= a[row * k + row];
  }
  return true;
}

}  // namespace

ModeMachine::ModeMachine(const Dynamics& dynamics, std::span<const double> theta, double dt)
    : d_(dynamics),
      width_time_(surface_width * dt),
      surfaces_(dynamics.surfaces.size()),
      bounds_(dynamics.bounds.size()),
      rate_mode_(dynamics.rate.switches(), 1),
      derivative_mode_(dynamics.derivatives.switches(), 0),
      gradient_mode_(dynamics.gradients.switches(), 0),
      free_mode_(std::max(dynamics.rate.switches(), dynamics.derivatives.switches()), 0),
      run_rate_(dynamics.rate),
      run_derivatives_(dynamics.derivatives),
      run_gradients_(dynamics.gradients),
      rate_r_(std::max(dynamics.rate.registers(), dynamics.inputs()) + 1),
      derivative_r_(std::max(dynamics.derivatives.registers(), dynamics.inputs()) + 1),
      gradient_r_(std::max(dynamics.gradients.registers(), dynamics.inputs()) + 1),
      g_(rate_r_.data() + dynamics.rate.switch_place()),
      gradient_(gradient_r_.data() + dynamics.gradients.output_place()),
      out_(dynamics.rate.outputs()),
      full_(dynamics.derivatives.outputs()) {
  plus_.resize(d_.n);
  for (std::vector<double>* registers : {&rate_r_, &derivative_r_, &gradient_r_})
    std::copy(theta.begin(), theta.end(), registers->begin() + (d_.inputs() - d_.p));
  d_.rate.prepare_frozen(rate_r_.data());
  if (d_.gradients.outputs() > 0) d_.gradients.prepare_frozen(gradient_r_.data());
  if (d_.dense()) d_.derivatives.prepare_frozen(derivative_r_.data());
  for (std::size_t s = 0; s < surfaces_.size(); ++s) set_mode(static_cast<int>(s), 1);
  for (std::size_t i = 0; i < bounds_.size(); ++i)
    for (std::size_t j = 0; j < bounds_.size(); ++j)
      if (i != j && d_.bounds[i].state == d_.bounds[j].state) bounds_[i].opposite = static_cast<int>(j);
  refresh_gradients();
}

Observation ModeMachine::observation() const {
  Observation o;
  o.f.resize(d_.n);
  o.event.resize(events());
  o.slope.resize(events());
  return o;
}

void ModeMachine::load(const Drive& drive, const double* x) noexcept {
  double* in = inputs();
  in[0] = drive.t;
  for (int i = 0; i < d_.exogenous; ++i) in[1 + i] = drive.u[i];
  for (int i = 0; i < d_.n; ++i) in[1 + d_.exogenous + i] = x[i];
}

/// The rate tape on the loaded inputs; leaves g.
void ModeMachine::run_rate(const std::vector<std::int8_t>& mode, double* out) noexcept {
  run_rate_(mode, rate_r_.data());
  const double* results = rate_r_.data() + d_.rate.output_place();
  for (std::size_t i = 0; i < out_.size(); ++i) out[i] = results[i];
  ++evaluations;
}

void ModeMachine::set_mode(int surface, std::int8_t mode) noexcept {
  surfaces_[surface].mode = mode;
  const auto apply = [&](const Dynamics::SwitchMap& map, std::vector<std::int8_t>& modes) {
    for (std::size_t i = 0; i < modes.size(); ++i)
      if (map.surface[i] == surface) modes[i] = static_cast<std::int8_t>(mode * map.orientation[i]);
  };
  apply(d_.rate_switches, rate_mode_);
  apply(d_.derivative_switches, derivative_mode_);
  apply(d_.gradient_switches, gradient_mode_);
}

void ModeMachine::set_sliding(int surface, int order) {
  if (surfaces_[surface].order == order) return;
  surfaces_[surface].order = order;
  std::erase(sliding_, surface);
  if (order > 0) sliding_.push_back(surface);
  const std::size_t k = sliding_.size();
  side_.resize(k * out_.size());
  full_side_.resize(k * full_.size());
  matrix_.resize(k * k);
  weight_.resize(k);
  delta_.resize(k);
  // in sliding, the plus side is the base from which the other sides are taken
  if (order > 0) set_mode(surface, 1);
  update_drifting();
}

ModeMachine::Mode ModeMachine::mode() const {
  Mode mode;
  for (const SurfaceState& surface : surfaces_) mode.side.push_back(surface.mode);
  for (const int s : sliding_) mode.sliding.emplace_back(s, surfaces_[s].order);
  for (const BoundState& bound : bounds_) mode.held.push_back(bound.held ? 1 : 0);
  return mode;
}

void ModeMachine::take_up(const Mode& mode) {
  while (sliding()) set_sliding(sliding_.back(), 0);
  for (std::size_t s = 0; s < surfaces_.size(); ++s) set_mode(static_cast<int>(s), mode.side[s]);
  for (const auto& [surface, order] : mode.sliding) set_sliding(surface, order);
  for (std::size_t j = 0; j < bounds_.size(); ++j) bounds_[j].held = mode.held[j] != 0;
  update_drifting();
}

void ModeMachine::update_drifting() noexcept {
  drifting_ = std::any_of(bounds_.begin(), bounds_.end(), [](const BoundState& b) { return b.held; }) ||
              std::any_of(sliding_.begin(), sliding_.end(), [&](int s) { return d_.surfaces[s].component < 0; });
}

void ModeMachine::refresh_gradients() noexcept {
  if (d_.gradients.outputs() == 0) return;
  take_inputs(gradient_r_.data());
  run_gradients_(gradient_mode_, gradient_r_.data());
}

void ModeMachine::hold_rates(double* out) const noexcept {
  const std::size_t count = bounds_.size();
  for (std::size_t j = 0; j < count; ++j)
    if (bounds_[j].held) out[d_.bounds[j].state] += d_.bounds[j].side * out[d_.n + count + j];
}

void ModeMachine::hold_derivatives(double* out) const noexcept {
  const int n = d_.n, p = d_.p;
  const double* gap = out + n + n * n + n * p;
  for (std::size_t j = 0; j < bounds_.size(); ++j, gap += n + p) {
    if (!bounds_[j].held) continue;
    const auto [state, side] = d_.bounds[j];
    for (int i = 0; i < n; ++i) out[n + state * n + i] += side * gap[i];
    for (int i = 0; i < p; ++i) out[n + n * n + state * p + i] += side * gap[n + i];
  }
}

/// The gradient of what stays zero while the motion slides (g) or rests (dg/dt).
const double* ModeMachine::condition(int surface) const noexcept {
  return row(surfaces_[surface].order == 2 ? events() + surface : surface);
}

/// The state whose rate is exactly zero on a surface slid upon, or -1.
int ModeMachine::still_component(int surface) const noexcept {
  const int component = d_.surfaces[surface].component;
  return component >= 0 && surfaces_[surface].order == 2 ? component + 1 : component;
}

/// The time derivative along f of a function with this gradient.
double ModeMachine::along(const double* gradient, const Drive& drive, const double* f) const noexcept {
  double sum = gradient[0];
  for (int i = 0; i < d_.exogenous; ++i) sum += gradient[1 + i] * drive.rate[i];
  for (int i = 0; i < d_.n; ++i) sum += gradient[1 + d_.exogenous + i] * f[i];
  return sum;
}

/// Rate outputs into out_ for the inputs in in_: plain, or combined over the sides slid upon.
void ModeMachine::run(const Drive& drive) noexcept {
  run_rate(rate_mode_, out_.data());
  if (!all_finite(out_.data(), static_cast<int>(out_.size()))) run_rate(free_mode_, out_.data());
  hold_rates(out_.data());
  if (sliding()) combine(drive);
}

void ModeMachine::combine(const Drive& drive) noexcept {
  const std::size_t width = out_.size();
  const int k = static_cast<int>(sliding_.size());
  for (int l = 0; l < k; ++l) {
    double* side = side_.data() + l * width;
    set_mode(sliding_[l], -1);
    run_rate(rate_mode_, side);
    set_mode(sliding_[l], 1);
    hold_rates(side);
    for (std::size_t i = 0; i < width; ++i) side[i] = out_[i] - side[i];
  }
  if (!d_.constant_gradients) refresh_gradients();
  if (!solve_weights(drive)) return;
  for (int l = 0; l < k; ++l)
    for (std::size_t i = 0; i < width; ++i) out_[i] -= weight_[l] * side_[l * width + i];
  for (const int s : sliding_)
    if (const int still = still_component(s); still >= 0) out_[still] = 0;
}

/// Weights w of the minus sides for which every condition stays zero: (grad_k . side_l) w = its rate on the plus side.
bool ModeMachine::solve_weights(const Drive& drive) noexcept {
  const int k = static_cast<int>(sliding_.size()), x0 = 1 + d_.exogenous;
  for (int row = 0; row < k; ++row) {
    const double* g = condition(sliding_[row]);
    for (int l = 0; l < k; ++l) {
      double sum = 0;
      for (int i = 0; i < d_.n; ++i) sum += g[x0 + i] * side_[l * out_.size() + i];
      matrix_[row * k + l] = sum;
    }
    weight_[row] = along(g, drive, out_.data());
  }
  return solve_small(matrix_.data(), weight_.data(), k);
}

void ModeMachine::rate(const Drive& drive, const double* x, double* f) noexcept {
  load(drive, x);
  run(drive);
  std::copy_n(out_.data(), d_.n, f);
}

void ModeMachine::observe(const Drive& drive, const double* x, Observation& o) noexcept {
  load(drive, x);
  if (!d_.constant_gradients) refresh_gradients();
  run(drive);
  std::copy_n(out_.data(), d_.n, o.f.data());
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (surfaces_[s].order > 0) {
      o.slope[s] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const double dg = along(row(static_cast<int>(s)), drive, o.f.data());
    if (std::abs(dg) > surfaces_[s].scale) surfaces_[s].scale = std::abs(dg);
    o.event[s] = surfaces_[s].mode * g_[d_.surfaces[s].switch_index] + width_time_ * surfaces_[s].scale + least_width;
    o.slope[s] = surfaces_[s].mode * dg;
  }
  for (std::size_t l = 0; l < sliding_.size(); ++l) o.event[sliding_[l]] = std::min(weight_[l], 1 - weight_[l]);
  for (std::size_t j = 0; j < bounds_.size(); ++j) {
    const std::size_t e = surfaces_.size() + j;
    const double gap_rate = out_[d_.n + bounds_.size() + j];
    if (std::abs(gap_rate) > bounds_[j].scale) bounds_[j].scale = std::abs(gap_rate);
    const bool free = !bounds_[j].held && !held_by_opposite(static_cast<int>(j));
    o.event[e] = free ? out_[d_.n + j] + width_time_ * bounds_[j].scale + least_width : bounds_[j].held ? -gap_rate : 1;
    o.slope[e] = free ? gap_rate : std::numeric_limits<double>::quiet_NaN();
  }
}

/// The derivative tape on the loaded inputs, in its registers.
const double* ModeMachine::run_derivatives() noexcept {
  double* r = derivative_r_.data();
  take_inputs(r);
  run_derivatives_(derivative_mode_, r);
  ++evaluations;
  const double* results = r + d_.derivatives.output_place();
  const int size = static_cast<int>(full_.size());
  if (!all_finite(results, size)) {
    d_.derivatives.run_prepared_frozen(free_mode_.data(), r);
    // a slope that is infinite on the surface itself is so in every mode, and frozen it has at least a sign
    if (!all_finite(results, size)) run_derivatives_(derivative_mode_, r);
    // that of abs(v)^n at v = 0, which holds for an instant alone, is left out
    double* slopes = r + d_.derivatives.output_place() + d_.n;
    if (all_finite(results, d_.n))
      for (int i = 0; i < size - d_.n; ++i)
        if (!std::isfinite(slopes[i])) slopes[i] = 0;
  }
  return results;
}

void ModeMachine::copy_derivatives(double* out) noexcept {
  std::copy_n(run_derivatives(), full_.size(), out);
  hold_derivatives(out);
}

Derivatives ModeMachine::derivatives(const Drive& drive, const double* x) noexcept {
  load(drive, x);
  const int n = d_.n;
  if (!sliding() && bounds_.empty()) {
    const double* results = run_derivatives();
    return {results, results + n, results + n + n * n};
  }
  copy_derivatives(full_.data());
  run(drive);
  if (sliding()) combine_derivatives();
  return {out_.data(), full_.data() + n, full_.data() + n + n * n};
}

/// The derivatives in sliding, after run() has left the weights: the weighted derivatives of the sides, then what the
/// weights themselves change so that grad g . dx' stays zero, which is a projection along the jumps.
void ModeMachine::combine_derivatives() noexcept {
  const std::size_t width = full_.size();
  const int n = d_.n, p = d_.p, k = static_cast<int>(sliding_.size());
  for (int l = 0; l < k; ++l) {
    double* side = full_side_.data() + l * width;
    set_mode(sliding_[l], -1);
    copy_derivatives(side);
    set_mode(sliding_[l], 1);
    for (std::size_t i = 0; i < width; ++i) side[i] = full_[i] - side[i];
  }
  for (int l = 0; l < k; ++l)
    for (std::size_t i = 0; i < width; ++i) full_[i] -= weight_[l] * full_side_[l * width + i];
  for (int c = 0; c < n; ++c) project_column(full_.data() + n + c, n);
  for (int c = 0; c < p; ++c) project_column(full_.data() + n + n * n + c, p);
}

/// One column of dx' (entries `stride` apart) made tangent to every surface slid upon.
void ModeMachine::project_column(double* column, int stride) noexcept {
  const int n = d_.n, k = static_cast<int>(sliding_.size());
  for (int row = 0; row < k; ++row) {
    const double* g = condition(sliding_[row]) + 1 + d_.exogenous;
    delta_[row] = 0;
    for (int i = 0; i < n; ++i) delta_[row] += g[i] * column[i * stride];
    for (int l = 0; l < k; ++l) {
      matrix_[row * k + l] = 0;
      for (int i = 0; i < n; ++i) matrix_[row * k + l] += g[i] * side_[l * out_.size() + i];
    }
  }
  if (!solve_small(matrix_.data(), delta_.data(), k)) return;
  for (int l = 0; l < k; ++l)
    for (int i = 0; i < n; ++i) column[i * stride] -= delta_[l] * side_[l * out_.size() + i];
  for (const int s : sliding_)
    if (const int still = still_component(s); still >= 0) column[still * stride] = 0;
}

const double* ModeMachine::jump_of(int surface) const noexcept {
  const auto l = std::find(sliding_.begin(), sliding_.end(), surface) - sliding_.begin();
  return side_.data() + l * static_cast<std::ptrdiff_t>(out_.size());
}

const double* ModeMachine::gradient(int event, const Drive& drive, const double* x) noexcept {
  load(drive, x);
  if (!d_.constant_gradients) refresh_gradients();
  return row(event);
}

bool ModeMachine::jumps(int event) const {
  const int count = static_cast<int>(surfaces_.size());
  return event < count ? surfaces_[event].order == 0 : !bounds_[event - count].held;
}

}  // namespace lunid
