#include "record/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
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

TEST(ParallelFor, OfOneThreadStaysOnItWhateverItsJobsAskFor) {
  std::set<std::thread::id> threads;
  parallel_for(4, 1, [&](int) { parallel_for(50, 8, [&](int) { threads.insert(std::this_thread::get_id()); }); });
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

TEST(ParallelFor, OfAJobTakesTheThreadsThatHaveNothingElseToDo) {
  for (int longest : {0, 1}) {  // on the thread that waits for the other, and on that one
    std::mutex guard;
    std::set<std::thread::id> threads;
    const auto count = [&] {
      const std::lock_guard lock(guard);
      return threads.size();
    };
    parallel_for(2, 2, [&](int i) {
      if (i != longest) return;
      while (count() < 2) {  // hangs where one thread does all
        parallel_for(2, 2, [&](int) {
          std::this_thread::yield();
          const std::lock_guard lock(guard);
          threads.insert(std::this_thread::get_id());
        });
      }
    });
    EXPECT_EQ(threads.size(), 2u);
  }
}

TEST(ParallelFor, RethrowsWhatAJobOfAJobThrew) {
  const auto fails = [](int i) {
    if (i == 7) throw std::runtime_error("seven");
  };
  for (int threads : {1, 2, 4})
    EXPECT_THROW(parallel_for(3, threads, [&](int) { parallel_for(20, 4, fails); }), std::runtime_error);
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
