#pragma once
// How good is a model on a measurement: every measure at once.
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "statistics/correlation.hpp"
#include "statistics/interval.hpp"
#include "statistics/lag_tests.hpp"

namespace lunid {

/// Columns of one length; those that may be absent are empty.
struct ComparedColumns {
  std::span<const double> measured, model;
  std::span<const double> measured_rate, model_rate;  ///< velocities, for the phase portrait
  std::span<const double> input;                      ///< what drove the motion, for the test of the residual
};

struct AgreementOptions {
  int neighbours = 3;      ///< of the mutual information
  int lags = 25;           ///< of the residual tests; cut to a quarter of the rows
  Eigen::Index band = -1;  ///< of the time warping, rows; < 0: none, and for more than 10000 rows 5e7 / rows
  double level = 0;        ///< of the intervals; 0: none
  int draws = 999;         ///< of the block bootstrap
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Absent: where it has no meaning, for a constant model or a residual that is 0.
struct Agreement {
  Eigen::Index rows = 0;
  double rmse = 0, nrmse = 0, r2 = 0, fit = 0;  ///< fit_measures.hpp
  std::optional<double> qqcc;                   ///< of the residual against a normal distribution
  std::optional<double> dtw;                    ///< of the phase portraits
  Eigen::Index band = -1;                       ///< that dtw was taken in
  std::optional<double> mutual_information;     ///< of measurement and model [nat]
  std::optional<Correlation> spearman, kendall;
  std::optional<LagTest> white;               ///< the residual's own past
  std::optional<TestResult> runs;             ///< signs of the residual
  std::optional<LagTest> follows;             ///< residual and input
  std::map<std::string, Interval> intervals;  ///< rmse nrmse r2 fit spearman kendall mutual_information
  Eigen::Index block_length = 1;              ///< of the intervals: what residual and measurement call for
};

/// Throws InputError as check_columns() does; at least 20 rows.
Agreement agreement(const ComparedColumns& columns, const AgreementOptions& options = {});

}  // namespace lunid
