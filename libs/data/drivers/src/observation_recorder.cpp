// SPDX-License-Identifier: BSD-3-Clause
// Recording of live observations to a rawlog, in a thread of its own.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/drivers/observation_recorder.h>
#include <headway/io/rawlog_sink.h>
#include <mrpt/serialization/CArchive.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace headway::drivers {

class ObservationRecorder::Implementation {
 public:
  Implementation(const std::string& path, MessageCallback message, std::size_t max_waiting)
      : path_(path), message_(std::move(message)), max_waiting_(max_waiting) {
    if (std::filesystem::is_regular_file(path)) replacement_.emplace(path);
    file_.emplace(replacement_ ? replacement_->temporaryPath().string() : path, path);
    thread_ = std::thread([this] { writeAll(); });
  }

  ~Implementation() { end(); }

  void write(const mrpt::obs::CObservation::Ptr& observation) {
    {
      const std::lock_guard lock(mutex_);
      if (ending_ || has_failed_) return;
      if (waiting_.size() >= max_waiting_) {
        ++dropped_;
        return;
      }
      waiting_.push_back(observation);
    }
    changed_.notify_one();
  }

  void close() {
    if (std::exchange(is_closed_, true)) return;
    end();
    file_->finish();
    if (!replacement_) {
      synchroniseFile(path_);
    } else if (is_begun_) {
      replacement_->commit();
    }
    if (dropped_ > 0) {
      message_(path_ + ": lacks " + std::to_string(dropped_) +
               " observations, because the disk was slower than the sensors");
    }
    if (has_failed_ || file_->hasFailed()) {
      throw InputError(path_ + ": not written completely; check the disk space");
    }
  }

  std::size_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  void end() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

  mrpt::obs::CObservation::Ptr next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return nullptr;
    auto observation = waiting_.front();
    waiting_.pop_front();
    return observation;
  }

  void writeAll() {
    try {
      auto archive = mrpt::serialization::archiveFrom(*file_);
      while (const auto observation = next()) {
        archive << *observation;
        is_begun_ = true;
      }
    } catch (const std::exception&) {
      {
        const std::lock_guard lock(mutex_);
        has_failed_ = true;
        waiting_.clear();
      }
      message_(path_ + ": write error; check the disk space: nothing more is recorded");
    }
  }

  std::string path_;
  MessageCallback message_;
  std::optional<OutputFile> replacement_;     ///< of an older file
  std::optional<io::CompressedOutput> file_;  ///< used by the thread, and after its end
  bool is_begun_ = false;                     ///< likewise: an observation was written
  bool is_closed_ = false;
  std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<mrpt::obs::CObservation::Ptr> waiting_;  // guarded by mutex_, like the members below
  std::size_t dropped_ = 0;
  bool ending_ = false;
  bool has_failed_ = false;
  std::thread thread_;
};

ObservationRecorder::ObservationRecorder(const std::string& path, MessageCallback message,
                                         std::size_t max_waiting)
    : implementation_(std::make_unique<Implementation>(path, std::move(message), max_waiting)) {}

ObservationRecorder::~ObservationRecorder() = default;

void ObservationRecorder::write(const mrpt::obs::CObservation::Ptr& observation) {
  implementation_->write(observation);
}

void ObservationRecorder::close() { implementation_->close(); }

std::size_t ObservationRecorder::dropped() const { return implementation_->dropped(); }

}  // namespace headway::drivers
