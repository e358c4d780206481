#include "regress/dispatch.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "regress/reduce.hpp"
#include "regress/subset.hpp"

namespace lunid::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// d feature / d channel for all features and the target, as a statistic of each record: its factor's Gram matrix is
/// the sum over the rows of the products of the slopes.
MatrixXd slopes(const Data& data, Expr channel, std::size_t record) {
  std::vector<Expr> slope;
  std::vector<std::string> names;
  for (const Expr& f : data.features) {
    slope.push_back(derivative(f, channel));
    names.push_back(std::to_string(names.size()));
  }
  const Columns columns(slope, derivative(data.target, channel), names);
  std::vector<TimeBlock> blocks;
  for (const TimeBlock& block : data.pass.blocks)
    if (block.record == record) blocks.push_back(block);
  return merged(statistics(columns, data.pass.records, blocks, columns.values(*data.values), data.pass.threads))
      .factor()
      .cast<double>();
}

/// Root of the covariances of the errors of features and target, to first order in the noise of the channels.
MatrixXd noise_root(const Data& data, const TotalOptions& options) {
  std::vector<Expr> all = data.features, channels;
  all.push_back(data.target);
  for (const Expr& f : all)
    for (const Expr& s : symbols(f, SymbolKind::channel))
      if (std::find(channels.begin(), channels.end(), s) == channels.end()) channels.push_back(s);
  for (const auto& [name, noise] : options.noise) {
    const auto is = [&](const Expr& s) { return s.name() == name; };
    if (std::none_of(channels.begin(), channels.end(), is))
      throw InputError("total_least_squares: noise: the channel '" + name + "' is in no feature");
    if (!(noise >= 0) || std::isinf(noise))
      throw InputError("total_least_squares: noise: " + name + ": expected >= 0, got " + std::to_string(noise));
  }
  const Index n = static_cast<Index>(data.features.size());
  MatrixXd root = MatrixXd::Zero(n + 1, n + 1);
  for (std::size_t r = 0; r < data.pass.records.size(); ++r)
    for (const Expr& channel : channels) {
      const Stream& record = data.pass.records[r];
      double noise = 0;
      if (options.noise.count(channel.name()))
        noise = options.noise.at(channel.name());
      else if (options.noise.empty() && record.has(channel.name()))
        noise = record.channel(channel.name()).noise;
      if (noise == 0) continue;
      MatrixXd block = noise * slopes(data, channel, r);
      triangularise(root, block);
    }
  if (root.norm() == 0)
    throw InputError(
        "total_least_squares: no channel of the features has noise: give it, noise = { y = ... }, or take "
        "least_squares");
  return root;
}

/// The statistics of features and instruments.
std::vector<Statistic> with_instruments(const Data& data, const InstrumentOptions& options) {
  std::vector<Expr> all = data.features;
  std::vector<std::string> names = data.pass.columns.names();
  for (const Expr& instrument : options.instruments) {
    for (const Expr& s : symbols(instrument, SymbolKind::parameter))
      if (!data.values->count(s.name()))
        throw InputError("instrumental_variables: parameter '" + s.name() + "' in instrument '" + to_text(instrument) +
                         "' has no value: fix it");
    all.push_back(instrument);
    names.push_back("instrument " + std::to_string(all.size() - data.features.size()));
  }
  const Columns columns(all, data.target, names);
  return statistics(columns, data.pass.records, data.pass.blocks, columns.values(*data.values), data.pass.threads);
}

/// Least squares on the features that are not 0.
std::function<VectorXd(const Statistic&)> refit(const Fit& fit, const std::vector<Constraint>& constraints) {
  std::vector<bool> zero(static_cast<std::size_t>(fit.coefficients.size()));
  for (std::size_t j = 0; j < zero.size(); ++j) zero[j] = fit.coefficients[static_cast<Index>(j)] == 0;
  return [zero, constraints](const Statistic& data) {
    const std::vector<bool> out = admissible(zero, data, constraints);
    const Problem problem = reduce(data, constraints, out);
    return expand(problem, solve(problem, data, constraints).u);
  };
}

struct Solver {
  const Data& data;
  std::vector<Constraint> constraints;

