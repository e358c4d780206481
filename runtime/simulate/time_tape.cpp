#include "simulate/time_tape.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "expr/kernel.hpp"
#include "expr/walk.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Rows of a grid that are worked on at once.
constexpr Index chunk = 16 * TimeTape::turned_rows;

/// The rate by which every node grows with t, where it is affine in t: empty where it is not, the constant 0 where it
/// does not hold t.
class Rates {
 public:
  Rates(std::span<const Expr> outputs, Expr t) : t_(t), zero_(t.pool().constant(0)) {
    for (const Expr& node : post_order(outputs)) rates_.emplace(node.id(), rate(node));
  }
  Expr operator[](Expr node) const { return rates_.at(node.id()); }
  bool grows(Expr node) const { return !still((*this)[node]); }

 private:
  static bool still(Expr rate) { return rate.valid() && rate.is_constant(0); }
  Expr sum(Op op, Expr a, Expr b) const {
    if (still(b)) return a;
    return still(a) ? (op == Op::add ? b : -b) : t_.pool().apply(op, {a, b});
  }
  Expr rate(Expr node) const {
    if (node == t_) return t_.pool().constant(1);
    const auto x = node.arguments();
    std::array<Expr, 3> of;
    bool all_still = true, known = true;
    for (std::size_t i = 0; i < x.size(); ++i) {
      of[i] = rates_.at(x[i].id());
      all_still &= still(of[i]);
      known &= of[i].valid();
    }
    if (all_still) return zero_;
    if (!known) return {};
    switch (node.op()) {
      case Op::neg: return -of[0];
      case Op::add:
      case Op::sub: return sum(node.op(), of[0], of[1]);
      case Op::mul: return still(of[1]) ? of[0] * x[1] : still(of[0]) ? x[0] * of[1] : Expr();
      case Op::div: return still(of[1]) ? of[0] / x[1] : Expr();
      default: return {};
    }
  }

  Expr t_, zero_;
  std::unordered_map<std::uint32_t, Expr> rates_;
};

/// One wave's angles turned: from the first of a block by the rows within it, then by the place within the interval.
LUNID_WIDE void turn(Index rows, const double* base_c, const double* base_s, const double* row_c, const double* row_s,
                     const double* place, bool sine, double* out) {
  using kernel::quad;
  for (Index row = 0; row < rows; row += 4) {
    const double c = base_c[row / TimeTape::turned_rows], s = base_s[row / TimeTape::turned_rows];
    const auto rc = quad(row_c + row % TimeTape::turned_rows), rs = quad(row_s + row % TimeTape::turned_rows);
    const auto zc = c * rc - s * rs, zs = s * rc + c * rs;
    if (!place)
      quad(out + row) = sine ? zs : zc;
    else
      quad(out + row) = sine ? zs * place[0] + zc * place[1] : zc * place[0] - zs * place[1];
  }
}

/// Columns of one tape, `count` values each; the last inputs may be single numbers.
void run_columns(const Tape& tape, std::span<const double* const> columns, std::span<const double> q,
                 std::span<const double* const> more, Index count, std::span<double* const> out) {
  std::vector<const double*> in(columns.begin(), columns.end());
  std::vector<int> stride(columns.size(), 1);
  for (const double& value : q) {
    in.push_back(&value);
    stride.push_back(0);
  }
  in.insert(in.end(), more.begin(), more.end());
  stride.resize(in.size(), 1);
  tape.run_columns(in, stride, static_cast<std::size_t>(count), out);
}

/// Sines and cosines of `count` angles.
struct Circle {
  std::vector<double> c, s;
  explicit Circle(std::size_t count) : c(count), s(count) {}
  void set(std::size_t i, double angle) {
    c[i] = wave::cos(angle);
    s[i] = wave::sin(angle);
  }
};

}  // namespace

