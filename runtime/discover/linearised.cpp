#include "discover/linearised.hpp"

#include "discover/judge.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// d model / d (theta, first state) of a record; empty where it cannot be run.
MatrixXd slopes(const Study& study, const System& system, const VectorXd& theta, const FitResult& at,
                std::size_t record) {
  const FitData& data = study.train[record];
  const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
  MatrixXd jacobian;
  if (study.imposed) {
    imposed_force(system, values, data.record, &jacobian);
    return jacobian;
  }
  VectorXd x0 = VectorXd::Zero(system.states());
  const VectorXd& fitted = at.segments[record].x0;
  x0.head(fitted.size()) = fitted;
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = at.substeps;
  options.cancelled = study.options->cancelled;
  const auto run = simulate_sensitivities(system, values, data.excitation, x0, options);
  if (!run.run.summary.completed) return {};
  return shown_slopes(system, values, data.excitation, run, study.output()).leftCols(theta.size() + fitted.size());
}

}  // namespace

bool linearise(const Study& study, const System& system, const VectorXd& theta, const FitResult& at,
               const Whitening& whitening, Linearised& out) {
  std::vector<MatrixXd> parts;
  std::vector<VectorXd> residual;
  Index rows = 0, columns = theta.size();
  out.row_of_record.clear();
  for (std::size_t r = 0; r < study.train.size(); ++r) {
    const MatrixXd jacobian = slopes(study, system, theta, at, r);
    if (jacobian.size() == 0 || !jacobian.allFinite()) return false;
    VectorXd column;
    whiten(at.residual[r], {}, whitening, column);
    residual.push_back(column);
    MatrixXd whitened(column.size(), jacobian.cols());
    for (Index j = 0; j < jacobian.cols(); ++j) {
      whiten(jacobian.col(j), {}, whitening, column);
      whitened.col(j) = column;
    }
    out.row_of_record.push_back(rows);
    rows += whitened.rows();
    columns += whitened.cols() - theta.size();
    parts.push_back(std::move(whitened));
  }
  out.row_of_record.push_back(rows);
  out.residual.resize(rows);
  out.columns.setZero(rows, columns);
  Index state = theta.size();
  for (std::size_t r = 0; r < parts.size(); ++r) {
    const Index first = out.row_of_record[r], n = parts[r].rows(), states = parts[r].cols() - theta.size();
    out.residual.segment(first, n) = residual[r];
    out.columns.block(first, 0, n, theta.size()) = parts[r].leftCols(theta.size());
    out.columns.block(first, state, n, states) = parts[r].rightCols(states);
    state += states;
  }
  return true;
}

void hold_and_scale(const Model& model, const FitResult& fit, MatrixXd& columns) {
  for (std::size_t j = 0; j < model.parameters.size(); ++j)
    if (model.parameters[j].fixed || (j < fit.at_bound.size() && fit.at_bound[j]))
      columns.col(static_cast<Index>(j)).setZero();
  for (Index j = 0; j < columns.cols(); ++j)
    if (const double norm = columns.col(j).norm(); norm > 0) columns.col(j) /= norm;
}

}  // namespace lunid
