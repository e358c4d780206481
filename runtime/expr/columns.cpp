// The column run: the same instructions over blocks of rows.
#include <algorithm>

#include "expr/kernel.hpp"

namespace lunid {
namespace {

constexpr std::size_t block = 256;  // rows: a few registers of 2 kB stay in the first cache

LUNID_WIDE void step(const Instruction& at, double* const* r, const ExternalCall* externals) {
  kernel::run(block, at, r[at.dst], r[at.a], r[at.b], r[at.c], kernel::has_four(at.code) ? r[at.d] : nullptr,
              externals);
}

/// Registers of one block each. Whole blocks of inputs with stride 1 are read in place and whole blocks of outputs
/// written in place; the rest lives in one allocation.
class Blocks {
 public:
  Blocks(const Layout& layout, std::size_t registers, std::span<const double* const> in, std::span<const int> stride,
         std::span<double* const> out)
      : layout_(layout), in_(in), stride_(stride), out_(out), memory_(block * registers) {
    for (std::size_t r = 0; r < registers; ++r) places_.push_back(own(r));
    for (std::size_t k = 0; k < layout.constants.size(); ++k)
      std::fill_n(own(layout.inputs + k), block, layout.constants[k]);
    for (std::size_t i = 0; i < in.size(); ++i)
      if (stride[i] == 0) std::fill_n(own(i), block, *in[i]);
  }

  /// Makes rows first .. first + count ready: their inputs, and where their outputs go.
  void open(std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < in_.size(); ++i)
      if (stride_[i] != 0) open_input(i, in_[i] + first * static_cast<std::size_t>(stride_[i]), count);
    for (std::size_t j = 0; j < out_.size(); ++j)
      places_[layout_.outputs + j] = count == block ? out_[j] + first : own(layout_.outputs + j);
    for (const auto& [place, value] : layout_.constant_results) std::fill_n(places_[place], count, value);
  }

  /// Hands over the outputs of an unfinished block.
  void close(std::size_t first, std::size_t count) {
    if (count == block) return;
    for (std::size_t j = 0; j < out_.size(); ++j) std::copy_n(own(layout_.outputs + j), count, out_[j] + first);
  }

  double* const* places() const { return places_.data(); }

 private:
  double* own(std::size_t r) { return memory_.data() + block * r; }

  void open_input(std::size_t i, const double* from, std::size_t count) {
    const std::size_t stride = static_cast<std::size_t>(stride_[i]);
    if (stride == 1 && count == block) {
      places_[i] = const_cast<double*>(from);  // no instruction writes to an input
      return;
    }
    places_[i] = own(i);
    for (std::size_t k = 0; k < count; ++k) own(i)[k] = from[k * stride];
    std::fill(own(i) + count, own(i) + block, from[0]);  // fills the block up with a valid row
  }

  const Layout& layout_;
  std::span<const double* const> in_;
  std::span<const int> stride_;
  std::span<double* const> out_;
  std::vector<double> memory_;
  std::vector<double*> places_;
};

}  // namespace

void Tape::run_columns(std::span<const double* const> in, std::span<const int> stride, std::size_t rows,
                       std::span<double* const> out) const {
  const Program& program = *program_;
  if (in.size() != program.layout.inputs || stride.size() != in.size() || out.size() != program.outputs)
    throw InputError("tape: expected " + std::to_string(program.layout.inputs) + " columns in and " +
                     std::to_string(program.outputs) + " out, got " + std::to_string(in.size()) + " and " +
                     std::to_string(out.size()));
  if (rows == 0) return;
  Blocks blocks(program.layout, program.values.registers, in, stride, out);
  for (std::size_t first = 0; first < rows; first += block) {
    const std::size_t count = std::min(block, rows - first);
    blocks.open(first, count);
    for (const Instruction* at = program.values.instructions.data(); at->code != Code::done; ++at)
      step(*at, blocks.places(), program.externals.data());
    blocks.close(first, count);
  }
}

}  // namespace lunid
