// What the maps say, as an engineer would.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>

#include "discover/residual_maps.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string quantity(double value, const std::string& unit) {
  static constexpr struct {
    double factor;
    const char* prefix;
  } prefixes[] = {{1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "\u00b5"}, {1e-9, "n"}};
  const auto* chosen = &prefixes[2];
  for (const auto& p : prefixes)
    if (value != 0 && std::abs(value) >= 0.9995 * p.factor) {
      chosen = &p;
      break;
    }
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s%s", value / chosen->factor, chosen->prefix, unit.c_str());
  return text;
}

/// A map over y or v seen from its middle outward.
struct Shape {
  double odd = 0, even = 0;    ///< sums of squares of the two parts
  double from = 0, limit = 0;  ///< |x| beyond which it is above its noise everywhere; the largest |x|
  bool grows = false;          ///< more than in proportion, or from a threshold on
  bool jumps = false;          ///< nearly the same size on each side from the middle on
};

Shape shape_of(const BinnedMap& m) {
  Shape s;
  const Index half = m.value.size() / 2;
  s.limit = -m.x[0] + 0.5 * (m.x[1] - m.x[0]);
  std::vector<double> size;
  std::vector<bool> above;
  for (Index k = 0; k < half; ++k) {  // k = 0 beside the middle
    const Index right = half + k, left = half - 1 - k;
    const double a = m.value[right], b = m.value[left];
    const bool both = std::isfinite(a) && std::isfinite(b);
    if (both) {
      const double weight = std::min(m.rows[right], m.rows[left]);
      s.odd += weight * std::pow((a - b) / 2, 2);
      s.even += weight * std::pow((a + b) / 2, 2);
    }
    const double larger = std::max(std::isfinite(a) ? std::abs(a) : 0, std::isfinite(b) ? std::abs(b) : 0);
    size.push_back(larger);
    above.push_back((std::isfinite(a) && m.above(right)) || (std::isfinite(b) && m.above(left)));
  }
  Index last = half - 1;
  while (last > 0 && size[static_cast<std::size_t>(last)] == 0) --last;
  Index onset = last + 1;
  while (onset > 0 && above[static_cast<std::size_t>(onset - 1)]) --onset;
  s.from = onset <= last ? m.x[half + onset] - 0.5 * (m.x[1] - m.x[0]) : s.limit;
  const double most = *std::max_element(size.begin(), size.end());
  const auto middle = static_cast<std::size_t>(last / 2);
  s.grows = size[static_cast<std::size_t>(last)] > 0.6 * most && size[middle] < 0.6 * most;
  s.jumps = size[1] > 0.6 * most && size[static_cast<std::size_t>(last)] < 1.6 * size[1];
  return s;
}

/// A bend at a displacement, such as that of a stop or a clearance.
struct Bend {
  double at = 0;      ///< |x|
  int side = 0;       ///< 1: of positive x alone, -1: of negative x alone, 0: of both
  bool grows = true;  ///< the force is steeper beyond it
};

/// Sum of squares that columns leave of the map, each bin over its level; the last column's coefficient.
std::pair<double, double> left_by(const MatrixXd& columns, const VectorXd& target, const VectorXd& weight) {
  const MatrixXd weighted = weight.asDiagonal() * columns;
  const VectorXd seen = weight.cwiseProduct(target), beta = weighted.colPivHouseholderQr().solve(seen);
  return {(seen - weighted * beta).squaredNorm(), beta[beta.size() - 1]};
}

/// Where a straight line that bends follows a map beyond its noise better than other curves of as many parameters do: a
/// cubic, odd powers to the fifth, and a jump at zero beside the first and third. At least two bins lie beyond it.
std::optional<Bend> bend_of(const BinnedMap& m) {
  constexpr double asked = 0.25;  // of what the smooth curves leave
  constexpr double told = 0.44;   // mean square over the level's: two deviations of a bin
  const double width = m.x[1] - m.x[0], limit = m.x[m.x.size() - 1] + 0.5 * width;
  std::vector<Index> bins;
  for (Index i = 0; i < m.value.size(); ++i)
    if (std::isfinite(m.value[i]) && m.level[i] > 0) bins.push_back(i);
  const auto n = static_cast<Index>(bins.size());
  if (n < 8) return {};
  VectorXd x(n), target(n), weight(n);
  for (Index i = 0; i < n; ++i) {
    const Index bin = bins[static_cast<std::size_t>(i)];
    x[i] = m.x[bin] / limit;
    target[i] = m.value[bin];
    weight[i] = 1 / m.level[bin];
  }
  MatrixXd columns(n, 4);
  columns << VectorXd::Ones(n), x, x.array().pow(2).matrix(), x.array().pow(3).matrix();
  double smooth = left_by(columns, target, weight).first;
  columns.col(2) = x.array().pow(5).matrix();
  smooth = std::min(smooth, left_by(columns, target, weight).first);
  columns.col(2) = x.array().sign().matrix();
  smooth = std::min(smooth, left_by(columns, target, weight).first);
  if (smooth < told * static_cast<double>(n - 4)) return {};
  Bend best;
  double least = INFINITY;
  columns.conservativeResize(n, 3);
  for (double at = width; at <= limit - 1.5 * width; at += width / 8)
    for (const int side : {0, 1, -1}) {
      const double g = at / limit;
      for (Index i = 0; i < n; ++i) {
        const double right = std::max(0.0, x[i] - g), left = std::max(0.0, -x[i] - g);
        columns(i, 2) = side == 0 ? right - left : side > 0 ? right : -left;
      }
      const auto [sum, slope] = left_by(columns, target, weight);
      if (sum >= least) continue;
      least = sum;
      best = {at, side, slope > 0};
    }
  return least < asked * smooth ? std::optional(best) : std::nullopt;
}

