#include "simulate/response.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "simulate/periodic.hpp"
#include "simulate/response_checks.hpp"
#include "simulate/stepped.hpp"

namespace lunid {
namespace {

using Eigen::VectorXd;
using std::numbers::pi;

/// Periods of simulation before shooting begins, and where Newton's method needs a nearer start.
constexpr long first_periods = 40, more_periods = 5000;
/// Part of a step over which the amplitude's slope along the branch is taken.
constexpr double aside = 1e-4;
/// An amplitude that is so many times that of the start is a resonance without damping.
constexpr double unbounded = 1e5;
/// Halvings by which a change of stability is located within a step.
constexpr int halvings = 24;

double log_omega(double frequency) { return std::log(2 * pi * frequency); }
double hertz(double lambda) { return std::exp(lambda) / (2 * pi); }

/// What changes along the branch tells of special points.
struct Signs {
  double turn = 0;  ///< direction of the frequency
  double rise = 0;  ///< of the amplitude along the branch, relative
  Outside outside;
};

/// One branch, followed from one end of the range towards the other.
class Tracer {
 public:
  Tracer(PeriodicCurve& curve, const PeriodicProblem& problem, const ResponseOptions& options, int output,
         ResponseCurve& out, int branch)
      : curve_(curve),
        problem_(problem),
        options_(options),
        output_(output),
        out_(out),
        branch_(branch),
        continuation_(curve, {.max_step = options.max_step}) {}

  /// True when the other end was reached.
  bool trace(double from, double to, bool simulate_first) {
    from_ = from;
    to_ = to;
    const bool reached = follow(log_omega(from), log_omega(to), simulate_first);
    out_.corrections += continuation_.corrections();
    return reached;
  }

 private:
  bool follow(double from, double to, bool simulate_first);
  bool begin(double from, int direction, bool simulate_first);
  bool step(double from, double to);
  bool leave(double at, std::string why);
  ResponsePoint point_at(const BranchPlace& place);
  Signs signs_at(const BranchPlace& place, const ResponsePoint& point);
  void add(ResponsePoint point, const std::string& mark);
  void mark_between(const Signs& before, const Signs& now, double low, double high);
  double locate_change(int total_before);
  bool stop(std::string why) {
    out_.stopped.push_back(std::move(why));
    return false;
  }

