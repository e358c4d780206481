// lunid_benchmarks LUNID [NAME]: times every work (or those whose name holds NAME) with Google Benchmark,
// ours and the hand-written limit by turns, and prints `<work> ratio <x> limit <y>` of the fastest
// repetitions. Exit 1 where a ratio is beyond its limit.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <limits>
#include <map>

#include "benchmarks/work.hpp"

namespace {

/// Keeps the fastest repetition of each benchmark: the one that the machine disturbed least.
class Fastest : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const double seconds = run.real_accumulated_time / static_cast<double>(run.iterations);
      auto [place, fresh] = seconds_.try_emplace(run.run_name.function_name, seconds);
      if (!fresh && seconds < place->second) place->second = seconds;
    }
  }
  double seconds(const std::string& name) const { return seconds_.at(name); }

 private:
  std::map<std::string, double> seconds_;
};

void add(const std::string& name, const std::function<void()>& function, const std::function<double()>& seconds,
         int repetitions) {
  auto* const registered = seconds ? benchmark::RegisterBenchmark(name.c_str(),
                                                                  [seconds](benchmark::State& state) {
                                                                    for (auto _ : state)
                                                                      state.SetIterationTime(seconds());
                                                                  })
                                   : benchmark::RegisterBenchmark(name.c_str(), [function](benchmark::State& state) {
                                       for (auto _ : state) function();
                                     });
  registered->Repetitions(repetitions)->MinTime(0.05);
  seconds ? registered->UseManualTime() : registered->UseRealTime();
}

std::vector<bench::Work> works(const std::string& lunid, const std::string& wanted) {
  std::vector<bench::Work> chosen;
  for (auto part : {bench::free_run_works(), bench::sundials_works(), bench::trajectory_fit_works(),
                    bench::regression_works(), bench::ensemble_works(), bench::statistics_works(),
                    bench::surface_works(), bench::figure_works(lunid), bench::process_works(lunid)}) {
    for (bench::Work& work : part) {
      if (work.name.find(wanted) != std::string::npos) chosen.push_back(std::move(work));
    }
  }
  return chosen;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: lunid_benchmarks LUNID [NAME]\n");
    return 2;
  }
  const std::vector<bench::Work> chosen = works(argv[1], argc > 2 ? argv[2] : "");
  if (chosen.empty()) {
    std::fprintf(stderr, "lunid_benchmarks: no work is called '%s'\n", argv[2]);
    return 2;
  }
  // Ours and the limit are run by turns, so that a slow spell of the machine meets both.
  char name[] = "lunid_benchmarks", turns[] = "--benchmark_enable_random_interleaving=true";
  char* arguments[] = {name, turns};
  int count = 2;
  benchmark::Initialize(&count, arguments);
  for (const bench::Work& work : chosen) {
    add(work.name + " ours", work.ours, work.ours_seconds, work.repetitions);
    if (work.hand) add(work.name + " hand", work.hand, work.hand_seconds, work.repetitions);
  }
  Fastest fastest;
  benchmark::RunSpecifiedBenchmarks(&fastest);
  bool within = true;
  for (const bench::Work& work : chosen) {
    const double ours = fastest.seconds(work.name + " ours");
    const double hand = work.hand ? fastest.seconds(work.name + " hand") : 0;
    const double ratio = work.allowance > 0 ? (ours - hand) / work.allowance : ours / hand;
    std::printf("%s ratio %.2f limit %g   (ours %.4g ms, hand %.4g ms%s)\n", work.name.c_str(), ratio, work.limit,
                1e3 * ours, 1e3 * hand, work.allowance > 0 ? ", difference over what is allowed" : "");
    within = within && ratio <= work.limit;
  }
  return within ? 0 : 1;
}
