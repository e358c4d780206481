#pragma once
// Independent jobs on a few threads.
#include <algorithm>
#include <functional>
#include <thread>

namespace lunid {

/// Threads to use: `threads`, or for 0 the cores of the machine.
inline int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Runs job(0) ... job(count - 1), each once, on `threads` threads (0: all cores). Results must go to slots of their
/// own, so that they do not depend on the number of threads. Of several exceptions that of the least job is rethrown,
/// so that it is the same one each time; jobs after it may be left out. Jobs may divide their own work so: it runs on
/// the thread that they have, and on those of the outermost call that have nothing else to do, `threads` at most.
void parallel_for(int count, int threads, const std::function<void(int)>& job);

}  // namespace lunid
