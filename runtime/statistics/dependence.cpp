#include "statistics/dependence.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "statistics/bootstrap.hpp"

namespace lunid {
namespace {

double explained(const Eigen::VectorXd& residual, const std::vector<Projection>& projections) {
  double sum = 0;
  for (const Projection& p : projections) sum += (p.basis.transpose() * residual(p.rows)).squaredNorm();
  return sum;
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns, double least) {
  if (columns.cols() == 0) return columns;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Eigen::Index rank = 0;
  while (rank < std::min(columns.rows(), columns.cols()) && std::abs(qr.matrixR()(rank, rank)) > least) ++rank;
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), rank);
}

}  // namespace

Eigen::MatrixXd orthonormal_beside(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& nuisance) {
  const double least = 1e-8 * std::max(columns.norm(), nuisance.norm());
  const Eigen::MatrixXd q = orthonormal(nuisance, least);
  return orthonormal(columns - q * (q.transpose() * columns), least);
}

Eigen::MatrixXd legendre(const Eigen::ArrayXd& s, int degree) {
  Eigen::MatrixXd p(s.size(), degree + 1);
  p.col(0).setOnes();
  p.col(1) = s;
  for (int k = 1; k < degree; ++k)
    p.col(k + 1) = ((2 * k + 1) * s * p.col(k).array() - k * p.col(k - 1).array()) / (k + 1);
  return p;
}

Dependence dependence(const Eigen::VectorXd& residual, const Eigen::VectorXd& noise,
                      const std::vector<Projection>& projections, Eigen::Index block_length, std::uint64_t seed) {
  Dependence result;
  const Eigen::Index n = residual.size();
  if (n < 40 || projections.empty()) return result;
  result.explained = explained(residual, projections);
  const Eigen::Index own = choose_block_length({noise.data(), static_cast<std::size_t>(n)});
  const BlockBootstrap bootstrap(n, std::clamp<Eigen::Index>(std::max(block_length, own), 1, n / 20), seed);
  // A p-value of 0.001 for usual records; long ones get fewer draws, never under 199.
  MonteCarlo chance(std::clamp<std::uint64_t>(40'000'000 / static_cast<std::uint64_t>(n), 199, 999));
  double sum = 0;
  while (chance.more()) {
    const double drawn = explained(noise(bootstrap.indices(chance.draws())), projections);
    sum += drawn;
    chance.add(drawn >= result.explained);
  }
  result.by_chance = sum / static_cast<double>(chance.draws());
  result.p_value = chance.p_value();
  return result;
}

}  // namespace lunid
