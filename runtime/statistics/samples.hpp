#pragma once
// Points spread over the unit cube, for sweeps and ensembles: at random, by Latin hypercubes, by Sobol's sequence.
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>

namespace lunid {

enum class Sampling { random, latin_hypercube, sobol };
std::string to_string(Sampling);
/// "random" "latin_hypercube" "sobol". Throws InputError with the choices.
Sampling sampling_from(std::string_view name);

/// Dimensions for which Sobol's sequence has direction numbers here.
inline constexpr int sobol_dimensions = 21;

/// `count` points in (0, 1)^dimensions, a column each; the same for the same seed. latin_hypercube: each dimension has
/// one point, at random, in each of `count` equal intervals, in random order (McKay, Beckman & Conover 1979). sobol:
/// the first points of Sobol's sequence with the direction numbers of Joe & Kuo (2008, SIAM J. Sci. Comput. 30, 2635),
/// shifted digit by digit by the seed, so that no point lies on 0 and that seeds differ; best where `count` is a power
/// of two. Throws InputError: count or dimensions < 1, more than sobol_dimensions for sobol.
Eigen::MatrixXd unit_samples(Sampling sampling, Eigen::Index count, int dimensions, std::uint64_t seed);

}  // namespace lunid
