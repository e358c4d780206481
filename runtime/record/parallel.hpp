#pragma once
// Independent jobs on a few threads.
#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lunid {

/// Threads to use: `threads`, or for 0 the cores of the machine.
inline int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Runs job(0) ... job(count - 1), each once, on `threads` threads (0: all cores). Results must go to slots of their
/// own, so that they do not depend on the number of threads. Of several exceptions that of the least job is rethrown,
/// so that it is the same one each time; jobs after it may be left out. Jobs that divide their own work so do it on the
/// thread that they have.
inline void parallel_for(int count, int threads, const std::function<void(int)>& job) {
  thread_local bool divided = false;  // what runs here is part of a larger job
  const int workers = divided ? std::min(count, 1) : std::min(count, thread_count(threads));
  std::atomic<int> next{0}, failed{count};  // failed: the least job that threw
  std::exception_ptr failure;
  std::mutex guard;
  auto work = [&] {
    const bool before = std::exchange(divided, divided || workers > 1);
    for (int i = next++; i < failed; i = next++) {
      try {
        job(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        if (i > failed) continue;
        failure = std::current_exception();
        failed = i;
      }
    }
    divided = before;
  };
  std::vector<std::jthread> pool;
  for (int i = 1; i < workers; ++i) pool.emplace_back(work);
  work();
  for (auto& t : pool) t.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lunid
