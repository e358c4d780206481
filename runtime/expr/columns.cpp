// The column run: the same instructions over blocks of rows.
#include <algorithm>
#include <cmath>

#include "expr/branch.hpp"
#include "expr/program.hpp"

namespace lunid {
namespace {

constexpr std::size_t block = 256;  // rows: a few registers of 2 kB stay in the first cache

/// One instruction over a block. The trip count is fixed, and a destination is either apart from an operand or the
/// same block, so that the compiler may vectorise.
template <class F>
void rows(double* dst, F f) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < block; ++i) dst[i] = f(i);
}

void step(const Instruction& at, double* const* r) {
  double* dst = r[at.dst];
  const double* a = r[at.a];
  const bool called = at.code == Code::call;
  const bool four = at.code == Code::mul_add_mul || at.code == Code::mul_sub_mul;
  const double *b = r[at.b], *c = r[at.c], *d = four ? r[at.d] : nullptr;
  if (called) {
    const auto value = row_of(static_cast<Op>(at.d)).value;
    for (std::size_t i = 0; i < block; ++i) dst[i] = value(a[i], b[i], c[i]);
    return;
  }
  using namespace branch;
  switch (at.code) {
    case Code::add: return rows(dst, [=](std::size_t i) { return a[i] + b[i]; });
    case Code::sub: return rows(dst, [=](std::size_t i) { return a[i] - b[i]; });
    case Code::mul: return rows(dst, [=](std::size_t i) { return a[i] * b[i]; });
    case Code::div: return rows(dst, [=](std::size_t i) { return a[i] / b[i]; });
    case Code::neg: return rows(dst, [=](std::size_t i) { return -a[i]; });
    case Code::sqrt: return rows(dst, [=](std::size_t i) { return std::sqrt(a[i]); });
    case Code::mul3: return rows(dst, [=](std::size_t i) { return a[i] * b[i] * c[i]; });
    case Code::mul_add: return rows(dst, [=](std::size_t i) { return a[i] * b[i] + c[i]; });
    case Code::mul_sub: return rows(dst, [=](std::size_t i) { return a[i] * b[i] - c[i]; });
    case Code::sub_mul: return rows(dst, [=](std::size_t i) { return c[i] - a[i] * b[i]; });
    case Code::mul_add_mul: return rows(dst, [=](std::size_t i) { return a[i] * b[i] + c[i] * d[i]; });
    case Code::mul_sub_mul: return rows(dst, [=](std::size_t i) { return a[i] * b[i] - c[i] * d[i]; });
    case Code::sign: return rows(dst, [=](std::size_t i) { return sign(a[i]); });
    case Code::abs: return rows(dst, [=](std::size_t i) { return std::fabs(a[i]); });
    case Code::min: return rows(dst, [=](std::size_t i) { return min(a[i], b[i]); });
    case Code::max: return rows(dst, [=](std::size_t i) { return max(a[i], b[i]); });
    case Code::greater: return rows(dst, [=](std::size_t i) { return greater(a[i], b[i]); });
    case Code::less: return rows(dst, [=](std::size_t i) { return greater(b[i], a[i]); });
    case Code::greater_equal: return rows(dst, [=](std::size_t i) { return greater_equal(a[i], b[i]); });
    case Code::less_equal: return rows(dst, [=](std::size_t i) { return greater_equal(b[i], a[i]); });
    case Code::select:
    case Code::where: return rows(dst, [=](std::size_t i) { return where(a[i], b[i], c[i]); });
    default: return;
  }
}

/// Registers of one block each. Inputs with stride 1 are read in place, all others live in one allocation.
class Blocks {
 public:
  Blocks(const Assembly& code, std::span<const double* const> in, std::span<const int> stride)
      : in_(in), stride_(stride), memory_(block * static_cast<std::size_t>(code.registers)) {
    for (int r = 0; r < code.registers; ++r) places_.push_back(memory_.data() + block * static_cast<std::size_t>(r));
    for (std::size_t k = 0; k < code.constants.size(); ++k)
      std::fill_n(places_[in.size() + k], block, code.constants[k]);
    for (std::size_t i = 0; i < in.size(); ++i)
      if (stride[i] == 0) std::fill_n(places_[i], block, *in[i]);
  }

  /// Makes the inputs of rows first .. first + count ready.
  void load(std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < in_.size(); ++i) {
      if (stride_[i] == 0) continue;
      const double* from = in_[i] + first * static_cast<std::size_t>(stride_[i]);
      double* own = memory_.data() + block * i;
      if (stride_[i] == 1 && count == block) {
        places_[i] = const_cast<double*>(from);  // inputs are never written
        continue;
      }
      places_[i] = own;
      for (std::size_t k = 0; k < count; ++k) own[k] = from[k * static_cast<std::size_t>(stride_[i])];
      std::fill(own + count, own + block, own[0]);  // the rest of the last block: any valid row
    }
  }

  double* const* places() const { return places_.data(); }

 private:
  std::span<const double* const> in_;
  std::span<const int> stride_;
  std::vector<double> memory_;
  std::vector<double*> places_;
};

}  // namespace

void Tape::run_columns(std::span<const double* const> in, std::span<const int> stride, std::size_t rows,
                       std::span<double* const> out) const {
  const Assembly& code = program_->values;
  if (in.size() != static_cast<std::size_t>(program_->inputs) || stride.size() != in.size() ||
      out.size() != code.results.size())
    throw InputError("tape: expected " + std::to_string(program_->inputs) + " columns in and " +
                     std::to_string(code.results.size()) + " out, got " + std::to_string(in.size()) + " and " +
                     std::to_string(out.size()));
  Blocks blocks(code, in, stride);
  for (std::size_t first = 0; first < rows; first += block) {
    const std::size_t count = std::min(block, rows - first);
    blocks.load(first, count);
    for (const Instruction& at : code.instructions) {
      if (at.code == Code::done) break;
      step(at, blocks.places());
    }
    for (std::size_t j = 0; j < out.size(); ++j)
      std::copy_n(blocks.places()[code.results[j]], count, out[j] + first);
  }
}

}  // namespace lunid
