#pragma once

#include <headway/core/detection.h>
#include <headway/io/rawlog_sink.h>

#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// What a dataset has of one time.
struct DatasetFrame {
  Time time = 0.0;                          ///< [s]
  cv::Mat left;                             ///< 8-bit grey or BGR; empty: no images
  cv::Mat right;                            ///< likewise
  std::optional<Pose> T_map_robot;          ///< an estimate to be used instead of visual SLAM
  std::optional<Pose> truth_T_map_robot;    ///< ground truth
  std::optional<Detections> detections;     ///< to be used
  std::optional<Detections> truth_objects;  ///< ground truth, with ids
};

/// One inertial sample in the robot frame.
struct DatasetInertial {
  Time time = 0.0;                                             ///< [s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< [m/s^2], gravity included
};

/// A recording in the layout of some dataset, read frame by frame.
class Dataset {
 public:
  virtual ~Dataset() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// @throws InputError naming the file if an image cannot be read
  [[nodiscard]] virtual DatasetFrame frame(std::size_t index) const = 0;
  /// Of all images; nullopt if there are none.
  [[nodiscard]] virtual std::optional<RawStereoCamera> camera() const = 0;
  /// In time order; empty if none were recorded.
  [[nodiscard]] virtual std::vector<DatasetInertial> inertial() const { return {}; }
  /// What was left out while opening, by reason.
  [[nodiscard]] virtual std::map<std::string, std::size_t> dropped() const { return {}; }
};

}  // namespace headway::io
