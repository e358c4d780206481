#pragma once
// What a tape holds: values in static single assignment (lower.cpp), assembled into code with registers
// (assemble.cpp), which run.cpp runs on a point and columns.cpp over blocks of rows.
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "expr/expr.hpp"
#include "expr/external.hpp"
#include "expr/tape.hpp"

namespace lunid {

/// Instructions. Fused ones round each operation on its own: the same bits as the single ones. a, b, c, d are
/// operands; switching instructions hold the switch in d.
enum class Code : std::uint16_t {
  input,
  constant,  // no instructions: registers that are set before the run; in decided code (frozen.cpp) the number a - 1
  copy,
  add,
  sub,
  mul,
  div,
  neg,
  sqrt,
  mul3,         // (a*b)*c
  mul_add,      // a*b + c
  mul_sub,      // a*b - c
  sub_mul,      // c - a*b
  mul_add_mul,  // a*b + c*d
  mul_sub_mul,  // a*b - c*d
  sub_sum,      // d - (a*b + c): the force less a restoring force
  call,         // the value function of operation d on a, b, c
  external,     // an external function of a, b, c, d; those that it lacks are a again
  select,       // c where a fails, b where it holds; a is a comparison
  choose,       // b where a is +1, c where it is -1: a branch by a mode that is a value (chain.hpp)
  sign,
  abs,
  min,
  max,
  greater,
  less,
  greater_equal,
  less_equal,
  where,
  done,
};

bool is_switching(Code code);

/// One value: an instruction whose operands are values (d of a call or a switch excepted).
struct Value {
  Code code;
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
  std::uint32_t function = 0;  ///< of external: an index into Values::externals
  friend bool operator==(const Value&, const Value&) = default;
};

/// The operands of a value that are values themselves.
int operand_count(const Value& value);

/// All values of a tape, operands before users; the first ones are the inputs.
struct Values {
  std::vector<Value> list;
  std::vector<double> constants;             // of Code::constant, indexed by a
  std::vector<std::uint32_t> outputs;        // indices into list
  std::vector<std::uint32_t> switch_values;  // the value of each g
  std::vector<Expr> switching_functions;
  std::vector<ExternalCall> externals;
};

/// Switch operand: index and whether this node's own g is the negative of the switch's.
constexpr std::uint32_t switch_operand(std::uint32_t index, bool reversed) { return 2 * index + (reversed ? 1 : 0); }

/// The switch operand of a node that has no switch.
constexpr std::uint32_t no_switch = 0xFFFFFFFF;

/// The branch that a switching instruction is told to take: +1, -1, or 0 for its own.
inline int told(const std::int8_t* mode, std::uint32_t switch_operand) {
  if (switch_operand == no_switch) return 0;
  const int m = mode[switch_operand / 2];
  return switch_operand % 2 ? -m : m;
}

/// Lowers expressions to values: powers to products, common values once, switches collected.
Values lower(std::span<const Expr> outputs, std::span<const Expr> inputs);

struct Instruction {
  Code code;
  std::uint16_t function;  ///< of external
  std::uint32_t dst, a, b, c, d;
};

/// Where things are in the registers, the same for all code of a tape: inputs, constants, outputs, switching
/// functions, temporaries. Only the last three are written by instructions.
struct Layout {
  std::uint32_t inputs = 0;
  std::uint32_t fixed = 0;  // so many inputs, the last, stay as they are between runs in place
  std::uint32_t outputs = 0, switches = 0, temporaries = 0;  // the first register of each
  std::vector<double> constants;                             // from register `inputs` on
  /// Results that are constants: set before the run, not by an instruction.
  std::vector<std::pair<std::uint32_t, double>> constant_results;
};

/// A value and the register that must hold it after the run.
struct Result {
  std::uint32_t value;
  std::uint32_t place;
};

/// Instructions that end with Code::done, and the registers that they need.
struct Assembly {
  std::vector<Instruction> instructions;
  std::uint32_t registers = 0;
};

/// Code in two parts: what depends on fixed inputs alone, and the rest, which finds that in registers of its own.
struct Split {
  Assembly fixed, rest;
};

Layout lay_out(const Values& values, std::size_t inputs);
/// The outputs, then the switching functions.
std::vector<Result> output_results(const Values& values, const Layout& layout);
std::vector<Result> switch_results(const Values& values, const Layout& layout);
/// Code that computes `results`, fused and with temporaries reused.
Assembly assemble(const Values& values, const Layout& layout, std::span<const Result> results);
Split assemble_split(const Values& values, const Layout& layout, std::span<const Result> results);

class Machine;

/// All that a tape is made of.
struct Program {
  Values lowered;  // what the rest was made from, for chains
  Layout layout;
  std::vector<Expr> switching_functions;
  std::vector<ExternalCall> externals;
  std::uint32_t outputs = 0;
  std::uint32_t registers = 0;
  Assembly values;    // the outputs
  Assembly computed;  // the outputs that are not inputs
  Split complete;     // the outputs, then every g
  Assembly switches;  // every g

  ~Program();
  /// Machine code of `complete.rest` in a mode, where there is some; `make` it, where it was not yet.
  Tape::PointCode find_frozen(const std::vector<std::int8_t>& mode, bool make) const;
  /// Made once, when the tape is first run in place; what it lacks the interpreters run.
  const Machine& machine() const {
    const Machine* made = made_.load(std::memory_order_acquire);
    return made ? *made : make_machine();
  }

 private:
  const Machine& make_machine() const;
  mutable std::once_flag making_;
  mutable std::unique_ptr<const Machine> machine_;
  mutable std::atomic<const Machine*> made_{nullptr};
  mutable std::mutex frozen_use_;
  mutable std::map<std::vector<std::int8_t>, std::unique_ptr<const Machine>> frozen_;  // null: the interpreter runs it
};

}  // namespace lunid
