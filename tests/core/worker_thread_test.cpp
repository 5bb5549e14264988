// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/worker_thread.h>

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <vector>

#ifdef __linux__
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace headway {
namespace {

TEST(WorkerThreadTest, DoesAllWorkInOrderInOneOtherThread) {
  std::vector<int> done;
  std::vector<std::future<std::thread::id>> threads;
  {
    WorkerThread worker;
    for (int i = 0; i < 100; ++i) {
      threads.push_back(worker.run([&done, i] {
        done.push_back(i);
        return std::this_thread::get_id();
      }));
    }
  }
  ASSERT_EQ(done.size(), 100U) << "the destructor waits for it";
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  const auto first = threads.front().get();
  EXPECT_NE(first, std::this_thread::get_id());
  for (std::size_t i = 1; i < threads.size(); ++i) EXPECT_EQ(threads[i].get(), first);
}

TEST(WorkerThreadTest, PassesResultsAndExceptionsOn) {
  WorkerThread worker;
  auto fails = worker.run([]() -> int { throw std::runtime_error("no"); });
  auto works = worker.run([] { return 7; });
  EXPECT_THROW(static_cast<void>(fails.get()), std::runtime_error);
  EXPECT_EQ(works.get(), 7);
}

TEST(WorkerThreadTest, ResultsNeedNotBeTaken) {
  WorkerThread worker;
  static_cast<void>(worker.run([] { return 7; }));
  EXPECT_EQ(worker.run([] { return 8; }).get(), 8);
}

#ifdef __linux__
TEST(WorkerThreadTest, BackgroundWorkYieldsToTheOthers) {
  const auto priority = [] {
    return getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)));
  };
  WorkerThread normal, background(WorkerThread::Priority::kBackground);
  const int here = priority();
  EXPECT_EQ(normal.run(priority).get(), here);
  EXPECT_EQ(background.run(priority).get(), std::max(here, 10));
  EXPECT_EQ(priority(), here) << "this thread's is not changed";
}
#endif

TEST(WorkerThreadTest, MayHaveNothingToDo) { const WorkerThread worker; }

}  // namespace
}  // namespace headway
