// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check_item.h"

namespace mrpt::obs {
class CObservation;
class CObservationIMU;
}  // namespace mrpt::obs

namespace headway::import {

/// An angular velocity of an inertial sensor, robot frame.
struct TurnSample {
  Time time = 0.0;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< [rad/s]
};

/// Times of all sensors of a recording: rates, gaps, clocks, and offsets of left and right images.
class TimeCheck {
 public:
  /// @param sensor_label  stereo camera to check, `LEFT,RIGHT` of single images; may be empty
  explicit TimeCheck(std::string sensor_label) : sensor_label_(std::move(sensor_label)) {}

  void add(const mrpt::obs::CObservation& observation);
  [[nodiscard]] std::vector<CheckItem> items() const;
  /// Number of images, of pairs or single.
  [[nodiscard]] std::size_t images() const { return images_; }
  /// Up to 200,000 samples of the gyroscope.
  [[nodiscard]] const std::vector<TurnSample>& turns() const { return turns_; }

 private:
  struct Sensor {
    bool is_needed = false;  ///< images or an IMU
    std::size_t count = 0;
    std::size_t without_time = 0;
    std::size_t backwards = 0;
    Time last = 0.0;
    std::vector<float> intervals;  ///< up to 200,000 [s]
    std::vector<Time> times;       ///< of single images, up to 200,000
    std::optional<Time> newest;    ///< since the last image
    std::vector<float> offsets;    ///< from the images between which it came, up to 200,000 [s]
  };
  using Name = std::pair<std::string, std::string>;  ///< label and class
  void compareClocks(const Name& image, Time time);
  void addTurn(Time time, const mrpt::obs::CObservationIMU& imu);
  [[nodiscard]] static CheckItem rateOf(const Name& name, const Sensor& sensor);
  [[nodiscard]] bool isChosen(const std::string& label) const;
  [[nodiscard]] static CheckItem pairOffset(const std::string& labels,
                                            std::vector<double> distances);

  std::string sensor_label_;
  std::map<Name, Sensor> sensors_;
  std::optional<Name> first_camera_;    ///< that other sensors' clocks are compared with
  std::optional<Time> last_image_;      ///< of that camera
  std::size_t of_further_sensors_ = 0;  ///< observations
  std::vector<TurnSample> turns_;
  std::size_t images_ = 0;
};

}  // namespace headway::import
