// Imposed motion: the measured y, v, a drive the internal states, and the force is read off.
#include <cmath>

#include "expr/digits.hpp"
#include "expr/external.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Change of the force on halving the step, over its standard deviation, with which a run is content.
constexpr double tolerance = 1e-6;
constexpr int max_substeps = 64;
/// Stiff states take more: until the change is no more than this.
constexpr double stiff_tolerance = 1e-3;
constexpr int max_stiff_substeps = 1024;
// A state that goes along its limit meets and leaves it as y and v, which were measured or smoothed apart, say by
// turns: the more often, the shorter the steps.
constexpr long many_events = 4;  // per row
constexpr double more_by_steps = 1.5;

/// y, v, a of each coordinate along the record.
using Motion = std::vector<std::span<const double>>;

/// The motion of base or shaft that forces and rates follow.
std::vector<std::span<const double>> side_inputs(const System& system, const Record& record) {
  std::vector<std::span<const double>> sides;
  for (const std::string& side : system.model().sides()) sides.push_back(record[side]);
  return sides;
}

/// Evaluates the forces on each row of the states: those of the first coordinate, then those of the second ...
class ForceSink : public RowSink {
 public:
  ForceSink(const System& system, std::span<const double> theta, const Record& record, const Motion& motion,
            VectorXd& force, Eigen::MatrixXd* dforce)
      : system_(system),
        record_(record),
        motion_(motion),
        force_(force),
        dforce_(dforce),
        tape_(dforce ? system.force_with_derivatives() : system.force()),
        n_(static_cast<std::size_t>(system.degrees())),
        z_(system.states() - 2 * system.degrees()),
        p_(system.parameters()),
        sides_(side_inputs(system, record)),
        in_(tape_.inputs(), 0.0),
        out_(tape_.outputs()),
        scratch_(tape_.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - p_);
  }

  void row(Index row, const double* z, const double*, const double* s) override {
    in_[0] = record_.time(row);
    for (std::size_t i = 0; i < n_; ++i) {
      in_[1 + i] = motion_[3 * i + 2][row];
      in_[1 + n_ + 2 * i] = motion_[3 * i][row];
      in_[2 + n_ + 2 * i] = motion_[3 * i + 1][row];
    }
    std::copy_n(z, z_, in_.begin() + static_cast<Index>(1 + 3 * n_));
    for (std::size_t i = 0; i < sides_.size(); ++i)
      in_[1 + 3 * n_ + static_cast<std::size_t>(z_) + i] = sides_[i][static_cast<std::size_t>(row)];
    tape_.run_point(in_.data(), out_.data(), scratch_.data());
    const double* slopes = out_.data() + n_;
    for (std::size_t i = 0; i < n_; ++i, slopes += z_ + static_cast<int>(sides_.size()) + p_) {
      const Index at = static_cast<Index>(i) * record_.rows() + row;
      force_[at] = out_[i];
      if (!dforce_) continue;
      for (int c = 0; c < p_; ++c) {
        double slope = slopes[z_ + static_cast<int>(sides_.size()) + c];
        for (int k = 0; k < z_; ++k) slope += slopes[k] * s[k * (p_ + z_) + c];
        (*dforce_)(at, c) = slope;
      }
    }
  }

 private:
  const System& system_;
  const Record& record_;
  const Motion& motion_;
  VectorXd& force_;
  Eigen::MatrixXd* dforce_;
  const Tape& tape_;
  std::size_t n_;
  int z_, p_;
  std::vector<std::span<const double>> sides_;
  std::vector<double> in_, out_, scratch_;
};

