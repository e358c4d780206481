#include "truth/law.hpp"

#include <algorithm>
#include <cmath>

namespace truth::laws {

Law of_motion(std::function<double(double, double)> force, std::function<double(double, double)> jump) {
  Law law;
  law.jump = std::move(jump);
  law.force = [force](double, double x, double v, const double*) { return force(x, v); };
  return law;
}

Law of_time(std::function<double(double, double, double)> force) {
  Law law;
  law.ages = true;
  law.force = [force](double tau, double x, double v, const double*) { return force(tau, x, v); };
  return law;
}

Law that_ages(Law law) {
  law.ages = true;
  return law;
}

Law inertia(std::function<double(double, double)> mass, std::function<double(double, double)> force) {
  Law law = of_motion(std::move(force));
  law.mass = std::move(mass);
  return law;
}

Law fractional(double c, double p) {
  // D^p x = sin(pi p)/pi * integral of L^p u_L over ln L, du_L/dt = v - L u_L; beyond the fastest rate u_L = v/L.
  constexpr int count = 44;
  constexpr double step = 0.28, fastest = 300;
  static const std::vector<double> rates = [] {
    std::vector<double> r;
    for (int i = 0; i < count; ++i) r.push_back(fastest * std::exp(-step * (i + 0.5)));
    return r;
  }();
  const double scale = c * std::sin(M_PI * p) / M_PI;
  std::vector<double> weight;
  for (const double rate : rates) weight.push_back(scale * step * std::pow(rate, p));
  const double rest = scale * std::pow(fastest, p - 1) / (1 - p);
  Law law;
  law.states = count;
  law.force = [weight, rest](double, double, double v, const double* u) {
    double f = rest * v;
    for (int i = 0; i < count; ++i) f += weight[i] * u[i];
    return f;
  };
  law.rate = [](double, double, double v, const double* u, double* rate) {
    for (int i = 0; i < count; ++i) rate[i] = v - rates[i] * u[i];
  };
  return law;
}

Law slip(double k, std::function<double(double, double, double)> limit) {
  Law law;
  law.states = 2;  // force, work
  law.force = [limit](double, double x, double v, const double* z) {
    const double most = limit(x, v, z[1]);
    return std::clamp(z[0], -most, most);
  };
  law.rate = [k, limit](double, double x, double v, const double* z, double* rate) {
    rate[0] = k * v;
    rate[1] = std::abs(z[0]) >= limit(x, v, z[1]) && z[0] * v > 0 ? std::abs(z[0] * v) : 0;
  };
  law.settle = [limit](double x, double v, double* z) {
    const double most = limit(x, v, z[1]);
    z[0] = std::clamp(z[0], -most, most);
  };
  return law;
}

Law quake(double q, std::function<double(double, double, double)> force) {
  Law law;
  law.states = 2;  // part of the limit, path of slip
  law.force = [force](double, double, double v, const double* z) {
    return force(std::clamp(z[0], -1.0, 1.0), v, z[1]);
  };
  law.rate = [q](double, double, double v, const double* z, double* rate) {
    rate[0] = v / q;
    rate[1] = std::abs(z[0]) >= 1 && z[0] * v > 0 ? std::abs(v) : 0;
  };
  law.settle = [](double, double, double* z) { z[0] = std::clamp(z[0], -1.0, 1.0); };
  return law;
}

Law masing(std::function<double(double)> backbone, double reach) {
  // Chords of the backbone: element i slips at x_i, and its stiffness is what the slope loses there.
  constexpr int count = 60;
  struct Element {
    double k, limit;
  };
  std::vector<Element> elements;
  std::vector<double> slope, at;
  double before = 0, value = 0;
  for (int i = 1; i <= count; ++i) {
    const double x = reach * std::pow(static_cast<double>(i) / count, 2), f = backbone(x);
    slope.push_back((f - value) / (x - before));
    at.push_back(x);
    before = x;
    value = f;
  }
  for (int i = 0; i < count; ++i) {
    const double k = slope[i] - (i + 1 < count ? slope[i + 1] : 0);
    elements.push_back({k, k * at[i]});
  }
  Law law;
  law.states = count;
  law.force = [elements](double, double, double, const double* z) {
    double f = 0;
    for (int i = 0; i < count; ++i) f += std::clamp(z[i], -elements[i].limit, elements[i].limit);
    return f;
  };
  law.rate = [elements](double, double, double v, const double*, double* rate) {
    for (int i = 0; i < count; ++i) rate[i] = elements[i].k * v;
  };
  law.settle = [elements](double, double, double* z) {
    for (int i = 0; i < count; ++i) z[i] = std::clamp(z[i], -elements[i].limit, elements[i].limit);
  };
  return law;
}

Law toe(double ultimate, double quake, double damping) {
  Law law;
  law.states = 1;  // where the soil stands
  law.force = [=](double, double x, double v, const double* z) {
    const double soil = std::max(z[0], x - quake);
    return ultimate / quake * std::max(x - soil, 0.0) * std::max(1 + damping * v, 0.0);
  };
  law.rate = [](double, double, double, const double*, double* rate) { rate[0] = 0; };
  law.settle = [=](double x, double, double* z) { z[0] = std::max(z[0], x - quake); };
  return law;
}

Law dahl(double stiffness, double friction) {
  Law law;
  law.states = 1;
  law.force = [](double, double, double, const double* z) { return z[0]; };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    rate[0] = stiffness * (v - std::abs(v) * z[0] / friction);
  };
  return law;
}