/// The place to two digits: bins do not tell it better.
std::string words_of(const Bend& bend, const std::string& unit) {
  const double digit = std::pow(10.0, std::floor(std::log10(bend.at)) - 1);
  return (bend.grows ? "grows with |y| above " : "is less steep in |y| above ") +
         quantity(std::round(bend.at / digit) * digit, unit) +
         (bend.side == 0  ? ""
          : bend.side > 0 ? " on the positive side"
                          : " on the negative side");
}

std::string follows(const BinnedMap& m) {
  const Shape s = shape_of(m);
  const std::string name = m.over;
  const std::optional<Bend> bend = name == "y" ? bend_of(m) : std::nullopt;
  const bool jumps = s.jumps && !bend;
  std::string text = bend      ? words_of(*bend, m.unit)
                     : jumps   ? (s.odd > s.even ? "jumps with the sign of " + name : "is an offset")
                     : s.grows ? "grows with |" + name + "|"
                               : "follows " + std::string(name == "y" ? "the displacement" : "the velocity");
  if (!jumps && !bend && s.from > 0.08 * s.limit && s.from < s.limit) text += " above " + quantity(s.from, m.unit);
  char share[48];
  std::snprintf(share, sizeof share, " (%.0f %% of its variance)", 100 * m.share);
  text += share;
  const double sum = s.odd + s.even;
  if (jumps || !(sum > 0)) return text;
  if (s.odd > 0.85 * sum) return text + ", odd";
  if (s.even > 0.85 * sum) return text + ", even";
  return text + ", neither odd nor even";
}

constexpr const char* orders[] = {"mean", "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth"};

std::string order(Index k) { return k == 0 ? std::string("mean") : orders[k] + std::string(" harmonic"); }

std::string harmonics(const BinnedMap& m) {
  Index best = -1, second = -1;
  for (Index k = 0; k < m.value.size(); ++k) {
    if (!m.above(k)) continue;
    if (best < 0 || m.value[k] > m.value[best]) {
      second = best;
      best = k;
    } else if (second < 0 || m.value[k] > m.value[second]) {
      second = k;
    }
  }
  if (best < 0) return {};
  std::string text = ", in the " + order(best);
  if (second >= 0 && m.value[second] > 0.5 * m.value[best]) text += " and the " + order(second);
  return text;
}

std::string changes(const SlowTime& slow) {
  static constexpr const char* words[] = {"its mean", "its slope in y", "its slope in v"};
  std::string text;
  for (int j = 0; j < 3; ++j)
    if (slow.changes[j]) text += std::string(text.empty() ? ", and " : ", ") + words[j];
  return text.empty()
             ? text
             : text + (text.find(", its", 7) == std::string::npos ? " changes" : " change") + " over the record";
}

/// Where a map stands out most of its level; -1 where nowhere.
Index peak_of(const BinnedMap& m) {
  Index best = -1;
  for (Index i = 0; i < m.value.size(); ++i)
    if (m.above(i) && (best < 0 || std::abs(m.value[i]) * m.level[best] > std::abs(m.value[best]) * m.level[i]))
      best = i;
  return best;
}

/// The bins above the level about the one that stands out most.
struct Range {
  double from = 0, to = 0;
  bool elsewhere = false, all = false;
  Index bins = 0;  ///< with data, in all
};

std::optional<Range> range_above(const BinnedMap& m) {
  const Index peak = peak_of(m);
  if (peak < 0) return {};
  Index first = peak, last = peak;
  while (first > 0 && m.above(first - 1)) --first;
  while (last + 1 < m.value.size() && m.above(last + 1)) ++last;
  const double half = 0.5 * (m.x[1] - m.x[0]);
  const auto edge = [half](double x) { return std::abs(x) < 1e-9 * half ? 0 : x; };
  Range out{edge(m.x[first] - half), edge(m.x[last] + half)};
  for (Index i = 0; i < m.value.size(); ++i) {
    out.bins += std::isfinite(m.value[i]);
    out.elsewhere = out.elsewhere || (m.above(i) && (i < first || i > last));
  }
  out.all = last - first + 1 == out.bins;
  return out;
}

