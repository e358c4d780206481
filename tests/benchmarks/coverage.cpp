// Coverage of intervals: how often the 95 % interval of a final model's parameter holds the truth, over short records
// of tests/truth whose hidden effect was named.
//   lunid_coverage [RUNS]      400 by default; exit 1 where the share is outside 90 to 98 %
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "record/parallel.hpp"
#include "runtime/discover_catalogue.hpp"

namespace {

using namespace lunid;

constexpr const char* cases[] = {"cubic_hardening", "quadratic_stiffness", "constant_force", "coulomb_friction",
                                 "viscous_damping"};
constexpr double levels[] = {40, 30, 20, 60};
constexpr truth::Excited excitations[] = {truth::Excited::multisine, truth::Excited::tones, truth::Excited::chirp,
                                          truth::Excited::noise, truth::Excited::decay};

double level_of(int index) { return levels[static_cast<std::size_t>(index / 5) % 4]; }
truth::Excited excited_of(int index) { return excitations[static_cast<std::size_t>(index / 20) % 5]; }

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

Tally run(int index) {
  const truth::Case& which = truth::case_named(cases[index % std::size(cases)]);
  const truth::Scale& scale = truth::scales()[static_cast<std::size_t>(index / 7) % 3];
  truth::RecordOptions options;
  options.rows = 900;
  options.noise_db = level_of(index);
  options.excited = excited_of(index);
  options.seed = static_cast<std::uint64_t>(1000 + index);
  const truth::Records records = truth::make_records(which, scale, options);
  const Model model = testing::baseline(which.baseline, scale.mass);
  DiscoverOptions discover_options;
  discover_options.threads = 1;
  std::vector<Record> train{testing::record_of(records.train, "train")};
  for (const truth::Columns& more : records.more) train.push_back(testing::record_of(more, "train 2"));
  const Discovery found = discover(model, testing::small_catalogue(*model.pool), train,
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

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 400;
  if (runs < 1) {
    std::fprintf(stderr, "usage: lunid_coverage [RUNS]\n");
    return 2;
  }
  std::vector<Tally> tallies(static_cast<std::size_t>(runs));
  parallel_for(runs, 0, [&](int i) { tallies[static_cast<std::size_t>(i)] = run(i); });
  std::map<std::string, Tally> rows;
  Tally total;
  const auto add = [](Tally& to, const Tally& t) {
    to.inside += t.inside;
    to.all += t.all;
    to.named += t.named;
    to.runs += t.runs;
  };
  for (int i = 0; i < runs; ++i) {
    const Tally& t = tallies[static_cast<std::size_t>(i)];
    char level[16];
    std::snprintf(level, sizeof level, "%.0f dB", level_of(i));
    add(rows[cases[i % std::size(cases)]], t);
    add(rows[level], t);
    add(rows[truth::to_string(excited_of(i))], t);
    add(total, t);
  }
  for (const auto& [name, t] : rows)
    std::printf("%-20s named %3d of %3d, inside %3d of %3d (%.1f %%)\n", name.c_str(), t.named, t.runs, t.inside, t.all,
                100.0 * t.inside / std::max(1, t.all));
  const double share = 100.0 * total.inside / std::max(1, total.all);
  std::printf("coverage %d/%d = %.1f %% over %d runs, %d of them named right\n", total.inside, total.all, share, runs,
              total.named);
  return share >= 90 && share <= 98 ? 0 : 1;
}
