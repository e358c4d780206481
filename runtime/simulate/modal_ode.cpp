#include "simulate/modal_ode.hpp"

#include <algorithm>
#include <cmath>

#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::VectorXd;

/// A slope within this part of the greatest one is none: a watch on it never rests on zero.
constexpr double rest_speed = 1e-12;
/// Steps that were too long are shortened in fewer tries than this; a motion that explodes asks again and again.
constexpr int tries_beyond = 50;
/// A coordinate that hardly moves is not held to a precision of its own: it counts this part of the largest. So does a
/// sensitivity, beside what its parameter as a whole would make of the state.
constexpr double least_share = 1e-3;

double finite_or_zero(double slope) { return std::isfinite(slope) ? slope : 0; }

}  // namespace

ModalOde::ModalOde(const System& system, std::span<const double> theta, const Excitations& excitation,
                   const VectorXd& x0, const SimulateOptions& options, bool sensitivities)
    : modes(system.dynamics(), theta, excitation.dt()),
      excitation_(excitation),
      options_(options),
      n_(system.states()),
      columns_(sensitivities ? system.parameters() + n_ : 0),
      observation_(modes.observation()),
      scale_(n_, 0.0),
      in_(system.dynamics().inputs()),
      scratch_(std::max(system.dynamics().jacobian.registers(), system.dynamics().rate.registers()) + 1) {
  std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
  const double fastest = fastest_motion(system, theta, excitation, excitation.t0(), x0).rate;
  first_scales(x0, std::min(excitation.dt(), 1 / fastest));
  if (sensitivities) size_columns(theta);
}

Drive ModalOde::drive(double t) const {
  Drive d(t, excitation_.count());
  for (int i = 0; i < excitation_.count(); ++i) {
    const Excitation& input = excitation_[i];
    d.u[i] = input.at(std::min(t, hold_until));
    if (!modes.dynamics().input_rates) continue;
    const double step = 1e-6 * excitation_.dt();
    d.rate[i] = (input.at(t + step) - input.at(t - step)) / (2 * step);
  }
  return d;
}

void ModalOde::rate(double t, const double* x, double* f) {
  if ((++calls_ & (cancel_interval - 1)) == 0) check_cancelled(options_.cancelled);
  for (int i = 0; bound > 0 && i < modes.dynamics().degrees; ++i)
    if (!(std::abs(x[2 * i]) <= bound)) {  // a step too long, perhaps: no value there, and SUNDIALS tries a shorter one
      beyond = Beyond{t, Eigen::Map<const VectorXd>(x, n_), beyond ? beyond->times + 1 : 1};
      if (beyond->times > tries_beyond) throw *beyond;
      std::fill_n(f, n_, std::numeric_limits<double>::quiet_NaN());
      return;
    }
  modes.rate(drive(t), x, f);
}

const std::vector<Dynamics::Entry>* ModalOde::pattern() const {
  return modes.dynamics().dense() ? nullptr : &modes.dynamics().pattern;
}

/// With many states that of the side on which each switch stands: in sliding it is an approximation, which costs
/// iterations and no accuracy.
void ModalOde::jacobian(double t, const double* x, double* j) {
  if (modes.dynamics().dense()) {
    std::copy_n(modes.derivatives(drive(t), x).jx, n_ * n_, j);
    return;
  }
  const Dynamics& d = modes.dynamics();
  const Drive now = drive(t);
  in_[0] = t;
  std::copy_n(now.u, d.exogenous, in_.begin() + 1);
  std::copy_n(x, d.n, in_.begin() + 1 + d.exogenous);
  d.jacobian.run_point(in_.data(), j, scratch_.data());
}

void ModalOde::event_functions(double t, const double* x, double* g) {
  modes.observe(drive(t), x, observation_);
  std::copy(observation_.event.begin(), observation_.event.end(), g);
  for (int i = 0; i < events(); ++i)
    g[events() + i] = std::isfinite(observation_.slope[i]) ? observation_.slope[i] + rest_speed * modes.speed(i) : 1;
}

/// 1 / (rtol |x| + atol), atol being rtol times the largest |x| so far where none is given.
void ModalOde::error_weights(const double* x, double* w) {
  for (int i = 0; i < n_; ++i) scale_[i] = std::max(scale_[i], std::abs(x[i]));
  share_scales();
  for (int i = 0; i < n_; ++i)
    w[i] = 1 / (options_.rtol * std::abs(x[i]) + (options_.atol > 0 ? options_.atol : options_.rtol * scale_[i]));
}

