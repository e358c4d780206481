#include "statistics/philox.hpp"

#include <cmath>
#include <numbers>

namespace lunid {

Philox::Counter Philox::block(Counter counter, Key key) {
  constexpr std::uint64_t multiplier0 = 0xD2511F53, multiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t golden_ratio = 0x9E3779B9, root_of_three = 0xBB67AE85;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = multiplier0 * counter[0], product1 = multiplier1 * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
    key[0] += golden_ratio;
    key[1] += root_of_three;
  }
  return counter;
}

Philox::Philox(std::uint64_t seed, std::uint64_t stream)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {
  counter_[2] = static_cast<std::uint32_t>(stream);
  counter_[3] = static_cast<std::uint32_t>(stream >> 32);
}

std::uint32_t Philox::bits() {
  if (left_ == 0) {
    words_ = block(counter_, key_);
    if (++counter_[0] == 0) ++counter_[1];
    left_ = 4;
  }
  return words_[static_cast<std::size_t>(4 - left_--)];
}

double Philox::uniform() {
  const std::uint64_t high = bits(), low = bits();
  return (static_cast<double>(high << 20 | low >> 12) + 0.5) * 0x1p-52;
}

double Philox::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

std::uint64_t Philox::below(std::uint64_t n) {
  if (n <= UINT32_MAX) {  // by a product (Lemire 2019): the remainder tells the few words to draw again
    const auto range = static_cast<std::uint32_t>(n);
    for (;;) {
      const std::uint64_t product = static_cast<std::uint64_t>(bits()) * range;
      const auto low = static_cast<std::uint32_t>(product);
      if (low >= range || low >= static_cast<std::uint32_t>(-range) % range) return product >> 32;
    }
  }
  const std::uint64_t last = UINT64_MAX - (UINT64_MAX % n + 1) % n;  // end of the last whole multiple of n
  for (;;) {
    const std::uint64_t high = bits(), value = high << 32 | bits();
    if (value <= last) return value % n;
  }
}

}  // namespace lunid
