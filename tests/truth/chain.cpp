#include "truth/chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "truth/noise.hpp"

namespace truth {
namespace {

constexpr double warm_up = 120;  // radians before the record begins
constexpr int bisections = 40;

/// x of each mass, v of each mass, s and z of each link.
using Vector = std::vector<double>;

class Run {
 public:
  Run(const Chain& chain, const std::vector<Signal>& signals, double level)
      : chain_(chain), signals_(signals), level_(level), n_(chain.masses.size()), links_(chain.links.size()) {
    state_.assign(2 * n_ + 2 * links_, 0.0);
    mode_.assign(links_, 0);
    for (std::size_t i = 0; i < links_; ++i) settle(i);
  }

  /// One small step, split where a friction begins or ends to slide.
  void step(double& tau, double h) {
    double left = h;
    for (int split = 0; left > 0 && split < 20; ++split) {
      for (std::size_t i = 0; i < links_; ++i) settle(i, tau);
      Vector next = rk4(tau, left);
      if (!crossed(next)) {
        take(next, tau, left);
        return;
      }
      double low = 0, high = left;
      for (int k = 0; k < bisections; ++k) {
        const double middle = 0.5 * (low + high);
        (crossed(rk4(tau, middle)) ? high : low) = middle;
      }
      take(rk4(tau, high), tau, high);
      left -= high;
      for (std::size_t i = 0; i < links_; ++i)
        if (mode_[i] != 0 && rate(i, state_) * mode_[i] <= 0) stop(i);
    }
  }

  double x(std::size_t mass) const { return state_[mass]; }
  bool sticks() const {
    for (std::size_t i = 0; i < links_; ++i)
      if (chain_.links[i].coulomb > 0 && mode_[i] == 0) return true;
    return false;
  }
  double force(std::size_t driven, double tau) const { return level_ * signals_[driven](tau); }

 private:
  double elongation(std::size_t i, const Vector& s) const {
    const Link& l = chain_.links[i];
    return s[static_cast<std::size_t>(l.of)] - (l.from < 0 ? 0 : s[static_cast<std::size_t>(l.from)]);
  }
  double rate(std::size_t i, const Vector& s) const {
    const Link& l = chain_.links[i];
    return s[n_ + static_cast<std::size_t>(l.of)] - (l.from < 0 ? 0 : s[n_ + static_cast<std::size_t>(l.from)]);
  }
  /// How fast the rate of a link changes under a unit force in another: a column of the constraints' matrix.
  double response(std::size_t i, std::size_t j) const {
    const Link &a = chain_.links[i], &b = chain_.links[j];
    const auto part = [&](int mass, double sign) {
      if (mass < 0) return 0.0;
      const double own = (a.of == mass ? 1 : 0) - (a.from == mass ? 1 : 0);
      return own * sign / chain_.masses[static_cast<std::size_t>(mass)];
    };
    return -part(b.of, 1) - part(b.from, -1);
  }

  void add(std::size_t i, double force, Vector& out) const {
    const Link& l = chain_.links[i];
    out[n_ + static_cast<std::size_t>(l.of)] -= force / chain_.masses[static_cast<std::size_t>(l.of)];
    if (l.from >= 0)
      out[n_ + static_cast<std::size_t>(l.from)] += force / chain_.masses[static_cast<std::size_t>(l.from)];
  }

