// Smoothers against dense solutions of the problems that they claim to solve, and against one another.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "message.hpp"
#include "record/banded.hpp"
#include "record/method_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

VectorXd noisy_sine(Index n, double rows_per_cycle, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, noise);
  return VectorXd::NullaryExpr(
      n, [&](Index i) { return std::sin(2 * M_PI * static_cast<double>(i) / rows_per_cycle) + normal(random); });
}

TEST(BandedLeastSquares, IsTheDenseSolutionWithItsInverse) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const Index n = 20, band = 4, rows = 60;
  MatrixXd a = MatrixXd::Zero(rows, n);
  VectorXd b(rows);
  BandedLeastSquares system(n, band);
  for (Index r = 0; r < rows; ++r) {
    const Index first = std::min(r / 3, n - band);
    VectorXd row(band);
    for (double& value : row) value = normal(random);
    a.row(r).segment(first, band) = row.transpose();
    b[r] = normal(random);
    system.add(first, span_of(row), b[r]);
  }
  const VectorXd x = a.colPivHouseholderQr().solve(b);
  EXPECT_LT((system.solve() - x).norm(), 1e-12 * x.norm());
  EXPECT_NEAR(system.squares(), (a * x - b).squaredNorm(), 1e-12 * b.squaredNorm());
  const MatrixXd inverse = (a.transpose() * a).inverse(), kept = system.inverse_band();
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j < std::min(i + band, n); ++j) EXPECT_NEAR(kept(j - i, i), inverse(i, j), 1e-10);
  EXPECT_NEAR(system.log_determinant(), 0.5 * std::log((a.transpose() * a).determinant()), 1e-10);
}

/// The penalty of Reinsch: f^T K f = integral of f''^2 of the natural cubic spline through f, K = Q R^-1 Q^T.
MatrixXd reinsch(Index n) {
  MatrixXd q = MatrixXd::Zero(n, n - 2), r = MatrixXd::Zero(n - 2, n - 2);
  for (Index j = 0; j < n - 2; ++j) {
    q(j, j) = 1, q(j + 1, j) = -2, q(j + 2, j) = 1;
    r(j, j) = 2.0 / 3;
    if (j > 0) r(j, j - 1) = r(j - 1, j) = 1.0 / 6;
  }
  return q * r.inverse() * q.transpose();
}