  PeriodicCurve& curve_;
  const PeriodicProblem& problem_;
  const ResponseOptions& options_;
  int output_;
  ResponseCurve& out_;
  int branch_;
  Continuation continuation_;
  double from_ = 0, to_ = 0;  ///< [Hz]
  Signs signs_;
  std::string fault_;  ///< of the simulations that look for a start
  long added_ = 0;
  std::size_t first_ = 0;  ///< point of the branch
};

ResponsePoint Tracer::point_at(const BranchPlace& place) {
  ResponsePoint point;
  point.frequency = hertz(place.lambda);
  point.branch = branch_;
  point.harmonics = curve_.harmonics();
  curve_.motions(place.x, place.lambda, point.motion);
  if (!options_.stability) return point;
  point.multipliers = curve_.multipliers(place.x, place.lambda);
  point.stable = outside(point.multipliers).total() == 0;
  return point;
}

Signs Tracer::signs_at(const BranchPlace& place, const ResponsePoint& point) {
  Signs s;
  s.turn = place.tangent_lambda;
  s.outside = outside(point.multipliers);
  const double amplitude = point.motion[output_].amplitude();
  const double then =
      curve_.amplitude(place.x + aside * place.tangent, place.lambda + aside * place.tangent_lambda, output_);
  s.rise = amplitude > 0 ? (then - amplitude) / (aside * amplitude) : 0;
  return s;
}

void Tracer::add(ResponsePoint point, const std::string& mark) {
  point.mark = mark;
  if (!mark.empty()) out_.special.push_back({mark, out_.points.size()});
  out_.points.push_back(std::move(point));
  ++added_;
}

bool Tracer::begin(double from, int direction, bool simulate_first) {
  if (!simulate_first && continuation_.begin(curve_.guess(), from, direction)) return true;
  const double omega = std::exp(from);
  PeriodRun run(problem_);
  fault_ = run.choose_rows(problem_.start, omega);
  if (!fault_.empty()) return false;
  Settled settled = settle(run, problem_.start, omega, first_periods, options_.accuracy);
  for (const long periods : {0L, more_periods}) {
    if (periods > 0) settled = settle(run, settled.period.end(), omega, periods, options_.accuracy);
    fault_ = settled.period.fault;
    if (!fault_.empty()) return false;
    const Period last = run.run(settled.period.end(), omega, false);
    if (last.fault.empty() && continuation_.begin(curve_.of_period(last), from, direction)) return true;
  }
  return false;
}

bool Tracer::follow(double from, double to, bool simulate_first) {
  if (!begin(from, to > from ? 1 : -1, simulate_first)) {
    const std::string fault = fault_.empty() ? curve_.fault() : fault_;
    return stop("no periodic answer was found at " + in_hertz(from_) + (fault.empty() ? "" : ": " + fault));
  }
  first_ = out_.points.size();
  ResponsePoint first = point_at(continuation_.here());
  first.frequency = from_;  // not what is left of it after logarithm and power
  signs_ = signs_at(continuation_.here(), first);
  add(std::move(first), "");
  while (added_ < options_.max_points) {
    if (!continuation_.advance()) {
      const std::string fault = curve_.fault();
      return stop("no step leads on from " + in_hertz(hertz(continuation_.here().lambda)) +
                  (fault.empty() ? "" : ": " + fault));
    }
    const double lambda = continuation_.here().lambda, low = std::min(from, to), high = std::max(from, to);
    const bool outside_range = lambda < low || lambda > high;
    const Signs before = signs_;
    ResponsePoint point = point_at(continuation_.here());
    signs_ = signs_at(continuation_.here(), point);
    out_.truncated |= curve_.truncated();
    if (point.motion[output_].amplitude() > unbounded * out_.points[first_].motion[output_].amplitude())
      return stop("the answer grows without bound at " + in_hertz(hertz(lambda)));
    mark_between(before, signs_, low, high);
    if (!outside_range) {
      add(std::move(point), "");
      continue;
    }
    const bool reached = (lambda > high) == (to > from);
    BranchPlace end;
    if (continuation_.between_at(lambda > high ? high : low, end)) {
      ResponsePoint last = point_at(end);
      last.frequency = reached ? to_ : from_;
      add(std::move(last), "");
    }
    if (!reached) return stop("the branch turns back and leaves the range at " + in_hertz(from_));
    out_.stopped.push_back("reached " + in_hertz(to_));
    return true;
  }
  return stop("max_points = " + std::to_string(options_.max_points) + " were not enough: stopped at " +
              in_hertz(hertz(continuation_.here().lambda)));
}

/// Part of the last step at which the number of multipliers outside changes.
double Tracer::locate_change(int total_before) {
  double low = 0, high = 1;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    BranchPlace place;
    if (!continuation_.between(middle, place)) break;
    const bool same = outside(curve_.multipliers(place.x, place.lambda)).total() == total_before;
    (same ? low : high) = middle;
  }
  return high;
}

void Tracer::mark_between(const Signs& before, const Signs& now, double low, double high) {
  std::vector<std::pair<double, std::string>> found;
  const bool turned = before.turn * now.turn < 0;
  if (turned) {
    const auto turn = [&](double part) {
      BranchPlace place;
      return continuation_.between(part, place) ? place.tangent_lambda : std::nan("");
    };
    found.emplace_back(root_between(before.turn, now.turn, turn), "fold");
  }
  if (before.rise > 0 && now.rise < 0) {
    const auto rise = [&](double part) {
      BranchPlace place;
      if (!continuation_.between(part, place)) return std::nan("");
      const double amplitude = curve_.amplitude(place.x, place.lambda, output_);
      return (curve_.amplitude(place.x + aside * place.tangent, place.lambda + aside * place.tangent_lambda, output_) -
              amplitude) /
             (aside * amplitude);
    };
    found.emplace_back(root_between(before.rise, now.rise, rise), "peak");
  }
  const int change = now.outside.total() - before.outside.total();
  const int plus = now.outside.plus - before.outside.plus, minus = now.outside.minus - before.outside.minus;
  std::string kind;
  if (change != 0 && minus % 2 != 0)
    kind = "period_doubling";
  else if (change != 0 && plus % 2 != 0)
    kind = turned ? "" : "branch_point";
  else if (change != 0)
    kind = "neimark_sacker";
  if (!kind.empty()) found.emplace_back(locate_change(before.outside.total()), kind);
  std::sort(found.begin(), found.end());
  for (const auto& [part, mark] : found) {
    BranchPlace place;
    if (!continuation_.between(part, place) || place.lambda < low || place.lambda > high) continue;
    add(point_at(place), mark);
  }
}

void trace_branches(const PeriodicProblem& problem, const ResponseOptions& options, bool balance, int output,
                    ResponseCurve& out) {
  const auto make = [&] { return balance ? make_balance_curve(problem) : make_shooting_curve(problem); };
  auto curve = make();
  out.complete = Tracer(*curve, problem, options, output, out, 1).trace(options.from, options.to, !balance);
  if (out.complete) return;
  curve = make();  // what the other end knows
  Tracer(*curve, problem, options, output, out, out.points.empty() ? 1 : 2).trace(options.to, options.from, !balance);
}

std::string method_words(const ResponseCurve& curve, bool balance, bool chosen) {
  if (!balance) return chosen ? "shooting (the model has switches)" : "shooting";
  int least = 0, most = 0;
  for (const ResponsePoint& point : curve.points) {
    least = least == 0 ? point.harmonics : std::min(least, point.harmonics);
    most = std::max(most, point.harmonics);
  }
  return "harmonic balance, " + (least < most ? std::to_string(least) + " to " : "") + std::to_string(most) +
         (most == 1 ? " harmonic" : " harmonics");
}

}  // namespace

ResponseCurve frequency_response(const System& system, std::span<const double> theta,
                                 const std::vector<HarmonicInput>& inputs, const ResponseOptions& options) {
  validate(options);
  check_periodic("frequency_response", system, theta, inputs);
  const auto begin = std::chrono::steady_clock::now();
  const Dynamics& d = system.dynamics();
  PeriodicProblem problem{&d, theta, inputs, rest_of(system), options.harmonics};
  problem.accuracy = options.accuracy;
  problem.cancelled = options.cancelled;
  ResponseCurve out;
  out.states = d.names;
  if (options.method <= ResponseMethod::shooting) {
    const bool chosen = options.method == ResponseMethod::automatic;
    const bool balance = chosen ? d.smooth() : options.method == ResponseMethod::harmonic_balance;
    if (balance) check_balance("frequency_response", d, "; take method 'shooting'");
    trace_branches(problem, options, balance, 0, out);
    out.method = method_words(out, balance, chosen);
  } else if (options.method <= ResponseMethod::stepped_down) {
    run_stepped(problem, options, out);
  } else {
    run_swept(problem, options, out);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace lunid
