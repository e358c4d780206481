#include "expr/tape.hpp"

#include <algorithm>

#include "expr/program.hpp"

namespace lunid {

Tape::Tape(std::span<const Expr> outputs, std::span<const Expr> inputs) {
  const Values values = lower(outputs, inputs);
  std::vector<std::uint32_t> all = values.outputs;
  all.insert(all.end(), values.switch_values.begin(), values.switch_values.end());
  auto program = std::make_shared<Program>();
  program->inputs = static_cast<int>(inputs.size());
  program->switching_functions = values.switching_functions;
  program->values = assemble(values, inputs.size(), values.outputs);
  program->complete = assemble(values, inputs.size(), all);
  program->switches = assemble(values, inputs.size(), values.switch_values);
  program_ = std::move(program);
}

int Tape::inputs() const { return program_ ? program_->inputs : 0; }
int Tape::outputs() const { return program_ ? static_cast<int>(program_->values.results.size()) : 0; }
int Tape::switches() const { return program_ ? static_cast<int>(program_->switching_functions.size()) : 0; }
int Tape::instructions() const { return program_ ? static_cast<int>(program_->values.instructions.size()) - 1 : 0; }

int Tape::registers() const {
  if (!program_) return 0;
  return std::max({program_->values.registers, program_->complete.registers, program_->switches.registers});
}

const std::vector<Expr>& Tape::switching_functions() const {
  static const std::vector<Expr> none;
  return program_ ? program_->switching_functions : none;
}

}  // namespace lunid
