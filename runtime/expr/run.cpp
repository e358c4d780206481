// The point run: one state, one pass over the instructions.
#include <cmath>
#include <limits>

#include "expr/branch.hpp"
#include "expr/program.hpp"

namespace lunid {
namespace {

void load(const Assembly& code, int inputs, const double* in, double* r) {
  for (int i = 0; i < inputs; ++i) r[i] = in[i];
  double* constant = r + inputs;
  for (const double value : code.constants) *constant++ = value;
}

/// The branch that a switching instruction is told to take: +1, -1, or 0 for its own.
int told(const std::int8_t* mode, std::uint32_t switch_operand) {
  if (switch_operand == no_switch) return 0;
  const int m = mode[switch_operand / 2];
  return switch_operand % 2 ? -m : m;
}

/// Runs the instructions over the registers r. Direct threading: every instruction jumps to the next by itself,
/// which branch predictors learn far better than one common switch.
template <bool frozen>
void execute(const Instruction* at, double* r, const std::int8_t* mode) noexcept {
  static constexpr void* const labels[] = {
      nullptr,   nullptr,  &&do_add,         &&do_sub,         &&do_mul,  &&do_div,    &&do_neg,
      &&do_sqrt, &&do_mul3, &&do_mul_add,    &&do_mul_sub,     &&do_sub_mul, &&do_mul_add_mul, &&do_mul_sub_mul,
      &&do_call, &&do_select, &&do_sign,     &&do_abs,         &&do_min,  &&do_max,    &&do_greater,
      &&do_less, &&do_greater_equal, &&do_less_equal, &&do_where, &&do_done};
#define NEXT goto* labels[static_cast<std::uint32_t>((++at)->code)]
#define A r[at->a]
#define B r[at->b]
#define C r[at->c]
#define D r[at->d]
#define DST r[at->dst]
#define MODE (frozen ? told(mode, at->d) : 0)
  goto* labels[static_cast<std::uint32_t>(at->code)];
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
do_call: DST = branch::call(at->d, at->a, at->b, at->c, r); NEXT;
do_select: DST = branch::where(A, B, C); NEXT;
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
#undef NEXT
#undef A
#undef B
#undef C
#undef D
#undef DST
#undef MODE
}

}  // namespace

void Tape::run_point(const double* in, double* out, double* scratch) const noexcept {
  const Assembly& code = program_->values;
  load(code, program_->inputs, in, scratch);
  execute<false>(code.instructions.data(), scratch, nullptr);
  for (const std::uint32_t r : code.results) *out++ = scratch[r];
}

void Tape::run_frozen(const double* in, const std::int8_t* mode, double* out, double* g,
                      double* scratch) const noexcept {
  const Assembly& code = g ? program_->complete : program_->values;
  load(code, program_->inputs, in, scratch);
  execute<true>(code.instructions.data(), scratch, mode);
  const std::size_t outputs = program_->values.results.size();
  for (std::size_t j = 0; j < outputs; ++j) out[j] = scratch[code.results[j]];
  for (std::size_t j = outputs; j < code.results.size(); ++j) g[j - outputs] = scratch[code.results[j]];
}

void Tape::run_switches(const double* in, double* g, double* scratch) const noexcept {
  const Assembly& code = program_->switches;
  load(code, program_->inputs, in, scratch);
  execute<false>(code.instructions.data(), scratch, nullptr);
  for (const std::uint32_t r : code.results) *g++ = scratch[r];
}

}  // namespace lunid
