// Free runs over rows that their model did not see.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "discover/gap.hpp"
#include "discover/judge.hpp"
#include "discover/linearised.hpp"

namespace lunid {

namespace {

std::span<const double> view(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// The rows of a record that belong to a part and may be left out: not the lead-in, where the first state is estimated.
bool left_out(const Study& study, const Record& record, Eigen::Index row, int part, int parts) {
  return row >= lead_in(record, study.omega) && part_of(row, record.rows(), parts) == part;
}

/// Residuals of free runs, per record; empty where one did not come to its end.
using Residuals = std::vector<Eigen::VectorXd>;

/// Of a model fitted again without a part.
Residuals refitted_without(const Study& study, const Candidate& candidate, int part, int parts) {
  std::vector<FitData> data = study.train;
  for (auto& d : data) {
    d.use.assign(static_cast<std::size_t>(d.record.rows()), 1);
    for (Eigen::Index i = 0; i < d.record.rows(); ++i)
      if (left_out(study, d.record, i, part, parts)) d.use[static_cast<std::size_t>(i)] = 0;
  }
  FitOptions options;
  options.max_iterations = 6;
  options.tolerance = 1e-4;
  options.substeps = candidate.fit.substeps;
  options.first_states = candidate.fit.segments;
  options.cancelled = study.options->cancelled;
  FitResult fit = fit_trajectory(*candidate.system, candidate.fit.theta, data, options);
  return std::isfinite(fit.cost) ? std::move(fit.residual) : Residuals{};
}

/// The same by one Gauss-Newton step from the fit of all rows, whose slopes serve for every part: near enough, since
/// leaving a part out moves the parameters by about a deviation. Each run is a real one.
class LeaveOut {
 public:
  LeaveOut(const Study& study, const Candidate& candidate, int parts)
      : study_(study), candidate_(candidate), parts_(parts) {
    possible_ = linearise(study, *candidate.system, candidate.fit.theta, candidate.fit, {}, linear_);
    if (!possible_) return;
    hold(candidate.system->model());
    length_ = linear_.columns.colwise().norm().transpose();
    for (auto& l : length_) l = l > 0 ? 1 / l : 0;
    const Eigen::Index size = linear_.columns.cols();
    whole_ = {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    for (int part = 0; part < parts; ++part) {
      parts_sums_.push_back(sums_of(part));
      whole_.gram += parts_sums_.back().gram;
      whole_.right += parts_sums_.back().right;
    }
    const Sums lead = sums_of(-1);
    whole_.gram += lead.gram;
    whole_.right += lead.right;
  }

  /// Empty where a run stops, or where the step does not lower the error of the rows that are kept.
  Residuals without(int part) const {
    if (!possible_) return {};
    const Sums& own = parts_sums_[static_cast<std::size_t>(part)];
    Eigen::MatrixXd gram = whole_.gram - own.gram;
    gram.diagonal().array() += ridge;
    const Eigen::VectorXd step = length_.asDiagonal() * gram.ldlt().solve(whole_.right - own.right);
    Residuals after = run(step);
    return !after.empty() && kept_squares(after, part) <= kept_squares(candidate_.fit.residual, part) ? after
                                                                                                     : Residuals{};
  }

 private:
  static constexpr double ridge = 1e-10;  ///< on columns of length one
  struct Sums {
    Eigen::MatrixXd gram;
    Eigen::VectorXd right;
  };

  void hold(const Model& model) {
    for (std::size_t j = 0; j < model.parameters.size(); ++j)
      if (model.parameters[j].fixed || (j < candidate_.fit.at_bound.size() && candidate_.fit.at_bound[j]))
        linear_.columns.col(static_cast<Eigen::Index>(j)).setZero();
  }

  /// Over the rows of a part; -1: over the lead-ins, which all keep.
  Sums sums_of(int part) const {
    std::vector<Eigen::Index> rows;
    for (std::size_t r = 0; r < study_.train.size(); ++r) {
      const Record& record = study_.train[r].record;
      const Eigen::Index lead = lead_in(record, study_.omega);
      for (Eigen::Index i = 0; i < record.rows(); ++i)
        if (part < 0 ? i < lead : left_out(study_, record, i, part, parts_))
          rows.push_back(linear_.row_of_record[r] + i);
    }
    const Eigen::MatrixXd columns = linear_.columns(rows, Eigen::all) * length_.asDiagonal();
    return {columns.transpose() * columns, columns.transpose() * linear_.residual(rows)};
  }

  Residuals run(const Eigen::VectorXd& step) const {
    const System& system = *candidate_.system;
    const auto& table = system.model().parameters;
    Eigen::VectorXd theta = candidate_.fit.theta;
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const auto& row = table[static_cast<std::size_t>(j)];
      theta[j] = std::clamp(theta[j] + step[j], row.min, row.max);
    }
    SimulateOptions options;
    options.solver = Solver::fixed;
    options.substeps = candidate_.fit.substeps;
    options.cancelled = study_.options->cancelled;
    Residuals out;
    Eigen::Index at = theta.size();
    for (std::size_t r = 0; r < study_.train.size(); ++r) {
      const FitData& data = study_.train[r];
      const auto measured = data.record[study_.output()];
      out.push_back(Eigen::Map<const Eigen::VectorXd>(measured.data(), data.record.rows()));
      if (study_.imposed) {
        out.back() -= imposed_force(system, view(theta), data.record);
        if (!out.back().allFinite()) return {};
        continue;
      }
      Eigen::VectorXd x0 = candidate_.fit.segments[r].x0;
      x0 += step.segment(at, x0.size());
      at += x0.size();
      const Run run = simulate(system, view(theta), data.excitation, x0, options);
      if (!run.summary.completed) return {};
      out.back() -= shown(system, view(theta), run, study_.output());
    }
    return out;
  }

  double kept_squares(const Residuals& residual, int part) const {
    double sum = 0;
    for (std::size_t r = 0; r < residual.size(); ++r)
      for (Eigen::Index i = 0; i < residual[r].size(); ++i)
        if (!left_out(study_, study_.train[r].record, i, part, parts_)) sum += residual[r][i] * residual[r][i];
    return sum;
  }

  const Study& study_;
  const Candidate& candidate_;
  const int parts_;
  bool possible_ = false;
  Linearised linear_;
  Eigen::VectorXd length_;
  Sums whole_;
  std::vector<Sums> parts_sums_;
};

}  // namespace

int part_of(Eigen::Index row, Eigen::Index rows, int parts) {
  constexpr Eigen::Index pieces = 3;
  return static_cast<int>((row * parts * pieces / rows) % parts);
}

void run_left_out(const Study& study, Candidate& candidate) {
  candidate.left_out_gap = INFINITY;
  if (!candidate.ran()) return;
  const int parts = study.options->blocks;
  const LeaveOut leave(study, candidate, parts);
  Residuals residual;
  for (const auto& data : study.train) residual.push_back(Eigen::VectorXd::Zero(data.record.rows()));
  for (int part = 0; part < parts; ++part) {
    Residuals own = leave.without(part);
    if (own.empty()) own = refitted_without(study, candidate, part, parts);
    if (own.empty()) return;
    for (std::size_t r = 0; r < own.size(); ++r)
      for (Eigen::Index i = 0; i < residual[r].size(); ++i)
        if (left_out(study, study.train[r].record, i, part, parts)) residual[r][i] = own[r][i];
  }
  candidate.left_out = join(residual);
  candidate.left_out_gap =
      std::sqrt(candidate.left_out.squaredNorm() / static_cast<double>(candidate.left_out.size())) /
      study.measured_std();
}

}  // namespace lunid
