#pragma once
// Inside regress: lagged samples as the inputs of a tape.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "expr/tape.hpp"
#include "regress/history.hpp"

namespace lunid::detail {

/// A lagged signal: which, and how many steps back.
struct Lag {
  enum class Signal { output, input, error } signal;
  int steps;
};

/// The features of a history model over lagged samples, as one tape.
class HistoryRows {
 public:
  /// Throws InputError on a feature of anything but lagged samples.
  HistoryRows(std::vector<Expr> features, const HistoryOptions& options);

  Eigen::Index first() const { return first_; }  ///< first row with all its lags
  int features() const { return tape_.outputs(); }
  const std::vector<std::string>& names() const { return names_; }

  /// Features of row `k`: y, u and e hold at least the samples before it (u also row k itself).
  void at(const double* y, const double* u, const double* e, Eigen::Index k, double* out);
  /// Features of all rows from `from` on.
  Eigen::MatrixXd all(const Eigen::VectorXd& y, const Eigen::VectorXd& u, const Eigen::VectorXd& e,
                      Eigen::Index from) const;

 private:
  std::vector<Lag> lags_;
  std::vector<std::string> names_;
  Tape tape_;
  std::vector<double> in_, scratch_;
  Eigen::Index first_ = 0;
};

/// Channels of a record as vectors. Throws InputError where one is absent or holds a value that is not finite.
struct HistorySignals {
  Eigen::VectorXd y, u;
};
HistorySignals signals_of(const Record& record, const HistoryOptions& options);

/// One-step prediction errors over a record; the rows before the first prediction are 0.
Eigen::VectorXd innovations(HistoryRows& rows, const Eigen::VectorXd& coefficients, const HistorySignals& signals);

}  // namespace lunid::detail
