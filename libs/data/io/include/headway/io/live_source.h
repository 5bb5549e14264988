// SPDX-License-Identifier: BSD-3-Clause
// The newest frame of live observations.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/io/rawlog_source.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace headway::io {

/// Options of LiveSource.
struct LiveSourceOptions {
  /// Selection of sensors, and what is used of them. `read_ahead` delays every frame by as many
  /// frame intervals; 1 for boxes and poses that arrive after their images. Indices are ignored.
  RawlogSourceOptions observations;
  std::size_t max_waiting_frames = 1;  ///< stereo pairs that wait besides those read ahead, >= 1
  std::size_t max_waiting_samples = 4000;  ///< samples of each motion sensor, >= 2
  std::size_t max_waiting_items = 50;      ///< boxes, poses, and scans of each laser, >= 1
  /// Duration for which the last sample of odometry or inertial sensor is extrapolated to a frame
  /// whose next sample has not arrived yet [s].
  double max_extrapolation_s = 0.05;

  LiveSourceOptions();
};

/// Numbers of waiting data.
struct LiveQueues {
  std::size_t frames = 0;          ///< stereo pairs, with those read ahead
  std::size_t motion_samples = 0;  ///< of all motion sensors
  std::size_t items = 0;           ///< boxes, poses and laser scans
};

/// Assembles frames from live observations and returns the newest one.
///
/// Older frames that are waiting when a frame is complete are dropped and counted; images of
/// dropped frames are never decoded. Motion between two returned frames covers the dropped ones.
/// push() may be called by any thread and never waits for the consumer; all other functions belong
/// to one thread. Memory is bounded by the options.
///
///     LiveSource source;
///     driver.onObservation([&](const auto& observation) { source.push(observation); });
///     Perception perception(source.camera(), PerceptionParams::live());  // in another thread
///     while (auto live = source.next()) perception.process(live->frame);
class LiveSource {
 public:
  explicit LiveSource(const LiveSourceOptions& options = {},
                      MonotonicClock clock = monotonicSeconds);
  ~LiveSource();
  LiveSource(const LiveSource&) = delete;
  LiveSource& operator=(const LiveSource&) = delete;

  /// Adds an observation; null pointers and calls after close() are ignored.
  void push(const mrpt::obs::CObservation::Ptr& observation);

  /// Ends the input: next() returns the frame that is waiting, then nullopt.
  void close();

  /// Waits for the first usable stereo pair, or for poses if there are no cameras.
  ///
  /// @return  rectified camera of all frames; null if the input has only poses, or none at all
  /// @throws  InputError as RawlogSource's constructor, and if images have come for 2 s of which
  ///          none can be used
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera();

  /// Waits for the newest frame; nullopt once the source is closed and no frame is waiting.
  ///
  /// Frames with a missing or broken image are skipped and counted.
  /// @throws InputError as RawlogSource's constructor, and if both cameras are the same
  [[nodiscard]] std::optional<LiveFrame> next();

  /// Whether a frame is waiting, so that next() does not block unless its images are broken.
  [[nodiscard]] bool hasFrame() const;

  /// Number of complete frames dropped because a newer one was complete.
  [[nodiscard]] std::size_t dropped() const;

  /// Why no camera is known yet by what has come so far, with what to do; empty if one is, or
  /// nothing has come. May be called by any thread.
  [[nodiscard]] std::string missing() const;

  /// Current lengths of the queues.
  [[nodiscard]] LiveQueues queues() const;

  /// Consistency of images and calibration, of the first pair; nullopt before camera().
  [[nodiscard]] const std::optional<CalibrationReport>& calibration() const;

  /// Number of unused observations by class name or reason, see RawlogSource. May be called by any
  /// thread.
  [[nodiscard]] std::map<std::string, std::size_t> skipped() const;

  /// Sensors with other clocks, see RawlogSource.
  [[nodiscard]] Warnings warnings() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::io
