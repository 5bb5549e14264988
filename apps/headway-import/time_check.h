#pragma once

#include <headway/core/pose.h>

#include <map>
#include <string>
#include <vector>

#include "check_item.h"

namespace mrpt::obs {
class CObservation;
}

namespace headway::import {

/// An angular velocity of an inertial sensor, robot frame.
struct TurnSample {
  Time time = 0.0;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< [rad/s]
};

/// Times of all sensors of a recording: rates, gaps, and offsets of left and right images.
class TimeCheck {
 public:
  void add(const mrpt::obs::CObservation& observation);
  [[nodiscard]] std::vector<CheckItem> items() const;
  /// Number of images, of pairs or single.
  [[nodiscard]] std::size_t images() const { return images_; }
  /// Up to 200,000 samples of the gyroscope.
  [[nodiscard]] const std::vector<TurnSample>& turns() const { return turns_; }

 private:
  struct Sensor {
    std::string class_name;
    bool is_single_image = false;
    std::size_t count = 0;
    std::size_t without_time = 0;
    std::size_t backwards = 0;
    Time first = 0.0, last = 0.0;
    std::vector<float> intervals;  ///< up to 200,000 [s]
    std::vector<Time> times;       ///< of single images, up to 200,000
  };
  [[nodiscard]] static CheckItem rateOf(const std::string& label, const Sensor& sensor);
  [[nodiscard]] std::vector<CheckItem> pairOffsets() const;

  std::map<std::string, Sensor> sensors_;  ///< by label
  std::vector<TurnSample> turns_;
  std::size_t images_ = 0;
};

}  // namespace headway::import