TEST(SmoothingSpline, CubicIsReinschsDenseSolution) {
  const Index n = 60;
  const VectorXd x = noisy_sine(n, 23, 0.1, 2);
  for (const double weight : {0.1, 10.0, 1e4}) {
    const MatrixXd hat = (MatrixXd::Identity(n, n) + weight * reinsch(n)).inverse();
    const Spline spline = fit_spline(span_of(x), 3, weight);
    EXPECT_LT((spline.values.col(0) - hat * x).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_NEAR(spline.trace, hat.trace(), 1e-8);
    EXPECT_NEAR(spline.squares, (x - hat * x).squaredNorm(), 1e-10);
    EXPECT_NEAR(spline.values(0, 2), 0, 1e-9);  // natural ends
    EXPECT_NEAR(spline.values(n - 1, 2), 0, 1e-9);
  }
}

TEST(SmoothingSpline, OfAHeavyWeightIsTheLeastSquaresPolynomial) {
  const Index n = 80;
  const VectorXd x = noisy_sine(n, 60, 0.1, 3), s = VectorXd::LinSpaced(n, -1, 1);
  MatrixXd powers(n, 3);
  powers << VectorXd::Ones(n), s, s.cwiseAbs2();
  const VectorXd parabola = powers * powers.colPivHouseholderQr().solve(x);
  const Spline spline = fit_spline(span_of(x), 5, 1e16);
  EXPECT_LT((spline.values.col(0) - parabola).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(spline.trace, 3, 1e-5);
}

/// The batch problem over y, v and a with rows one apart: all rows of all times at once.
VectorXd batch(const std::vector<Measurement>& measured, double density, Index n) {
  MatrixXd transition(3, 3), covariance(3, 3);
  transition << 1, 1, 0.5, 0, 1, 1, 0, 0, 1;
  covariance << 1.0 / 20, 1.0 / 8, 1.0 / 6, 1.0 / 8, 1.0 / 3, 0.5, 1.0 / 6, 0.5, 1;  // of an integrated white jerk
  const MatrixXd root = (density * covariance).llt().matrixL();
  const MatrixXd weight = root.inverse();
  MatrixXd a = MatrixXd::Zero(static_cast<Index>(measured.size()) * n + 3 * (n - 1), 3 * n);
  VectorXd b = VectorXd::Zero(a.rows());
  Index r = 0;
  for (const Measurement& m : measured)
    for (Index i = 0; i < n; ++i, ++r) {
      a(r, 3 * i + m.rank) = 1 / m.noise;
      b[r] = m.values[static_cast<std::size_t>(i)] / m.noise;
    }
  for (Index i = 0; i + 1 < n; ++i, r += 3) {
    a.block(r, 3 * i, 3, 3) = -weight * transition;
    a.block(r, 3 * i + 3, 3, 3) = weight;
  }
  return a.colPivHouseholderQr().solve(b);
}

TEST(KalmanSmoother, IsTheBatchSolution) {
  const Index n = 40;
  const VectorXd y = noisy_sine(n, 23, 0.05, 4), a = -0.07 * noisy_sine(n, 23, 0.1, 5);
  for (const double density : {1e-6, 1e-2}) {
    for (const std::vector<Measurement>& measured :
         {std::vector<Measurement>{{0, span_of(y), 0.05}}, {{0, span_of(y), 0.05}, {2, span_of(a), 0.007}}}) {
      const VectorXd whole = batch(measured, density, n);
      const SmoothedMotion motion = kalman_smoother(measured, 1, {density, 3});
      for (Index i = 0; i < n; ++i)
        for (Index k = 0; k < 3; ++k) EXPECT_NEAR(motion.values(i, k), whole[3 * i + k], 1e-8) << i << " " << k;
    }
  }
}

TEST(KalmanSmoother, OfADisplacementIsTheQuinticSpline) {
  // Wahba 1978: a spline is the smoother of an integrated Wiener process without a prior on its first state.
  const VectorXd x = noisy_sine(300, 40, 0.05, 6);
  const double density = 1e-7;
  const SmoothedMotion motion = kalman_smoother({{0, span_of(x), 0.05}}, 1, {density, 3});
  const Spline spline = fit_spline(span_of(x), 5, 0.05 * 0.05 / density);
  for (int k = 0; k < 3; ++k) EXPECT_LT((motion.values.col(k) - spline.values.col(k)).cwiseAbs().maxCoeff(), 1e-8) << k;
}

TEST(KalmanSmoother, ItsDeviationsHoldUnderItsOwnModel) {
  // Motions drawn from the model: errors over stated deviations are N(0, 1). The density is found within a factor.
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  MatrixXd covariance(3, 3);
  covariance << 1.0 / 20, 1.0 / 8, 1.0 / 6, 1.0 / 8, 1.0 / 3, 0.5, 1.0 / 6, 0.5, 1;
  const double density = 1e-4, noise = 0.5;
  const MatrixXd root = (density * covariance).llt().matrixL();
  const Index n = 1500;
  MatrixXd truth(n, 3);
  Eigen::Vector3d state(0, 0, 0);
  VectorXd y(n), v(n);
  for (Index i = 0; i < n; ++i) {
    truth.row(i) = state.transpose();
    y[i] = state[0] + noise * normal(random);
    v[i] = state[1] + noise * normal(random);
    const Eigen::Vector3d draw(normal(random), normal(random), normal(random));
    state = Eigen::Vector3d(state[0] + state[1] + 0.5 * state[2], state[1] + state[2], state[2]) + root * draw;
  }
  const SmoothedMotion motion = kalman_smoother({{0, span_of(y), noise}, {1, span_of(v), noise}}, 1, {0, 3});
  EXPECT_NEAR(std::log10(motion.density / density), 0, 0.15);
  for (int k = 0; k < 3; ++k) {
    const double ratio =
        std::sqrt((motion.values.col(k) - truth.col(k)).cwiseQuotient(motion.std.col(k)).squaredNorm() / n);
    EXPECT_NEAR(ratio, 1, 0.15) << k;  // some 1500/20 independent errors: 8 % of a deviation
  }
}

TEST(KalmanSmoother, UnitsOfTimeDoNotMatter) {
  const VectorXd y = noisy_sine(200, 40, 0.05, 8);
  const double dt = 1e-3;
  const SmoothedMotion rows = kalman_smoother({{0, span_of(y), 0.05}}, 1),
                       seconds = kalman_smoother({{0, span_of(y), 0.05}}, dt);
  EXPECT_NEAR(seconds.density * std::pow(dt, 7) / rows.density, 1, 1e-6);
  EXPECT_LT((seconds.values.col(2) * dt * dt - rows.values.col(2)).norm(), 1e-6 * rows.values.col(2).norm());
}

TEST(TotalVariation, MeetsTheConditionsOfItsMinimum) {
  const VectorXd x = noisy_sine(300, 80, 0.05, 9);
  for (const int order : {1, 2, 3}) {
    for (const double weight : {0.05, 2.0}) {
      const Variation fit = fit_variation(span_of(x), order, weight);
      // f = x - D^T z; |z| <= weight; z = weight*sign(D f) where D f is not zero. Differences by hand.
      const int k = order + 1;
      const auto difference = [&](VectorXd d) {
        for (int i = 0; i < k; ++i) d = (d.tail(d.size() - 1) - d.head(d.size() - 1)).eval();
        return d;
      };
      VectorXd back = VectorXd::Zero(x.size());
      for (Index j = 0; j < x.size(); ++j) back[j] = difference(VectorXd::Unit(x.size(), j)).dot(fit.dual);
      EXPECT_LT((x - back - fit.values).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LE(fit.dual.cwiseAbs().maxCoeff(), weight);
      const VectorXd bends = difference(fit.values);
      double gap = 0;  // sum of weight*|b| - z*b: all terms >= 0, zero at the minimum
      for (Index i = 0; i < bends.size(); ++i) gap += weight * std::abs(bends[i]) - fit.dual[i] * bends[i];
      const double objective = 0.5 * (x - fit.values).squaredNorm() + weight * bends.lpNorm<1>();
      EXPECT_GE(gap, -1e-9 * objective);
      EXPECT_LT(gap, 1e-8 * objective) << order << " " << weight;
    }
  }
}

TEST(TotalVariation, FindsTheJumpsOfAVelocity) {
  // A saw tooth of displacement: velocity +1 and -1 by turns, 50 rows each.
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal(0, 0.2);
  VectorXd x(400), v(400);
  double y = 0;
  for (Index i = 0; i < 400; ++i) {
    v[i] = (i / 50) % 2 == 0 ? 1 : -1;
    x[i] = y + normal(random);
    y += v[i];
  }
  const auto error = [&](const DerivativeMethod& method) {
    const Derivative d = differentiate(span_of(x), 1, 0.2, 1, method);
    double sum = 0;
    for (Index i = 5; i < 395; ++i)
      if (i % 50 > 4 && i % 50 < 45) sum += std::pow(d.values[i] - v[i], 2) / 320;
    return std::sqrt(sum);
  };
  EXPECT_LT(error(TotalVariation{1}), 0.05);
  EXPECT_LT(error(TotalVariation{1}), 0.6 * error(PolynomialWindow{}));
}

TEST(Smoothers, RefuseWhatCannotBe) {
  const VectorXd x = noisy_sine(40, 20, 0.1, 1);
  const auto said = [&](const DerivativeMethod& method, Index rows = 40) {
    return message([&] { differentiate(span_of(VectorXd(x.head(rows))), 0.01, 0.1, 1, method); });
  };
  EXPECT_EQ(said(SmoothingSpline{4}), "spline: degree: expected 3 or 5, got 4");
  EXPECT_EQ(said(TotalVariation{4}), "total_variation: order: expected 1 to 3, got 4");
  EXPECT_EQ(said(FourierFilter{50}), "fourier: cutoff: expected < 50 Hz, the Nyquist frequency, got 50");
  EXPECT_EQ(said(FiniteDifferences{3, 1}), "finite_differences: accuracy: expected an even number 2 to 12, got 3");
  EXPECT_EQ(said(FiniteDifferences{2, 30}),
            "finite_differences: step: expected 1 to 19 for 40 rows and accuracy 2, got 30");
  EXPECT_EQ(said(PolynomialWindow{10, 3}), "savitzky_golay: rows: expected an odd number, got 10");
  EXPECT_EQ(said(KalmanSmoother{}, 5), "kalman: expected at least 6 rows, got 5");
  EXPECT_EQ(said(KalmanSmoother{0, 2}), "kalman: order: expected 3 to 6, got 2");
  EXPECT_EQ(message([&] { kalman_smoother({}, 1); }), "kalman: expected at least one measured channel");
}

}  // namespace
}  // namespace lunid
