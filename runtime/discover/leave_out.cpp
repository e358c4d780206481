// Free runs over rows that their model did not see.
#include <cmath>

#include "discover/gap.hpp"
#include "discover/judge.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

/// The rows of a record that belong to a part and may be left out: not the lead-in, where the first state is estimated.
/// Where there are as many records as parts, they are left out whole.
bool left_out(const Study& study, std::size_t r, Eigen::Index row, int part, int parts) {
  const Record& record = study.train[r].record;
  const int own =
      static_cast<int>(study.train.size()) >= parts ? static_cast<int>(r) % parts : part_of(row, record.rows(), parts);
  return own == part && row >= lead_in(study, record);
}

/// Residuals of free runs, as a fit has them; empty where one did not come to its end.
using Residuals = std::vector<Eigen::VectorXd>;

/// Of a model fitted again without a part.
Residuals refitted_without(const Study& study, const Candidate& candidate, int part, int parts) {
  std::vector<FitData> data = study.train;
  for (std::size_t r = 0; r < data.size(); ++r) {
    data[r].use.assign(static_cast<std::size_t>(data[r].record.rows()), 1);
    for (Eigen::Index i = 0; i < data[r].record.rows(); ++i)
      if (left_out(study, r, i, part, parts)) data[r].use[static_cast<std::size_t>(i)] = 0;
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

}  // namespace

int part_of(Eigen::Index row, Eigen::Index rows, int parts) {
  constexpr Eigen::Index pieces = 3;
  return static_cast<int>((row * parts * pieces / rows) % parts);
}

void run_left_out(const Study& study, Candidate& candidate) {
  candidate.left_out_gap = INFINITY;
  if (!candidate.ran()) return;
  const int parts = study.options->blocks;
  Residuals residual;
  const std::size_t records = study.train.size();
  for (const auto& known : candidate.fit.residual) residual.push_back(Eigen::VectorXd::Zero(known.size()));
  std::vector<Residuals> without(static_cast<std::size_t>(parts));
  parallel_for(parts, study.options->threads, [&](int part) {
    without[static_cast<std::size_t>(part)] = refitted_without(study, candidate, part, parts);
  });
  for (int part = 0; part < parts; ++part) {
    const Residuals& own = without[static_cast<std::size_t>(part)];
    if (own.empty()) return;
    for (std::size_t r = 0; r < own.size(); ++r)
      for (Eigen::Index i = 0; i < residual[r].size(); ++i)
        if (left_out(study, r % records, i, part, parts)) residual[r][i] = own[r][i];
  }
  for (std::size_t r = 0; r < residual.size(); ++r)
    residual[r] = residual[r].tail(residual[r].size() - lead_in(study, study.train[r % records].record)).eval();
  candidate.left_out = join(residual);
  candidate.left_out_gap =
      std::sqrt(candidate.left_out.squaredNorm() / static_cast<double>(candidate.left_out.size())) /
      study.measured_std();
}

}  // namespace lunid
