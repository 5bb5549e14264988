// SPDX-License-Identifier: BSD-3-Clause
// The part of a live run that is connected to ROS 2.
#pragma once

#include <headway/drivers/sensor_group.h>
#include <headway/pipeline/perception.h>
#include <headway/program/command_line.h>
#include <headway/run/session.h>
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::live {

/// Command-line options of the connection.
struct Ros2Options {
  std::optional<std::string> file;  ///< .ini; empty: defaults; nullopt: no connection
  std::string left, right, color, depth;
  std::string interface;
  bool list = false;

  /// Whether there is to be a connection.
  [[nodiscard]] bool isUsed() const;
};

/// Adds the options; none in a build without ROS 2.
void describe(Ros2Options& options, program::CommandLine& line);

/// What `--ros2-list` prints. @throws InputError
[[nodiscard]] std::string listOfTopics(const Ros2Options& options);

/// Topics as sensors of a live run, and its results as topics.
class Ros2Connection {
 public:
  struct Callbacks {
    std::function<void(const mrpt::obs::CObservation::Ptr&)> observation;
    std::function<void(const std::string&)> message;
    std::function<std::vector<drivers::SensorStatus>()> sensors;  ///< for /diagnostics
  };

  /// @param has_sensors       there are MRPT's drivers, too: topics are not guessed
  /// @param calibration       file, or empty
  /// @throws InputError
  Ros2Connection(const Ros2Options& options, bool has_sensors, const std::string& calibration,
                 double pair_tolerance_s, Callbacks callbacks);
  ~Ros2Connection();
  Ros2Connection(const Ros2Connection&) = delete;
  Ros2Connection& operator=(const Ros2Connection&) = delete;

  /// Domain and network, one line.
  [[nodiscard]] std::string network() const;
  /// Part of it: why large images are lost; or empty.
  [[nodiscard]] std::string bufferHint() const;
  void start();  ///< subscribing
  void stop();   ///< likewise; neither perception nor callbacks are used any more
  /// Of the session.
  [[nodiscard]] run::Sink& sink();
  /// Takes the poses of /initialpose.
  void setPerception(pipeline::Perception& perception);
  /// An observation of any sensor.
  void addObservation(const mrpt::obs::CObservation& observation);

  [[nodiscard]] std::vector<drivers::SensorStatus> sensors() const;  ///< topics as sensors
  [[nodiscard]] std::map<std::string, std::size_t> skipped() const;
  [[nodiscard]] std::string missing() const;  ///< what is waited for; or empty

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::live
