// What the maps say, as an engineer would.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "discover/residual_maps.hpp"

namespace lunid {

namespace {

using Eigen::Index;

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

std::string follows(const BinnedMap& m) {
  const Shape s = shape_of(m);
  const std::string name = m.over;
  std::string text = s.jumps   ? "jumps with the sign of " + name
                     : s.grows ? "grows with |" + name + "|"
                               : "follows " + std::string(name == "y" ? "the displacement" : "the velocity");
  if (!s.jumps && s.from > 0.08 * s.limit && s.from < s.limit) text += " above " + quantity(s.from, m.unit);
  char share[48];
  std::snprintf(share, sizeof share, " (%.0f %% of its variance)", 100 * m.share);
  text += share;
  const double sum = s.odd + s.even;
  if (s.jumps || !(sum > 0)) return text;
  if (s.odd > 0.85 * sum) return text + ", odd";
  if (s.even > 0.85 * sum) return text + ", even";
  return text + ", neither odd nor even";
}

std::string harmonics(const BinnedMap& m) {
  static constexpr const char* words[] = {"mean",  "first", "second",  "third", "fourth",
                                          "fifth", "sixth", "seventh", "eighth"};
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
  const auto word = [&](Index k) { return k == 0 ? std::string("mean") : std::string(words[k]) + " harmonic"; };
  if (best < 0) return {};
  std::string text = ", in the " + word(best);
  if (second >= 0 && m.value[second] > 0.5 * m.value[best]) text += " and the " + word(second);
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

}  // namespace

std::string sentence_of(const ResidualMaps& maps, const ResidualRows& rows) {
  const std::string size = "rms " + quantity(maps.rms, rows.units.force);
  if (!maps.above_noise) return size + ", nothing above its noise";
  const BinnedMap &y = maps.map("y"), &v = maps.map("v");
  const BinnedMap& main = y.share >= v.share ? y : v;
  std::string text = size + ", ";
  text += main.any_above() ? follows(main) : "no function of y or v alone";
  text += harmonics(maps.map("harmonic"));
  // A baseline's damping that is a little off is no sign of memory.
  text += maps.loop && maps.loop_share > 0.1 ? ", different on loading and unloading"
          : maps.loop                        ? ", nearly the same on loading and unloading"
                                             : ", the same on loading and unloading";
  return text + changes(maps.slow);
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
