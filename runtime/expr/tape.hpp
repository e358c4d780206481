#pragma once
// One compiled tape per list of outputs: topologically sorted, common subexpressions once, registers reused.
// The same tape runs over columns (blocks of rows, SIMD) and on one point (the right-hand side of an ODE).
//
// Switches. Every distinct switching node (sign(x), abs(x), min, max, and each comparison) has a switching function
// g: x for sign and abs, a - b for min, max and a > b (b - a for a < b). Nodes that share the same g up to the node
// itself (sign(v) and abs(v)) share one switch. In a *frozen* run the branch of each switch is given by
// mode[i] = +1 or -1 in place of the sign of g, so that the right-hand side is smooth within a mode; the values of g
// are written so that the integrator can find where a mode ends. mode[i] = 0 means: take the branch by the sign of g.
// +1 is: sign = 1, abs = x, max = a, min = b, the comparison holds, where takes its first value. A g and its negative
// (a > b and a < b) are one switch. Switches are in order of first appearance over the outputs, so that a tape with
// more outputs behind starts with the same switches. A g that is constant makes no switch.
// NaN: an unfrozen run gives NaN for sign, min, max, comparisons and where of a NaN; a frozen sign gives its mode.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "expr/expr.hpp"

namespace lunid {

struct Program;
struct Values;

class Tape {
 public:
  Tape() = default;
  /// `inputs` are symbols, in the order of the values given to run. Throws InputError when an output depends on a
  /// symbol that is not among them, naming the symbol.
  /// The last `fixed` inputs are those that stay as they are between runs in place (parameters).
  Tape(std::span<const Expr> outputs, std::span<const Expr> inputs, std::size_t fixed = 0);

  int inputs() const;
  int outputs() const;
  int switches() const;
  int registers() const;  ///< size of the scratch space that run_point needs
  int instructions() const;
  int frozen_instructions() const;  ///< of a frozen run in place, after prepare_frozen()
  /// Of the external functions that it calls: any thread may run the tape; and the error that one of them raised is
  /// rethrown (external.hpp).
  bool thread_safe() const;
  void rethrow() const;
  /// The switching function g of each switch, in order.
  const std::vector<Expr>& switching_functions() const;

  /// Point run; branches by the sign of g. `scratch` has registers() doubles. No allocation, no throw.
  void run_point(const double* in, double* out, double* scratch) const noexcept;
  /// Point run in a frozen mode; `mode` and `g` have switches() entries. `g` may be null.
  void run_frozen(const double* in, const std::int8_t* mode, double* out, double* g, double* scratch) const noexcept;
  /// Switching functions only (g has switches() entries).
  void run_switches(const double* in, double* g, double* scratch) const noexcept;

  /// In-place runs, for inner loops that cannot spare the copies. prepare() fills a scratch space once; from then on
  /// the caller keeps the inputs at scratch[0 .. inputs()) (runs leave them as they are) and reads outputs() values at
  /// scratch + output_place() and, after a frozen run, switches() values of g at scratch + switch_place(). A
  /// prepared scratch space belongs to one tape.
  void prepare(double* scratch) const noexcept;
  void run_prepared(double* scratch) const noexcept;
  /// For frozen runs: prepare() and what depends on the fixed inputs alone, which are there already.
  void prepare_frozen(double* scratch) const noexcept;
  void run_prepared_frozen(const std::int8_t* mode, double* scratch) const noexcept;
  /// run_prepared without writing outputs that are inputs (copy_of), which the caller has already.
  void run_prepared_without_copies(double* scratch) const noexcept;
  /// The machine code of run_prepared_without_copies, where there is some; valid as long as the tape. It returns what
  /// it writes last, which is output last_written().
  using PointCode = double (*)(double* scratch);
  PointCode point_code() const noexcept;
  int last_written() const;
  /// The machine code of run_prepared_frozen in a mode, where there is some; `make` it, where it was not yet.
  PointCode frozen_code(const std::vector<std::int8_t>& mode, bool make) const;
  int output_place() const;
  int switch_place() const;

  /// Runs of points side by side, in lanes: place[i] is the first lane of register i (registers() of them). The caller
  /// keeps inputs (registers 0 on), outputs (output_place() on) and the rest where it likes, on 64-byte lines for
  /// speed, and may move inputs and outputs between runs. `lanes` is a multiple of lane_group; more of them share the
  /// cost of an instruction. Each lane gets the bits of run_prepared on it alone. No allocation, no throw.
  static constexpr int lane_group = 8;
  void prepare_lanes(double* const* place, int lanes) const noexcept;  ///< once: constants
  void run_lanes(double* const* place, int lanes) const noexcept;
  /// The same without writing outputs that are inputs (copy_of), which the caller has already.
  void run_lanes_without_copies(double* const* place, int lanes) const noexcept;
  bool lanes_compiled() const;    ///< they run as machine code
  int copy_of(int output) const;  ///< the input that an output is, or -1
  bool reads(int input) const;    ///< some output depends on this input

  /// Column run, in blocks: in[i] points to `rows` values of input i (or to one value when stride[i] == 0);
  /// out[j] receives `rows` values. Same bits as run_point on each row. Allocates only its scratch.
  /// Output columns must not overlap input columns. Throws InputError on a wrong number of columns.
  void run_columns(std::span<const double* const> in, std::span<const int> stride, std::size_t rows,
                   std::span<double* const> out) const;

 private:
  friend class TapeChain;
  Tape(Values values, std::size_t inputs, std::size_t fixed = 0);

  std::shared_ptr<const Program> program_;
};

}  // namespace lunid