void check(const System& system, std::span<const double> theta) {
  if (static_cast<int>(theta.size()) != system.parameters())
    throw InputError("imposed_force: theta: expected " + std::to_string(system.parameters()) + " values, got " +
                     std::to_string(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i)
    if (!std::isfinite(theta[i]))
      throw InputError("imposed_force: parameter '" + system.model().parameters[i].name +
                       "': expected a finite value, got " + number(theta[i]));
  if (!system.imposed())
    throw InputError("imposed_force: the rate of a state holds F, which is the output where the motion is imposed");
}

VectorXd initial_states(const System& system) {
  const auto& states = system.model().states;
  VectorXd z0(static_cast<Index>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) z0[static_cast<Index>(i)] = states[i].initial;
  return z0;
}

/// Runs the states on the motion between its samples (a local cubic) with a number of substeps; returns how often their
/// limits were met and left.
long run_states(const System& system, std::span<const double> theta, const Record& record,
                const std::vector<Excitation>& motion, int substeps, bool sensitivities, RowSink& sink) {
  FixedProblem problem;
  problem.dynamics = system.imposed();
  problem.theta = theta;
  problem.t0 = record.start();
  problem.dt = record.dt();
  problem.rows = record.rows();
  problem.substeps = substeps;
  problem.sensitivities = sensitivities;
  for (std::size_t i = 0; i < motion.size(); ++i) problem.drive[i] = motion[i].stage_grid(substeps).data();
  return run_fixed(problem, initial_states(system), sink).events;
}

/// Largest change over the standard deviation; NaN where the force overflows.
double change(const VectorXd& fine, const VectorXd& coarse) {
  const double spread = std::sqrt((fine.array() - fine.mean()).square().mean());
  const double largest = (fine - coarse).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  return largest == 0 ? 0 : largest / (std::isfinite(spread) ? spread : std::numeric_limits<double>::quiet_NaN());
}

VectorXd force_along(const System& system, std::span<const double> theta, const Record& record, Eigen::MatrixXd* dforce,
                     int substeps) {
  check(system, theta);
  const Index rows = record.rows();
  const std::vector<double> still(rows, 0.0);
  const Model& model = system.model();
  Motion motion;
  for (int i = 0; i < model.degrees(); ++i) {
    motion.push_back(record[model.channel('y', i)]);
    motion.push_back(record[model.channel('v', i)]);
    motion.push_back(system.needs_acceleration() ? record[model.channel('a', i)] : std::span<const double>(still));
  }
  const Index all = rows * model.degrees();
  VectorXd force = VectorXd::Constant(all, std::numeric_limits<double>::quiet_NaN());
  if (dforce) dforce->setConstant(all, system.parameters(), std::numeric_limits<double>::quiet_NaN());
  ForceSink plain(system, theta, record, motion, force, nullptr), full(system, theta, record, motion, force, dforce);

  if (model.states.empty()) {
    for (Index row = 0; row < rows; ++row) (dforce ? full : plain).row(row, nullptr, nullptr, nullptr);
    return force;
  }
  std::vector<Excitation> between;
  for (const auto& inputs : {motion, side_inputs(system, record)})
    for (const auto& input : inputs) between.emplace_back(record.start(), record.dt(), input, Interpolation::cubic);
  if (substeps > 0) {
    run_states(system, theta, record, between, substeps, dforce != nullptr, dforce ? full : plain);
    return force;
  }
  substeps = 1;
  long events = run_states(system, theta, record, between, substeps, false, plain);
  bool chatters = false;
  double last = std::numeric_limits<double>::quiet_NaN();
  const auto enough = [&] { return substeps < max_substeps && !chatters ? tolerance : stiff_tolerance; };
  for (VectorXd coarse = force; !(last <= enough()); coarse = force) {
    if (substeps == max_stiff_substeps) return VectorXd::Constant(all, std::numeric_limits<double>::quiet_NaN());
    substeps *= 2;
    const long met = run_states(system, theta, record, between, substeps, false, plain);
    chatters = met > many_events * rows && static_cast<double>(met) > more_by_steps * static_cast<double>(events);
    events = met;
    last = change(force, coarse);
  }
  if (dforce) run_states(system, theta, record, between, substeps, true, full);
  return force;
}

}  // namespace

VectorXd imposed_force(const System& system, std::span<const double> theta, const Record& record,
                       Eigen::MatrixXd* dforce, int substeps) {
  const ExternalWatch externals(*system.model().pool);
  VectorXd force = force_along(system, theta, record, dforce, substeps);
  externals.rethrow();
  return force;
}

}  // namespace lunid