  Solved operator()(const BaggingOptions& options) const {
    return finished({ensemble(data.parts, options, constraints), {}, {}, {}, {}, {}});
  }
  Solved operator()(const TotalOptions& options) const {
    need_rows("total_least_squares");
    const MatrixXd noise = noise_root(data, options);
    Solved out{total_least_squares(merged(data.parts), noise, constraints), {}, {}, {}, {}, {}};
    out = finished(std::move(out));
    out.again = [noise, all = constraints](const Statistic& rest) {
      return total_least_squares(rest, noise, all).coefficients;
    };
    return out;
  }
  Solved operator()(const InstrumentOptions& options) const {
    need_rows("instrumental_variables");
    const int features = static_cast<int>(data.features.size());
    Solved out;
    out.parts = with_instruments(data, options);
    out.constraints = constraints;
    const auto fit = [features, all = constraints](const Statistic& rows) {
      return instrumental_variables(rows, features, all);
    };
    out.fit = fit(merged(out.parts));
    out.again = [fit, features](const Statistic& rest) -> VectorXd {
      try {
        return fit(rest).coefficients;
      } catch (const InputError&) {  // without a block the instruments may not tell them apart
        return VectorXd::Constant(features, std::nan(""));
      }
    };
    return out;
  }
  Solved operator()(const HuberOptions& options) const {
    need_rows("huber");
    Solved out;
    out.fit = huber(data.pass, data.parts, options, constraints, out.parts, out.outliers);
    return finished(std::move(out));
  }
  template <class Options>
  Solved operator()(const Options& options) const {
    Solved out;
    out.fit = lunid::solve(data.parts, StatisticSolver(options), constraints, &out.path);
    return finished(std::move(out));
  }

 private:
  void need_rows(const char* name) const {
    if (data.weak)
      throw InputError(std::string(name) +
                       ": needs the rows of the record, the weak form has integrals: take another "
                       "solver, or leave weak_form out");
  }
  Solved finished(Solved out) const {
    if (out.parts.empty()) out.parts.assign(data.parts.begin(), data.parts.end());
    out.constraints = constraints;
    out.again = refit(out.fit, constraints);
    return out;
  }
};

/// All ways to leave out all but `most` of `count`.
std::vector<std::vector<int>> left_out(int count, int most) {
  std::vector<std::vector<int>> out;
  std::vector<bool> keep(static_cast<std::size_t>(count), false);
  std::fill(keep.begin(), keep.begin() + most, true);
  do {
    out.emplace_back();
    for (int k = 0; k < count; ++k)
      if (!keep[static_cast<std::size_t>(k)]) out.back().push_back(k);
  } while (std::prev_permutation(keep.begin(), keep.end()));
  return out;
}

/// The constraints of every choice of the groups.
std::vector<std::vector<Constraint>> alternatives(std::span<const Constraint> constraints,
                                                  std::span<const Choice> groups) {
  constexpr std::size_t kMost = 1000;
  std::vector<std::vector<Constraint>> out = {{constraints.begin(), constraints.end()}};
  for (const Choice& group : groups) {
    const int count = static_cast<int>(group.features.size());
    if (group.at_most >= count) continue;
    if (count > 20) throw InputError("group: expected at most 20 features, got " + std::to_string(count), group.where);
    std::vector<std::vector<Constraint>> next;
    const auto choices = left_out(count, group.at_most);
    if (out.size() * choices.size() > kMost)
      throw InputError("group: the groups make " + std::to_string(out.size() * choices.size()) +
                           " choices or more, of which each is tried: expected at most " + std::to_string(kMost),
                       group.where);
    for (const auto& before : out)
      for (const auto& choice : choices) {
        next.push_back(before);
        for (const int k : choice) {
          next.back().push_back(fixed(group.features[static_cast<std::size_t>(k)], 0));
          next.back().back().where = group.where;
        }
      }
    out = std::move(next);
  }
  return out;
}

double score(const Fit& fit) {
  const double rows = static_cast<double>(fit.rows), rss = fit.rmse * fit.rmse * rows;
  return information(true, rows, rss, rows, static_cast<int>((fit.coefficients.array() != 0).count()));
}

}  // namespace

Solved solve(const RegressionSolver& solver, const Data& data, std::span<const Constraint> constraints,
             std::span<const Choice> groups) {
  Solved best;
  double least = std::numeric_limits<double>::infinity();
  std::exception_ptr fault;
  const auto all = alternatives(constraints, groups);
  for (const auto& each : all) {
    try {
      Solved solved = std::visit(Solver{data, each}, solver);
      const double value = score(solved.fit);
      if (!best.again || value < least) {
        least = value;
        best = std::move(solved);
      }
    } catch (const InputError&) {  // a choice against the constraints; all of them are a fault
      if (!fault) fault = std::current_exception();
    }
  }
  if (!best.again) std::rethrow_exception(fault);
  if (all.size() > 1) best.fit.summary.solver += ", best of " + std::to_string(all.size()) + " choices of the groups";
  return best;
}

}  // namespace lunid::detail
