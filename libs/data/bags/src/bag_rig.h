// SPDX-License-Identifier: BSD-3-Clause
// Calibration and mounting of the sensors of a bag, by camera_info and tf.
#pragma once

#include <headway/bags/bag_import.h>
#include <headway/bags/bag_selection.h>
#include <headway/core/pose.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "messages.h"

namespace headway::bags {

/// Frames of a robot and how they are mounted on each other, by its recorded transforms.
///
/// Of a frame that moves the first transform is kept: mounted sensors do not move.
class TransformTree {
 public:
  /// @param is_static  replaces what is known of the child frame
  void add(const TransformMessage& transform, bool is_static);
  [[nodiscard]] bool contains(const std::string& frame) const;
  /// Pose of frame b in frame a; nullopt if they are not connected.
  [[nodiscard]] std::optional<Pose> between(const std::string& a, const std::string& b) const;

 private:
  struct Parent {
    std::string frame;
    Pose T_parent_child = Pose::Identity();
    bool is_static = false;
  };
  /// The frame and all above it, with the pose of `frame` in each.
  [[nodiscard]] std::map<std::string, Pose> ancestorsOf(const std::string& frame) const;

  std::map<std::string, Parent> parents_;  ///< by child
};

/// The usual frame of a robot's base that is connected with another frame; empty: none is.
[[nodiscard]] std::string baseOf(const TransformTree& transforms, const std::string& frame);

/// What the beginning of a bag tells about the sensors.
struct BagSurvey {
  std::map<std::string, io::CameraInfo> camera_infos;  ///< by topic
  std::map<std::string, std::string> frames;           ///< of the sensors' topics
  TransformTree transforms;
};

/// Collects what must be known about topics before their messages can be used.
class Surveyor {
 public:
  /// @param topics  those that exist: a camera_info among them is waited for
  Surveyor(const BagSelection& selection, const std::vector<BagTopic>& topics);

  void use(const BagTopic& topic, std::string_view message);
  /// Takes the next camera_info of each camera, too; until then there are those of before.
  void renewInfos() { missing_infos_ = infos_; }
  [[nodiscard]] bool hasInfos() const { return missing_infos_.empty(); }
  /// Whether nothing more can be learnt: all sensors have frames that belong to one tree.
  [[nodiscard]] bool isComplete() const;

  BagSurvey survey;

 private:
  std::set<std::string> infos_;  ///< topics
  std::set<std::string> missing_infos_;
  std::set<std::string> transform_topics_;
  std::set<std::string> sensors_;
};

/// Reads until all is known, or for 10 s of the recording; for camera_info to the end.
[[nodiscard]] BagSurvey surveyBag(const std::string& path, const BagSelection& selection);

/// Calibration and mounting of the sensors of a bag.
struct BagRig {
  io::RawStereoCamera stereo;  ///< if a stereo camera is selected
  io::RawCamera color;         ///< if a depth camera is, as the following
  io::RawCamera depth;
  Pose T_robot_color = Pose::Identity();       ///< optical frame
  Pose T_robot_depth = Pose::Identity();       ///< optical frame
  std::map<std::string, Pose> T_robot_sensor;  ///< by topic; missing: unknown
  std::map<std::string, std::string> frames;   ///< of sensors by topic, for messages
  std::string base_frame;                      ///< empty: no transforms
  TransformTree transforms;
  std::vector<std::string> notes;  ///< what had to be assumed
};

/// @throws InputError naming the topic whose calibration is missing or impossible
[[nodiscard]] BagRig rigOf(const BagSurvey& survey, const BagImportOptions& options);

}  // namespace headway::bags
