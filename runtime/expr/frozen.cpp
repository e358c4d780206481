#include "expr/frozen.hpp"

#include <algorithm>
#include <optional>

#include "expr/machine.hpp"

namespace lunid {
namespace {

constexpr std::size_t most_modes = 64;  // of a tape: a machine's code takes a page of memory
constexpr int runs_before_code = 32;    // making it costs about as much as so many runs

Instruction with(const Instruction& at, Code code, std::uint32_t a) { return {code, 0, at.dst, a, 0, 0, 0}; }

Instruction constant(const Instruction& at, int value) {
  return with(at, Code::constant, static_cast<std::uint32_t>(value + 1));
}

/// What a switching instruction is where its branch is told by m, +1 or -1.
Instruction decided(const Instruction& at, int m) {
  switch (at.code) {
    case Code::sign: return constant(at, m);
    case Code::abs: return with(at, m > 0 ? Code::copy : Code::neg, at.a);
    case Code::min: return with(at, Code::copy, m > 0 ? at.b : at.a);
    case Code::max: return with(at, Code::copy, m > 0 ? at.a : at.b);
    case Code::where: return with(at, Code::copy, m > 0 ? at.b : at.c);
    default: return constant(at, m > 0);  // a comparison
  }
}

/// The code in one mode, without branches; nothing where a switch is not told.
std::optional<std::vector<Instruction>> decide(const Program& program, const std::vector<std::int8_t>& mode) {
  std::vector<Instruction> code;
  std::vector<std::optional<int>> known(program.registers);  // the registers that hold a constant
  for (Instruction at : program.complete.rest.instructions) {
    if (is_switching(at.code)) {
      const int m = told(mode.data(), at.d);
      if (m == 0) return {};
      at = decided(at, m);
    } else if (at.code == Code::select) {
      if (!known[at.a]) return {};
      at = with(at, Code::copy, *known[at.a] > 0 ? at.b : at.c);
    }
    if (at.code != Code::done)
      known[at.dst] = at.code == Code::constant ? std::optional(static_cast<int>(at.a) - 1) : std::nullopt;
    code.push_back(at);
  }
  return code;
}

/// Leaves out what no result needs.
std::vector<Instruction> needed(const Program& program, const std::vector<Instruction>& code) {
  std::vector<bool> read(program.registers, false);
  for (std::uint32_t r = program.layout.outputs; r < program.layout.temporaries; ++r) read[r] = true;
  std::vector<Instruction> kept;
  for (auto at = code.rbegin(); at != code.rend(); ++at) {
    if (at->code != Code::done) {
      if (!read[at->dst]) continue;
      read[at->dst] = false;
      const std::uint32_t operands[] = {at->a, at->b, at->c, at->d};
      const int count = operand_count({at->code, at->a, at->b, at->c, at->d});
      for (int k = 0; k < count; ++k) read[operands[k]] = true;
    }
    kept.push_back(*at);
  }
  std::reverse(kept.begin(), kept.end());
  return kept;
}

}  // namespace

Tape::PointCode Program::find_frozen(const std::vector<std::int8_t>& mode, bool make) const {
  const std::lock_guard lock(frozen_use_);
  const auto found = frozen_.find(mode);
  if (found != frozen_.end()) return found->second ? found->second->values : nullptr;
  if (!make || frozen_.size() >= most_modes) return nullptr;
  std::unique_ptr<const Machine>& machine = frozen_[mode];
  if (const auto code = decide(*this, mode))
    machine = std::make_unique<const Machine>(*this, Assembly{needed(*this, *code), complete.rest.registers});
  return machine ? machine->values : nullptr;
}

Tape::PointCode Tape::frozen_code(const std::vector<std::int8_t>& mode, bool make) const {
  return program_->find_frozen(mode, make);
}

FrozenRun::Mode* FrozenRun::find(const std::vector<std::int8_t>& mode) {
  for (Mode& known : modes_)
    if (same(mode, known.mode)) return &known;
  if (modes_.size() >= most_modes) return nullptr;
  modes_.push_back({mode, tape_.frozen_code(mode, false), 0});
  return &modes_.back();
}

void FrozenRun::interpret(const std::vector<std::int8_t>& mode, double* scratch) noexcept {
  tape_.run_prepared_frozen(mode.data(), scratch);
  if (now_ && ++now_->runs == runs_before_code) now_->code = tape_.frozen_code(mode, true);
}

}  // namespace lunid
