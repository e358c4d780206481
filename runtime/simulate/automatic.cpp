// solver = automatic: explicit steps locked to the samples, or BDF where it is cheaper.
#include "simulate/run.hpp"
#include "simulate/sundials.hpp"

namespace lunid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A run by BDF beside the explicit ones.
class Rival {
 public:
  Rival(const System& system, std::span<const double> theta, const Excitations& excitation, const Eigen::VectorXd& x0,
        SimulateOptions options)
      : run_(empty_run(system, excitation)),
        sink_(run_),
        sundials_(system, theta, excitation, x0, by_bdf(std::move(options)), sink_, false) {}

  /// Goes on for that much work in all; true when it has come to the end of the record.
  bool completes(double budget) {
    ended_ = ended_ || sundials_.go(budget);
    return ended_ && sundials_.summary().completed;
  }
  long evaluations() const { return sundials_.summary().evaluations; }
  Run take() {
    run_.summary = sundials_.summary();
    return std::move(run_);
  }

 private:
  static SimulateOptions by_bdf(SimulateOptions options) {
    options.solver = Solver::bdf;
    return options;
  }

  Run run_;
  FreeSink sink_;
  SundialsRun sundials_;
  bool ended_ = false;
};

const char* reason(bool found, const Run& by_steps) {
  return !found                        ? "explicit steps would need more than 64 per sample"
         : !by_steps.summary.completed ? "explicit steps explode"
                                       : "halving explicit steps does not converge";
}

}  // namespace

/// Where fast decays are met, at the start or on the rows of a run, BDF is given as much work as the explicit runs have
/// had and the next one will have; that it comes to its end first says that it is cheaper. So the whole costs at most
/// twice the better one, whichever that is.
AutomaticRun run_automatic(const System& system, std::span<const double> theta, const Excitations& excitation,
                           const Eigen::VectorXd& x0, const SimulateOptions& options) {
  std::optional<Rival> rival;
  long spent = 0;
  AutomaticRun out;
  const auto take_rival = [&](const std::string& why) {
    out.run = rival->take();
    out.run.summary.tried = spent;
    out.run.summary.solver += " (auto: " + why + ")";
    out.implicit = true;
    return std::move(out);
  };
  Run start;
  start.t0 = excitation.t0();
  start.dt = excitation.dt();
  start.x = x0.transpose();
  StepChoice choice;
  double least = 1;
  do {
    Halving halving(system, theta, excitation, x0, default_tolerance, explicit_limit, options, least);
    while (!halving.done()) {
      const Run& seen = halving.last() ? *halving.last() : start;
      if (!rival && may_be_stiff(system, theta, excitation, seen))
        rival.emplace(system, theta, excitation, x0, options);
      if (rival && rival->completes(static_cast<double>(spent + halving.spent()) + halving.next_cost())) {
        spent += halving.spent();
        return take_rival("fast decays hold explicit steps down");
      }
      halving.next();
    }
    spent += halving.spent();
    choice = halving.take();
    least = least_substeps(system, theta, excitation, x0, choice);
  } while (choice.substeps < least && least <= explicit_limit);

  out.substeps = choice.substeps;
  out.run = std::move(choice.finer);
  out.run.summary.error = choice.change;
  out.run.summary.tried = spent - out.run.summary.evaluations;
  const bool good = choice.change < default_tolerance && out.run.summary.completed && choice.substeps >= least;
  if (!good) {
    if (!rival) rival.emplace(system, theta, excitation, x0, options);
    const bool completed = rival->completes(infinity);
    const bool found = choice.reached && choice.substeps >= least;
    if (completed || !found) return take_rival(reason(found, out.run));
  }
  if (rival) out.run.summary.tried += rival->evaluations();
  return out;
}

}  // namespace lunid
