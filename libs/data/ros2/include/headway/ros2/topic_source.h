// SPDX-License-Identifier: BSD-3-Clause
// Topics of ROS 2 as live observations.
#pragma once

#include <headway/core/pose.h>
#include <headway/ros2/node.h>
#include <headway/ros2/ros2_params.h>
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::ros2 {

/// How topics become observations, besides which they are.
struct TopicSourceOptions {
  std::string calibration;          ///< file of a stereo camera, instead of camera_info; or empty
  double pair_tolerance_s = 0.01;   ///< between the images of a pair; depth at least 0.02 [s]
  std::string odom_frame = "odom";  ///< of the odometry that others publish, see odometryAt()
  std::string map_frame = "map";  ///< of /initialpose
};

/// State of one topic.
struct TopicStatus {
  std::string topic;
  std::string use;  ///< "left image", "laser scan", ...
  std::size_t messages = 0;
  double age_s = 0.0;  ///< of the newest one
};

/// Subscribes to the sensors of a robot and calls back with an observation for each message, a pair
/// for each two images of the same time.
///
/// Topics may come and go; what is not named is chosen from what is published. Sensors are mounted
/// by /tf and /tf_static, cameras calibrated by their camera_info. Messages that cannot be used are
/// counted by reason, and each reason is said once.
///
///     TopicSource topics(node, params, {}, callbacks);
///     topics.start();
class TopicSource {
 public:
  /// Called by the source's thread.
  struct Callbacks {
    std::function<void(const mrpt::obs::CObservation::Ptr&)> observation;
    std::function<void(const std::string&)> message;            ///< what is wrong, one line
    std::function<void(const Pose& T_map_robot)> initial_pose;  ///< of /initialpose
  };

  /// @param node  which nobody else uses between start() and stop(), apart from its publications
  TopicSource(Node& node, const Ros2SourceParams& params, const TopicSourceOptions& options,
              Callbacks callbacks);
  ~TopicSource();  ///< stops and unsubscribes
  TopicSource(const TopicSource&) = delete;
  TopicSource& operator=(const TopicSource&) = delete;

  void start();
  void stop();

  // By any thread:

  [[nodiscard]] std::vector<TopicStatus> status() const;
  /// Messages that were not used, by reason.
  [[nodiscard]] std::map<std::string, std::size_t> skipped() const;
  /// What is waited for before there are observations of a camera; empty: nothing.
  [[nodiscard]] std::string missing() const;
  /// The robot's frame: base_frame, or that on which tf mounts the camera; base_link without tf.
  [[nodiscard]] std::string robotFrame() const;
  /// T_odom_robot that others publish; nullopt if nobody does at that time.
  [[nodiscard]] std::optional<Pose> odometryAt(Time time) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// What `--ros2-list` prints: the topics that are published, and what they would be used as.
[[nodiscard]] std::string listOfTopics(Node& node, const Ros2SourceParams& params);

}  // namespace headway::ros2