  /// Rates without the friction of links that stick.
  Vector free_rates(double tau, const Vector& s) const {
    Vector out(s.size(), 0.0);
    for (std::size_t m = 0; m < n_; ++m) out[m] = s[n_ + m];
    for (std::size_t d = 0; d < chain_.driven.size(); ++d) {
      const auto mass = static_cast<std::size_t>(chain_.driven[d]);
      out[n_ + mass] += force(d, tau) / chain_.masses[mass];
    }
    for (std::size_t i = 0; i < links_; ++i) {
      const Link& l = chain_.links[i];
      const double u = elongation(i, s), w = rate(i, s), memory = s[2 * n_ + 2 * i], z = s[2 * n_ + 2 * i + 1];
      double f = l.k * u + l.c * w + l.k3 * u * u * u + l.drag * std::abs(w) * w + l.coulomb * mode_[i] + memory +
                 l.bouc_k * z + l.stop_k * std::max(u - l.stop_gap, 0.0);
      if (l.other) f += l.other(u, w);
      add(i, f, out);
      if (l.maxwell > 0) out[2 * n_ + 2 * i] = l.maxwell_k * w - memory / l.maxwell;
      const double sign = z > 0 ? 1 : z < 0 ? -1 : 0;
      if (l.bouc_k > 0) out[2 * n_ + 2 * i + 1] = w - std::abs(z / l.bouc_yield) * (0.5 * std::abs(w) * sign + 0.5 * w);
    }
    return out;
  }

  /// The forces in the links that stick, so that they go on sticking; one after the other until they agree.
  Vector holding(const Vector& rates) const {
    Vector held(links_, 0.0);
    for (int pass = 0; pass < 200; ++pass) {
      double most = 0;
      for (std::size_t i = 0; i < links_; ++i) {
        if (chain_.links[i].coulomb <= 0 || mode_[i] != 0) continue;
        double acceleration = rate_of(i, rates);
        for (std::size_t j = 0; j < links_; ++j) acceleration += response(i, j) * held[j];
        const double change = -acceleration / response(i, i);
        held[i] += change;
        most = std::max(most, std::abs(change));
      }
      if (most < 1e-14) break;
    }
    return held;
  }
  double rate_of(std::size_t i, const Vector& rates) const { return rate(i, rates); }

  Vector rates(double tau, const Vector& s) const {
    Vector out = free_rates(tau, s);
    const Vector held = holding(out);
    for (std::size_t i = 0; i < links_; ++i)
      if (held[i] != 0) add(i, held[i], out);
    return out;
  }

  Vector rk4(double tau, double h) const {
    const auto moved = [&](const Vector& k, double part) {
      Vector out = state_;
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += part * k[i];
      return out;
    };
    const Vector a = rates(tau, state_), b = rates(tau + h / 2, moved(a, h / 2)),
                 c = rates(tau + h / 2, moved(b, h / 2)), d = rates(tau + h, moved(c, h));
    Vector out = state_;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    return out;
  }

  bool crossed(const Vector& next) const {
    for (std::size_t i = 0; i < links_; ++i)
      if (mode_[i] != 0 && rate(i, next) * mode_[i] < 0) return true;
    return false;
  }

  void take(Vector next, double& tau, double h) {
    state_ = std::move(next);
    tau += h;
  }

  /// A friction comes to rest: the small rate that bisection left is taken off the lighter side.
  void stop(std::size_t i) {
    const Link& l = chain_.links[i];
    const double w = rate(i, state_);
    state_[n_ + static_cast<std::size_t>(l.of)] -= w;
    mode_[i] = 0;
  }

  /// A friction that sticks begins to slide where it takes more than it can hold.
  void settle(std::size_t i, double tau = 0) {
    if (chain_.links[i].coulomb <= 0 || mode_[i] != 0) return;
    const double held = holding(free_rates(tau, state_))[i];
    if (std::abs(held) > chain_.links[i].coulomb) mode_[i] = held > 0 ? 1 : -1;
  }