/// An infinite slope (a root at its zero) stands at one point only, and its integral is finite: it counts for nothing.
void ModalOde::sensitivity_rate(double t, const double* x, const double* const* s, double* const* ds) {
  const Derivatives at = modes.derivatives(drive(t), x);
  const int p = columns_ - n_;
  for (int c = 0; c < columns_; ++c)
    for (int i = 0; i < n_; ++i) {
      double sum = c < p ? finite_or_zero(at.jtheta[i * p + c]) : 0;
      for (int j = 0; j < n_; ++j) sum += finite_or_zero(at.jx[i * n_ + j]) * s[c][j];
      ds[c][i] = sum;
    }
}

/// The same as for the states, of a change of the parameter by its own size: relative to the sensitivity's largest
/// value so far, or to what makes a thousandth of the state's scale.
void ModalOde::sensitivity_weights(int column, const double* s, double* w) {
  double* scale = column_scale_.data() + static_cast<std::ptrdiff_t>(column) * n_;
  const double size = size_[column];
  for (int i = 0; i < n_; ++i) {
    scale[i] = std::max({scale[i], std::abs(s[i]), least_share * scale_[i] / size});
    w[i] = 1 / (options_.rtol * std::abs(s[i]) + (options_.atol > 0 ? options_.atol / size : options_.rtol * scale[i]));
  }
}

void ModalOde::share_scales() {
  const int degrees = modes.dynamics().degrees;
  for (const int quantity : {0, 1}) {
    double largest = 0;
    for (int i = 0; i < degrees; ++i) largest = std::max(largest, scale_[2 * i + quantity]);
    for (int i = 0; i < degrees; ++i)
      scale_[2 * i + quantity] = std::max(scale_[2 * i + quantity], least_share * largest);
  }
}

/// |x'| with every switch on its own side: no mode is known yet, and a contact not made must not count.
void ModalOde::free_rates(const Drive& d, const VectorXd& x, VectorXd& out) {
  in_[0] = d.t;
  std::copy_n(d.u, modes.dynamics().exogenous, in_.begin() + 1);
  std::copy(x.begin(), x.end(), in_.begin() + 1 + modes.dynamics().exogenous);
  modes.dynamics().rate.run_point(in_.data(), out.data(), scratch_.data());
  out = out.array().isFinite().select(out.cwiseAbs(), 0);
}

/// The size of each state before there is motion to read it off: what the first rates make in a time, that of a
/// sample or of the fastest motion, whichever is less.
void ModalOde::first_scales(const VectorXd& x0, double time) {
  const int degrees = modes.dynamics().degrees;
  Drive d(excitation_.t0(), excitation_.count());
  VectorXd x = x0, rates(modes.dynamics().rate.outputs());
  for (const double side : {0.0, 1.0, -1.0}) {
    for (int i = 0; i < excitation_.count(); ++i) d.u[i] = side * excitation_[i].peak();
    free_rates(d, x, rates);
    for (int i = 0; i < n_; ++i) scale_[i] = std::max({scale_[i], std::abs(x0[i]), rates[i] * time});
  }
  for (int i = 0; i < degrees; ++i) {
    scale_[2 * i] = std::max(scale_[2 * i], scale_[2 * i + 1] * time);
    x[2 * i] += scale_[2 * i];
    x[2 * i + 1] += scale_[2 * i + 1];
  }
  free_rates(d, x, rates);
  for (int i = 0; i < n_; ++i) {
    scale_[i] = std::max(scale_[i], rates[i] * time);
    if (!(scale_[i] > 0)) scale_[i] = 1e-9;
  }
}

/// A first state counts as a whole at its scale, a parameter at its value; one that is zero where it changes the rates
/// at these scales by as much as they are, or at 1.
void ModalOde::size_columns(std::span<const double> theta) {
  const Drive d(excitation_.t0(), excitation_.count());
  const Derivatives at = modes.derivatives(d, scale_.data());
  const int p = columns_ - n_;
  for (int c = 0; c < p; ++c) {
    double part = 0;
    for (int i = 0; i < n_; ++i)
      if (at.f[i] != 0) part = std::max(part, std::abs(at.jtheta[i * p + c] / at.f[i]));
    const double unit = part > 0 && std::isfinite(part) ? 1 / part : 1;
    size_.push_back(theta[static_cast<std::size_t>(c)] != 0 ? std::abs(theta[static_cast<std::size_t>(c)]) : unit);
  }
  for (int i = 0; i < n_; ++i) size_.push_back(scale_[i]);
  column_scale_.assign(size_.size() * static_cast<std::size_t>(n_), 0.0);
}

}  // namespace lunid
