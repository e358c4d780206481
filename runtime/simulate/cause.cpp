// Why a run stopped, in words.
#include <cmath>

#include "simulate/run.hpp"

namespace lunid {
namespace {

/// States beyond this are cut to it, so that powers of them stay finite.
constexpr double huge = 1e50;

/// The summands of the restoring force at chosen states.
class Terms {
 public:
  Terms(const System& system, std::span<const double> theta)
      : expressions(system.terms()),
        values(expressions.size()),
        tape_(system.term_values()),
        in_(tape_.inputs(), 0.0),
        scratch_(tape_.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
  }

  double sum(double t, const Eigen::VectorXd& x) {
    in_[0] = t;
    for (Eigen::Index i = 0; i < x.size(); ++i) in_[2 + i] = x[i];
    tape_.run_point(in_.data(), values.data(), scratch_.data());
    double total = 0;
    for (const double value : values) total += value;
    return total;
  }

  const std::vector<Expr>& expressions;
  std::vector<double> values;

 private:
  const Tape& tape_;
  std::vector<double> in_, scratch_;
};

/// The displacement beyond which, up to `far`, the force drives away from rest; 0 when it does not at `far`.
double barrier(Terms& terms, double t, Eigen::VectorXd x, double far) {
  const double side = far < 0 ? -1 : 1;
  const auto outward = [&](double y) {
    x[0] = y;
    return side * terms.sum(t, x) < 0;
  };
  if (!outward(far)) return 0;
  double least = std::abs(far);
  while (least > 1e-30) {
    const double next = least * 0.9;
    if (!outward(side * next)) {
      double low = next, high = least;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (outward(side * middle) ? high : low) = middle;
      }
      return high;
    }
    least = next;
  }
  return least;  // no way back at all
}

/// The term that pushes most in the direction `sign`.
std::string largest(const Terms& terms, double sign) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < terms.values.size(); ++i)
    if (sign * terms.values[i] > sign * terms.values[best]) best = i;
  return to_text(terms.expressions[best]);
}

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

}  // namespace

std::string mass_fault(const System& system, std::span<const double> theta, double t, const Eigen::VectorXd& x) {
  std::vector<double> in{t, 0}, scratch(system.inertia().registers() + 1);
  in.insert(in.end(), x.begin(), x.end());
  in.insert(in.end(), theta.begin(), theta.end());
  double mass = 0;
  system.inertia().run_point(in.data(), &mass, scratch.data());
  if (mass > 0) return "";
  return "the mass is " + short_number(mass) + " kg at y = " + short_number(x[0]) + " m, v = " + short_number(x[1]) +
         " m/s; it must stay above 0";
}

std::string explosion_cause(const System& system, std::span<const double> theta, double t, Eigen::VectorXd x,
                            double dt) {
  x = x.cwiseMin(huge).cwiseMax(-huge);
  if (const std::string fault = mass_fault(system, theta, t, x); !fault.empty()) return fault;
  const Model& model = system.model();
  Terms terms(system, theta);
  Eigen::VectorXd next = x;
  next[0] += dt * x[1];
  for (const Eigen::VectorXd& at : {x, next}) {
    terms.sum(t, at);
    for (std::size_t i = 0; i < terms.values.size(); ++i)
      if (!std::isfinite(terms.values[i]))
        return "the term " + to_text(terms.expressions[i]) + " has no finite value at y = " + short_number(at[0]) +
               " m, v = " + short_number(at[1]) + " m/s";
  }
  Eigen::VectorXd still = x;
  still[1] = 0;
  if (const double y = barrier(terms, t, still, x[0]); y > 0) {
    still[0] = x[0];
    terms.sum(t, still);
    return "the restoring force grows without bound beyond |y| = " + short_number(y) + " m (term " +
           largest(terms, x[0] < 0 ? 1 : -1) + ")";
  }
  for (Eigen::Index i = 2; i < x.size(); ++i)
    if (std::abs(x[i]) > 1e12 * (1 + std::abs(model.states[i - 2].initial)))
      return "the state " + model.states[i - 2].symbol.name() + " grows without bound";
  terms.sum(t, x);
  return "the motion grows without bound: y = " + short_number(x[0]) + " m, v = " + short_number(x[1]) +
         " m/s (largest driving term " + largest(terms, x[1] < 0 ? 1 : -1) + ")";
}

std::string chatter_cause(const Dynamics& d, int event, long max_events) {
  const int surfaces = static_cast<int>(d.surfaces.size());
  const std::string where = event < 0          ? std::string("its switches")
                            : event < surfaces ? to_text(d.surfaces[event].g) + " = 0"
                                               : "the bound of " + d.names[d.bounds[event - surfaces].state];
  return "more than " + std::to_string(max_events) + " switches: the motion chatters at " + where;
}

}  // namespace lunid
