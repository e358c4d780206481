// The bundle run: points side by side, one pass over the instructions for all of them.
#include <algorithm>

#include "expr/kernel.hpp"
#include "expr/machine.hpp"

namespace lunid {
namespace {

LUNID_WIDE void execute(std::size_t lanes, const Instruction* at, double* const* r,
                        const ExternalCall* externals) noexcept {
  for (; at->code != Code::done; ++at)
    kernel::run(lanes, *at, r[at->dst], r[at->a], r[at->b], r[at->c], r[kernel::has_four(at->code) ? at->d : 0],
                externals);
}

}  // namespace

void Tape::prepare_lanes(double* const* place, int lanes) const noexcept {
  const Layout& layout = program_->layout;
  for (std::size_t i = 0; i < layout.constants.size(); ++i)
    std::fill_n(place[layout.inputs + i], lanes, layout.constants[i]);
}

namespace {

/// Temporaries stand as Machine::row_values takes them.
bool in_rows(const Program& program, double* const* place) {
  const std::uint32_t first = program.layout.temporaries;
  for (std::uint32_t r = first; r < program.values.registers; ++r)
    if (place[r] != place[first] + static_cast<std::size_t>(Machine::lane_row) * (r - first)) return false;
  return true;
}

}  // namespace

void Tape::run_lanes(double* const* place, int lanes) const noexcept {
  if (const auto rows = program_->machine().row_values; rows && in_rows(*program_, place))
    rows(place, static_cast<std::size_t>(lanes));
  else if (const auto code = program_->machine().lane_values)
    code(place, static_cast<std::size_t>(lanes));
  else
    execute(static_cast<std::size_t>(lanes), program_->values.instructions.data(), place, program_->externals.data());
  for (const auto& [result, value] : program_->layout.constant_results) std::fill_n(place[result], lanes, value);
}

void Tape::run_lanes_without_copies(double* const* place, int lanes) const noexcept {
  if (const auto code = program_->machine().lane_computed)
    code(place, static_cast<std::size_t>(lanes));
  else
    execute(static_cast<std::size_t>(lanes), program_->computed.instructions.data(), place, program_->externals.data());
  for (const auto& [result, value] : program_->layout.constant_results) std::fill_n(place[result], lanes, value);
}

bool Tape::lanes_compiled() const { return program_->machine().lane_computed != nullptr; }

int Tape::copy_of(int output) const {
  const auto is_copy = [&](const Instruction& at) {
    return at.code == Code::copy && at.a < program_->layout.inputs &&
           static_cast<int>(at.dst) == output_place() + output;
  };
  const auto& code = program_->values.instructions;
  const auto at = std::find_if(code.begin(), code.end(), is_copy);
  return at == code.end() ? -1 : static_cast<int>(at->a);
}

bool Tape::reads(int input) const {
  const auto reads_input = [&](const Instruction& at) {
    const Value operands{at.code, at.a, at.b, at.c, at.d};
    const std::uint32_t all[] = {at.a, at.b, at.c, at.d};
    const auto end = all + operand_count(operands);
    return std::find(all, end, static_cast<std::uint32_t>(input)) != end;
  };
  const auto& code = program_->values.instructions;
  return std::any_of(code.begin(), code.end(), reads_input);
}

}  // namespace lunid
