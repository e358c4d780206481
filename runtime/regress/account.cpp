#include "regress/account.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "record/parallel.hpp"
#include "regress/lag.hpp"
#include "regress/unit.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// 97.5 % point of Student's t (Abramowitz & Stegun 26.7.5; within 1 % from 2 degrees of freedom on).
double student(double freedom) {
  const double z = 1.959963984540054, z2 = z * z;
  const double g1 = z * (z2 + 1) / 4, g2 = z * (5 * z2 * z2 + 16 * z2 + 3) / 96;
  const double g3 = z * (3 * z2 * z2 * z2 + 19 * z2 * z2 + 17 * z2 - 15) / 384;
  const double g4 = z * (79 * z2 * z2 * z2 * z2 + 776 * z2 * z2 * z2 + 1482 * z2 * z2 - 1920 * z2 - 945) / 92160;
  return freedom > 0
             ? z + g1 / freedom + g2 / std::pow(freedom, 2) + g3 / std::pow(freedom, 3) + g4 / std::pow(freedom, 4)
             : std::nan("");
}

/// " (a at study.lua:9, y at study.lua:8)", or "".
std::string places_of(const RegressOptions& options, const Fit& fit, const Unexcited& unexcited) {
  if (options.places.empty()) return "";
  std::vector<int> all = {unexcited.feature};
  all.insert(all.end(), unexcited.of.begin(), unexcited.of.end());
  std::string text;
  for (const int j : all) {
    const std::string place = to_text(options.places[static_cast<std::size_t>(j)]);
    if (!place.empty()) append_item(text, fit.features[static_cast<std::size_t>(j)] + " at " + place);
  }
  return text.empty() ? "" : " (" + text + ")";
}

}  // namespace

void check_units(std::span<const Stream> records, const std::vector<Expr>& expressions) {
  for (const Expr& f : expressions)
    for (const Expr& s : symbols(f, SymbolKind::channel)) {
      const Stream* first = nullptr;
      for (const Stream& record : records) {
        if (!record.has(s.name()) || record.channel(s.name()).unit.empty()) continue;
        if (!first) first = &record;
        const std::string &one = first->channel(s.name()).unit, &other = record.channel(s.name()).unit;
        if (one != other)
          throw InputError("regress: '" + s.name() + "' is in " + one + " in " + first->name() + " and in " + other +
                               " in " + record.name() +
                               ": regress them one by one, or mend the units where they are read",
                           {}, Fault::data);
      }
    }
}

VectorXd block_deviations(const Solved& solved, int threads) {
  const Fit& fit = solved.fit;
  const Index n = fit.coefficients.size();
  const std::size_t count = solved.parts.size();
  const VectorXd none = VectorXd::Constant(n, std::nan(""));
  if (count < 3) return none;
  // All but part k is what comes before and what comes after it: three merges for each part.
  std::vector<Statistic> after(count + 1, Statistic(solved.parts.front().names())), before = after;
  parallel_for(2, threads, [&](int direction) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = direction == 0 ? i : count - 1 - i;
      const std::size_t from = direction == 0 ? k : k + 1, to = direction == 0 ? k + 1 : k;
      std::vector<Statistic>& sums = direction == 0 ? before : after;
      sums[to] = sums[from];
      sums[to].merge(solved.parts[k]);
    }
  });
  Eigen::MatrixXd left(n, static_cast<Index>(count));
  std::atomic<bool> excited = true;  // what the fit uses is not 0 without any one part
  parallel_for(static_cast<int>(count), threads, [&](int part) {
    const auto k = static_cast<std::size_t>(part);
    before[k].merge(after[k + 1]);
    if (((before[k].rms().head(n).array() == 0) && (fit.coefficients.array() != 0)).any())
      excited = false;
    else
      left.col(part) = solved.again(before[k]);
  });
  if (!excited) return none;
  const VectorXd mean = left.rowwise().mean();
  const double blocks = static_cast<double>(count);
  const VectorXd std = ((left.colwise() - mean).rowwise().squaredNorm() * ((blocks - 1) / blocks)).cwiseSqrt();
  constexpr double rounding = 1e-12;  // a coefficient that a bound holds in all of them does not vary
  return (std.array() > rounding * mean.array().abs()).select(std, 0);
}

