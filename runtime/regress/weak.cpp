#include "regress/weak.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "record/parallel.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void validate(const WeakForm& form) {
  if (!(form.half_width >= 0) || std::isinf(form.half_width))
    throw InputError("weak_form: half_width: expected >= 0, got " + exact_number(form.half_width));
  if (form.order < 3 || form.order > 16)
    throw InputError("weak_form: order: expected 3 to 16, got " + std::to_string(form.order));
  if (!(form.spacing > 0 && form.spacing <= 1))
    throw InputError("weak_form: spacing: expected > 0 and <= 1, got " + exact_number(form.spacing));
}

namespace detail {
namespace {

constexpr Index kLeast = 6;  // samples of a half width

/// The test function (derivative 0), or its derivatives, at the samples -h .. h, over its own integral.
VectorXd test_function(Index h, double dt, int order, int derivative) {
  VectorXd value(2 * h + 1);
  double integral = 0;
  const double width = dt * static_cast<double>(h), p = order;
  for (Index i = -h; i <= h; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(h), u = 1 - s * s;
    integral += std::pow(u, p) * dt;
    double f = std::pow(u, p);
    if (derivative == 1) f = -2 * p * s * std::pow(u, p - 1) / width;
    if (derivative == 2)
      f = (4 * p * (p - 1) * s * s * std::pow(u, p - 2) - 2 * p * std::pow(u, p - 1)) / (width * width);
    value[i + h] = f;
  }
  return value / integral;
}

/// How much a channel's noise weighs in the integral with a derivative of the test function; infinite where the channel
/// is missing or was itself derived.
double noise_of(const Stream& record, const char* channel, int derivative, double half_width, int order) {
  if (!record.has(channel) || record.channel(channel).derived) return std::numeric_limits<double>::infinity();
  const Index h = std::max<Index>(kLeast, std::lround(half_width / record.dt()));
  return std::max(record.channel(channel).noise, 1e-300) * test_function(h, record.dt(), order, derivative).norm();
}

/// G(y) with v*g(y) = dG/dt for a feature v*g(y) with g a number or a power of y; empty for any other.
Expr antiderivative(Expr feature) {
  Pool& pool = feature.pool();
  const Expr y = pool.channel("y"), v = pool.channel("v");
  const Expr slope = derivative(feature, v);
  if (!depends_on(feature, v) || depends_on(slope, v) || !(feature == slope * v || feature == v * slope)) return {};
  if (slope.is_constant()) return slope * y;
  if (slope == y) return 0.5 * pow(y, 2);
  if (slope.op() == Op::pow && slope.arguments()[0] == y && slope.arguments()[1].is_constant()) {
    const double n = slope.arguments()[1].value();
    if (n > 0) return pow(y, n + 1) / (n + 1);
  }
  return {};
}

double default_half_width(const Stream& stream, int order) {
  if (!stream.in_memory())
    throw InputError("weak_form: half_width: 0 takes it from the whole of a record, and " + stream.name() +
                     " is a stream: expected a width in seconds");
  const Record record = stream.read(0, stream.rows());
  const double fastest = 3 * dominant_frequency(record[record.has("y") ? "y" : "F"], record.dt());
  const double width = fastest > 0 ? 2 * std::sqrt(2.0 * order + 3) / fastest : 0;
  return std::clamp(width, static_cast<double>(kLeast) * record.dt(),
                    std::max(record.duration() / 16, 6 * record.dt()));
}

}  // namespace

WeakProblem weak_problem(const std::vector<Expr>& features, double mass, Expr known, std::span<const Stream> records,
                         const WeakForm& form) {
  const Stream& record = records.front();
  Pool& pool = features.front().pool();
  WeakProblem out;
  out.half_width = form.half_width > 0 ? form.half_width : default_half_width(record, form.order);
  const auto noise = [&](const char* channel, int k) {
    return noise_of(record, channel, k, out.half_width, form.order);
  };
  out.target.push_back({1, {0, pool.channel("F")}});
  if (known.valid()) out.target.push_back({-1, {0, known}});
  out.text = "weak form, T = " + number(out.half_width, 3) + " s";
  if (mass != 0) {
    const double from_y = noise("y", 2), from_v = noise("v", 1), from_a = noise("a", 0);
    const double least = std::min({from_y, from_v, from_a});
    const char* best = least == from_y ? "y" : least == from_v ? "v" : "a";
    out.target.push_back({-mass, {best[0] == 'y' ? 2 : best[0] == 'v' ? 1 : 0, pool.channel(best)}});
    out.text += best[0] == 'a' ? ", a as measured" : std::string(", a by parts from ") + best;
  }
  const auto derived = [&](const char* channel) { return record.has(channel) && record.channel(channel).derived; };
  for (const Expr& f : features) {
    const Expr whole = antiderivative(f);
    const bool by_parts = whole.valid() && noise("y", 1) < noise("v", 0);
    out.features.push_back(by_parts ? WeakTerm{1, whole} : WeakTerm{0, f});
    for (const char* channel : {"v", "a"})
      if (derived(channel) && depends_on(out.features.back().integrand, pool.channel(channel)))
        out.warnings.push_back("weak form: the feature '" + to_text(f) + "' holds " + channel +
                               ", which was derived from the data: it is not free of their derivative");
  }
  return out;
}

namespace {

/// The integrals as columns of one tape, and what each row of integrals needs of them.
struct Integrals {
  Columns columns;
  std::vector<int> derivative;  // of the test function, by column
  std::vector<double> values;
};

/// The rows of integrals whose centres lie in the samples [from, to) of a block.
void add_rows(Statistic& sum, const WeakProblem& problem, const Integrals& integrals, const Stream& record, Index first,
              Index count, const std::vector<VectorXd>& test, Index h, Index step) {
  const Index n = static_cast<Index>(problem.features.size()), all = static_cast<Index>(integrals.derivative.size());
  constexpr Index kCentres = 512;
  const Index centres = (count - 2 * h - 1) / step + 1;
  MatrixXd work, rows;
  for (Index at = 0; at < centres; at += kCentres) {
    const Index now = std::min(kCentres, centres - at);
    work.resize((now - 1) * step + 2 * h + 1, all + 2);
    const Index from = first + at * step;
    integrals.columns.fill(integrals.columns.load(record, from, work.rows()), from, integrals.values, work);
    rows.setZero(now, n + 2);
    for (Index j = 0; j < all; ++j) {
      const int k = integrals.derivative[static_cast<std::size_t>(j)];
      const double factor =
          (k == 1 ? -record.dt() : record.dt()) * (j < n ? 1 : problem.target[static_cast<std::size_t>(j - n)].first);
      const VectorXd& phi = test[static_cast<std::size_t>(k)];
      for (Index i = 0; i < now; ++i)
        rows(i, std::min(j, n) + 1) += factor * phi.dot(work.col(j + 1).segment(i * step, phi.size()));
    }
    sum.add_in_place(rows);
  }
}

}  // namespace

std::vector<Statistic> weak_statistics(const WeakProblem& problem, const std::vector<std::string>& names,
                                       const WeakForm& form, const std::map<std::string, double>& values,
                                       std::span<const Stream> records, std::span<const TimeBlock> blocks,
                                       int threads) {
  std::vector<Expr> expressions;
  std::vector<int> derivative;
  for (const WeakTerm& term : problem.features) {
    expressions.push_back(term.integrand);
    derivative.push_back(term.derivative);
  }
  for (const auto& [factor, term] : problem.target) {
    expressions.push_back(term.integrand);
    derivative.push_back(term.derivative);
  }
  std::vector<std::string> texts = names;
  for (std::size_t i = names.size(); i < expressions.size(); ++i) texts.push_back(to_text(expressions[i]));
  Integrals integrals{Columns(expressions, expressions.front().pool().constant(0), texts), derivative, {}};
  integrals.values = integrals.columns.values(values);
  std::vector<Statistic> out(blocks.size());
  parallel_for(static_cast<int>(blocks.size()), integrals.columns.thread_safe() ? threads : 1, [&](int block) {
    const auto i = static_cast<std::size_t>(block);
    const Stream& record = records[blocks[i].record];
    const Index h = std::max<Index>(kLeast, std::lround(problem.half_width / record.dt()));
    const Index step = std::max<Index>(1, std::lround(form.spacing * static_cast<double>(h)));
    if (blocks[i].count < 2 * h + 1)
      throw InputError("weak_form: a block of " + record.name() + " lasts " +
                           number(record.dt() * static_cast<double>(blocks[i].count), 3) + " s, a test function " +
                           number(2 * record.dt() * static_cast<double>(h), 3) +
                           " s: take fewer blocks or a smaller half_width",
                       {}, Fault::data);
    std::vector<VectorXd> test;
    for (int k = 0; k < 3; ++k) test.push_back(test_function(h, record.dt(), form.order, k));
    out[i] = Statistic(names);
    add_rows(out[i], problem, integrals, record, blocks[i].first, blocks[i].count, test, h, step);
  });
  return out;
}

}  // namespace detail
}  // namespace lunid
