// Why a run stopped, in words.
#include <cmath>

#include "expr/digits.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

/// States beyond this are cut to it, so that powers of them stay finite.
constexpr double huge = 1e50;

/// Inputs of System::force() and its kin at a state: no accelerations, no base motion.
std::vector<double> force_inputs(const System& system, const Tape& tape, std::span<const double> theta, double t,
                                 const Eigen::VectorXd& x) {
  std::vector<double> in(tape.inputs(), 0.0);
  in[0] = t;
  std::copy(x.begin(), x.end(), in.begin() + 1 + system.degrees());
  std::copy(theta.begin(), theta.end(), in.end() - static_cast<std::ptrdiff_t>(theta.size()));
  return in;
}

/// The summands of the restoring force of one coordinate at chosen states.
class Terms {
 public:
  Terms(const System& system, std::span<const double> theta, int coordinate)
      : system_(system), theta_(theta), all_(system.terms().size()), scratch_(system.term_values().registers() + 1) {
    for (std::size_t i = 0; i < all_.size(); ++i)
      if (system.terms()[i].coordinate == coordinate) {
        own_.push_back(i);
        expressions.push_back(system.terms()[i].expression);
      }
    values.resize(own_.size());
  }

  double sum(double t, const Eigen::VectorXd& x) {
    const std::vector<double> in = force_inputs(system_, system_.term_values(), theta_, t, x);
    system_.term_values().run_point(in.data(), all_.data(), scratch_.data());
    double total = 0;
    for (std::size_t i = 0; i < own_.size(); ++i) total += values[i] = all_[own_[i]];
    return total;
  }

  std::vector<Expr> expressions;
  std::vector<double> values;

 private:
  const System& system_;
  std::span<const double> theta_;
  std::vector<double> all_, scratch_;
  std::vector<std::size_t> own_;
};

constexpr double nowhere = 1e-30;  ///< a displacement that none is

/// The displacement beyond which, up to `far`, the force drives away from rest; 0 when it does not at `far`, below
/// `nowhere` when it does at all.
double barrier(Terms& terms, double t, Eigen::VectorXd x, int place, double far) {
  const double side = far < 0 ? -1 : 1;
  const auto outward = [&](double y) {
    x[place] = y;
    return side * terms.sum(t, x) < 0;
  };
  if (!outward(far)) return 0;
  double least = std::abs(far);
  while (least > nowhere) {
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

std::string short_number(double x) { return number(x, 3); }

/// "y2 = 0.1 m, v2 = 3 m/s"
std::string place_words(const Model& model, const Eigen::VectorXd& x, int i) {
  return model.channel('y', i) + " = " + short_number(x[2 * i]) + " m, " + model.channel('v', i) + " = " +
         short_number(x[2 * i + 1]) + " m/s";
}

}  // namespace

std::string mass_fault(const System& system, std::span<const double> theta, double t, const Eigen::VectorXd& x) {
  const std::vector<double> in = force_inputs(system, system.inertia(), theta, t, x);
  std::vector<double> scratch(system.inertia().registers() + 1), masses(system.degrees());
  system.inertia().run_point(in.data(), masses.data(), scratch.data());
  for (int i = 0; i < system.degrees(); ++i)
    if (!(masses[i] > 0))
      return "the mass is " + short_number(masses[i]) + " kg at " + place_words(system.model(), x, i) +
             "; it must stay above 0";
  return "";
}

std::string start_fault(const System& system, std::span<const double> theta, const Excitations& excitation,
                        const Eigen::VectorXd& x0) {
  const double t = excitation.t0();
  if (std::string fault = mass_fault(system, theta, t, x0); !fault.empty()) return fault;
  const Dynamics& d = system.dynamics();
  std::vector<double> in(d.inputs(), 0.0), out(d.rate.outputs()), scratch(d.rate.registers() + 1);
  in[0] = t;
  for (int i = 0; i < d.exogenous; ++i) in[1 + i] = excitation[i].at(t);
  std::copy(x0.begin(), x0.end(), in.begin() + 1 + d.exogenous);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  d.rate.run_point(in.data(), out.data(), scratch.data());
  for (int i = 0; i < d.n; ++i) {
    if (std::isfinite(out[i])) continue;
    const int coordinate = i < 2 * d.degrees ? i / 2 : 0;
    const std::string place =
        " at the start, t = " + short_number(t) + " s, " + place_words(system.model(), x0, coordinate);
    if (i >= 2 * d.degrees) return "the rate of the state " + d.names[i] + " has no finite value" + place;
    Terms terms(system, theta, coordinate);
    terms.sum(t, x0);
    for (std::size_t k = 0; k < terms.values.size(); ++k)
      if (!std::isfinite(terms.values[k]))
        return "the term " + to_text(terms.expressions[k]) + " has no finite value" + place;
    return "the rate of " + d.names[i] + " has no finite value" + place;
  }
  return "";
}

std::string explosion_cause(const System& system, std::span<const double> theta, double t, Eigen::VectorXd x,
                            double dt) {
  x = x.cwiseMin(huge).cwiseMax(-huge);
  if (const std::string fault = mass_fault(system, theta, t, x); !fault.empty()) return fault;
  const Model& model = system.model();
  int worst = 0;  // the coordinate that went farthest
  for (int i = 1; i < system.degrees(); ++i)
    if (std::abs(x[2 * i]) > std::abs(x[2 * worst])) worst = i;
  const int y = 2 * worst, v = y + 1;
  Terms terms(system, theta, worst);
  Eigen::VectorXd next = x;
  for (int i = 0; i < system.degrees(); ++i) next[2 * i] += dt * x[2 * i + 1];
  for (const Eigen::VectorXd& at : {x, next}) {
    terms.sum(t, at);
    for (std::size_t i = 0; i < terms.values.size(); ++i)
      if (!std::isfinite(terms.values[i]))
        return "the term " + to_text(terms.expressions[i]) + " has no finite value at " + place_words(model, at, worst);
  }
  Eigen::VectorXd still = x;
  still[v] = 0;
  if (const double limit = barrier(terms, t, still, y, x[y]); limit > 0) {
    still[y] = x[y];
    terms.sum(t, still);
    if (limit <= nowhere)
      return "the restoring force drives " + model.channel('y', worst) + " away from rest at any displacement (term " +
             largest(terms, x[y] < 0 ? 1 : -1) + ")";
    return "the restoring force grows without bound beyond |" + model.channel('y', worst) +
           "| = " + short_number(limit) + " m (term " + largest(terms, x[y] < 0 ? 1 : -1) + ")";
  }
  for (std::size_t i = 0; i < model.states.size(); ++i)
    if (std::abs(x[2 * system.degrees() + static_cast<int>(i)]) > 1e12 * (1 + std::abs(model.states[i].initial)))
      return "the state " + model.states[i].symbol.name() + " grows without bound";
  terms.sum(t, x);
  return "the motion grows without bound: " + place_words(model, x, worst) + " (largest driving term " +
         largest(terms, x[v] < 0 ? 1 : -1) + ")";
}

std::string chatter_cause(const Dynamics& d, int event, long max_events) {
  const int surfaces = static_cast<int>(d.surfaces.size());
  const std::string where = event < 0          ? std::string("its switches")
                            : event < surfaces ? to_text(d.surfaces[event].g) + " = 0"
                                               : "the bound of " + d.names[d.bounds[event - surfaces].state];
  return "more than " + std::to_string(max_events) + " switches: the motion chatters at " + where;
}

}  // namespace lunid
