#pragma once
// What a tape holds: values in static single assignment (lower.cpp), assembled into code with registers
// (assemble.cpp), which run.cpp runs on a point and columns.cpp over blocks of rows.
#include <cstdint>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"

namespace lunid {

/// Instructions. Fused ones round each operation on its own: the same bits as the single ones. a, b, c, d are
/// operands; switching instructions hold the switch in d.
enum class Code : std::uint32_t {
  input, constant,  // no instructions: registers that are set before the run
  add, sub, mul, div, neg, sqrt,
  mul3,         // (a*b)*c
  mul_add,      // a*b + c
  mul_sub,      // a*b - c
  sub_mul,      // c - a*b
  mul_add_mul,  // a*b + c*d
  mul_sub_mul,  // a*b - c*d
  call,         // the value function of operation d on a, b, c
  select,       // c where a fails, b where it holds; a is a comparison
  sign, abs, min, max, greater, less, greater_equal, less_equal, where,
  done,
};

bool is_switching(Code code);

/// One value: an instruction whose operands are values (d of a call or a switch excepted).
struct Value {
  Code code;
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
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
};

/// Switch operand: index and whether this node's own g is the negative of the switch's.
constexpr std::uint32_t switch_operand(std::uint32_t index, bool reversed) { return 2 * index + (reversed ? 1 : 0); }

/// The switch operand of a node that has no switch.
constexpr std::uint32_t no_switch = 0xFFFFFFFF;

/// Lowers expressions to values: powers to products, common values once, switches collected.
Values lower(std::span<const Expr> outputs, std::span<const Expr> inputs);

struct Instruction {
  Code code;
  std::uint32_t dst, a, b, c, d;
};

/// Code over registers: inputs first, then constants, then temporaries.
struct Assembly {
  std::vector<Instruction> instructions;  // ends with Code::done
  std::vector<double> constants;
  std::vector<std::uint32_t> results;  // a register per result
  int registers = 0;
};

/// Code that computes `results` (values), fused and with registers reused.
Assembly assemble(const Values& values, std::size_t inputs, std::span<const std::uint32_t> results);

struct Tape::Program {
  int inputs = 0;
  std::vector<Expr> switching_functions;
  Assembly values;    // the outputs
  Assembly complete;  // the outputs, then every g
  Assembly switches;  // every g
};

}  // namespace lunid
