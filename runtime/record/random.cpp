#include "record/random.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include "expr/error.hpp"
#include "expr/number.hpp"

namespace lunid {
namespace {

/// log(n!) by Stirling's series; for small n by the product.
double log_factorial(double n) {
  if (n < 16) {
    double product = 1;
    for (double k = 2; k <= n; ++k) product *= k;
    return std::log(product);
  }
  const double x = n + 1, r = 1 / (x * x);
  return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2 * std::numbers::pi) +
         (1.0 / 12 - r * (1.0 / 360 - r * (1.0 / 1260 - r / 1680))) / x;
}

}  // namespace

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

Philox::Philox(std::uint64_t seed, std::uint64_t stream, std::uint64_t block)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {
  counter_[0] = static_cast<std::uint32_t>(block);
  counter_[1] = static_cast<std::uint32_t>(block >> 32);
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

double Philox::poisson(double mean) {
  if (!(mean >= 0 && mean <= 1e15))
    throw InputError("poisson: expected a mean of 0 to 1e15, got " + write_number(mean, Format::plain).text);
  if (mean < 10) {
    const double least = std::exp(-mean);
    double count = 0;
    for (double product = uniform(); product > least; product *= uniform()) ++count;
    return count;
  }
  const double b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), squeeze = 0.9277 - 3.6224 / (b - 2);
  for (;;) {
    const double u = uniform() - 0.5, v = uniform(), side = 0.5 - std::abs(u);
    const double count = std::floor((2 * a / side + b) * u + mean + 0.43);
    if (side >= 0.07 && v <= squeeze) return count;
    if (count < 0 || (side < 0.013 && v > side)) continue;
    if (std::log(v * inverse_alpha / (a / (side * side) + b)) <= count * std::log(mean) - mean - log_factorial(count))
      return count;
  }
}

std::vector<std::size_t> Philox::permutation(std::size_t n) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[below(i)]);
  return order;
}

std::uint64_t stream_of(std::string_view label) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : label) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

}  // namespace lunid
