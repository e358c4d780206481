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

Law both(const Law& a, const Law& b) {
  const auto first = [](const Law& law) {
    std::vector<double> z = law.start;
    z.resize(static_cast<std::size_t>(law.states), 0.0);
    return z;
  };
  const int n = a.states;
  Law law;
  law.states = n + b.states;
  law.start = first(a);
  for (const double z : first(b)) law.start.push_back(z);
  law.ages = a.ages || b.ages;
  law.force = [=](double tau, double x, double v, const double* z) {
    return a.force(tau, x, v, z) + b.force(tau, x, v, z + n);
  };
  law.rate = [=](double tau, double x, double v, const double* z, double* rate) {
    if (a.rate) a.rate(tau, x, v, z, rate);
    if (b.rate) b.rate(tau, x, v, z + n, rate + n);
  };
  law.settle = [=](double x, double v, double* z) {
    if (a.settle) a.settle(x, v, z);
    if (b.settle) b.settle(x, v, z + n);
  };
  law.mass = [=](double x, double v) { return (a.mass ? a.mass(x, v) : 0) + (b.mass ? b.mass(x, v) : 0); };
  law.jump = a.jump ? a.jump : b.jump;
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

Law depth(double k, double first, double growth, double tau) {
  const auto limit = [=](const double* z) { return std::max(first + growth * z[1], 0.0); };
  Law law;
  law.states = 2;  // force, slow part of the motion
  law.force = [=](double, double, double, const double* z) { return std::clamp(z[0], -limit(z), limit(z)); };
  law.rate = [=](double, double x, double v, const double* z, double* rate) {
    rate[0] = k * v;
    rate[1] = (x - z[1]) / tau;
  };
  law.settle = [=](double, double, double* z) { z[0] = std::clamp(z[0], -limit(z), limit(z)); };
  return law;
}

Law liquefaction(double k, double still, double flowing, double g, double tau) {
  const auto limit = [=](const double* z) {
    return flowing + (still - flowing) * std::exp(-std::sqrt(2 * std::max(z[1], 0.0)) / g);
  };
  Law law;
  law.states = 2;  // force, mean square of the acceleration
  law.force = [=](double, double, double, const double* z) { return std::clamp(z[0], -limit(z), limit(z)); };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    rate[0] = k * v;
    rate[1] = -z[1] / tau;
  };
  law.shaken = [=](double a, double* rate) { rate[1] += a * a / tau; };
  law.settle = [=](double, double, double* z) { z[0] = std::clamp(z[0], -limit(z), limit(z)); };
  return law;
}

Law pinching(const Wear& w) {
  const double beta = w.rho / std::pow(w.zy, w.n), gamma = (1 - w.rho) / std::pow(w.zy, w.n);
  Law law;
  law.states = 2;  // z, energy over k zy^2
  law.force = [k = w.k](double, double, double, const double* z) { return k * z[0]; };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    const double e = z[1], nu = 1 + w.weaker * e, eta = 1 + w.softer * e, size = std::pow(std::abs(z[0]), w.n);
    const double most = std::pow(1 / (nu * (beta + gamma)), 1 / w.n), side = v < 0 ? -z[0] : z[0];
    const double depth = w.pinched * (1 - std::exp(-w.p * e)), width = (w.psi + w.dpsi * e) * (w.lambda + depth);
    const double h = 1 - depth * std::exp(-std::pow((side - w.q * most) / (w.zy * width), 2));
    rate[0] = h * (v - nu * size * (beta * std::abs(v) * (z[0] < 0 ? -1 : 1) + gamma * v)) / eta;
    rate[1] = z[0] * v / (w.zy * w.zy);
  };
  return law;
}

}  // namespace truth::laws
