// SPDX-License-Identifier: BSD-3-Clause
// A thread that does work in order, and requests to stop long work.
#include <headway/core/worker_thread.h>

#include <algorithm>
#include <atomic>

#ifdef __linux__
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace headway {
namespace {

std::atomic<int> g_reason{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers require it");

}  // namespace

void requestStop(int reason) noexcept { g_reason = reason; }

int stopRequest() noexcept { return g_reason; }

namespace {

/// Lowers the priority of this thread; one that the system does not lower works as well.
void runInBackground() {
#ifdef __linux__
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  const int nice = std::max(10, getpriority(PRIO_PROCESS, thread));  // 10: a tenth of the time
  (void)setpriority(PRIO_PROCESS, thread, nice);
#endif
}

}  // namespace

WorkerThread::~WorkerThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void WorkerThread::add(std::function<void()> work) {
  if (!thread_.joinable()) thread_ = std::thread([this] { loop(); });
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  changed_.notify_one();
}

void WorkerThread::loop() {
  if (priority_ == Priority::kBackground) runInBackground();
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    auto work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    work();
    work = nullptr;  // what it holds ends outside the lock
    lock.lock();
  }
}

}  // namespace headway
