#include <array>
#include <limits>

#include "expr/program.hpp"

namespace lunid {
namespace {

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

class Assembler {
 public:
  Assembler(const Values& values, std::size_t inputs, std::span<const std::uint32_t> results)
      : constants_(values.constants),
        list_(values.list),
        inputs_(inputs),
        results_(results),
        uses_(list_.size(), 0),
        last_use_(list_.size(), 0),
        register_(list_.size(), nowhere) {}

  Assembly assemble() {
    count_uses();
    for (std::size_t i = list_.size(); i-- > 0;)
      if (uses_[i] > 0) fuse(list_[i]);
    find_last_uses();
    place_inputs_and_constants();
    for (std::uint32_t i = 0; i < list_.size(); ++i)
      if (uses_[i] > 0 && register_[i] == nowhere) emit(i);
    code_.instructions.push_back({Code::done, 0, 0, 0, 0, 0});
    for (const std::uint32_t r : results_) code_.results.push_back(register_[r]);
    return std::move(code_);
  }

 private:
  using Operands = std::array<std::uint32_t, 4>;
  static Operands operands_of(const Value& v) { return {v.a, v.b, v.c, v.d}; }

  template <class Visit>
  static void each_operand(const Value& v, Visit visit) {
    const Operands operands = operands_of(v);
    for (int k = 0; k < operand_count(v); ++k) visit(operands[static_cast<std::size_t>(k)]);
  }

  /// Uses of each value by what the results need; 0 for the rest. Users stand behind their operands.
  void count_uses() {
    for (const std::uint32_t r : results_) ++uses_[r];
    for (std::size_t i = list_.size(); i-- > 0;)
      if (uses_[i] > 0) each_operand(list_[i], [this](std::uint32_t operand) { ++uses_[operand]; });
  }

  /// A product with one user only: it can be computed within its user.
  bool own_product(std::uint32_t i) const { return list_[i].code == Code::mul && uses_[i] == 1; }

  Value take(std::uint32_t product) {
    uses_[product] = 0;
    return list_[product];
  }

  /// Takes own products into their user: fewer dispatches, fewer trips through memory. Sums and products may be
  /// turned round (x + y is y + x to the last bit), never regrouped.
  void fuse(Value& v) {
    const bool left = own_product(v.a), right = own_product(v.b);
    if (!left && !right) return;
    if (v.code == Code::mul) {
      const Value p = take(left ? v.a : v.b);
      v = {Code::mul3, p.a, p.b, left ? v.b : v.a};
    } else if (v.code == Code::add || v.code == Code::sub) {
      const bool sum = v.code == Code::add;
      if (left && right && v.a != v.b) {
        const Value p = take(v.a), q = take(v.b);
        v = {sum ? Code::mul_add_mul : Code::mul_sub_mul, p.a, p.b, q.a, q.b};
      } else if (left) {
        const Value p = take(v.a);
        v = {sum ? Code::mul_add : Code::mul_sub, p.a, p.b, v.b};
      } else {
        const Value p = take(v.b);
        v = {sum ? Code::mul_add : Code::sub_mul, p.a, p.b, v.a};
      }
    }
  }

  void find_last_uses() {
    for (std::uint32_t i = 0; i < list_.size(); ++i)
      if (uses_[i] > 0) each_operand(list_[i], [this, i](std::uint32_t operand) { last_use_[operand] = i; });
    for (const std::uint32_t r : results_) last_use_[r] = nowhere;
  }

  /// All inputs keep their places, used or not; constants only where they are used. Neither is ever overwritten.
  void place_inputs_and_constants() {
    for (std::uint32_t i = 0; i < inputs_; ++i) register_[i] = i;
    code_.registers = static_cast<int>(inputs_);
    for (std::uint32_t i = 0; i < list_.size(); ++i) {
      if (uses_[i] == 0 || list_[i].code != Code::constant) continue;
      register_[i] = static_cast<std::uint32_t>(code_.registers++);
      code_.constants.push_back(constants_[list_[i].a]);
    }
    first_temporary_ = static_cast<std::uint32_t>(code_.registers);
  }

  void emit(std::uint32_t i) {
    const Value& v = list_[i];
    Operands operands = operands_of(v);
    for (int k = 0; k < operand_count(v); ++k) {
      std::uint32_t& operand = operands[static_cast<std::size_t>(k)];
      const std::uint32_t place = register_[operand];
      if (last_use_[operand] == i && place >= first_temporary_) {
        free_.push_back(place);
        last_use_[operand] = nowhere;  // free it once, also in x*x
      }
      operand = place;
    }
    if (free_.empty()) free_.push_back(static_cast<std::uint32_t>(code_.registers++));
    register_[i] = free_.back();
    free_.pop_back();
    code_.instructions.push_back({v.code, register_[i], operands[0], operands[1], operands[2], operands[3]});
  }

  const std::vector<double>& constants_;
  std::vector<Value> list_;
  std::size_t inputs_;
  std::span<const std::uint32_t> results_;
  std::vector<std::uint32_t> uses_, last_use_, register_;
  std::vector<std::uint32_t> free_;
  std::uint32_t first_temporary_ = 0;
  Assembly code_;
};

}  // namespace

Assembly assemble(const Values& values, std::size_t inputs, std::span<const std::uint32_t> results) {
  return Assembler(values, inputs, results).assemble();
}

}  // namespace lunid
