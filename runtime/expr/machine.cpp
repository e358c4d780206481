#include "expr/machine.hpp"

#if defined(__x86_64__) && defined(__linux__)
#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "expr/op.hpp"

namespace lunid {
namespace {

constexpr std::size_t never = std::numeric_limits<std::size_t>::max();
constexpr std::uint64_t sign_bit = 0x8000000000000000;

/// The bytes of instructions (Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2). `packed`: on
/// eight numbers, four in a vector register and four in the register eight places on: while one waits for a result the
/// other goes on. Else on one number.
class Bytes {
 public:
  std::vector<std::uint8_t> all;
  bool packed = false;

  void put(std::initializer_list<int> bytes) {
    for (const int byte : bytes) all.push_back(static_cast<std::uint8_t>(byte));
  }
  void put32(std::uint32_t value) {
    for (int i = 0; i < 4; ++i) put({static_cast<int>(value >> 8 * i & 255)});
  }
  void put64(std::uint64_t value) {
    put32(static_cast<std::uint32_t>(value));
    put32(static_cast<std::uint32_t>(value >> 32));
  }
  void align(std::size_t to) {
    while (all.size() % to) put({0x90});
  }

  enum Operation {
    load = 0x10,
    store = 0x11,
    root = 0x51,
    flip = 0x57,
    duplicate = 0x28,
    sum = 0x58,
    product = 0x59,
    difference = 0x5C,
    quotient = 0x5E
  };
  /// to = a <operation> b, all three vector registers.
  void arithmetic(Operation operation, int to, int a, int b) {
    each([&](int other) {
      prefix(operation, to + other, operation == root && packed ? 0 : a + other, b + other);
      put({0xC0 | (to & 7) << 3 | (b & 7)});
    });
  }
  /// The same with the second operand at [r8 + rcx + offset].
  void arithmetic_of_row(Operation operation, int to, int a, std::uint32_t offset) {
    each([&](int other) {
      prefix(operation, to + other, operation == load || operation == store ? 0 : a + other, 8);
      put({0x80 | (to & 7) << 3 | 4, 0x08});
      put32(offset + static_cast<std::uint32_t>(4 * other));
    });
  }
  /// to = b where the sign of `mask` is set, else a; four at once.
  void blend(int to, int a, int b, int mask) {
    each([&](int other) {
      put({0xC4, (to + other < 8 ? 0x80 : 0) | 0x40 | (b + other < 8 ? 0x20 : 0) | 3, (~(a + other) & 15) << 3 | 4 | 1,
           0x4B, 0xC0 | (to & 7) << 3 | (b & 7), (mask + other) << 4});
    });
  }
  /// to = a <operation> the four numbers at `place` of the bytes.
  void arithmetic_of_constant(Operation operation, int to, int a, std::size_t place) {
    each([&](int other) {
      prefix(operation, to + other, operation == load ? 0 : a + other, 0);
      put({(to & 7) << 3 | 5});
      put32(static_cast<std::uint32_t>(static_cast<std::int64_t>(place) - static_cast<std::int64_t>(all.size() + 4)));
    });
  }
  /// to = -a, by the mask at the front of the bytes.
  void negative(int to, int a) { arithmetic_of_constant(flip, to, a, 0); }
  void put_four(std::uint64_t bits) {
    for (int i = 0; i < 4; ++i) put64(bits);
  }
  /// By rax, of one number.
  void number(int to, double value) {
    put({0x48, 0xB8});  // mov rax, value; vmovq to, rax
    put64(std::bit_cast<std::uint64_t>(value));
    put({0xC4, (to < 8 ? 0x80 : 0) | 0x60 | 1, 0xF9, 0x6E, 0xC0 | (to & 7) << 3});
  }
  void copy(int to, int from) {
    prefix(duplicate, to, 0, from);
    put({0xC0 | (to & 7) << 3 | (from & 7)});
  }
  /// Between a vector register and [base + offset]; base 3: rbx, 7: rdi.
  void move(Operation operation, int vector, int base, std::uint32_t offset) {
    prefix(operation, vector, 0, 0);
    put({0x80 | (vector & 7) << 3 | base});
    put32(offset);
  }
  /// to = a <operation> what stands at [base + rcx].
  void arithmetic_of_lanes(Operation operation, int to, int a, int base) {
    each([&](int other) {
      prefix(operation, to + other, operation == load || operation == store ? 0 : a + other, base);
      put({0x40 | (to & 7) << 3 | 4, 0x08 | (base & 7), 4 * other});
    });
  }
  /// base = an entry of the table that rdi points to.
  void load_entry(int base, std::uint32_t entry) {
    put({base < 8 ? 0x48 : 0x4C, 0x8B, 0x87 | (base & 7) << 3});
    put32(8 * entry);
  }
  void push(int base) { push_or_pop(0x50, base); }
  void pop(int base) { push_or_pop(0x58, base); }
  /// Vector registers that hold values of their own.
  int registers() const { return packed ? 8 : 16; }

