// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
