#include <array>
#include <limits>

#include "expr/program.hpp"

namespace lunid {
namespace {

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

class Assembler {
 public:
  Assembler(const Values& values, const Layout& layout, std::span<const Result> results, std::uint32_t temporaries)
      : list_(values.list),
        layout_(layout),
        results_(results),
        temporaries_(temporaries),
        known_(list_.size(), 0),
        uses_(list_.size(), 0),
        last_use_(list_.size(), 0),
        register_(list_.size(), nowhere) {
    for (std::size_t i = 0; i < list_.size(); ++i) known_[i] = is_given(list_[i]);
  }

  /// These values are in their registers already.
  void hold(std::span<const Result> held) {
    for (const Result& h : held) {
      register_[h.value] = h.place;
      known_[h.value] = 1;
    }
  }

  Assembly assemble() {
    code_.registers = temporaries_;
    count_uses();
    for (std::uint32_t i = static_cast<std::uint32_t>(list_.size()); i-- > 0;)
      if (uses_[i] > 0 && !is_known(i)) fuse(list_[i]);
    find_last_uses();
    for (std::uint32_t i = 0; i < list_.size(); ++i) place(i);
    for (const Result& r : results_) reserve(r);
    for (std::uint32_t i = 0; i < list_.size(); ++i)
      if (uses_[i] > 0 && !is_known(i)) emit(i);
    for (const Result& r : results_)
      if (list_[r.value].code != Code::constant && register_[r.value] != r.place)
        code_.instructions.push_back({Code::copy, 0, r.place, register_[r.value], 0, 0, 0});
    code_.instructions.push_back({Code::done, 0, 0, 0, 0, 0, 0});
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
    for (const Result& r : results_) ++uses_[r.value];
    for (std::uint32_t i = static_cast<std::uint32_t>(list_.size()); i-- > 0;)
      if (uses_[i] > 0 && !is_known(i)) each_operand(list_[i], [this](std::uint32_t operand) { ++uses_[operand]; });
  }

  /// A value with one user only: it can be computed within its user.
  bool own(std::uint32_t i, Code code) const { return list_[i].code == code && uses_[i] == 1 && !is_known(i); }
  bool own_product(std::uint32_t i) const { return own(i, Code::mul); }

  Value take(std::uint32_t product) {
    uses_[product] = 0;
    return list_[product];
  }