Law lugre(double s0, double s1, double kinetic, double breakaway, double speed) {
  const auto bend = [=](double v, double z) {
    return v - s0 * std::abs(v) * z / (kinetic + (breakaway - kinetic) * std::exp(-v * v / (speed * speed)));
  };
  Law law;
  law.states = 1;
  law.force = [=](double, double, double v, const double* z) { return s0 * z[0] + s1 * bend(v, z[0]); };
  law.rate = [=](double, double, double v, const double* z, double* rate) { rate[0] = bend(v, z[0]); };
  return law;
}

Law maxwell(double k, double tau) {
  Law law;
  law.states = 1;
  law.force = [](double, double, double, const double* z) { return z[0]; };
  law.rate = [=](double, double, double v, const double* z, double* rate) { rate[0] = k * v - z[0] / tau; };
  return law;
}

Law hidden_mass(double mass, double k, double c) {
  Law law;
  law.states = 2;
  law.force = [=](double, double x, double v, const double* z) { return k * (x - z[0]) + c * (v - z[1]); };
  law.rate = [=](double, double x, double v, const double* z, double* rate) {
    rate[0] = z[1];
    rate[1] = (k * (x - z[0]) + c * (v - z[1])) / mass;
  };
  return law;
}

Law plug(double mass, double k, double limit) {
  Law law;
  law.states = 2;  // force, velocity of the plug
  law.force = [=](double, double, double, const double* z) { return std::clamp(z[0], -limit, limit); };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    rate[0] = k * (v - z[1]);
    rate[1] = std::clamp(z[0], -limit, limit) / mass;
  };
  law.settle = [=](double, double, double* z) { z[0] = std::clamp(z[0], -limit, limit); };
  return law;
}

Law recovery(double k, double first, double last, double tau) {
  Law law;
  law.states = 2;  // force, what is still to recover
  law.ages = true;
  law.start = {0, 1};
  const auto limit = [=](double left) { return last + (first - last) * left; };
  law.force = [=](double, double, double, const double* z) { return std::clamp(z[0], -limit(z[1]), limit(z[1])); };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    rate[0] = k * v;
    rate[1] = -z[1] / tau;
  };
  law.settle = [=](double, double, double* z) { z[0] = std::clamp(z[0], -limit(z[1]), limit(z[1])); };
  return law;
}

}  // namespace truth::laws
