#include "discovery_settings.hpp"

#include <algorithm>
#include <iterator>
#include <random>

namespace matrix {
namespace {

using truth::Excited;

constexpr double levels[] = {40, 30, 20, 60};
constexpr Excited excitations[] = {Excited::multisine, Excited::noise, Excited::chirp, Excited::tones, Excited::decay};

Setting setting_of(const truth::Case* which, const truth::Fault* fault, int scale, double db, Excited excited,
                   const Plan& plan) {
  Setting s{which, fault, &truth::scales()[static_cast<std::size_t>(scale)], {}, "", true, 0};
  s.options.rows = plan.rows;
  s.options.noise_db = db;
  s.options.excited = excited;
  s.options.seed = plan.seed + static_cast<std::uint64_t>(db) + 100 * static_cast<std::uint64_t>(scale);
  return s;
}

/// Records in which nothing is missing: each known baseline under each excitation, at each scale and level, with each
/// kind of trouble: 1008 of them, of which any few in a row differ in all.
std::vector<Setting> null_settings(const Plan& plan) {
  const char* names[] = {"null_linear", "null_duffing", "null_friction", "null_hysteresis"};
  std::vector<Setting> list;
  for (int i = 0; i < plan.nulls; ++i) {
    Plan own = plan;
    own.seed = plan.seed + 1000 + static_cast<std::uint64_t>(i);
    const int turn = i / 12;  // of the baselines and excitations
    Setting s = setting_of(&truth::case_named(names[i % 4]), nullptr, (i + turn) % 3, levels[(i + turn / 3) % 4],
                           excitations[i % 3], own);
    switch (i % 7) {
      case 1: s.options.colour = 0.9, s.kind = "coloured"; break;
      case 2: s.options.unknown = 0.05, s.kind = "process"; break;
      case 3: s.options.feedback = 0.2, s.kind = "closed loop"; break;
      case 4: s.mass_known = s.which->baseline.find("bouc_wen") != std::string::npos, s.kind = "mass"; break;
      case 5: s.options.rows = 200, s.kind = "200 rows"; break;
      case 6: s.options.force_noise_db = 30, s.kind = "noisy force"; break;
      default: break;
    }
    list.push_back(s);
  }
  return list;
}

std::vector<Setting> short_settings(const Plan& plan) {
  std::vector<Setting> list;
  const auto add = [&](const char* name, int scale, double db) {
    list.push_back(setting_of(&truth::case_named(name), nullptr, scale, db, Excited::multisine, plan));
  };
  add("cubic_hardening", 0, 30);
  add("bouc_wen", 2, 40);
  add("bouc_wen_stiffening", 1, 40);
  add("coulomb_friction", 1, 40);
  add("one_sided_stop", 2, 30);
  add("null_linear", 2, 20);
  add("null_duffing", 1, 30);
  add("coulomb+constant", 0, 40);
  add("outside_v2y", 1, 40);
  // Short records in which forces with memory and many parameters are found from few of their guesses.
  Plan brief = plan;
  brief.seed = 29001;
  brief.rows = 1400;
  list.push_back(setting_of(&truth::case_named("lugre_friction"), nullptr, 0, 40, Excited::tones, brief));
  list.push_back(
      setting_of(&truth::case_named("pinching_degrading_hysteresis"), nullptr, 2, 20, Excited::noise, brief));
  return list;
}

/// Scales and excitations that a case or a fault is asked under, by their numbers.
struct Range {
  std::vector<int> scales{0, 1, 2};
  std::vector<Excited> excitations{std::begin(matrix::excitations), std::end(matrix::excitations)};
};

Range range_of(const truth::Case& which) {
  Range range;
  std::erase_if(range.scales, [&](int i) {
    return !which.only_at.empty() && truth::scales()[static_cast<std::size_t>(i)].name != which.only_at;
  });
  if (which.only_under) range.excitations = {*which.only_under};
  if (!which.in_decay) std::erase(range.excitations, Excited::decay);
  return range;
}

Range range_of(const truth::Fault& fault) {
  Range range;
  if (!fault.in_decay) std::erase(range.excitations, Excited::decay);
  return range;
}

/// All settings of a case or a fault, or the one that is its turn; a fault has a turn at each scale.
void add(const Range& range, const truth::Case* which, const truth::Fault* fault, int turn, const Plan& plan,
         std::vector<Setting>& list) {
  const bool all = plan.full || plan.draw > 0;
  const auto scales = static_cast<int>(range.scales.size()), kinds = static_cast<int>(range.excitations.size());
  for (int scale = 0; scale < scales; ++scale)
    for (int level = 0; level < 4; ++level)
      for (int kind = 0; kind < kinds; ++kind) {
        const bool one = fault ? level == (turn + scale) % 3 && kind == (turn + scale) % kinds
                               : scale == turn % scales && level == turn / 3 % 3 && kind == turn % std::min(3, kinds);
        if (!all && !one) continue;
        const Setting setting = setting_of(which, fault, range.scales[static_cast<std::size_t>(scale)], levels[level],
                                           range.excitations[static_cast<std::size_t>(kind)], plan);
        if (setting.folder().find(plan.only) != std::string::npos) list.push_back(setting);
      }
}

std::vector<Setting> one_round(const Plan& plan) {
  if (plan.nulls > 0) return null_settings(plan);
  if (plan.brief) return short_settings(plan);
  std::vector<Setting> list;
  int turn = 0;
  for (const truth::Case& each : truth::cases()) add(range_of(each), &each, nullptr, ++turn, plan, list);
  turn = 0;
  for (const truth::Fault& each : truth::faults()) add(range_of(each), nullptr, &each, ++turn, plan, list);
  return list;
}

}  // namespace

std::string Setting::folder() const {
  return (fault ? "fault_" + fault->name : which->name) + "-" + scale->name + "-" + to_string(options.excited) + "-" +
         std::to_string(static_cast<int>(options.noise_db)) + (repeat > 0 ? "-s" + std::to_string(repeat + 1) : "");
}

std::string Setting::baseline() const {
  return fault ? baseline_at(fault->baseline, fault->stiffness_known, *scale)
               : baseline_at(which->baseline, which->stiffness_known, *scale);
}

std::vector<Setting> settings(const Plan& plan) {
  std::vector<Setting> list;
  for (int repeat = 0; repeat < plan.seeds; ++repeat) {
    Plan own = plan;
    own.seed = plan.seed + 100000 * static_cast<std::uint64_t>(repeat);
    for (Setting& setting : one_round(own)) {
      setting.repeat = repeat;
      list.push_back(std::move(setting));
    }
  }
  if (plan.draw > 0 && static_cast<std::size_t>(plan.draw) < list.size()) {
    std::shuffle(list.begin(), list.end(), std::mt19937_64(plan.seed));
    list.resize(static_cast<std::size_t>(plan.draw));
  }
  return list;
}

}  // namespace matrix