 private:
  void push_or_pop(int code, int base) {
    if (base >= 8) put({0x41});
    put({code | (base & 7)});
  }
  /// Emits for the four numbers of a register, then for the other four.
  template <class Emit>
  void each(Emit emit) {
    emit(0);
    if (packed) emit(8);
  }
  void prefix(Operation operation, int to, int a, int b) {
    const bool whole = packed || operation == flip || operation == duplicate;  // these know whole registers only
    put({0xC4, (to < 8 ? 0x80 : 0) | 0x40 | (b < 8 ? 0x20 : 0) | 1, (~a & 15) << 3 | (packed ? 4 : 0) | (whole ? 1 : 3),
         operation});
  }
};

/// Where Machine puts a constant of a tape: behind the mask, each four times.
constexpr std::size_t constants_place(std::size_t i) { return 4 * sizeof(double) * (1 + i); }

/// Translates instructions, keeping values in the vector registers for as long as they are read.
class Translator {
 public:
  /// `rows`: temporaries of lanes stand Machine::lane_row apart.
  Translator(const Program& program, const Assembly& assembly, bool rows, Bytes& bytes)
      : layout_(program.layout),
        code_(assembly.instructions),
        rows_(rows),
        bytes_(bytes),
        slot_of_(program.registers, -1) {
    find_last_reads();
    if (bytes.packed) choose_bases();
  }

  /// Of lanes: the pointers that are used most, in registers of the processor; those that are a caller's come back.
  void load_bases() {
    for (const auto& [base, entry] : bases_) {
      if (callers(base)) bytes_.push(base);
      bytes_.load_entry(base, entry);
    }
  }
  void return_bases() {
    for (auto at = bases_.rbegin(); at != bases_.rend(); ++at)
      if (callers(at->first)) bytes_.pop(at->first);
  }

  /// Emits the whole; false where an instruction has no translation.
  bool translate() {
    for (at_ = 0; code_[at_].code != Code::done; ++at_)
      if (!instruction(code_[at_])) return false;
    return true;
  }

  static bool calls(const Assembly& assembly) {
    for (const Instruction& i : assembly.instructions)
      if (i.code == Code::call) return true;
    return false;
  }
  /// What was written last, in the register of a function's value.
  void hand_over() {
    if (at_ == 0) return;
    const int slot = operand(code_[at_ - 1].dst);
    if (slot != 0) bytes_.copy(0, slot);
  }
  int base = 7;  ///< of the registers: rdi, or rbx where functions are called

 private:
  struct Slot {
    int value = -1;      ///< the tape's register that it holds
    bool ahead = false;  ///< memory does not have it yet
    std::size_t used = 0;
  };

  void find_last_reads() {
    std::vector<std::size_t> next(slot_of_.size(), never);
    last_read_.resize(code_.size(), never);
    for (std::size_t i = code_.size(); i-- > 0;) {
      const Instruction& at = code_[i];
      if (at.code == Code::done) continue;
      last_read_[i] = std::exchange(next[at.dst], never);
      const std::uint32_t operands[] = {at.a, at.b, at.c, at.d};
      const int count = operand_count({at.code, at.a, at.b, at.c, at.d});
      for (int k = 0; k < count; ++k)
        if (next[operands[k]] == never) next[operands[k]] = i;
    }
    needed_until_ = std::move(next);
  }
  bool needed(int value) const {
    const std::size_t until = needed_until_[static_cast<std::size_t>(value)];
    return until != never && until >= at_;
  }

