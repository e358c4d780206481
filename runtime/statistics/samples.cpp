#include "statistics/samples.hpp"

#include <array>
#include <bit>
#include <vector>

#include "expr/error.hpp"
#include "record/random.hpp"

namespace lunid {
namespace {

using Eigen::Index;

constexpr int digits = 32;

/// A primitive polynomial over the field of two elements: its degree, its inner coefficients as bits, and the first
/// direction numbers. Of dimension 2 on; dimension 1 is van der Corput's sequence.
struct Direction {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 7> first;
};
constexpr std::array<Direction, sobol_dimensions - 1> directions{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
}};

/// v_k of a dimension, k = 0 ... 31, as digits from the highest bit on.
std::array<std::uint32_t, digits> direction_numbers(int dimension) {
  std::array<std::uint32_t, digits> v{};
  if (dimension == 0) {
    for (int k = 0; k < digits; ++k) v[static_cast<std::size_t>(k)] = 1u << (digits - 1 - k);
    return v;
  }
  const Direction& d = directions[static_cast<std::size_t>(dimension - 1)];
  const auto s = static_cast<std::size_t>(d.degree);
  for (std::size_t k = 0; k < digits; ++k) {
    if (k < s) {
      v[k] = d.first[k] << (digits - 1 - k);
      continue;
    }
    v[k] = v[k - s] ^ (v[k - s] >> s);
    for (std::size_t j = 1; j < s; ++j)
      if (d.coefficients >> (s - 1 - j) & 1) v[k] ^= v[k - j];
  }
  return v;
}

/// In Gray-code order (Antonov & Saleev 1979): each point differs from the one before by one direction number.
void fill_sobol(Eigen::MatrixXd& points, std::uint64_t seed) {
  for (Index row = 0; row < points.rows(); ++row) {
    const auto v = direction_numbers(static_cast<int>(row));
    Philox random(seed, stream_of("sobol " + std::to_string(row)));
    const std::uint32_t shift = random.bits();
    std::uint32_t x = 0;
    for (Index i = 0; i < points.cols(); ++i) {
      points(row, i) = (static_cast<double>(x ^ shift) + 0.5) * 0x1p-32;
      x ^= v[static_cast<std::size_t>(std::countr_one(static_cast<std::uint32_t>(i)))];
    }
  }
}

void fill_latin(Eigen::MatrixXd& points, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(points.cols());
  for (Index row = 0; row < points.rows(); ++row) {
    Philox random(seed, stream_of("latin hypercube " + std::to_string(row)));
    const std::vector<std::size_t> order = random.permutation(count);
    for (std::size_t i = 0; i < count; ++i)
      points(row, static_cast<Index>(i)) =
          (static_cast<double>(order[i]) + random.uniform()) / static_cast<double>(count);
  }
}

void fill_random(Eigen::MatrixXd& points, std::uint64_t seed) {
  for (Index row = 0; row < points.rows(); ++row) {
    Philox random(seed, stream_of("random " + std::to_string(row)));
    for (Index i = 0; i < points.cols(); ++i) points(row, i) = random.uniform();
  }
}

}  // namespace

std::string to_string(Sampling sampling) {
  switch (sampling) {
    case Sampling::random: return "random";
    case Sampling::latin_hypercube: return "latin_hypercube";
    case Sampling::sobol: return "sobol";
  }
  return "";
}

Sampling sampling_from(std::string_view name) {
  std::vector<std::string> choices;
  for (const Sampling sampling : {Sampling::random, Sampling::latin_hypercube, Sampling::sobol}) {
    if (to_string(sampling) == name) return sampling;
    choices.push_back(to_string(sampling));
  }
  throw InputError("method: expected random, latin_hypercube or sobol, got '" + std::string(name) + "'" +
                   did_you_mean(nearest_word(std::string(name), choices)));
}

Eigen::MatrixXd unit_samples(Sampling sampling, Index count, int dimensions, std::uint64_t seed) {
  if (count < 1) throw InputError("samples: expected >= 1, got " + std::to_string(count));
  if (dimensions < 1) throw InputError("draw: expected 1 quantity or more, got " + std::to_string(dimensions));
  if (sampling == Sampling::sobol && dimensions > sobol_dimensions)
    throw InputError("method: sobol: expected at most " + std::to_string(sobol_dimensions) + " quantities, got " +
                     std::to_string(dimensions) + "; take latin_hypercube");
  Eigen::MatrixXd points(dimensions, count);
  switch (sampling) {
    case Sampling::random: fill_random(points, seed); break;
    case Sampling::latin_hypercube: fill_latin(points, seed); break;
    case Sampling::sobol: fill_sobol(points, seed); break;
  }
  return points;
}

}  // namespace lunid
