#pragma once
// The solvers beyond those of fit.hpp that work on a Statistic alone. All honour linear constraints, but for those
// that say they refuse them: these take fixed coefficients only, and name the first other constraint with its line.
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <variant>

#include "regress/fit.hpp"

namespace lunid {

/// Least squares with every coefficient >= 0 (Lawson & Hanson 1974), besides the constraints given.
Fit non_negative(const Statistic& data, std::span<const Constraint> constraints = {});

struct Sr3Options {
  double threshold = 0.02;   ///< > 0: contribution at which a coefficient is cut (l0) or by which it is shrunk (l1)
  double relaxation = 0.1;   ///< > 0, nu: how far the sparse copy w may be from the coefficients
  bool absolute = false;     ///< penalty on absolute values (l1) in place of the number of terms (l0)
  bool refit = true;         ///< least squares on the terms of w; false: w itself, without constraints only
  int max_passes = 10000;    ///< >= 1
  double tolerance = 1e-12;  ///< > 0: stops when w moves by less, relative to its length
};
void validate(const Sr3Options& options);
/// Sparse relaxed regularised regression (Zheng, Askham, Brunton, Kutz & Aravkin 2019, IEEE Access 7, 1404): min |X b -
/// z|^2 / (2 rows size(z)^2) + P(w) + |s(b) - w|^2 / (2 nu) with s_j = size_j b_j / size(z), over b and w by turns; P
/// is threshold^2 / (2 nu) times the number of terms of w, or threshold / nu times their absolute values. Constraints
/// hold for b (Champion et al. 2020, IEEE Access 8, 169259) and for the refit.
Fit sr3(const Statistic& data, const Sr3Options& options = {}, std::span<const Constraint> constraints = {});

enum class Criterion { aicc, bic };

struct FrolsOptions {
  double threshold = 1e-3;  ///< 0 <= threshold < 1: least error reduction ratio of a term
  int max_terms = 0;        ///< >= 0; 0: as many as there are features
};
void validate(const FrolsOptions& options);
/// Forward regression by orthogonal least squares (Chen, Billings & Luo 1989, Int. J. Control 50, 1873): takes up the
/// feature whose error reduction ratio, the part of the target's sum of squares that it explains beyond those taken
/// before, is largest. Under constraints the ratio is that of the constrained sums of squares.
Fit frols(const Statistic& data, const FrolsOptions& options = {}, std::span<const Constraint> constraints = {});

struct StepwiseOptions {
  Criterion criterion = Criterion::bic;
  int max_terms = 0;  ///< >= 0; 0: as many as there are features
};
void validate(const StepwiseOptions& options);
/// From the empty model, adds or drops the feature that lowers the criterion most, until none does (Efroymson 1960).
Fit stepwise(const Statistic& data, const StepwiseOptions& options = {}, std::span<const Constraint> constraints = {});

struct BestSubsetOptions {
  int terms = 0;  ///< >= 0; 0: by the criterion over all sizes
  Criterion criterion = Criterion::bic;
  long max_nodes = 2000000;  ///< >= 1: of the search tree
};
void validate(const BestSubsetOptions& options);
/// The best model of each size, among all subsets: branch and bound over the tree of dropped features (Furnival &
/// Wilson 1974, Technometrics 16, 499; Gatu & Kontoghiorghes 2006, J. Comput. Graph. Stat. 15, 139). At most 30
/// features. Constraints hold in every model; the bound is the sum of squares without them.
Fit best_subset(const Statistic& data, const BestSubsetOptions& options = {},
                std::span<const Constraint> constraints = {});

struct SpikeSlabOptions {
  double prior = 0.5;      ///< 0 < prior < 1: probability of each feature before the data
  double cut = 0.5;        ///< 0 < cut < 1: features of at least this inclusion probability make the model reported
  int sweeps = 2000;       ///< >= 1: of the Gibbs sampler over the features; a tenth more goes before
  std::uint64_t seed = 1;  ///< of the sampler
};
void validate(const SpikeSlabOptions& options);
/// Bayesian selection by a spike at 0 and a slab: Zellner's prior with g = rows (the information of one row) for the
/// coefficients of a model, 1/sigma for the noise. The probability of a model is then a closed form in its residual sum
/// of squares. Up to 15 features all models are summed; beyond, Gibbs sampling (George & McCulloch 1997, Stat. Sinica
/// 7, 339). Reports the median probability model (Barbieri & Berger 2004, Ann. Stat. 32, 870), by least squares. Rows
/// count as independent. Refuses constraints other than fixed coefficients.
Fit spike_slab(const Statistic& data, const SpikeSlabOptions& options = {},
               std::span<const Constraint> constraints = {});

struct LeastSquaresOptions {};
struct NonNegativeOptions {};
/// The solvers that need nothing but statistics.
using StatisticSolver = std::variant<LeastSquaresOptions, RidgeOptions, StlsqOptions, LassoOptions, NonNegativeOptions,
                                     Sr3Options, FrolsOptions, StepwiseOptions, BestSubsetOptions, SpikeSlabOptions>;
void validate(const StatisticSolver& solver);
/// Solves by any of them. `blocks`: of time, for cross-validation; `path` receives a lasso's path where it makes one.
Fit solve(std::span<const Statistic> blocks, const StatisticSolver& solver,
          std::span<const Constraint> constraints = {}, std::vector<PathPoint>* path = nullptr);

struct BaggingOptions {
  StatisticSolver solver = StlsqOptions{};  ///< of each member
  int members = 100;                        ///< >= 2
  double features = 1;                      ///< 0 < features <= 1: share of the features that a member sees
  double inclusion = 0.5;                   ///< 0 < inclusion <= 1: least share of members that keep a feature
  std::uint64_t seed = 1;
};
void validate(const BaggingOptions& options);
/// Bagging (Fasel, Kutz, Brunton & Brunton 2022, Proc. R. Soc. A 478, 20210904): each member sees blocks of time drawn
/// with replacement and some of the features; a feature's inclusion probability is the share of the members that saw it
/// and kept it. What reaches `inclusion` is refitted by least squares on all rows. Features that the constraints need
/// are seen by all. Needs at least 3 blocks.
Fit ensemble(std::span<const Statistic> blocks, const BaggingOptions& options,
             std::span<const Constraint> constraints = {});

/// Total least squares: the least change of features and target, in units of their noise, that makes an exact equation
/// of them (generalised: Van Huffel & Vandewalle 1989, SIAM J. Matrix Anal. 10, 294). `noise`: any rows x (features +
/// 1), noise' noise the sum over the data's rows of the covariances of the errors of [features, target]; a feature
/// whose column is 0 is exact. Covariance to first order in the noise. Refuses constraints other than fixed
/// coefficients.
Fit total_least_squares(const Statistic& data, const Eigen::MatrixXd& noise,
                        std::span<const Constraint> constraints = {});

/// Instrumental variables, by two-stage least squares (Theil 1953; of machines in closed loops: Janot, Vandanjon &
/// Gautier 2014, IEEE Trans. Control Syst. Technol. 22, 132): features and target are projected on the instruments,
/// whose errors are independent of theirs, so that noise in the features leaves no bias. `data`: of the `features`
/// first, then the instruments; those that are combinations of others are left out. Scores are those of the equation
/// error. Throws InputError where the instruments do not tell the coefficients apart. Refuses constraints other than
/// fixed coefficients.
Fit instrumental_variables(const Statistic& data, int features, std::span<const Constraint> constraints = {});

/// Intervals by resampling blocks of time with replacement (Carlstein 1986, Ann. Stat. 14, 1171) on the features that
/// the fit kept, under its constraints. Works on the blocks' statistics: each replicate costs a sum of small matrices.
struct Bootstrap {
  Eigen::VectorXd std, lower, upper;  ///< NaN where fewer than 95 % of the replicates could be solved
  int replicates = 0;
};
/// `replicates` >= 20; at least 3 blocks.
Bootstrap bootstrap(std::span<const Statistic> blocks, std::span<const Constraint> constraints, const Fit& fit,
                    int replicates, std::uint64_t seed = 1);

}  // namespace lunid