/// "3.1 N, noise alone stays below 1.2 N"
std::string beside_noise(double value, double level, const std::string& unit, const char* per = "") {
  return quantity(value, unit) + per + ", noise alone stays below " + quantity(level, unit) + per;
}

/// "above the noise from 12 s to 15 s, and elsewhere; most at 13.5 s: ..."
std::string place_above(const BinnedMap& m, const Units& units) {
  const Index peak = peak_of(m);
  if (peak < 0) return "nothing above the noise";
  const char* per = m.over == "frequency" ? "/sqrt(Hz)" : "";
  const std::string size = beside_noise(m.value[peak], m.level[peak], units.force, per);
  if (m.over == "harmonic") return "above the noise, most in the " + order(peak) + ": " + size;
  const Range found = *range_above(m);
  const std::string most = (found.bins > 1 ? "most at " + quantity(m.x[peak], m.unit) + ": " : std::string()) + size;
  if (found.all) return "above the noise throughout; " + most;
  return "above the noise from " + quantity(found.from, m.unit) + " to " + quantity(found.to, m.unit) +
         (found.elsewhere ? ", and elsewhere" : "") + "; " + most;
}

/// Where in time or at which frequency alone.
std::string apart_from_motion(const ResidualMaps& maps) {
  std::string text;
  if (const auto found = range_above(maps.map("time")); found && !found->all)
    text += ", most from " + quantity(found->from, "s") + " to " + quantity(found->to, "s");
  const BinnedMap& frequency = maps.map("frequency");
  if (const Index peak = peak_of(frequency); peak >= 0) text += ", most at " + quantity(frequency.x[peak], "Hz");
  return text;
}

std::string plane_above(const ResidualMaps& maps, const Units& units) {
  Index above = 0, seen = 0, row = -1, column = -1;
  for (Index i = 0; i < maps.plane.before.rows(); ++i)
    for (Index j = 0; j < maps.plane.before.cols(); ++j) {
      const double size = std::abs(maps.plane.before(i, j)), level = maps.plane_level(i, j);
      seen += std::isfinite(size);
      if (!(size > level)) continue;
      ++above;
      if (row < 0 || size * maps.plane_level(row, column) > std::abs(maps.plane.before(row, column)) * level) {
        row = i;
        column = j;
      }
    }
  if (row < 0) return "nothing above the noise";
  return "above the noise in " + std::to_string(above) + " of " + std::to_string(seen) +
         " cells; most at y = " + quantity(maps.plane.y[row], units.y) +
         ", v = " + quantity(maps.plane.v[column], units.v) + ": " +
         beside_noise(maps.plane.before(row, column), maps.plane_level(row, column), units.force);
}

}  // namespace

std::string sentence_of(const ResidualMaps& maps, const ResidualRows& rows) {
  const std::string size = "rms " + quantity(maps.rms, rows.units.force);
  if (!maps.above_noise) return size + ", nothing above its noise";
  const BinnedMap &y = maps.map("y"), &v = maps.map("v");
  const BinnedMap& main = y.share >= v.share ? y : v;
  std::string text = size + ", ";
  text += main.any_above() ? follows(main) : "no function of y or v alone" + apart_from_motion(maps);
  text += harmonics(maps.map("harmonic"));
  if (!main.any_above() && !maps.loop) return text + changes(maps.slow);
  // A baseline's damping that is a little off is no sign of memory.
  text += maps.loop && maps.loop_share > 0.1 ? ", different on loading and unloading"
          : maps.loop                        ? ", nearly the same on loading and unloading"
                                             : ", the same on loading and unloading";
  return text + changes(maps.slow);
}

void say_each(ResidualMaps& maps, const Units& units) {
  for (BinnedMap& map : maps.maps) map.sentence = place_above(map, units);
  maps.plane_sentence = plane_above(maps, units);
  const std::string change = changes(maps.slow);
  maps.slow.sentence =
      change.empty() ? "no change over the record beyond chance" : change.substr(std::strlen(", and "));
}

std::string unseen(const ResidualMaps& maps, const ResidualRows& rows) {
  Index empty = 0;
  for (Index i = 0; i < maps.plane.count.size(); ++i) empty += maps.plane.count.data()[i] < 1;
  char share[64];
  std::snprintf(share, sizeof share, "; %.0f %% of the phase plane within",
                100.0 * static_cast<double>(empty) / static_cast<double>(maps.plane.count.size()));
  return "y below " + quantity(rows.y.minCoeff(), rows.units.y) + " and above " +
         quantity(rows.y.maxCoeff(), rows.units.y) + ", |v| above " +
         quantity(rows.v.cwiseAbs().maxCoeff(), rows.units.v) + share;
}

}  // namespace lunid
