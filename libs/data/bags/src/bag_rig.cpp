// SPDX-License-Identifier: BSD-3-Clause
// Calibration and mounting of the sensors of a bag, by camera_info and tf.
#include "bag_rig.h"

#include <headway/core/error.h>
#include <headway/io/calibration_file.h>

#include <algorithm>
#include <array>

#include "bag_file.h"

namespace headway::bags {
namespace {

constexpr std::size_t kMaxFrames = 10000;  // of tf, and
constexpr std::size_t kMaxDepth = 100;     // of their tree: a broken bag may contain circles
constexpr std::int64_t kSurveyNs = 10'000'000'000;  // in which each sensor and transform occurs

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
    rig_.base_frame = baseOf(survey_.transforms, camera);
    if (!rig_.base_frame.empty()) return;
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
      throw InputError("there is no calibration of " + image_topic + ": no message in " + name +
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

void TransformTree::add(const TransformMessage& transform, bool is_static) {
  const auto known = parents_.find(transform.child_frame);
  if (known != parents_.end() && (known->second.is_static || !is_static)) return;
  if (known == parents_.end() && parents_.size() == kMaxFrames) return;
  parents_[transform.child_frame] = {transform.header.frame, transform.T_parent_child, is_static};
}

bool TransformTree::contains(const std::string& frame) const {
  return parents_.count(frame) > 0 ||
         std::any_of(parents_.begin(), parents_.end(),
                     [&](const auto& entry) { return entry.second.frame == frame; });
}

std::optional<Pose> TransformTree::between(const std::string& a, const std::string& b) const {
  if (a == b) return Pose::Identity();
  const auto above_a = ancestorsOf(a);
  Pose T_above_b = Pose::Identity();
  std::string frame = b;
  for (std::size_t depth = 0; depth < kMaxDepth; ++depth) {
    const auto common = above_a.find(frame);
    if (common != above_a.end()) return common->second.inverse() * T_above_b;
    const auto parent = parents_.find(frame);
    if (parent == parents_.end()) return std::nullopt;
    T_above_b = parent->second.T_parent_child * T_above_b;
    frame = parent->second.frame;
  }
  return std::nullopt;
}

std::map<std::string, Pose> TransformTree::ancestorsOf(const std::string& frame) const {
  std::map<std::string, Pose> result = {{frame, Pose::Identity()}};
  Pose T_above_frame = Pose::Identity();
  std::string current = frame;
  for (std::size_t depth = 0; depth < kMaxDepth; ++depth) {
    const auto parent = parents_.find(current);
    if (parent == parents_.end()) break;
    T_above_frame = parent->second.T_parent_child * T_above_frame;
    current = parent->second.frame;
    result.emplace(current, T_above_frame);
  }
  return result;
}

std::string baseOf(const TransformTree& transforms, const std::string& frame) {
  for (const char* name : {"base_link", "base_footprint", "base", "body"}) {
    if (transforms.contains(name) && transforms.between(name, frame)) return name;
  }
  return "";
}

Surveyor::Surveyor(const BagSelection& selection, const std::vector<BagTopic>& topics)
    : transform_topics_(selection.tf.begin(), selection.tf.end()) {
  for (const auto& image : {selection.left, selection.right, selection.color, selection.depth}) {
    if (image.empty()) continue;
    sensors_.insert(image);
    const std::string info = cameraInfoTopicOf(image);
    const bool exists = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
      return topic.name == info && topic.messages > 0;
    });
    if (exists) infos_.insert(info);
  }
  renewInfos();
  for (const auto* names : {&selection.imu, &selection.scans}) {
    sensors_.insert(names->begin(), names->end());
  }
  if (!selection.gnss.empty()) sensors_.insert(selection.gnss);
}

void Surveyor::use(const BagTopic& topic, std::string_view message) {
  try {
    if (missing_infos_.count(topic.name) > 0) {
      survey.camera_infos[topic.name] = decodeCameraInfo(message, topic.encoding).info;
      missing_infos_.erase(topic.name);
    } else if (transform_topics_.count(topic.name) > 0) {
      const bool is_static = topic.name.find("static") != std::string::npos;
      for (const auto& transform : decodeTransforms(message, topic.encoding)) {
        survey.transforms.add(transform, is_static);
      }
    } else if (sensors_.count(topic.name) > 0 && survey.frames.count(topic.name) == 0) {
      survey.frames[topic.name] = decodeHeader(message, topic.encoding).frame;
    }
  } catch (const BrokenData&) {  // counted when it is imported, or there is another one
  }
}

bool Surveyor::isComplete() const {
  if (!hasInfos() || survey.frames.size() < sensors_.size()) return false;
  if (transform_topics_.empty()) return true;
  const std::string& first = survey.frames.begin()->second;
  return survey.transforms.contains("base_link") && survey.transforms.between("base_link", first) &&
         std::all_of(survey.frames.begin(), survey.frames.end(), [&](const auto& frame) {
           return survey.transforms.between(first, frame.second).has_value();
         });
}

BagSurvey surveyBag(const std::string& path, const BagSelection& selection) {
  const auto bag = openBag(path);
  Surveyor surveyor(selection, bag->topics());
  std::optional<std::int64_t> start;
  while (const auto message = bag->next()) {
    surveyor.use(bag->topics()[message->topic], message->content);
    start = std::min(start.value_or(message->received_ns), message->received_ns);
    const bool is_late = message->received_ns / 2 - *start / 2 > kSurveyNs / 2;
    if (surveyor.isComplete() || (is_late && surveyor.hasInfos())) break;
  }
  return surveyor.survey;
}

BagRig rigOf(const BagSurvey& survey, const BagImportOptions& options) {
  return RigBuilder(survey, options).build();
}

}  // namespace headway::bags
