#pragma once
// Kolmogorov-Smirnov tests: the largest difference of two distribution functions. Rows are taken as independent.
#include <cstdint>
#include <span>

#include "statistics/correlation.hpp"

namespace lunid {

/// P(D >= d) for n rows of the distribution that is tested for. Up to 1000 rows exact (Marsaglia, Tsang & Wang 2003, J.
/// Stat. Softw. 8, 18); beyond them the limit with Vrbik's correction (2018), to
/// 3e-5; far in the tail twice the one-sided value
/// (Smirnov 1944).
double kolmogorov_tail(double d, double n);
/// P(D >= d) for two samples of n and m rows of one continuous distribution: exact by counting paths up to n m =
/// 1e6 (Hodges 1958, Ark. Mat. 3, 469), else the limit (Stephens 1970).
double smirnov_tail(double d, double n, double m);

/// Are the rows of the normal distribution with this mean and deviation, known beforehand? deviation > 0. Throws
/// InputError as check_columns() does.
TestResult kolmogorov_normal(std::span<const double> x, double mean, double deviation);
/// Are the rows of any normal distribution? Mean and deviation are those of the rows, which makes D smaller (Lilliefors
/// 1967, J. Am. Stat. Assoc. 62, 399): its distribution is simulated, 1999 draws of up to 500 rows, compared by
/// Stephens' (1974) form of D. At least 5 rows.
TestResult lilliefors(std::span<const double> x, std::uint64_t seed);
/// Are two samples of one distribution?
TestResult kolmogorov_two(std::span<const double> a, std::span<const double> b);

}  // namespace lunid
