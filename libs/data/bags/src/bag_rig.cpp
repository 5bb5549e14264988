// SPDX-License-Identifier: BSD-3-Clause
#include "bag_rig.h"

#include <headway/core/error.h>
#include <headway/io/calibration_file.h>

#include <array>

namespace headway::bags {
namespace {

using io::ImageKind;

ImageKind kindOf(const std::string& image_topic) {
  return image_topic.find("rect") == std::string::npos ? ImageKind::kRaw : ImageKind::kRectified;
}

/// Determines calibration and mounting step by step.
class RigBuilder {
 public:
  RigBuilder(const BagSurvey& survey, const BagImportOptions& options)
      : survey_(survey), options_(options) {
    rig_.frames = survey.frames;
    rig_.transforms = survey.transforms;
  }

  BagRig build() {
    const auto& topics = options_.topics;
    const std::string& first = topics.left.empty() ? topics.depth : topics.left;
    chooseBase(first);
    if (topics.left.empty()) {
      setDepthCamera();
    } else {
      setStereoCamera();
    }
    for (const auto* names : {&topics.imu, &topics.scans}) {
      for (const auto& name : *names) mountSensor(name);
    }
    if (!topics.gnss.empty()) mountSensor(topics.gnss);
    return rig_;
  }

 private:
  [[nodiscard]] std::string frameOf(const std::string& topic) const {
    const auto frame = survey_.frames.find(topic);
    return frame == survey_.frames.end() ? "" : frame->second;
  }

  void chooseBase(const std::string& camera_topic) {
    const std::string camera = frameOf(camera_topic);
    if (!options_.base_frame.empty()) {
      if (!survey_.transforms.between(options_.base_frame, camera)) {
        throw InputError("--base " + options_.base_frame + ": tf does not connect it with '" +
                         camera + "', the frame of " + camera_topic);
      }
      rig_.base_frame = options_.base_frame;
      return;
    }
    for (const char* name : {"base_link", "base_footprint", "base", "body"}) {
      if (!survey_.transforms.contains(name)) continue;
      if (!survey_.transforms.between(name, camera)) continue;
      rig_.base_frame = name;
      return;
    }
    rig_.notes.push_back("the mounting of the camera is unknown: tf does not connect '" + camera +
                         "' with base_link (--base FRAME); the robot's frame is in the camera");
  }

  /// Pose of a topic's frame on the robot; nullopt if it is unknown.
  [[nodiscard]] std::optional<Pose> mountingOf(const std::string& topic) const {
    if (rig_.base_frame.empty()) return std::nullopt;
    return survey_.transforms.between(rig_.base_frame, frameOf(topic));
  }

  [[nodiscard]] const io::CameraInfo& infoOf(const std::string& image_topic) const {
    const std::string name = cameraInfoTopicOf(image_topic);
    const auto info = survey_.camera_infos.find(name);
    if (info == survey_.camera_infos.end()) {
      throw InputError("the bag has no calibration of " + image_topic + ": no message in " + name +
                       (options_.topics.left.empty() ? "" : "; give --calibration FILE"));
    }
    return info->second;
  }

  [[nodiscard]] io::RawCamera lensOf(const std::string& image_topic) const {
    const std::string name = cameraInfoTopicOf(image_topic);
    const io::CameraInfo& info = infoOf(image_topic);
    const ImageKind kind = kindOf(image_topic);
    const double focal = kind == ImageKind::kRaw ? info.K[0] : info.P[0];
    if (focal == 0.0) {
      throw InputError(name + ": the camera was not calibrated (" +
                       (kind == ImageKind::kRaw ? "K" : "P") + " is zero)" +
                       (options_.topics.left.empty() ? "" : "; give --calibration FILE"));
    }
    try {
      const io::RawCamera lens = io::lensFrom(info, kind);
      const std::string fault = io::lensFault(lens);
      if (!fault.empty()) throw InputError(fault);
      return lens;
    } catch (const InputError& error) {
      throw InputError(name + ": " + error.what());
    }
  }

  void setStereoCamera() {
    const auto& topics = options_.topics;
    if (!options_.calibration.empty()) {
      const auto file = io::readStereoCalibration(options_.calibration);
      rig_.stereo = file.camera;
      const auto mounting = mountingOf(topics.left);
      if (mounting && !file.is_mounted) rig_.stereo.T_robot_left = *mounting;
    } else {
      rig_.stereo.left = lensOf(topics.left);
      rig_.stereo.right = lensOf(topics.right);
      rig_.stereo.T_left_right = rightInLeft();
      const double baseline = rig_.stereo.T_left_right.translation().norm();
      const std::string fault = io::baselineFault(baseline);
      if (!fault.empty()) {
        throw InputError(cameraInfoTopicOf(topics.right) + ": the baseline is " +
                         std::to_string(baseline) + ": " + fault);
      }
      rig_.stereo.T_robot_left = mountingOf(topics.left).value_or(robotFromOptical());
    }
    rig_.T_robot_sensor[topics.left] = rig_.stereo.T_robot_left;
  }

  [[nodiscard]] Pose rightInLeft() const {
    const auto& topics = options_.topics;
    const auto by_info =
        io::rightInLeft(infoOf(topics.left), infoOf(topics.right), kindOf(topics.left));
    if (by_info) return *by_info;
    const std::string left = frameOf(topics.left), right = frameOf(topics.right);
    const auto by_transforms = survey_.transforms.between(left, right);
    if (by_transforms && left != right) return *by_transforms;
    throw InputError(cameraInfoTopicOf(topics.right) +
                     ": states no baseline (P[3] is zero), and tf does not connect '" + left +
                     "' with '" + right + "': give --calibration FILE");
  }

  void setDepthCamera() {
    const auto& topics = options_.topics;
    rig_.color = lensOf(topics.color);
    const bool has_info = survey_.camera_infos.count(cameraInfoTopicOf(topics.depth)) > 0;
    rig_.depth = has_info ? lensOf(topics.depth) : rig_.color;
    if (!has_info) {
      rig_.notes.push_back(topics.depth + " has no camera_info: it is taken as registered to " +
                           topics.color);
    }
    const std::string color = frameOf(topics.color), depth = frameOf(topics.depth);
    rig_.T_robot_depth = mountingOf(topics.depth).value_or(robotFromOptical());
    Pose T_depth_color = Pose::Identity();
    if (has_info && color != depth) {
      const auto known = survey_.transforms.between(depth, color);
      if (known) T_depth_color = *known;
      if (!known) {
        rig_.notes.push_back("tf does not connect '" + depth + "' with '" + color +
                             "': both cameras are taken as one");
      }
    }
    rig_.T_robot_color = rig_.T_robot_depth * T_depth_color;
    rig_.T_robot_sensor[topics.depth] = rig_.T_robot_depth;
  }

  void mountSensor(const std::string& topic) {
    const auto& topics = options_.topics;
    const std::string& camera = topics.left.empty() ? topics.depth : topics.left;
    auto mounting = mountingOf(topic);
    if (!mounting && !frameOf(topic).empty()) {  // without a base, by the camera
      const auto T_camera_sensor = survey_.transforms.between(frameOf(camera), frameOf(topic));
      if (T_camera_sensor) mounting = rig_.T_robot_sensor.at(camera) * *T_camera_sensor;
    }
    if (mounting) rig_.T_robot_sensor[topic] = *mounting;
  }

  const BagSurvey& survey_;
  const BagImportOptions& options_;
  BagRig rig_;
};

}  // namespace

BagRig rigOf(const BagSurvey& survey, const BagImportOptions& options) {
  return RigBuilder(survey, options).build();
}

}  // namespace headway::bags
