// SPDX-License-Identifier: BSD-3-Clause
// A thread that does work in order, and requests to stop long work.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>

namespace headway {

/// Whether a long-running function should return early with what it has; called by any thread.
using StopCondition = std::function<bool()>;

[[nodiscard]] inline bool neverStop() noexcept { return false; }

/// Asks the long-running functions of this process to return early with what they have: reading
/// and skipping of recordings, waiting, and what gets stopRequested() as its StopCondition.
/// Callable from signal handlers and from any thread.
///
/// @param reason  not 0, such as the number of a signal; 0 withdraws the request
void requestStop(int reason) noexcept;

/// The reason given to requestStop(); 0 without a request.
[[nodiscard]] int stopRequest() noexcept;

/// Whether there is a request.
[[nodiscard]] inline bool stopRequested() noexcept { return stopRequest() != 0; }

/// Whether a result is there: a std::future or std::shared_future that is valid.
template <typename Future>
[[nodiscard]] bool isReady(const Future& result) {
  return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// One thread that does work in the order in which it is given.
///
/// For work that comes with every frame: what libraries keep for each thread (OpenCV) is never
/// released, so that a new thread a frame would fill the memory. The thread starts with the first
/// work; the destructor ends it after all work given before.
class WorkerThread {
 public:
  enum class Priority {
    kNormal,
    kBackground,  ///< runs on what other threads leave of the processors, where the system has such
                  ///< priorities for threads (Linux)
  };

  explicit WorkerThread(Priority priority = Priority::kNormal) : priority_(priority) {}
  ~WorkerThread();
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;

  /// @param work  a function without parameters
  /// @return      its result or exception; does not wait when destroyed, unlike std::async()'s
  template <typename Work>
  [[nodiscard]] auto run(Work work) -> std::future<std::invoke_result_t<Work>> {
    const auto task =
        std::make_shared<std::packaged_task<std::invoke_result_t<Work>()>>(std::move(work));
    add([task] { (*task)(); });
    return task->get_future();
  }

 private:
  void add(std::function<void()> work);
  void loop();

  const Priority priority_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;  ///< guarded by mutex_
  bool ends_ = false;                          ///< guarded by mutex_
  std::thread thread_;
};

}  // namespace headway
