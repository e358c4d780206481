#include "record/parallel.hpp"

#include <atomic>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <utility>

namespace lunid {

namespace {

/// Threads that the outermost call may still begin; shared by all that its jobs divide.
using Spare = std::atomic<int>;
thread_local Spare* shared = nullptr;  // null: what runs here is no part of a larger job

bool take(Spare& spare) {
  int there = spare;
  while (there > 0 && !spare.compare_exchange_weak(there, there - 1)) continue;
  return there > 0;
}

class Jobs {
 public:
  Jobs(int count, int threads, Spare& spare, const std::function<void(int)>& job)
      : most_(std::min(count, threads)), spare_(spare), job_(job), failed_(count) {}

  /// On this thread, and on others as they get free.
  void run() {
    work();
    wait();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work() {
    Spare* const before = std::exchange(shared, &spare_);
    for (int i = next_++; i < failed_; i = next_++) {
      hire();
      try {
        job_(i);
      } catch (...) {
        const std::lock_guard lock(guard_);
        if (i > failed_) continue;
        failure_ = std::current_exception();
        failed_ = i;
      }
    }
    shared = before;
  }

  /// Threads for the jobs that nobody has begun.
  void hire() {
    while (next_ < failed_ && running_ < most_ && take(spare_)) {
      const std::lock_guard lock(guard_);
      try {
        others_.emplace_back([this] {
          work();
          --running_;
          ++spare_;
        });
      } catch (const std::system_error&) {  // the machine has no thread more: those that run do all
        ++spare_;
        return;
      }
      ++running_;
    }
  }

  /// For the others; a thread that waits is spare itself.
  void wait() {
    for (std::size_t i = 0; std::thread* const other = begun(i); ++i) {
      ++spare_;
      other->join();
      --spare_;
    }
  }

  /// Null where all that were begun before it have ended: then nobody is left to begin one.
  std::thread* begun(std::size_t i) {
    const std::lock_guard lock(guard_);
    return i < others_.size() ? &others_[i] : nullptr;
  }

  const int most_;
  Spare& spare_;
  const std::function<void(int)>& job_;
  std::atomic<int> next_{0}, running_{1}, failed_;  // failed: the least job that threw, else their number
  std::exception_ptr failure_;
  std::deque<std::thread> others_;  // none moves while others are begun
  std::mutex guard_;                // of failure and others
};

}  // namespace

void parallel_for(int count, int threads, const std::function<void(int)>& job) {
  Spare own{thread_count(threads) - 1};
  Jobs(count, thread_count(threads), shared ? *shared : own, job).run();
}

}  // namespace lunid