  const Chain& chain_;
  const std::vector<Signal>& signals_;
  double level_;
  std::size_t n_, links_;
  Vector state_;
  std::vector<int> mode_;  ///< of a link's friction: +1 and -1 slides, 0 sticks
};

double mean_rms(const ChainMotion& moved) {
  double sum = 0;
  for (const auto& x : moved.x) sum += std::pow(deviation(x), 2) / static_cast<double>(moved.x.size());
  return std::sqrt(sum);
}

ChainColumns record(const Chain& chain, const Scale& scale, const std::vector<Signal>& signals, double wanted,
                    const RecordOptions& options, int early) {
  const double spacing = scale.omega() * scale.dt();
  double level = 0.3 * wanted;
  for (int pass = 0; pass < 12; ++pass) {
    const double reached = mean_rms(integrate(chain, signals, level, early, options.rows, spacing, 4)) / wanted;
    if (std::abs(reached - 1) < 0.03) break;
    level *= std::clamp(1 / reached, 0.4, 2.5);
  }
  ChainMotion moved = integrate(chain, signals, level, early, options.rows, spacing, options.substeps);
  ChainColumns out;
  out.stuck_share = moved.stuck;
  for (int i = 0; i < options.rows; ++i) out.t.push_back(i * scale.dt());
  std::mt19937_64 bits(options.seed * 2654435761u + 29);
  const auto scaled = [](std::vector<double> x, double factor) {
    for (double& value : x) value *= factor;
    return x;
  };
  for (const auto& x : moved.x) out.y.push_back(noisy(scaled(x, scale.length), options.noise_db, options.colour, bits));
  for (const auto& f : moved.F) out.F.push_back(noisy(scaled(f, scale.force()), options.force_noise_db, 0, bits));
  return out;
}

/// Two masses before a wall, or three between two.
Chain masses(int count) {
  return in_a_row(std::vector<double>(static_cast<std::size_t>(count), 1.0), 1, 0.06, count == 3);
}

/// One more link, with what `set` puts into it.
Chain with(Chain chain, int of, int from, const std::function<void(Link&)>& set) {
  Link link;
  link.of = of;
  link.from = from;
  set(link);
  chain.links.push_back(std::move(link));
  return chain;
}

std::vector<ChainCase> make_cases() {
  const auto cubic = [](Link& l) { l.k3 = 0.15; };
  const auto friction = [](Link& l) { l.coulomb = 0.12; };
  const auto drag = [](Link& l) { l.drag = 0.15; };
  const auto maxwell = [](Link& l) {
    l.maxwell_k = 0.6;
    l.maxwell = 1.5;
  };
  const auto yields = [](Link& l) {
    l.bouc_k = 0.5;
    l.bouc_yield = 0.5;
  };
  const auto stop = [](Link& l) {
    l.stop_k = 1.5;
    l.stop_gap = 0.8;
  };
  const auto bristles = [](Link& l) {
    l.other = [](double u, double) { return 0.25 * std::sin(4 * u) * std::abs(u); };
  };
  const Chain two = masses(2), three = masses(3);
  return {
      {"two_null", two, {}},
      {"three_null", three, {}},
      {"two_cubic_joint", with(two, 0, 1, cubic), {"cubic_stiffness in y1 - y2"}},
      {"two_cubic_first", with(two, 0, -1, cubic), {"cubic_stiffness at y1"}},
      {"two_cubic_last", with(two, 1, -1, [](Link& l) { l.k3 = 0.04; }), {"cubic_stiffness at y2"}},
      {"three_cubic_joint", with(three, 1, 2, cubic), {"cubic_stiffness in y2 - y3"}},
      {"three_friction", with(three, 1, -1, friction), {"coulomb_friction at y2"}},
      {"two_friction_joint", with(two, 0, 1, friction), {"coulomb_friction in y1 - y2"}},
      {"two_drag", with(two, 1, -1, drag), {"quadratic_drag at y2"}},
      {"two_maxwell_joint", with(two, 0, 1, maxwell), {"maxwell_relaxation in y1 - y2"}},
      {"two_maxwell_last", with(two, 1, -1, maxwell), {"maxwell_relaxation at y2"}},
      {"two_yield_joint", with(two, 0, 1, yields), {"bouc_wen in y1 - y2"}},
      {"two_stop_joint", with(two, 0, 1, stop), {"one_sided_stop in y1 - y2"}},
      {"two_stiffer_joint", with(two, 0, 1, [](Link& l) { l.k = 0.3; }), {"linear_stiffness in y1 - y2"}},
      {"two_dashpot", with(two, 1, -1, [](Link& l) { l.c = 0.1; }), {"viscous_damping at y2"}},
      {"two_pair", with(with(two, 0, -1, cubic), 1, -1, friction), {"cubic_stiffness at y1", "coulomb_friction at y2"}},
      {"two_pair_joint",
       with(with(two, 0, 1, cubic), 0, 1, friction),
       {"cubic_stiffness in y1 - y2", "coulomb_friction in y1 - y2"}},
      {"three_pair",
       with(with(three, 0, 1, cubic), 2, -1, drag),
       {"cubic_stiffness in y1 - y2", "quadratic_drag at y3"}},
      {"two_outside", with(two, 0, 1, bristles), {"sin(4 u)*|u| in y1 - y2"}, true},
  };
}

}  // namespace

const std::vector<ChainCase>& chain_cases() {
  static const std::vector<ChainCase> table = make_cases();
  return table;
}

const ChainCase& chain_case(const std::string& name) {
  for (const ChainCase& each : chain_cases())
    if (each.name == name) return each;
  throw std::invalid_argument("no chain '" + name + "'; see lunid_truth list");
}

void write_csv(const ChainColumns& record, const Chain& chain, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path);
  std::fprintf(file, "t [s]");
  for (const int mass : chain.driven) std::fprintf(file, ",F%d [N]", mass + 1);
  for (std::size_t i = 0; i < record.y.size(); ++i) std::fprintf(file, ",y%zu [m]", i + 1);
  for (std::size_t row = 0; row < record.t.size(); ++row) {
    std::fprintf(file, "\n%.12g", record.t[row]);
    for (const auto& f : record.F) std::fprintf(file, ",%.9g", f[row]);
    for (const auto& y : record.y) std::fprintf(file, ",%.9g", y[row]);
  }
  std::fprintf(file, "\n");
  std::fclose(file);
}