  /// Takes own products into their user: fewer dispatches, fewer trips through memory. Sums and products may be
  /// turned round (x + y is y + x to the last bit), never regrouped.
  void fuse(Value& v) {
    if (v.code == Code::sub && own(v.b, Code::add) && (own_product(list_[v.b].a) || own_product(list_[v.b].b)))
      return fuse_sum(v);
    if (v.code != Code::mul && v.code != Code::add && v.code != Code::sub) return;
    const bool left = own_product(v.a), right = own_product(v.b);
    if (!left && !right) return;
    if (v.code == Code::mul) {
      const Value p = take(left ? v.a : v.b);
      v = {Code::mul3, p.a, p.b, left ? v.b : v.a};
      return;
    }
    const bool sum = v.code == Code::add;
    if (left && right) {
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

  /// d - (product + c). The product on the right is taken first: in a sum it is the last that is known.
  void fuse_sum(Value& v) {
    const Value sum = take(v.b);
    const bool right = own_product(sum.b);
    const Value p = take(right ? sum.b : sum.a);
    v = {Code::sub_sum, p.a, p.b, right ? sum.a : sum.b, v.a};
  }

  void find_last_uses() {
    for (std::uint32_t i = 0; i < list_.size(); ++i)
      if (uses_[i] > 0 && !is_known(i))
        each_operand(list_[i], [this, i](std::uint32_t operand) { last_use_[operand] = i; });
    for (const Result& r : results_) last_use_[r.value] = nowhere;
  }

  static bool is_given(const Value& v) { return v.code == Code::input || v.code == Code::constant; }
  bool is_known(std::uint32_t i) const { return known_[i] != 0; }

  /// Inputs and constants have their places in the layout and are never overwritten.
  void place(std::uint32_t i) {
    if (is_given(list_[i])) register_[i] = list_[i].a + (list_[i].code == Code::constant ? layout_.inputs : 0);
  }

  /// A computed result goes straight to its place; a second place of the same value is filled by a copy.
  void reserve(const Result& r) {
    if (register_[r.value] == nowhere) register_[r.value] = r.place;
  }

  void emit(std::uint32_t i) {
    const Value& v = list_[i];
    Operands operands = operands_of(v);
    for (int k = 0; k < operand_count(v); ++k) {
      std::uint32_t& operand = operands[static_cast<std::size_t>(k)];
      const std::uint32_t place = register_[operand];
      if (last_use_[operand] == i && place >= temporaries_) {
        free_.push_back(place);
        last_use_[operand] = nowhere;  // free it once, also in x*x
      }
      operand = place;
    }
    if (register_[i] == nowhere) register_[i] = temporary();
    code_.instructions.push_back({v.code, static_cast<std::uint16_t>(v.function), register_[i], operands[0],
                                  operands[1], operands[2], operands[3]});
  }

  std::uint32_t temporary() {
    if (free_.empty()) return code_.registers++;
    const std::uint32_t place = free_.back();
    free_.pop_back();
    return place;
  }

  std::vector<Value> list_;
  const Layout& layout_;
  std::span<const Result> results_;
  std::uint32_t temporaries_;        ///< the first register that is free for them
  std::vector<std::uint8_t> known_;  ///< given or held: nothing computes it here
  std::vector<std::uint32_t> uses_, last_use_, register_;
  std::vector<std::uint32_t> free_;
  Assembly code_;
};

}  // namespace

Layout lay_out(const Values& values, std::size_t inputs) {
  Layout layout;
  layout.inputs = static_cast<std::uint32_t>(inputs);
  layout.constants = values.constants;
  layout.outputs = static_cast<std::uint32_t>(inputs + values.constants.size());
  layout.switches = layout.outputs + static_cast<std::uint32_t>(values.outputs.size());
  layout.temporaries = layout.switches + static_cast<std::uint32_t>(values.switch_values.size());
  for (const Result& r : output_results(values, layout))
    if (const Value& v = values.list[r.value]; v.code == Code::constant)
      layout.constant_results.emplace_back(r.place, values.constants[v.a]);
  return layout;
}

std::vector<Result> output_results(const Values& values, const Layout& layout) {
  std::vector<Result> results;
  for (const std::uint32_t v : values.outputs)
    results.push_back({v, layout.outputs + static_cast<std::uint32_t>(results.size())});
  return results;
}

std::vector<Result> switch_results(const Values& values, const Layout& layout) {
  std::vector<Result> results;
  for (const std::uint32_t v : values.switch_values)
    results.push_back({v, layout.switches + static_cast<std::uint32_t>(results.size())});
  return results;
}

Assembly assemble(const Values& values, const Layout& layout, std::span<const Result> results) {
  return Assembler(values, layout, results, layout.temporaries).assemble();
}

namespace {

/// A value that computes the same as long as its operands do: no branch of a mode, nothing from outside.
bool is_plain(const Value& v) { return !is_switching(v.code) && v.code != Code::external && v.code != Code::choose; }

/// The computed values that depend on fixed inputs alone and are wanted by others or as results.
std::vector<std::uint32_t> fixed_values(const Values& values, const Layout& layout, std::span<const Result> results) {
  const std::vector<Value>& list = values.list;
  std::vector<std::uint8_t> fixed(list.size(), 0), wanted(list.size(), 0);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value& v = list[i];
    if (v.code == Code::input || v.code == Code::constant) {
      fixed[i] = v.code == Code::constant || v.a >= layout.inputs - layout.fixed;
      continue;
    }
    const std::uint32_t operands[] = {v.a, v.b, v.c, v.d};
    fixed[i] = is_plain(v);
    for (int k = 0; k < operand_count(v); ++k) fixed[i] = fixed[i] && fixed[operands[k]];
    for (int k = 0; k < operand_count(v) && !fixed[i]; ++k) wanted[operands[k]] = 1;
  }
  for (const Result& r : results) wanted[r.value] = 1;
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < list.size(); ++i)
    if (fixed[i] && wanted[i] && list[i].code != Code::input && list[i].code != Code::constant) out.push_back(i);
  return out;
}

}  // namespace

Split assemble_split(const Values& values, const Layout& layout, std::span<const Result> results) {
  std::vector<Result> held;
  for (const std::uint32_t value : fixed_values(values, layout, results))
    held.push_back({value, layout.temporaries + static_cast<std::uint32_t>(held.size())});
  const std::uint32_t temporaries = layout.temporaries + static_cast<std::uint32_t>(held.size());
  Assembler rest(values, layout, results, temporaries);
  rest.hold(held);
  return {Assembler(values, layout, held, temporaries).assemble(), rest.assemble()};
}

}  // namespace lunid
