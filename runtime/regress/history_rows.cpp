#include "regress/history_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// "F_3" of input F is three steps back. Throws InputError for any other symbol.
Lag lag_of(const std::string& name, const HistoryOptions& options) {
  const auto under = name.rfind('_');
  const std::string signal = name.substr(0, under);
  const bool counted = under != std::string::npos && under + 1 < name.size() &&
                       name.find_first_not_of("0123456789", under + 1) == std::string::npos;
  const int steps = counted ? std::atoi(name.c_str() + under + 1) : -1;
  if (counted && signal == options.output && steps > 0) return {Lag::Signal::output, steps};
  if (counted && signal == options.input) return {Lag::Signal::input, steps};
  if (counted && signal == "e" && steps > 0) return {Lag::Signal::error, steps};
  throw InputError("history model: feature of '" + name + "': expected " + options.output + "_1 ... (past outputs), " +
                   options.input + "_0 ... (inputs) or e_1 ... (past errors)");
}

}  // namespace

HistoryRows::HistoryRows(std::vector<Expr> features, const HistoryOptions& options) {
  std::vector<Expr> inputs;
  for (const Expr& f : features) {
    names_.push_back(to_text(f));
    for (const Expr& s : symbols(f))
      if (std::find(inputs.begin(), inputs.end(), s) == inputs.end()) inputs.push_back(s);
  }
  for (const Expr& s : inputs) {
    lags_.push_back(lag_of(s.name(), options));
    first_ = std::max<Index>(first_, lags_.back().steps);
  }
  tape_ = Tape(features, inputs);
  in_.resize(inputs.size());
  scratch_.resize(static_cast<std::size_t>(tape_.registers()));
}

void HistoryRows::at(const double* y, const double* u, const double* e, Index k, double* out) {
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    const double* from = lags_[i].signal == Lag::Signal::output ? y : lags_[i].signal == Lag::Signal::input ? u : e;
    in_[i] = from[k - lags_[i].steps];
  }
  tape_.run_point(in_.data(), out, scratch_.data());
}

MatrixXd HistoryRows::all(const VectorXd& y, const VectorXd& u, const VectorXd& e, Index from) const {
  const Index rows = y.size() - from;
  MatrixXd out(rows, features());
  std::vector<const double*> in;
  for (const Lag& lag : lags_) {
    const VectorXd& signal = lag.signal == Lag::Signal::output ? y : lag.signal == Lag::Signal::input ? u : e;
    in.push_back(signal.data() + from - lag.steps);
  }
  const std::vector<int> stride(in.size(), 1);
  std::vector<double*> columns;
  for (Index j = 0; j < out.cols(); ++j) columns.push_back(out.col(j).data());
  tape_.run_columns(in, stride, static_cast<std::size_t>(rows), columns);
  return out;
}

HistorySignals signals_of(const Record& record, const HistoryOptions& options) {
  const auto column = [&](const std::string& name) {
    const auto values = record[name];
    const VectorXd out = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
    if (!out.allFinite())
      throw InputError(
          "history model: channel '" + name + "' of " + record.name() + " holds a value that is not finite", {},
          Fault::data);
    return out;
  };
  return {column(options.output), column(options.input)};
}

VectorXd innovations(HistoryRows& rows, const VectorXd& coefficients, const HistorySignals& signals) {
  VectorXd e = VectorXd::Zero(signals.y.size()), features(rows.features());
  for (Index k = rows.first(); k < e.size(); ++k) {
    rows.at(signals.y.data(), signals.u.data(), e.data(), k, features.data());
    e[k] = signals.y[k] - features.dot(coefficients);
  }
  return e;
}

}  // namespace lunid::detail
