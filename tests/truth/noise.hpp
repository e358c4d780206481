#pragma once
// Noise on columns.
#include <random>
#include <vector>

namespace truth {

double deviation(const std::vector<double>& x);

/// x plus Gaussian noise `db` below its own deviation (Box and Muller 1958), white or a first-order autoregression.
std::vector<double> noisy(const std::vector<double>& x, double db, double colour, std::mt19937_64& bits);

}  // namespace truth