namespace {

void add_intervals(Regression& result, const RegressOptions& options, const Solved& solved) {
  if (options.bootstrap > 0) {
    const Bootstrap drawn = bootstrap(solved.parts, solved.constraints, solved.fit, options.bootstrap, options.seed);
    for (std::size_t j = 0; j < result.terms.size(); ++j) {
      result.terms[j].block_std = drawn.std[static_cast<Index>(j)];
      result.terms[j].lower = drawn.lower[static_cast<Index>(j)];
      result.terms[j].upper = drawn.upper[static_cast<Index>(j)];
    }
    result.interval = "95 %, " + std::to_string(drawn.replicates) + " replicates of " +
                      std::to_string(solved.parts.size()) + " blocks";
    return;
  }
  const bool blocks = std::any_of(result.terms.begin(), result.terms.end(),
                                  [](const Term& term) { return std::isfinite(term.block_std) && term.block_std > 0; });
  const double freedom =
      blocks ? static_cast<double>(solved.parts.size()) - 1 : static_cast<double>(solved.fit.rows - solved.fit.free);
  for (Term& term : result.terms) {
    const double reach = student(freedom) * (blocks ? term.block_std : term.std);
    term.lower = term.coefficient - reach;
    term.upper = term.coefficient + reach;
  }
  result.interval = blocks ? "95 %, " + std::to_string(solved.parts.size()) + " blocks left out in turn"
                           : "95 %, the residual taken as white";
}

/// Unit of F over that of the feature.
std::string unit_of(Expr feature, const RegressOptions& options, const Stream& record) {
  const auto of_symbol = [&](Expr s) -> std::optional<Unit> {
    if (s.kind() == SymbolKind::parameter) {
      const auto found = options.units.find(s.name());
      return found == options.units.end() || found->second.empty() ? std::nullopt : read_unit(found->second);
    }
    const auto past = lag_of(s.name());
    const std::string name = past && !record.has(s.name()) ? past->channel : s.name();
    if (name == "t") return Unit{{"s", 1}};
    if (!record.has(name) || record.channel(name).unit.empty()) return std::nullopt;
    return read_unit(record.channel(name).unit);
  };
  const auto force = of_symbol(feature.pool().channel("F")), of = detail::unit_of(feature, of_symbol, options.numbers);
  return force && of ? to_text(quotient(*force, *of)) : "";
}

}  // namespace

void add_terms(Regression& result, const RegressOptions& options, const Solved& solved,
               std::span<const Stream> records) {
  const Fit& fit = solved.fit;
  const VectorXd block_std =
      options.bootstrap > 0 ? VectorXd::Zero(fit.coefficients.size()) : block_deviations(solved, options.threads);
  for (std::size_t j = 0; j < options.features.size(); ++j) {
    const Index i = static_cast<Index>(j);
    Term term;
    term.feature = options.features[j];
    term.coefficient = fit.coefficients[i];
    term.std = fit.std[i];
    term.block_std = block_std[i];
    term.contribution = fit.contribution[i];
    term.vif = fit.vif[i];
    term.inclusion = fit.inclusion.size() > 0 ? fit.inclusion[i] : std::nan("");
    term.unit = unit_of(term.feature, options, records.front());
    if (!options.places.empty()) term.where = options.places[j];
    result.terms.push_back(std::move(term));
  }
  add_intervals(result, options, solved);
}

std::string describe(const Stream& record) {
  return record.name() + ", " + number(record.start()) + " to " + number(record.start() + record.duration()) + " s, " +
         std::to_string(record.rows()) + " rows";
}

namespace {

/// A motion of one frequency, on which m a and k y are one.
void warn_of_one_frequency(std::vector<std::string>& out, std::span<const Stream> records,
                           const RegressOptions& options) {
  Pool& pool = options.features.front().pool();
  const Expr y = pool.channel("y"), a = pool.channel("a");
  const bool spring = std::find(options.features.begin(), options.features.end(), y) != options.features.end();
  const bool inertia = options.mass.valid() && !options.mass.is_constant(0);
  if (!spring || !inertia) return;
  for (const Stream& record : records)
    if (!record.has("y") || !record.has("a")) return;
  const auto blocks = time_blocks(records, 32, 1 << 14);
  const Statistic data = merged(statistics(Columns({y}, a), records, blocks, {}, options.threads));
  if (data.rms()[0] == 0) return;
  const Fit one = least_squares(data);
  if (one.r2 > 0.999)
    out.push_back("on these data a = " + number(one.coefficients[0], 4) + "*y (R2 " + number(one.r2) +
                  "): one frequency, so that an error of the mass appears in the coefficient of y");
}

}  // namespace

std::vector<std::string> warnings(const Regression& result, std::span<const Stream> records,
                                  const RegressOptions& options, int constant) {
  const Fit& fit = result.fit;
  std::vector<std::string> out;
  for (const Unexcited& u : fit.unexcited)
    out.push_back(u.text + places_of(options, fit, u) + ": they cannot be told apart, '" +
                  fit.features[static_cast<std::size_t>(u.feature)] + "' is left at 0");
  if (fit.condition > 1e8)
    out.push_back("the features are nearly one another's combinations (condition " + number(fit.condition, 2) +
                  "): few digits of the coefficients mean anything");
  if (constant >= 0 && !symbols(options.features[static_cast<std::size_t>(constant)]).empty())
    out.push_back("'" + fit.features[static_cast<std::size_t>(constant)] +
                  "' is constant on these rows: its coefficient is that of a constant force");
  warn_of_one_frequency(out, records, options);
  return out;
}

}  // namespace lunid::detail