  /// rbx, rbp and r12 on.
  static bool callers(int base) { return base == 3 || base == 5 || base >= 12; }
  void choose_bases() {
    std::vector<std::pair<int, std::uint32_t>> uses(slot_of_.size());  // and the entry
    for (std::uint32_t r = 0; r < uses.size(); ++r) uses[r].second = r;
    const auto count = [&](std::uint32_t r) { uses[r].first += in_table(r); };
    for (const Instruction& at : code_) {
      if (at.code == Code::done) continue;
      count(at.dst);
      const std::uint32_t operands[] = {at.a, at.b, at.c, at.d};
      std::for_each_n(operands, operand_count({at.code, at.a, at.b, at.c, at.d}), count);
    }
    std::stable_sort(uses.begin(), uses.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    base_of_.assign(uses.size(), 0);
    std::size_t next = 0;
    for (const int base : {2, 9, 10, 11, 3, 5, 12, 13, 14, 15}) {
      if (next == uses.size() || uses[next].first == 0) return;
      const std::uint32_t entry = uses[next++].second;
      bases_.emplace_back(base, entry);
      base_of_[entry] = base;
    }
  }
  /// The register that points to the lanes of a value; rax, where none does all the time.
  int base_of(std::uint32_t value) {
    if (base_of_[value] == 0) bytes_.load_entry(0, value);
    return base_of_[value];
  }

  void move(Bytes::Operation operation, int vector, std::uint32_t value) {
    if (!bytes_.packed) return bytes_.move(operation, vector, base, 8 * value);
    arithmetic_in_memory(operation, vector, 0, value);
  }
  /// to = a <operation> a value of lanes where it is.
  void arithmetic_in_memory(Bytes::Operation operation, int to, int a, std::uint32_t value) {
    if (is_constant(value)) return bytes_.arithmetic_of_constant(operation, to, a, place_of(value));
    if (in_row(value)) return bytes_.arithmetic_of_row(operation, to, a, offset(value));
    bytes_.arithmetic_of_lanes(operation, to, a, base_of(value));
  }

  /// A constant of lanes stands among the bytes, once: as a row it would take the cache from those that change.
  bool is_constant(std::uint32_t value) const {
    return bytes_.packed && value >= layout_.inputs && value < layout_.outputs;
  }
  std::size_t place_of(std::uint32_t constant) const { return constants_place(constant - layout_.inputs); }
  bool in_row(std::uint32_t value) const { return rows_ && value >= layout_.temporaries; }
  std::uint32_t offset(std::uint32_t value) const { return 8 * Machine::lane_row * (value - layout_.temporaries); }
  bool in_table(std::uint32_t value) const { return !is_constant(value) && !in_row(value); }
  /// It can be an operand where it is, in memory: one instruction less.
  bool stays(std::uint32_t value) const { return bytes_.packed && slot_of_[value] < 0; }
  /// to = a <operation> the value.
  void arithmetic(Bytes::Operation operation, int to, int a, std::uint32_t value) {
    if (stays(value)) return arithmetic_in_memory(operation, to, a, value);
    bytes_.arithmetic(operation, to, a, operand(value));
  }
  /// to = a * b, or a + b: what is in a register first. Gives `to`, taken after the operands.
  int together(Bytes::Operation operation, std::uint32_t a, std::uint32_t b) {
    if (stays(a) && (!stays(b) || is_constant(a))) std::swap(a, b);
    const int first = operand(a);
    if (!stays(b)) operand(b);
    const int to = take();
    arithmetic(operation, to, first, b);
    return to;
  }

  /// A free vector register, or the one that was used longest ago.
  int take() {
    int chosen = -1;
    for (int s = 0; s < bytes_.registers() && chosen < 0; ++s)
      if (slots_[s].used != at_ + 1 && (slots_[s].value < 0 || !needed(slots_[s].value))) chosen = s;
    if (chosen < 0) {
      chosen = 0;
      for (int s = 1; s < bytes_.registers(); ++s)
        if (slots_[s].used < slots_[chosen].used) chosen = s;
      if (slots_[chosen].ahead) move(Bytes::store, chosen, static_cast<std::uint32_t>(slots_[chosen].value));
    }
    drop(chosen);
    slots_[chosen].used = at_ + 1;
    return chosen;
  }
  void drop(int slot) {
    if (slots_[slot].value >= 0) slot_of_[static_cast<std::size_t>(slots_[slot].value)] = -1;
    slots_[slot] = {};
  }
  void hold(int slot, std::uint32_t value, bool ahead) {
    slots_[slot] = {static_cast<int>(value), ahead, at_ + 1};
    slot_of_[value] = slot;
  }

  /// The vector register of an operand.
  int operand(std::uint32_t value) {
    if (slot_of_[value] >= 0) {
      slots_[slot_of_[value]].used = at_ + 1;
      return slot_of_[value];
    }
    const int slot = take();
    move(Bytes::load, slot, value);
    hold(slot, value, false);
    return slot;
  }
  void define(std::uint32_t value, int slot) {
    if (slot_of_[value] >= 0) drop(slot_of_[value]);
    needed_until_[value] = last_read_[at_];
    const bool result = value >= layout_.outputs && value < layout_.temporaries;
    if (result) move(Bytes::store, slot, value);
    hold(slot, value, !result);
  }

  bool instruction(const Instruction& i) {
    switch (i.code) {
      case Code::copy: return copy(i);
      case Code::constant: return constant(i);
      case Code::add: return simple(i, Bytes::sum);
      case Code::sub: return simple(i, Bytes::difference);
      case Code::mul: return simple(i, Bytes::product);
      case Code::div: return simple(i, Bytes::quotient);
      case Code::neg: return negative(i);
      case Code::sqrt: return root(i);
      case Code::mul3: return fused(i, Bytes::product, false);
      case Code::mul_add: return fused(i, Bytes::sum, false);
      case Code::mul_sub: return fused(i, Bytes::difference, false);
      case Code::sub_mul: return fused(i, Bytes::difference, true);
      case Code::mul_add_mul: return two_products(i, Bytes::sum);
      case Code::mul_sub_mul: return two_products(i, Bytes::difference);
      case Code::sub_sum: return sub_sum(i);
      case Code::choose: return bytes_.packed && choose(i);
      case Code::call: return !bytes_.packed && call(i);
      default: return false;
    }
  }

  bool copy(const Instruction& i) {
    const int from = operand(i.a);
    if (!bytes_.packed && i.dst >= layout_.temporaries) {
      const int to = take();
      bytes_.copy(to, from);
      define(i.dst, to);
      return true;
    }
    if (slot_of_[i.dst] >= 0) drop(slot_of_[i.dst]);
    needed_until_[i.dst] = last_read_[at_];
    move(Bytes::store, from, i.dst);
    return true;
  }
  bool constant(const Instruction& i) {
    const int to = take();
    bytes_.number(to, static_cast<double>(i.a) - 1);
    define(i.dst, to);
    return true;
  }
  bool simple(const Instruction& i, Bytes::Operation operation) {
    if (operation == Bytes::sum || operation == Bytes::product) {
      define(i.dst, together(operation, i.a, i.b));
      return true;
    }
    const int a = operand(i.a);
    if (!stays(i.b)) operand(i.b);
    const int to = take();
    arithmetic(operation, to, a, i.b);
    define(i.dst, to);
    return true;
  }
  bool negative(const Instruction& i) {
    const int a = operand(i.a), to = take();
    bytes_.negative(to, a);
    define(i.dst, to);
    return true;
  }
  bool root(const Instruction& i) {
    const int a = operand(i.a), to = take();
    bytes_.arithmetic(Bytes::root, to, a, a);
    define(i.dst, to);
    return true;
  }
  /// a*b, then with c; turned: c is the first of the two.
  bool fused(const Instruction& i, Bytes::Operation operation, bool turned) {
    if (turned || !stays(i.c)) operand(i.c);
    const int to = together(Bytes::product, i.a, i.b);
    if (turned)
      bytes_.arithmetic(operation, to, operand(i.c), to);
    else
      arithmetic(operation, to, to, i.c);
    define(i.dst, to);
    return true;
  }
  bool two_products(const Instruction& i, Bytes::Operation operation) {
    const int to = together(Bytes::product, i.a, i.b), other = together(Bytes::product, i.c, i.d);
    bytes_.arithmetic(operation, to, to, other);
    define(i.dst, to);
    slots_[other] = {};
    return true;
  }
  bool sub_sum(const Instruction& i) {
    operand(i.d);
    if (!stays(i.c)) operand(i.c);
    const int to = together(Bytes::product, i.a, i.b);
    arithmetic(Bytes::sum, to, to, i.c);
    bytes_.arithmetic(Bytes::difference, to, operand(i.d), to);
    define(i.dst, to);
    return true;
  }
  bool choose(const Instruction& i) {
    const int mode = operand(i.a), plus = operand(i.b), minus = operand(i.c), to = take();
    bytes_.blend(to, plus, minus, mode);
    define(i.dst, to);
    return true;
  }
  /// A function of the language, to which no vector register is sacred.
  bool call(const Instruction& i) {
    for (int s = 0; s < 16; ++s) {
      if (slots_[s].ahead && needed(slots_[s].value))
        move(Bytes::store, s, static_cast<std::uint32_t>(slots_[s].value));
      drop(s);
    }
    const std::uint32_t arguments[] = {i.a, i.b, i.c};
    for (int k = 0; k < 3; ++k) move(Bytes::load, k, arguments[k]);
    bytes_.put({0x48, 0xB8});  // mov rax, function; call rax
    bytes_.put64(reinterpret_cast<std::uint64_t>(row_of(static_cast<Op>(i.d)).value));
    bytes_.put({0xFF, 0xD0});
    slots_[0].used = at_ + 1;
    define(i.dst, 0);
    return true;
  }

  const Layout& layout_;
  const std::vector<Instruction>& code_;
  const bool rows_;
  Bytes& bytes_;
  Slot slots_[16];
  std::vector<int> base_of_;  ///< of each register of the tape; 0: none
  std::vector<std::pair<int, std::uint32_t>> bases_;
  std::vector<int> slot_of_;               ///< of each register of the tape; -1: in memory only
  std::vector<std::size_t> last_read_;     ///< of what each instruction writes
  std::vector<std::size_t> needed_until_;  ///< the last read of what each register holds now
  std::size_t at_ = 0;
};

/// Appends a function of one point, or of lanes; where it begins, or nothing.
enum class Form { point, lanes, rows };
std::optional<std::size_t> append(const Program& program, const Assembly& assembly, Form form, Bytes& bytes) {
  const bool packed = form != Form::point;
  bytes.align(32);
  bytes.packed = packed;
  const std::size_t entry = bytes.all.size();
  const bool calls = !packed && Translator::calls(assembly);
  Translator translator(program, assembly, form == Form::rows, bytes);
  if (calls) {
    translator.base = 3;
    bytes.put({0x53, 0x48, 0x89, 0xFB});  // push rbx; mov rbx, rdi
  }
  if (packed) bytes.put({0x48, 0xC1, 0xE6, 0x03, 0x31, 0xC9});  // shl rsi, 3; xor ecx, ecx
  if (form == Form::rows && assembly.registers > program.layout.temporaries)
    bytes.load_entry(8, program.layout.temporaries);
  if (packed) translator.load_bases();
  const std::size_t again = bytes.all.size();
  if (!translator.translate()) {
    bytes.all.resize(entry);
    return {};
  }
  if (!packed) translator.hand_over();
  if (packed) {
    bytes.put({0x48, 0x83, 0xC1, 0x40, 0x48, 0x39, 0xF1, 0x0F, 0x82});  // add rcx, 64; cmp rcx, rsi; jb again
    bytes.put32(static_cast<std::uint32_t>(again - (bytes.all.size() + 4)));
    bytes.put({0xC5, 0xF8, 0x77});  // vzeroupper
    translator.return_bases();
  }
  if (calls) bytes.put({0x5B});  // pop rbx
  bytes.put({0xC3});             // ret
  return entry;
}

}  // namespace

Machine::Machine(const Program& program) {
  if (!__builtin_cpu_supports("avx")) return;
  Bytes bytes;
  bytes.put_four(sign_bit);
  for (const double constant : program.layout.constants) bytes.put_four(std::bit_cast<std::uint64_t>(constant));
  const auto one = append(program, program.values, Form::point, bytes),
             one_less = append(program, program.computed, Form::point, bytes);
  const auto lanes = append(program, program.values, Form::lanes, bytes),
             lanes_less = append(program, program.computed, Form::lanes, bytes),
             rows = append(program, program.values, Form::rows, bytes);
  if (!place(bytes.all)) return;
  const auto code = [&](std::size_t entry) { return static_cast<std::uint8_t*>(memory_) + entry; };
  if (one) values = reinterpret_cast<Point>(code(*one));
  if (one_less) computed = reinterpret_cast<Point>(code(*one_less));
  if (lanes) lane_values = reinterpret_cast<Lanes>(code(*lanes));
  if (lanes_less) lane_computed = reinterpret_cast<Lanes>(code(*lanes_less));
  if (rows) row_values = reinterpret_cast<Lanes>(code(*rows));
}

Machine::Machine(const Program& program, const Assembly& assembly) {
  if (!__builtin_cpu_supports("avx")) return;
  Bytes bytes;
  bytes.put_four(sign_bit);
  const auto entry = append(program, assembly, Form::point, bytes);
  if (entry && place(bytes.all)) values = reinterpret_cast<Point>(static_cast<std::uint8_t*>(memory_) + *entry);
}

/// Written first, then made executable: never both at once.
bool Machine::place(const std::vector<std::uint8_t>& bytes) {
  void* const memory = mmap(nullptr, bytes.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  memory_ = memory;
  size_ = bytes.size();
  std::memcpy(memory, bytes.data(), size_);
  return mprotect(memory, size_, PROT_READ | PROT_EXEC) == 0;
}

Machine::~Machine() {
  if (memory_) munmap(memory_, size_);
}

}  // namespace lunid

#else

namespace lunid {
Machine::Machine(const Program&) {}
Machine::Machine(const Program&, const Assembly&) {}
Machine::~Machine() = default;
}  // namespace lunid

#endif