TimeTape::TimeTape(std::span<const Expr> outputs, std::span<const Expr> inputs) : direct_(outputs, inputs) {
  const Expr t = inputs[0];
  Pool& pool = t.pool();
  const Rates rates(outputs, t);
  std::vector<Expr> angles, angle_rates, rest_inputs(inputs.begin(), inputs.end());
  std::vector<std::pair<Expr, Expr>> replacements;
  for (const Expr& node : post_order(outputs)) {
    if (node.op() != Op::sin && node.op() != Op::cos) continue;
    const Expr angle = node.arguments()[0];
    if (!rates[angle].valid() || !rates.grows(angle)) continue;
    const auto wave = std::find(angles.begin(), angles.end(), angle) - angles.begin();
    if (wave == static_cast<std::ptrdiff_t>(angles.size())) {
      angles.push_back(angle);
      angle_rates.push_back(rates[angle]);
    }
    const bool sine = node.op() == Op::sin;
    values_.push_back({static_cast<int>(wave), sine});
    rest_inputs.push_back(pool.state((sine ? "turned_sine_" : "turned_cosine_") + std::to_string(wave + 1)));
    replacements.emplace_back(node, rest_inputs.back());
  }
  waves_ = static_cast<int>(angles.size());
  angles.insert(angles.end(), angle_rates.begin(), angle_rates.end());
  angles_ = Tape(angles, inputs);
  std::vector<Expr> rest;
  for (const Expr& output : outputs) rest.push_back(replacements.empty() ? output : substitute(output, replacements));
  rest_ = Tape(rest, rest_inputs);
}

void TimeTape::fill(double t0, double dt, double place, std::span<const double> q, Index rows,
                    std::span<double* const> out) const {
  const auto waves = static_cast<std::size_t>(waves_), turned = static_cast<std::size_t>(turned_rows);
  const auto blocks = static_cast<std::size_t>((rows + turned_rows - 1) / turned_rows);
  std::vector<double> time(std::max(blocks, static_cast<std::size_t>(chunk)));
  for (std::size_t b = 0; b < blocks; ++b) time[b] = t0 + dt * static_cast<double>(b * turned);
  std::vector<double> angles(2 * waves * blocks);
  std::vector<double*> angle_columns;
  for (std::size_t i = 0; i < 2 * waves; ++i) angle_columns.push_back(angles.data() + i * blocks);
  const double* const times[] = {time.data()};
  if (waves > 0) run_columns(angles_, times, q, {}, static_cast<Index>(blocks), angle_columns);

  Circle bases(waves * blocks + turned), turns(waves * turned), places(waves);
  for (std::size_t w = 0; w < waves; ++w) {
    for (std::size_t b = 0; b < blocks; ++b) bases.set(w * blocks + b, angle_columns[w][b]);
    const double rate = angle_columns[waves + w][0];
    for (std::size_t r = 0; r < turned; ++r) turns.set(w * turned + r, rate * (dt * static_cast<double>(r)));
    places.set(w, rate * (dt * place));
  }

  std::vector<double> values(values_.size() * static_cast<std::size_t>(chunk));
  std::vector<const double*> value_columns;
  for (std::size_t i = 0; i < values_.size(); ++i) value_columns.push_back(values.data() + i * chunk);
  std::vector<double*> to(out.size());
  for (Index first = 0; first < rows; first += chunk) {
    const Index count = std::min(chunk, rows - first), block = first / turned_rows;
    for (Index i = 0; i < count; ++i)
      time[static_cast<std::size_t>(i)] = t0 + dt * (static_cast<double>(first + i) + place);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const auto w = static_cast<std::size_t>(values_[i].wave), at = w * blocks + static_cast<std::size_t>(block);
      const double by[] = {places.c[w], places.s[w]};
      turn((count + 3) / 4 * 4, bases.c.data() + at, bases.s.data() + at, turns.c.data() + w * turned,
           turns.s.data() + w * turned, place > 0 ? by : nullptr, values_[i].sine, values.data() + i * chunk);
    }
    for (std::size_t j = 0; j < out.size(); ++j) to[j] = out[j] + first;
    run_columns(rest_, times, q, value_columns, count, to);
  }
}

}  // namespace lunid
