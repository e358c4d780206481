#pragma once
// A regression of the restoring force on features: F - m*a - known = sum of coefficient * feature, on measured records.
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "expr/expr.hpp"
#include "record/stream.hpp"
#include "regress/fit.hpp"
#include "regress/passivity.hpp"
#include "regress/robust.hpp"
#include "regress/search.hpp"
#include "regress/solvers.hpp"
#include "regress/weak.hpp"

namespace lunid {

/// What is known about coefficients, each named by its feature: lower <= sum of weight * coefficient <= upper.
struct TermConstraint {
  std::vector<std::pair<Expr, double>> terms;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  SourceSpan where;
};
TermConstraint at_least(Expr feature, double bound);
TermConstraint at_most(Expr feature, double bound);
TermConstraint at_most(Expr smaller, Expr larger);  ///< between two coefficients
TermConstraint between(Expr feature, double lower, double upper);
TermConstraint fixed(Expr feature, double value);

/// At most so many of these features, the others 0: the best choice is found by trying all.
struct TermGroup {
  std::vector<Expr> features;
  int at_most = 1;
  SourceSpan where;
};

/// A parameter inside a feature (tanh(p*y)), searched for within its bounds around the linear regression.
struct ImplicitParameter {
  std::string name;
  double value = 1;                                       ///< first guess, min <= value <= max
  double min = 0, max = 0;                                ///< finite, min < max
  double std = std::numeric_limits<double>::quiet_NaN();  ///< after the fit
};

/// Total least squares. Errors of features and target follow to first order from those of the channels.
struct TotalOptions {
  std::map<std::string, double> noise;  ///< standard deviation by channel; empty: as estimated from the records
};

/// Instrumental variables: functions of signals whose noise has nothing to do with that of the features, such as the
/// reference that a controller follows.
struct InstrumentOptions {
  std::vector<Expr> instruments;  ///< one or more for each feature that is to be told apart
};

using RegressionSolver = std::variant<LeastSquaresOptions, RidgeOptions, StlsqOptions, LassoOptions, NonNegativeOptions,
                                      Sr3Options, FrolsOptions, StepwiseOptions, BestSubsetOptions, SpikeSlabOptions,
                                      BaggingOptions, TotalOptions, InstrumentOptions, HuberOptions>;

/// What a regression minimises: (1 - mean_force) * mean square of the residual + mean_force * mean over the blocks of
/// time of the squared mean residual. A penalty on the mean keeps the force from shifting where no constant is among
/// the features (the thesis takes 0.25). R2 as an objective has the same minimum as the mean square.
struct RegressObjective {
  double mean_force = 0;  ///< 0 <= mean_force < 1
};

struct RegressOptions {
  std::vector<Expr> features;            ///< functions of channels, t, and parameters that have a value below
  Expr mass;                             ///< [kg]; may depend on channels; empty: none, the target is F - known
  Expr known;                            ///< known part of the restoring force, moved to the left; empty: none
  std::map<std::string, double> values;  ///< of parameters in features, mass and known
  std::vector<ImplicitParameter> implicit;
  std::vector<TermConstraint> constraints;
  std::vector<TermGroup> groups;
  std::optional<PassiveOptions> passive;
  std::optional<WeakForm> weak;              ///< integrals against test functions in place of the rows themselves
  std::vector<SourceSpan> places;            ///< of the features, for messages; empty: unknown
  std::map<std::string, std::string> units;  ///< of parameters, for the units of coefficients
  std::vector<Expr> numbers;                 ///< parts of features without a unit: normalised variables
  RegressionSolver solver = LeastSquaresOptions{};
  RegressObjective objective;
  int blocks = 8;          ///< of time in each record, 1..1000: for cross-validation and block errors
  int bootstrap = 0;       ///< replicates of the block bootstrap, 20 or more; 0: none
  std::uint64_t seed = 1;  ///< of the bootstrap
  SearchOptions search;    ///< for the implicit parameters
  int threads = 0;         ///< 0: all cores; the result does not depend on it
};
/// Throws InputError: no features, bad counts, bounds of implicit parameters, options of the solver.
void validate(const RegressOptions& options);

struct Term {
  Expr feature;
  double coefficient = 0;
  double std = 0;               ///< from the residual taken as white
  double block_std = 0;         ///< by leaving out blocks of time in turn (jackknife): holds for coloured residuals too
  double contribution = 0;      ///< rms(coefficient * feature) / rms(target)
  double lower = 0, upper = 0;  ///< 95 % interval, as Regression::interval says
  double vif = 0;               ///< variance inflation
  double inclusion = 0;         ///< probability that it belongs to the model; NaN where the solver gives none
  std::string unit;             ///< of the coefficient; "" where it cannot be told
  SourceSpan where;
};

struct Regression {
  std::vector<Term> terms;                  ///< one for each feature, in order; dropped ones have coefficient 0
  std::vector<ImplicitParameter> implicit;  ///< with the values found
  Fit fit;
  double r2 = 0;                     ///< of the target about its mean, on the rows of the fit
  double rmse = 0;                   ///< [unit of F]
  std::string mode;                  ///< "equation error, train": what r2 and rmse measure
  std::vector<std::string> windows;  ///< "run3.csv, 2 to 10 s, 6401 rows"
  std::vector<std::string> warnings;
  int passes = 0;               ///< over the data by the search for implicit parameters
  std::vector<PathPoint> path;  ///< of a lasso by cross-validation
  std::string interval;         ///< what lower and upper rest on
  std::string form;             ///< "" for the rows themselves, else what was integrated
  Outliers outliers;            ///< of a robust regression
  std::optional<Passivity> passivity;
  Expr restoring;  ///< sum of the terms that are not 0, implicit values put in, plus the known part
};

/// Regresses over all rows of `records` (windows of them, several side by side) in one pass by blocks of time; memory
/// does not grow with the rows. Throws InputError: a channel that a record lacks, a parameter without a value, a state
/// in a feature, a constraint on what is no feature, a value that is not finite (record, time, feature), and what the
/// solvers refuse; records whose channels differ in unit. The target and the features share the records' noise: the
/// coefficients are those of the equation error, a first guess that a free run has yet to confirm.
Regression regress(std::span<const Record> records, const RegressOptions& options);
/// The same of records that lie in files: each pass reads them again, some ten thousand rows at a time. The result is
/// that of the records in memory, to the last bit where their channels are. A weak form needs its half width.
Regression regress(std::span<const Stream> records, const RegressOptions& options);

}  // namespace lunid
