#include "expr/tape.hpp"

#include <algorithm>
#include <utility>

#include "expr/machine.hpp"

namespace lunid {

Tape::Tape(std::span<const Expr> outputs, std::span<const Expr> inputs, std::size_t fixed)
    : Tape(lower(outputs, inputs), inputs.size(), fixed) {}

Tape::Tape(Values lowered, std::size_t inputs, std::size_t fixed) {
  auto program = std::make_shared<Program>();
  program->lowered = std::move(lowered);
  const Values& values = program->lowered;
  program->layout = lay_out(values, inputs);
  program->layout.fixed = static_cast<std::uint32_t>(fixed);
  program->outputs = static_cast<std::uint32_t>(values.outputs.size());
  program->switching_functions = values.switching_functions;
  program->externals = values.externals;

  const std::vector<Result> results = output_results(values, program->layout);
  const std::vector<Result> switches = switch_results(values, program->layout);
  std::vector<Result> all = results;
  all.insert(all.end(), switches.begin(), switches.end());
  program->values = assemble(values, program->layout, results);
  program->computed = program->values;
  std::erase_if(program->computed.instructions,
                [&](const Instruction& at) { return at.code == Code::copy && at.a < program->layout.inputs; });
  program->complete = assemble_split(values, program->layout, all);
  program->switches = assemble(values, program->layout, switches);
  program->registers = std::max({program->values.registers, program->complete.fixed.registers,
                                 program->complete.rest.registers, program->switches.registers});
  program_ = std::move(program);
}

Program::~Program() = default;

const Machine& Program::make_machine() const {
  std::call_once(making_, [this] {
    machine_ = std::make_unique<const Machine>(*this);
    made_.store(machine_.get(), std::memory_order_release);
  });
  return *machine_;
}

int Tape::inputs() const { return program_ ? static_cast<int>(program_->layout.inputs) : 0; }
int Tape::outputs() const { return program_ ? static_cast<int>(program_->outputs) : 0; }
int Tape::switches() const { return program_ ? static_cast<int>(program_->switching_functions.size()) : 0; }
int Tape::registers() const { return program_ ? static_cast<int>(program_->registers) : 0; }
int Tape::instructions() const { return program_ ? static_cast<int>(program_->values.instructions.size()) - 1 : 0; }
int Tape::frozen_instructions() const {
  return program_ ? static_cast<int>(program_->complete.rest.instructions.size()) - 1 : 0;
}
int Tape::output_place() const { return program_ ? static_cast<int>(program_->layout.outputs) : 0; }
int Tape::switch_place() const { return program_ ? static_cast<int>(program_->layout.switches) : 0; }

bool Tape::thread_safe() const {
  return !program_ || std::all_of(program_->externals.begin(), program_->externals.end(),
                                  [](const ExternalCall& call) { return call.function->thread_safe(); });
}

void Tape::rethrow() const {
  if (!program_) return;
  for (const ExternalCall& call : program_->externals) call.function->rethrow();
}

const std::vector<Expr>& Tape::switching_functions() const {
  static const std::vector<Expr> none;
  return program_ ? program_->switching_functions : none;
}

}  // namespace lunid
