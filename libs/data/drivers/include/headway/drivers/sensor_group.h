// SPDX-License-Identifier: BSD-3-Clause
// The drivers of all sensors of a robot, each in its own thread and started again if it fails.
#pragma once

#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace headway::drivers {

/// When sensors are started again, and stopped.
struct SensorGroupOptions {
  double retry_s = 1.0;        ///< between a failure and the next start [s]
  double max_silence_s = 5.0;  ///< without observations, after the first one, until a restart [s]
  double max_stop_s = 2.0;     ///< of stop() [s]
};

/// State of one sensor.
struct SensorStatus {
  std::string name;              ///< section of the configuration
  bool is_running = false;       ///< started and not failed since
  std::size_t observations = 0;  ///< delivered so far
  std::size_t restarts = 0;
  std::string error;  ///< of the last failure; empty: none
};

/// Runs the drivers of `mrpt::hwdrivers` that an .ini file in the format of MRPT's rawlog-grabber
/// names, each in its own thread.
///
/// A section is a sensor if it has the key `driver`, a class of CGenericSensor, and not
/// `rawlog-grabber-ignore=true`; [global] is ignored. A sensor that cannot be started, fails (such
/// as an unplugged one) or falls silent is started again until stop(). With `side_by_side=true` the
/// section's images contain both images of a stereo camera, and are split.
///
///     SensorGroup sensors(mrpt::config::CConfigFile("SENSORS.ini"), onObservation, onMessage);
///     sensors.start();
class SensorGroup {
 public:
  /// Receives each observation, called by the sensors' threads, one call at a time, until stop().
  using ObservationCallback = std::function<void(const mrpt::obs::CObservation::Ptr&)>;
  /// Receives messages about failed and restarted sensors, called like the former.
  using MessageCallback = std::function<void(const std::string&)>;

  /// Reads the configuration of all sensors.
  ///
  /// @throws InputError if there is no sensor, a class is unknown, a section is invalid, or the
  ///         rawlog or folder of images of a camera does not exist; names the section
  SensorGroup(const mrpt::config::CConfigFileBase& configuration, ObservationCallback observation,
              MessageCallback message, const SensorGroupOptions& options = {});
  ~SensorGroup();  ///< stops
  SensorGroup(const SensorGroup&) = delete;
  SensorGroup& operator=(const SensorGroup&) = delete;

  void start();  ///< once
  /// Waits for the drivers' present calls, then closes them.
  ///
  /// @return  false if some did not return within `max_stop_s`, which a message names: they go on
  ///          in their threads, and are closed if they return, without callbacks
  bool stop();

  [[nodiscard]] std::vector<SensorStatus> status() const;

 private:
  class Implementation;
  std::shared_ptr<Implementation> implementation_;  ///< shared with the threads
};

}  // namespace headway::drivers
