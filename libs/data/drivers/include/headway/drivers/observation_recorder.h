// SPDX-License-Identifier: BSD-3-Clause
// Recording of live observations to a rawlog, in a thread of its own.
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace headway::drivers {

/// Writes live observations to a rawlog in a thread of its own.
///
/// If the disk is slower than the sensors, observations above `max_waiting` are dropped and
/// counted; the rawlog then lacks them. A new file grows under its name, so that a killed program
/// leaves what it wrote; an older file of that name remains until close(), and if nothing was
/// recorded.
class ObservationRecorder {
 public:
  /// Receives the first write error at once, called by the recorder's thread, and what the rawlog
  /// lacks, called by close().
  using MessageCallback = std::function<void(const std::string&)>;

  /// @throws InputError if the file cannot be written
  ObservationRecorder(const std::string& path, MessageCallback message,
                      std::size_t max_waiting = 200);
  ~ObservationRecorder();
  ObservationRecorder(const ObservationRecorder&) = delete;
  ObservationRecorder& operator=(const ObservationRecorder&) = delete;

  /// Adds an observation, which must not be changed afterwards. Callable by any thread.
  void write(const mrpt::obs::CObservation::Ptr& observation);

  /// Writes what is waiting and closes the file; further calls do nothing, and write() neither.
  ///
  /// @throws InputError on a write error; what was written before remains
  void close();

  [[nodiscard]] std::size_t dropped() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::drivers
