// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the whole pipeline.
#include <headway/core/error.h>
#include <headway/pipeline/perception_params.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace headway::pipeline {
namespace {

constexpr const char* kNone = "none";
constexpr const char* kAuto = "auto";
constexpr const char* kRecorded = "recorded";
constexpr const char* kStereoMotion = "stereo_motion";
constexpr const char* kShape = "shape";
constexpr const char* kNetwork = "dnn";

/// Of the network in live operation: a pass of YOLOX-nano takes 63 ms of one core, and two frames
/// at 10 Hz have to take less than 200 ms.
constexpr double kNetworkPeriod_s = 0.2;

std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> result;
  std::istringstream list(names + "+");
  for (std::string name; std::getline(list, name, '+');) result.push_back(name);
  return result;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string choices() {
  std::string text = std::string(kNone) + ", " + kAuto + ", " + kRecorded;
  for (const auto& name : detect::detectorNames()) text += ", " + name;
  return text + "; several joined by +";
}

}  // namespace

void DetectionParams::describe(Params& params) {
  params.section("detect").user().add(
      "detector", detector,
      "Source of detections: auto (unless boxes are recorded, stereo_motion, shape on robots, dnn "
      "if there is a model), none, recorded, "
      "stereo_motion, dnn, hog, shape, or several joined by +");
  params.section("detect").add(
      "recorded_timeout_s", recorded_timeout_s, 0.1, 1e4, "s",
      "Time without recorded boxes after which stereo_motion runs until they return (auto)");
  detect.describe(params);
}

void DetectionParams::validate() const {
  detect.validate();
  try {
    checkDetectorNames(detector);
  } catch (const InputError& error) {
    throw InputError(std::string("[detect] detector = ") + error.what());
  }
}

void checkDetectorNames(const std::string& names) {
  if (names == kNone || names == kAuto) return;
  const auto list = split(names);
  for (const auto& name : list) {
    if (name != kRecorded && !contains(detect::detectorNames(), name)) {
      throw InputError("'" + names + "' is none of " + choices());
    }
    if (std::count(list.begin(), list.end(), name) > 1) {
      throw InputError("'" + names + "' names " + name + " twice");
    }
  }
}

bool usesRecordedBoxes(const std::string& names) {
  return names == kAuto || contains(split(names), kRecorded);
}

std::vector<std::string> imageDetectors(const DetectionParams& params) {
  const std::string& names = params.detector;
  if (names == kAuto) {
    if (detect::findModel(params.detect.network).empty()) return {kStereoMotion, kShape};
    return {kNetwork, kStereoMotion, kShape};
  }
  if (names == kNone) return {};
  auto result = split(names);
  result.erase(std::remove(result.begin(), result.end(), kRecorded), result.end());
  return result;
}

std::string modelInUse(const DetectionParams& params) {
  return contains(imageDetectors(params), kNetwork) ? detect::findModel(params.detect.network) : "";
}

bool wouldUseModel(const DetectionParams& params) { return params.detector == kAuto; }

void CameraParams::describe(Params::Section section) {
  section.add(
      "scale", scale, 0.25, 1.0, "",
      "Size of the images inside by that of the input; 0.5 takes half the time and sees half "
      "as far; a map is continued at its own scale only");
}

void GridParams::describe(Params::Section section) {
  section.user().add("period_s", period_s, 0.0, 100.0, "s",
                     "Period of the ground scans, and of the depth scans of the dense map; greater "
                     "is faster; 0: neither grid nor dense map");
  section.renamed("every_nth_frame", "period_s", secondsOfFrames);
  section.add("local", local,
              "Scan each frame for what is blocked and free around the robot now; not used by "
              "headway-replay, unless live");
  scan.describe(section);
  map.describe(section);
}

void LaserParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("use", use, "Enter 2D laser scans into the grid as obstacles");
  user.add("reach_m", reach_m, 0.5, 100.0, "m",
           "Maximum distance of obstacles from the laser; greater is less accurate in turns");
}

PerceptionParams PerceptionParams::live(PerceptionParams params) {
  params.slam.adjust_in_background = true;
  if (modelInUse(params.detection).empty()) return params;
  auto& detect = params.detection.detect;
  detect.network.tiles = false;
  detect.period_s = std::max(detect.period_s, kNetworkPeriod_s);
  return params;
}

void PerceptionParams::describe(Params& params) {
  camera.describe(params.section("camera"));
  slam.describe(params.section("slam"));
  detection.describe(params);
  objects.describe(params.section("objects"));
  grid.describe(params.section("grid"));
  dense.describe(params.section("dense"));
  laser.describe(params.section("laser"));
  robot.describe(params.section("robot").user());
}

void PerceptionParams::validate() const {
  camera.validate();
  slam.validate();
  detection.validate();
  objects.validate();
  grid.validate();
  dense.validate();
  laser.validate();
  robot.validate();
}

}  // namespace headway::pipeline
