#pragma once
// Tapes put together from runs of others and the arithmetic between them, value by value: a step of an integrator as
// one tape. Every operation is that of the parts, on the same operands in the same order, so with the same bits; what
// two parts have in common is computed once.
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "expr/tape.hpp"

namespace lunid {

struct Value;
struct Values;

class TapeChain {
 public:
  /// A value of the chain.
  using Number = std::uint32_t;

  explicit TapeChain(int inputs);
  ~TapeChain();
  TapeChain(const TapeChain&) = delete;
  TapeChain& operator=(const TapeChain&) = delete;

  Number input(int i) const { return static_cast<Number>(i); }
  Number constant(double value);
  Number sum(Number a, Number b);
  Number difference(Number a, Number b);
  Number product(Number a, Number b);
  Number negative(Number a);
  struct Run {
    std::vector<Number> outputs;
    std::vector<Number> switches;  ///< g of each switch
  };
  /// A tape at these inputs, one for each of its own. `modes`: +1 or -1, a value for each switch of the tape, which is
  /// then frozen as in Tape::run_frozen; none: branches by the sign of g.
  Run run(const Tape& tape, std::span<const Number> inputs, std::span<const Number> modes = {});

  /// The tape of these outputs.
  Tape tape(std::span<const Number> outputs) const;

 private:
  using Key = std::array<std::uint32_t, 6>;
  Number add(const Key& key);
  Number frozen(const Value& value, Number mode);
  Number choose(Number mode, Number plus, Number minus);

  int inputs_;
  std::unique_ptr<Values> values_;
  std::map<Key, Number> known_;
  std::map<std::uint64_t, std::uint32_t> constants_;  // by their bits
  std::map<Number, Number> mode_of_;                  // of frozen comparisons
};

}  // namespace lunid
