#include "simulate/fit_problem.hpp"

#include <Eigen/Eigenvalues>

#include "expr/joined.hpp"
#include "simulate/measures.hpp"

namespace lunid {

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m, double tolerance) {
  if (m.rows() == 0) return m;
  Eigen::VectorXd scale = m.diagonal().cwiseMax(0).cwiseSqrt();
  for (auto& s : scale) s = s > 0 ? 1 / s : 0;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * m * scale.asDiagonal();
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::VectorXd inverse = eigen.eigenvalues();
  const double largest = inverse.cwiseAbs().maxCoeff();
  for (auto& value : inverse) value = value > tolerance * largest ? 1 / value : 0;
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

double spread_of(std::span<const double> x) {
  const Eigen::Map<const Eigen::ArrayXd> values(x.data(), static_cast<Eigen::Index>(x.size()));
  return std::sqrt((values - values.mean()).square().mean());
}

void hold_anchored(const Model& model, const FitSegment& segment, Eigen::Ref<Eigen::MatrixXd> slopes) {
  if (!segment.anchored) return;
  const auto states = static_cast<Eigen::Index>(model.states.size());
  for (Eigen::Index i = 0; i < states; ++i)
    if (model.states[static_cast<std::size_t>(i)].anchored) slopes.col(slopes.cols() - states + i).setZero();
}

std::vector<Output> outputs_of(const Model& model, const Record& record, const std::vector<std::string>& channels) {
  std::vector<Output> outputs;
  if (model.imposed_motion) return outputs;
  std::string wanted;
  for (int i = 0; channels.empty() && i < model.degrees(); ++i) {
    const std::string y = model.channel('y', i);
    append_item(wanted, y);
    if (record.has(y)) outputs.push_back({measured_channel(record, y.substr(1)), 1});
  }
  for (const std::string& channel : channels) {
    if (!is_shown(model, channel))
      throw InputError(
          "fit_trajectory: channels: expected displacements, velocities or accelerations of the model, "
          "got '" +
          channel + "'");
    append_item(wanted, channel);
    if (!record.has(channel))
      throw InputError("fit_trajectory: the record " + record.name() + " has no channel '" + channel + "'");
    outputs.push_back({channel, 1});
  }
  if (outputs.empty())
    throw InputError("fit_trajectory: the record " + record.name() + " has none of the channels " + wanted);
  const auto noise = [&](const Output& o) { return record.channel(o.channel).noise; };
  for (Output& o : outputs) {
    const bool known = noise(o) > 0 && noise(outputs[0]) > 0;
    o.weight = known ? noise(outputs[0]) / noise(o)
                     : spread_of(record[outputs[0].channel]) / std::max(spread_of(record[o.channel]), 1e-300);
  }
  outputs[0].weight = 1;
  return outputs;
}

std::vector<FittedChannel> fitted_channels(const Model& model, const Record& record) {
  std::vector<FittedChannel> out;
  for (const Output& o : outputs_of(model, record, {})) out.push_back({o.channel, o.weight});
  return out;
}

Eigen::VectorXd acting_forces(const Model& model, const Record& record) {
  const Eigen::Index rows = record.rows();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(rows * model.degrees());
  for (int i = 0; i < model.degrees(); ++i) {
    const std::string channel = model.channel('F', i);
    const bool driven =
        model.driven.empty() || std::find(model.driven.begin(), model.driven.end(), i) != model.driven.end();
    if (model.degrees() == 1 || (driven && record.has(channel)))
      out.segment(i * rows, rows) = Eigen::Map<const Eigen::VectorXd>(record[channel].data(), rows);
  }
  return out;
}

void whiten(const Eigen::VectorXd& column, const std::vector<std::uint8_t>& use, const Whitening& whitening,
            Eigen::VectorXd& out) {
  if (whitening.average == 1 && whitening.ar.empty()) {
    out = column;
    for (Eigen::Index i = 0; i < out.size(); ++i)
      if (!use.empty() && !use[static_cast<std::size_t>(i)]) out[i] = 0;
    return;
  }
  const Eigen::Index average = whitening.average, rows = column.size() / average;
  const auto order = static_cast<Eigen::Index>(whitening.ar.size());
  Eigen::VectorXd mean(rows);
  std::vector<std::uint8_t> keep(static_cast<std::size_t>(rows), 1);
  for (Eigen::Index i = 0; i < rows; ++i) {
    mean[i] = column.segment(i * average, average).mean();
    for (Eigen::Index j = 0; j < average && !use.empty(); ++j)
      if (!use[static_cast<std::size_t>(i * average + j)]) keep[static_cast<std::size_t>(i)] = 0;
  }
  out.setZero(rows);
  Eigen::Index history = 0;  // rows in use without a break before this one
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (!keep[static_cast<std::size_t>(i)]) {
      history = 0;
      continue;
    }
    if (history++ < order) continue;
    out[i] = mean[i];
    for (Eigen::Index j = 0; j < order; ++j) out[i] -= whitening.ar[static_cast<std::size_t>(j)] * mean[i - 1 - j];
  }
}

FitLayout::FitLayout(int parameters, int records, const std::vector<int>& separate)
    : parameters_(parameters), separate_(separate) {
  for (int i = 0; i < parameters; ++i) parameter_.push_back(i);
  for (int r = 1; r < records; ++r) parameter_.insert(parameter_.end(), separate.begin(), separate.end());
}

int FitLayout::place(int record, int parameter) const {
  const auto at = std::find(separate_.begin(), separate_.end(), parameter);
  if (record == 0 || at == separate_.end()) return parameter;
  return parameters_ + (record - 1) * static_cast<int>(separate_.size()) + static_cast<int>(at - separate_.begin());
}

Eigen::VectorXd FitLayout::of_record(const Eigen::VectorXd& theta, int record) const {
  if (shared()) return theta;
  Eigen::VectorXd own(parameters_);
  for (int i = 0; i < parameters_; ++i) own[i] = theta[place(record, i)];
  return own;
}

Eigen::VectorXd FitLayout::expanded(const Eigen::VectorXd& theta) const {
  if (theta.size() == size()) return theta;
  Eigen::VectorXd all(size());
  for (int i = 0; i < size(); ++i) all[i] = theta[parameter(i)];
  return all;
}

}  // namespace lunid
