// Coverage of intervals: how often the 95 % interval of a final model's parameter holds the truth, over short records
// of tests/truth whose hidden effect was named.
//   lunid_coverage [RUNS] [--simple | --only WORD] [--short]
// RUNS: 400 by default, of eleven effects in turn. --simple: of the five that have one parameter, which is fast.
// --only: of those whose name holds WORD. Exit 1 where the share is outside 90 to 98 %; --short: 40 runs of --simple,
// exit 1 only where a true share of 90 to 98 % would give such a count once in 10 000 times.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "coverage_catalogue.hpp"
#include "record/parallel.hpp"

namespace {

using namespace lunid;

struct Hidden {
  const char* name;
  bool shaped;  ///< has a shape parameter, an exponent or states
};
constexpr Hidden hidden_effects[] = {
    {"cubic_hardening", false},  {"quadratic_stiffness", false}, {"constant_force", false},
    {"coulomb_friction", false}, {"viscous_damping", false},     {"one_sided_stop", true},
    {"power_law_damping", true}, {"maxwell_relaxation", true},   {"elastic_slip", true},
    {"bouc_wen", true},          {"hidden_mode", true}};
constexpr double levels[] = {40, 30, 20, 60};
constexpr truth::Excited excitations[] = {truth::Excited::multisine, truth::Excited::tones, truth::Excited::chirp,
                                          truth::Excited::noise, truth::Excited::decay};

/// What a run is of: effects change fastest, then levels of noise, then excitations.
struct Plan {
  int runs = 400;
  bool brief = false;
  std::vector<Hidden> effects;

  const Hidden& effect_of(int index) const { return effects[static_cast<std::size_t>(index) % effects.size()]; }
  double level_of(int index) const { return levels[static_cast<std::size_t>(index) / effects.size() % 4]; }
  truth::Excited excited_of(int index) const {
    return excitations[static_cast<std::size_t>(index) / (4 * effects.size()) % 5];
  }
};

struct Tally {
  int inside = 0, all = 0, named = 0, runs = 0;
};

/// Name of a final parameter -> its true value.
std::map<std::string, double> truth_of(const truth::Case& which, const truth::Scale& scale) {
  const double omega = scale.omega();
  std::map<std::string, double> out{{"k", which.physics.k * scale.mass * omega * omega},
                                    {"c", 2 * which.physics.zeta * scale.mass * omega}};
  for (const truth::TrueParameter& p : which.parameters) out[p.effect + "_" + p.name] = p.in(scale);
  return out;
}

Tally run(const Plan& plan, int index) {
  const truth::Case& which = truth::case_named(plan.effect_of(index).name);
  const truth::Scale& scale = truth::scales()[static_cast<std::size_t>(index / 7) % 3];
  truth::RecordOptions options;
  options.rows = 900;
  options.noise_db = plan.level_of(index);
  options.excited = plan.excited_of(index);
  options.seed = static_cast<std::uint64_t>(1000 + index);
  const truth::Records records = truth::make_records(which, scale, options);
  const Model model = testing::baseline(which.baseline, scale.mass);
  DiscoverOptions discover_options;
  discover_options.threads = 1;
  std::vector<Record> train{testing::record_of(records.train, "train")};
  for (const truth::Columns& more : records.more) train.push_back(testing::record_of(more, "train 2"));
  const Discovery found = discover(model, testing::catalogue_with(*model.pool, which.effects.front()), train,
                                   {testing::record_of(records.test, "test")}, discover_options);
  Tally tally;
  tally.runs = 1;
  if (found.effects.size() != 1 || found.effects[0].name != which.effects.front()) return tally;
  tally.named = 1;
  const std::map<std::string, double> truth = truth_of(which, scale);
  for (const Parameter& p : found.final.parameters) {
    if (!(p.std > 0) || !truth.contains(p.name)) continue;
    ++tally.all;
    tally.inside += std::abs(p.value - truth.at(p.name)) <= 1.96 * p.std;
  }
  return tally;
}

/// Log of the probability of `count` of `all` at this rate.
double log_binomial(int count, int all, double rate) {
  return std::lgamma(all + 1) - std::lgamma(count + 1) - std::lgamma(all - count + 1) + count * std::log(rate) +
         (all - count) * std::log1p(-rate);
}

/// No more than once in 10 000 times would a true share of 90 to 98 % give so few or so many.
bool beyond_chance(int inside, int all) {
  double fewer = 0, more = 0;
  for (int i = 0; i <= inside; ++i) fewer += std::exp(log_binomial(i, all, 0.90));
  for (int i = inside; i <= all; ++i) more += std::exp(log_binomial(i, all, 0.98));
  return fewer < 1e-4 || more < 1e-4;
}

/// False where the options are wrong.
bool read_options(int argc, char** argv, Plan& plan) {
  bool simple = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--short")
      plan.brief = simple = true, plan.runs = 40;
    else if (option == "--simple")
      simple = true;
    else if (option == "--only" && i + 1 < argc)
      only = argv[++i];
    else
      plan.runs = std::atoi(argv[i]);
  }
  for (const Hidden& each : hidden_effects)
    if (!(simple && each.shaped) && std::string(each.name).find(only) != std::string::npos)
      plan.effects.push_back(each);
  return plan.runs > 0 && !plan.effects.empty();
}

void print(const std::string& name, const Tally& t) {
  std::printf("%-34s named %3d of %3d, inside %3d of %3d (%.1f %%)\n", name.c_str(), t.named, t.runs, t.inside, t.all,
              100.0 * t.inside / std::max(1, t.all));
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  if (!read_options(argc, argv, plan)) {
    std::fprintf(stderr, "usage: lunid_coverage [RUNS] [--simple | --only WORD] [--short]\n");
    return 2;
  }
  std::vector<Tally> tallies(static_cast<std::size_t>(plan.runs));
  parallel_for(plan.runs, 0, [&](int i) { tallies[static_cast<std::size_t>(i)] = run(plan, i); });
  std::map<std::string, Tally> rows;
  Tally total;
  const auto add = [](Tally& to, const Tally& t) {
    to.inside += t.inside;
    to.all += t.all;
    to.named += t.named;
    to.runs += t.runs;
  };
  for (int i = 0; i < plan.runs; ++i) {
    const Tally& t = tallies[static_cast<std::size_t>(i)];
    char level[16];
    std::snprintf(level, sizeof level, "%.0f dB", plan.level_of(i));
    add(rows[plan.effect_of(i).name], t);
    add(rows[level], t);
    add(rows[truth::to_string(plan.excited_of(i))], t);
    add(rows[plan.effect_of(i).shaped ? "of shape, exponent or states" : "of one parameter"], t);
    add(total, t);
  }
  for (const auto& [name, t] : rows) print(name, t);
  const double share = 100.0 * total.inside / std::max(1, total.all);
  std::printf("coverage %d/%d = %.1f %% over %d runs, %d of them named right\n", total.inside, total.all, share,
              plan.runs, total.named);
  if (plan.brief) return beyond_chance(total.inside, total.all) || 2 * total.named < plan.runs ? 1 : 0;
  return share >= 90 && share <= 98 ? 0 : 1;
}
