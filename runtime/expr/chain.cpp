#include "expr/chain.hpp"

#include <algorithm>
#include <bit>

#include "expr/program.hpp"

namespace lunid {

TapeChain::TapeChain(int inputs) : inputs_(inputs), values_(std::make_unique<Values>()) {
  for (int i = 0; i < inputs; ++i) values_->list.push_back({Code::input, static_cast<std::uint32_t>(i)});
}

TapeChain::~TapeChain() = default;

TapeChain::Number TapeChain::add(const Key& key) {
  const auto [at, fresh] = known_.try_emplace(key, static_cast<Number>(values_->list.size()));
  if (fresh) values_->list.push_back({static_cast<Code>(key[0]), key[1], key[2], key[3], key[4], key[5]});
  return at->second;
}

TapeChain::Number TapeChain::constant(double value) {
  const auto [at, fresh] = constants_.try_emplace(std::bit_cast<std::uint64_t>(value),
                                                  static_cast<std::uint32_t>(values_->constants.size()));
  if (fresh) values_->constants.push_back(value);
  return add({static_cast<std::uint32_t>(Code::constant), at->second, 0, 0, 0, 0});
}

TapeChain::Number TapeChain::sum(Number a, Number b) {
  return add({static_cast<std::uint32_t>(Code::add), a, b, 0, 0, 0});
}

TapeChain::Number TapeChain::difference(Number a, Number b) {
  return add({static_cast<std::uint32_t>(Code::sub), a, b, 0, 0, 0});
}

TapeChain::Number TapeChain::product(Number a, Number b) {
  return add({static_cast<std::uint32_t>(Code::mul), a, b, 0, 0, 0});
}

TapeChain::Number TapeChain::negative(Number a) { return add({static_cast<std::uint32_t>(Code::neg), a, 0, 0, 0, 0}); }

TapeChain::Number TapeChain::choose(Number mode, Number plus, Number minus) {
  return add({static_cast<std::uint32_t>(Code::choose), mode, plus, minus, 0, 0});
}

/// A switching value in the branch of its mode, as run.cpp takes it. Operands are numbers of the chain.
TapeChain::Number TapeChain::frozen(const Value& value, Number mode) {
  switch (value.code) {
    case Code::sign: return mode;
    case Code::abs: return product(mode, value.a);
    case Code::min: return choose(mode, value.b, value.a);
    case Code::max: return choose(mode, value.a, value.b);
    case Code::where: return choose(mode, value.b, value.c);
    default: {  // comparisons
      const Number truth = choose(mode, constant(1), constant(0));
      mode_of_[truth] = mode;
      return truth;
    }
  }
}

TapeChain::Run TapeChain::run(const Tape& tape, std::span<const Number> inputs, std::span<const Number> modes) {
  const Values& part = tape.program_->lowered;
  const auto offset = static_cast<std::uint32_t>(values_->externals.size());
  values_->externals.insert(values_->externals.end(), part.externals.begin(), part.externals.end());
  std::vector<Number> here;
  for (const Value& value : part.list) {
    if (value.code == Code::input) {
      here.push_back(inputs[value.a]);
      continue;
    }
    if (value.code == Code::constant) {
      here.push_back(constant(part.constants[value.a]));
      continue;
    }
    Value v = value;
    std::uint32_t* const operands[] = {&v.a, &v.b, &v.c, &v.d};
    for (int k = 0; k < operand_count(value); ++k) *operands[k] = here[*operands[k]];
    if (!modes.empty() && is_switching(v.code) && v.d != no_switch) {
      const Number mode = modes[v.d / 2];
      here.push_back(frozen(v, v.d % 2 ? negative(mode) : mode));
    } else if (const auto of = mode_of_.find(v.a);
               of != mode_of_.end() && (v.code == Code::where || v.code == Code::select)) {
      here.push_back(choose(of->second, v.b, v.c));
    } else {
      if (v.code == Code::external) v.function += offset;
      here.push_back(add({static_cast<std::uint32_t>(v.code), v.a, v.b, v.c, v.d, v.function}));
    }
  }
  Run out;
  for (const std::uint32_t output : part.outputs) out.outputs.push_back(here[output]);
  for (const std::uint32_t g : part.switch_values) out.switches.push_back(here[g]);
  return out;
}

Tape TapeChain::tape(std::span<const Number> outputs) const {
  Values values = *values_;
  values.outputs.assign(outputs.begin(), outputs.end());
  return Tape(std::move(values), static_cast<std::size_t>(inputs_));
}

}  // namespace lunid
