// The point run: one state, one pass over the instructions.
#include <algorithm>
#include <cmath>

#include "expr/branch.hpp"
#include "expr/machine.hpp"

namespace lunid {
namespace {

void load_constants(const Layout& layout, double* r) {
  double* place = r + layout.inputs;
  for (const double value : layout.constants) *place++ = value;
}

/// Element by element: the caller has just written the inputs one by one, and wider loads would wait for all of them.
void load_inputs(const Layout& layout, const double* in, double* r) {
  for (std::uint32_t i = 0; i < layout.inputs; ++i) r[i] = in[i];
}

void load_constant_results(const Layout& layout, double* r) {
  for (const auto& [place, value] : layout.constant_results) r[place] = value;
}

/// Runs the instructions over the registers r. Direct threading: every instruction jumps to the next by itself,
/// which branch predictors learn far better than one common switch.
template <bool frozen>
void execute(const Instruction* at, double* r, const std::int8_t* mode, const ExternalCall* externals) noexcept {
  // clang-format off
  static constexpr void* const labels[] = {
      nullptr,   nullptr,  &&do_copy,        &&do_add,         &&do_sub,         &&do_mul,  &&do_div,    &&do_neg,
      &&do_sqrt, &&do_mul3, &&do_mul_add,    &&do_mul_sub,     &&do_sub_mul, &&do_mul_add_mul, &&do_mul_sub_mul, &&do_sub_sum,
      &&do_call, &&do_external, &&do_select, &&do_choose, &&do_sign,     &&do_abs,         &&do_min,  &&do_max,    &&do_greater,
      &&do_less, &&do_greater_equal, &&do_less_equal, &&do_where, &&do_done};
#define NEXT goto* labels[static_cast<std::uint32_t>((++at)->code)]
#define A r[at->a]
#define B r[at->b]
#define C r[at->c]
#define D r[at->d]
#define DST r[at->dst]
#define MODE (frozen ? told(mode, at->d) : 0)
  goto* labels[static_cast<std::uint32_t>(at->code)];
do_copy: DST = A; NEXT;
do_add: DST = A + B; NEXT;
do_sub: DST = A - B; NEXT;
do_mul: DST = A * B; NEXT;
do_div: DST = A / B; NEXT;
do_neg: DST = -A; NEXT;
do_sqrt: DST = std::sqrt(A); NEXT;
do_mul3: DST = A * B * C; NEXT;
do_mul_add: DST = A * B + C; NEXT;
do_mul_sub: DST = A * B - C; NEXT;
do_sub_mul: DST = C - A * B; NEXT;
do_mul_add_mul: DST = A * B + C * D; NEXT;
do_mul_sub_mul: DST = A * B - C * D; NEXT;
do_sub_sum: DST = D - (A * B + C); NEXT;
do_call: DST = branch::call(at->d, at->a, at->b, at->c, r); NEXT;
do_external: DST = externals[at->function](A, B, C, D); NEXT;
do_select: DST = branch::where(A, B, C); NEXT;
do_choose: DST = A > 0 ? B : C; NEXT;
do_sign: { const int m = MODE; DST = m ? m : branch::sign(A); } NEXT;
do_abs: { const int m = MODE; DST = m ? m * A : std::fabs(A); } NEXT;
do_min: { const int m = MODE; DST = m ? (m > 0 ? B : A) : branch::min(A, B); } NEXT;
do_max: { const int m = MODE; DST = m ? (m > 0 ? A : B) : branch::max(A, B); } NEXT;
do_greater: { const int m = MODE; DST = m ? m > 0 : branch::greater(A, B); } NEXT;
do_less: { const int m = MODE; DST = m ? m > 0 : branch::greater(B, A); } NEXT;
do_greater_equal: { const int m = MODE; DST = m ? m > 0 : branch::greater_equal(A, B); } NEXT;
do_less_equal: { const int m = MODE; DST = m ? m > 0 : branch::greater_equal(B, A); } NEXT;
do_where: { const int m = MODE; DST = m ? (m > 0 ? B : C) : branch::where(A, B, C); } NEXT;
do_done: return;
  // clang-format on
#undef NEXT
#undef A
#undef B
#undef C
#undef D
#undef DST
#undef MODE
}

}  // namespace

void Tape::prepare(double* scratch) const noexcept {
  load_constants(program_->layout, scratch);
  load_constant_results(program_->layout, scratch);
}

void Tape::run_prepared(double* scratch) const noexcept {
  if (const auto code = program_->machine().values) return static_cast<void>(code(scratch));
  execute<false>(program_->values.instructions.data(), scratch, nullptr, program_->externals.data());
}

void Tape::run_prepared_without_copies(double* scratch) const noexcept {
  if (const auto code = program_->machine().computed) return static_cast<void>(code(scratch));
  execute<false>(program_->computed.instructions.data(), scratch, nullptr, program_->externals.data());
}

Tape::PointCode Tape::point_code() const noexcept { return program_->machine().computed; }

int Tape::last_written() const {
  const auto& code = program_->computed.instructions;
  return code.size() < 2 ? -1 : static_cast<int>(code[code.size() - 2].dst) - output_place();
}

void Tape::prepare_frozen(double* scratch) const noexcept {
  prepare(scratch);
  execute<false>(program_->complete.fixed.instructions.data(), scratch, nullptr, program_->externals.data());
}

void Tape::run_prepared_frozen(const std::int8_t* mode, double* scratch) const noexcept {
  execute<true>(program_->complete.rest.instructions.data(), scratch, mode, program_->externals.data());
}

void Tape::run_point(const double* in, double* out, double* scratch) const noexcept {
  const Program& program = *program_;
  load_inputs(program.layout, in, scratch);
  prepare(scratch);
  execute<false>(program.values.instructions.data(), scratch, nullptr, program.externals.data());
  const double* result = scratch + program.layout.outputs;
  for (std::uint32_t j = 0; j < program.outputs; ++j) out[j] = result[j];
}

void Tape::run_frozen(const double* in, const std::int8_t* mode, double* out, double* g,
                      double* scratch) const noexcept {
  const Program& program = *program_;
  load_inputs(program.layout, in, scratch);
  if (g) {
    prepare_frozen(scratch);
    run_prepared_frozen(mode, scratch);
  } else {
    prepare(scratch);
    execute<true>(program.values.instructions.data(), scratch, mode, program.externals.data());
  }
  std::copy_n(scratch + program.layout.outputs, program.outputs, out);
  if (g) std::copy_n(scratch + program.layout.switches, program.switching_functions.size(), g);
}

void Tape::run_switches(const double* in, double* g, double* scratch) const noexcept {
  const Program& program = *program_;
  load_inputs(program.layout, in, scratch);
  load_constants(program.layout, scratch);
  execute<false>(program.switches.instructions.data(), scratch, nullptr, program.externals.data());
  std::copy_n(scratch + program.layout.switches, program.switching_functions.size(), g);
}

}  // namespace lunid