ChainMotion integrate(const Chain& chain, const std::vector<Signal>& signals, double level, int early, int rows,
                      double spacing, int substeps) {
  ChainMotion out;
  out.x.resize(chain.masses.size());
  out.F.resize(chain.driven.size());
  Run run(chain, signals, level);
  double tau = 0;
  for (int row = 0; row < early + rows; ++row) {
    if (row >= early) {
      for (std::size_t m = 0; m < out.x.size(); ++m) out.x[m].push_back(run.x(m));
      for (std::size_t d = 0; d < out.F.size(); ++d) out.F[d].push_back(run.force(d, row * spacing));
      out.stuck += run.sticks() ? 1.0 / rows : 0;
    }
    tau = row * spacing;
    for (int k = 0; k < substeps; ++k) run.step(tau, spacing / substeps);
  }
  return out;
}

Chain in_a_row(std::vector<double> masses, double k, double c, bool both_ends) {
  Chain chain;
  const int n = static_cast<int>(masses.size());
  chain.masses = std::move(masses);
  const auto link = [&](int of, int from) {
    Link l;
    l.of = of;
    l.from = from;
    l.k = k;
    l.c = c;
    chain.links.push_back(l);
  };
  for (int i = 0; i < n; ++i) link(i, i - 1);
  if (both_ends) link(n - 1, -1);
  return chain;
}

ChainRecords make_chain_records(const Chain& chain, const Scale& scale, const RecordOptions& options) {
  const double spacing = scale.omega() * scale.dt(), duration = spacing * options.rows + warm_up;
  const int early = static_cast<int>(std::lround(warm_up / spacing));
  std::vector<Signal> lines, sweeps;
  for (std::size_t d = 0; d < chain.driven.size(); ++d) {
    lines.push_back(multisine(0.15, 2.4, 50, options.seed + 31 * d));
    const Signal sweep = chirp(0.2 + 0.1 * static_cast<double>(d), 2.2, duration);
    sweeps.push_back(sweep);
  }
  ChainRecords out;
  out.train = record(chain, scale, lines, 1.0, options, early);
  RecordOptions second = options;
  second.seed += 1000003;
  out.test = record(chain, scale, sweeps, 0.8, second, early);
  return out;
}

}  // namespace truth
