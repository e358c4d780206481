#include "record/parallel.hpp"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lunid {
namespace {

TEST(ParallelFor, RunsEachJobOnce) {
  std::vector<int> times(100, 0);
  parallel_for(100, 4, [&](int i) { ++times[static_cast<std::size_t>(i)]; });
  EXPECT_EQ(times, std::vector<int>(100, 1));
}

TEST(ParallelFor, OfAJobStaysOnItsThread) {
  std::vector<std::set<std::thread::id>> threads(4);
  std::vector<std::thread::id> own(4);
  parallel_for(4, 2, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    std::mutex guard;
    own[k] = std::this_thread::get_id();
    parallel_for(50, 8, [&](int) {
      const std::lock_guard lock(guard);
      threads[k].insert(std::this_thread::get_id());
    });
  });
  for (std::size_t k = 0; k < threads.size(); ++k) EXPECT_EQ(threads[k], std::set{own[k]});
}

TEST(ParallelFor, IsParallelAgainBehindAJobThatFailed) {
  EXPECT_THROW(parallel_for(8, 2, [](int) { throw std::runtime_error("no"); }), std::runtime_error);
  std::atomic<int> here{0};
  parallel_for(2, 2, [&](int) {
    ++here;
    while (here < 2) std::this_thread::yield();  // hangs where both are not run at once
  });
  EXPECT_EQ(here, 2);
}

TEST(ParallelFor, RethrowsTheLeastFailure) {
  for (int threads : {1, 4}) {
    std::string said;
    try {
      parallel_for(20, threads, [](int i) {
        if (i % 5 == 3) throw std::runtime_error(std::to_string(i));
      });
    } catch (const std::runtime_error& e) {
      said = e.what();
    }
    EXPECT_EQ(said, "3");
  }
}

}  // namespace
}  // namespace lunid
