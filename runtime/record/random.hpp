#pragma once
// Random numbers that depend on (seed, stream, position) alone, so that work may be shared among threads as
// one likes.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace lunid {

/// Philox4x32-10: a counter-based generator. (Salmon, Moraes, Dror & Shaw 2011, Parallel random numbers: as
/// easy as 1, 2, 3.) Give each draw, record or realisation a stream of its own.
class Philox {
 public:
  /// Begins at the given block of four words: any place of a stream is reached without passing the ones before.
  Philox(std::uint64_t seed, std::uint64_t stream, std::uint64_t block = 0);

  std::uint32_t bits();                  ///< 32 random bits
  double uniform();                      ///< in (0, 1), 52 bits, never an end
  double normal();                       ///< mean 0, standard deviation 1 (Box & Muller 1958)
  std::uint64_t below(std::uint64_t n);  ///< 0 .. n - 1, all equally likely; n >= 1
  /// A count of the given mean. Below 10 by products of uniforms (Knuth, TAOCP 2, 3.4.1), else by transformed
  /// rejection (Hoermann 1993, Insur. Math. Econ. 12, 39). Throws InputError for a mean < 0 or > 1e15.
  double poisson(double mean);
  /// 0 .. n - 1 in random order (Fisher & Yates 1938).
  std::vector<std::size_t> permutation(std::size_t n);

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

/// The stream that belongs to a label, such as "noise y 1": draws of different labels are independent, whichever is
/// made first. (FNV-1a, 64 bits.)
std::uint64_t stream_of(std::string_view label);

}  // namespace lunid
