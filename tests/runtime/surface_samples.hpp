#pragma once
// Points for the tests of surfaces.
#include <cmath>
#include <random>

#include "surface/surface.hpp"

/// Uniform over |y| <= 2 mm, |v| <= 0.5 m/s.
template <class F>
lunid::SurfacePoints uniform_points(Eigen::Index count, F f, double noise = 0) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  lunid::SurfacePoints p{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    p.y[i] = 2e-3 * uniform(random);
    p.v[i] = 0.5 * uniform(random);
    p.f[i] = f(p.y[i], p.v[i]) + noise * normal(random);
  }
  return p;
}

/// A growing spiral, which leaves the corners of its rectangle empty.
template <class F>
lunid::SurfacePoints spiral(Eigen::Index count, F f) {
  lunid::SurfacePoints p{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double growth = static_cast<double>(i) / static_cast<double>(count), angle = 0.7 * static_cast<double>(i);
    p.y[i] = 2e-3 * growth * std::sin(angle);
    p.v[i] = 0.5 * growth * std::cos(angle);
    p.f[i] = f(p.y[i], p.v[i]);
  }
  return p;
}
