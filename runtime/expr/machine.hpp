#pragma once
// Machine code of a tape's arithmetic: the instructions of the interpreters, on the same operands in the same order, so
// with the same bits. It saves their dispatch and the way of each result through memory to its user, which is longer
// than the operation. Made for x86-64 with AVX on Linux; elsewhere, and for what holds
// switches that no mode tells (frozen.hpp), the interpreters run.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "expr/program.hpp"

namespace lunid {

class Machine {
 public:
  using Point = Tape::PointCode;
  using Lanes = void (*)(double* const* place, std::size_t lanes);  ///< lanes: a multiple of eight

  Machine() = default;
  explicit Machine(const Program& program);
  /// Of other code on the registers of a program, as values alone.
  Machine(const Program& program, const Assembly& assembly);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Of the outputs, and of those that are no inputs. Null: there is none.
  Point values = nullptr, computed = nullptr;
  Lanes lane_values = nullptr, lane_computed = nullptr;
  /// Of the outputs, where temporaries stand lane_row doubles apart, in the order of their registers: no way leads
  /// through the table.
  Lanes row_values = nullptr;
  static constexpr std::uint32_t lane_row = 72;  // 64 lanes, and what keeps rows from falling into one set of a cache

 private:
  bool place(const std::vector<std::uint8_t>& bytes);

  void* memory_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace lunid
