#pragma once
// What a discovery says beside its models: the sentence, what would decide, and what to mind.
#include <functional>
#include <string>
#include <vector>

#include "discover/verdict.hpp"

namespace lunid {

/// Free runs of baseline and final model over all records, and the share of the force channel's noise in them that the
/// system did not feel.
struct ModelRuns {
  std::vector<FreeRun> before_train, after_train, before_test, after_test;
  double share = 0;
};

/// Fills a Discovery whose gaps and test p-value are there: what was named and where, its rivals, intervals, how often
/// it would be named, what would decide, and the sentence. `catalogue`: all entries that were tried, from `tried` start
/// points. Changes the pool: main thread only.
void conclude(const Study& study, const std::vector<Effect>& catalogue, const Round& round, const ModelRuns& runs,
              int tried, const std::function<void(const std::string&, double)>& progress, Discovery& out);

}  // namespace lunid
