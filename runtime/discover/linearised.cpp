#include "discover/linearised.hpp"

#include <Eigen/QR>
#include <cmath>

#include "discover/judge.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// d model / d (theta, first state) of each output of a record, weighted; none where it cannot be run.
std::vector<MatrixXd> slopes(const Study& study, const System& system, const VectorXd& theta, const FitResult& at,
                             std::size_t record) {
  const FitData& data = study.train[record];
  const std::span<const double> values = view(theta);
  if (study.imposed) {
    std::vector<MatrixXd> out(1);
    imposed_force(system, values, data.record, &out[0]);
    return out;
  }
  VectorXd x0 = VectorXd::Zero(system.states());
  const VectorXd& fitted = at.segments[record].x0;
  x0.head(fitted.size()) = fitted;
  const auto run = simulate_sensitivities(system, values, data.excitation, x0, steps_of(study, at));
  if (!run.run.summary.completed) return {};
  std::vector<MatrixXd> out;
  const std::vector<double> weights = study.weights(data.record);
  for (const std::string& output : study.outputs()) {
    MatrixXd all = weights[out.size()] * shown_slopes(system, values, data.excitation, run, output);
    hold_anchored(system.model(), at.segments[record], all);
    out.push_back(all.leftCols(theta.size() + fitted.size()));
  }
  return out;
}

double misfit(const MatrixXd& columns, const VectorXd& residual, Index& rank) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  qr.setThreshold(1e-7);
  rank = qr.rank();
  const VectorXd rest = qr.householderQ().adjoint() * residual;
  return rest.tail(rest.size() - rank).squaredNorm();
}

}  // namespace

bool linearise(const Study& study, const System& system, const VectorXd& theta, const FitResult& at,
               const Whitening& whitening, Linearised& out) {
  const std::size_t records = study.train.size();
  std::vector<MatrixXd> parts(at.residual.size());
  std::vector<VectorXd> residual(at.residual.size());
  out.state_of_record.clear();
  Index rows = 0, columns = theta.size();
  for (std::size_t r = 0; r < records; ++r) {
    const std::vector<MatrixXd> jacobians = slopes(study, system, theta, at, r);
    if (jacobians.empty()) return false;
    for (std::size_t c = 0; c < jacobians.size(); ++c) {
      const MatrixXd& jacobian = jacobians[c];
      if (jacobian.size() == 0 || !jacobian.allFinite()) return false;
      VectorXd column;
      MatrixXd& whitened = parts[c * records + r];
      whiten(at.residual[c * records + r], {}, whitening, column);
      residual[c * records + r] = column;
      whitened.resize(column.size(), jacobian.cols());
      for (Index j = 0; j < jacobian.cols(); ++j) {
        whiten(jacobian.col(j), {}, whitening, column);
        whitened.col(j) = column;
      }
    }
    out.state_of_record.push_back(columns);
    columns += parts[r].cols() - theta.size();
  }
  out.state_of_record.push_back(columns);
  out.row_of_record.clear();
  for (const MatrixXd& part : parts) {
    out.row_of_record.push_back(rows);
    rows += part.rows();
  }
  out.row_of_record.push_back(rows);
  out.residual.resize(rows);
  out.columns.setZero(rows, columns);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const Index first = out.row_of_record[s], n = parts[s].rows(), states = parts[s].cols() - theta.size();
    out.residual.segment(first, n) = residual[s];
    out.columns.block(first, 0, n, theta.size()) = parts[s].leftCols(theta.size());
    out.columns.block(first, out.state_of_record[s % records], n, states) = parts[s].rightCols(states);
  }
  return true;
}

void project_first_states(Linearised& linear) {
  const std::size_t records = linear.state_of_record.size() - 1;
  const Index parameters = linear.state_of_record.front();
  MatrixXd all(linear.residual.size(), parameters + 1);  // the residual behind the columns
  all << linear.columns.leftCols(parameters), linear.residual;
  for (std::size_t r = 0; r < records; ++r) {
    const Index first = linear.state_of_record[r], count = linear.state_of_record[r + 1] - first;
    std::vector<Index> rows;
    for (std::size_t s = r; s + 1 < linear.row_of_record.size(); s += records)
      for (Index i = linear.row_of_record[s]; i < linear.row_of_record[s + 1]; ++i) rows.push_back(i);
    if (count == 0 || rows.empty()) continue;
    Eigen::ColPivHouseholderQR<MatrixXd> qr(linear.columns(rows, Eigen::seqN(first, count)));
    qr.setThreshold(1e-7);
    MatrixXd turned = qr.householderQ().adjoint() * all(rows, Eigen::all);
    turned.topRows(qr.rank()).setZero();
    all(rows, Eigen::all) = qr.householderQ() * turned;
  }
  linear.columns = all.leftCols(parameters);
  linear.residual = all.rightCols(1);
  linear.state_of_record.assign(records + 1, parameters);
}

void hold_and_scale(const Model& model, const FitResult& fit, MatrixXd& columns) {
  for (std::size_t j = 0; j < model.parameters.size(); ++j)
    if (model.parameters[j].fixed || (j < fit.at_bound.size() && fit.at_bound[j]))
      columns.col(static_cast<Index>(j)).setZero();
  for (Index j = 0; j < columns.cols(); ++j)
    if (const double norm = columns.col(j).norm(); norm > 0) columns.col(j) /= norm;
}

MotionGain gain_on_motion(const Study& study, const Whitening& whitening, const Candidate& before,
                          const Candidate& candidate, VectorXd theta) {
  MotionGain out;
  const Index known = before.parameters(), p = candidate.parameters();
  theta.head(known) = before.fit.theta;
  for (Index j = known; j < p; ++j)
    if (candidate.linear[static_cast<std::size_t>(j)]) theta[j] = 0;
  Linearised linear;
  if (!linearise(study, *candidate.system, theta, before.fit, whitening, linear)) {
    out.remark = "the model with it cannot be run from the first guess";
    return out;
  }
  hold_and_scale(before.system->model(), before.fit, linear.columns);
  MatrixXd own(linear.columns.rows(), linear.columns.cols() - (p - known));
  own << linear.columns.leftCols(known), linear.columns.rightCols(linear.columns.cols() - p);
  Index rank_own = 0, rank_all = 0;
  const double without = misfit(own, linear.residual, rank_own),
               with = misfit(linear.columns, linear.residual, rank_all);
  const auto added = static_cast<double>(rank_all - rank_own);
  const double freedom = static_cast<double>(linear.residual.size() - rank_all);
  if (added <= 0) {
    out.remark = "its effect on the motion is a combination of the baseline's own on these records";
    return out;
  }
  out.gain = 1 - std::sqrt(with / without);
  if (freedom > 0 && with > 0) out.p_value = f_tail((without - with) / added / (with / freedom), added, freedom);
  return out;
}

}  // namespace lunid
