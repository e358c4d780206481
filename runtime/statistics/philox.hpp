#pragma once
// Random numbers that depend on (seed, stream, position) alone, so that work may be shared among threads as
// one likes.
#include <array>
#include <cstdint>

namespace lunid {

/// Philox4x32-10: a counter-based generator. (Salmon, Moraes, Dror & Shaw 2011, Parallel random numbers: as
/// easy as 1, 2, 3.) Give each draw, record or realisation a stream of its own.
class Philox {
 public:
  Philox(std::uint64_t seed, std::uint64_t stream);

  std::uint32_t bits();                  ///< 32 random bits
  double uniform();                      ///< in (0, 1), 52 bits, never an end
  double normal();                       ///< mean 0, standard deviation 1 (Box & Muller 1958)
  std::uint64_t below(std::uint64_t n);  ///< 0 .. n - 1, all equally likely; n >= 1

  using Counter = std::array<std::uint32_t, 4>;
  using Key = std::array<std::uint32_t, 2>;
  /// The bijection itself.
  static Counter block(Counter counter, Key key);

 private:
  Key key_;
  Counter counter_{}, words_{};
  int left_ = 0;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace lunid
