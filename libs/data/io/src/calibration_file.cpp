// SPDX-License-Identifier: BSD-3-Clause
// Calibrations in headway's own format, and telling apart those of other programs.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/calibration_file.h>
#include <headway/io/raw_camera.h>
#include <headway/io/rawlog_sink.h>

#include <filesystem>
#include <limits>
#include <string>

#include "foreign_calibration.h"
#include "rectifier.h"
#include "text_rows.h"
#include "yaml_file.h"

namespace headway::io {
namespace {

constexpr double kMaxMountingM = 100.0;  // of a camera on a robot

/// As in the file of headway's own format, or of another program.
void requireValid(const RawStereoCamera& camera, const std::string& path,
                  const std::string& baseline_key) {
  const auto refuse = [&path](const std::string& reason) {
    throw InputError(path + ": " + reason);
  };
  const double baseline = camera.T_left_right.translation().norm();
  const std::string fault = baselineFault(baseline);
  if (!fault.empty()) refuse(baseline_key + ": " + formatted("%.6g", baseline) + ": " + fault);
  if (camera.T_robot_left.translation().norm() > kMaxMountingM) {
    refuse("T_robot_cam: the camera is " +
           formatted("%.6g", camera.T_robot_left.translation().norm()) +
           " away from the robot: in metres?");
  }
  try {
    validate(camera);
  } catch (const InputError& error) {
    refuse(error.what());
  }
}

std::string poseText(const Pose& pose) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += row == 0 ? "[" : "\n  ";
    for (int column = 0; column < 4; ++column) {
      text += formatted("%.17g", pose.matrix()(row, column));
      text += row == 2 && column == 3 ? "]" : ", ";
    }
  }
  return text;
}

/// What tells that the camera is a depth camera.
std::string depthText(const StereoCamera& camera) {
  if (!camera.isDepthCamera()) return "";
  return "# A depth camera: its baseline is that of a stereo camera with as much noise.\n" +
         formatted("depth_range_m: %.17g\n", camera.depth_reach_m);
}

StereoCalibrationFile readOwn(const YamlFile& file) {
  StereoCalibrationFile result;
  result.format = "headway";
  result.camera = readRawCalibration(file.path(), {"times", "frame_rate_hz"});
  result.is_mounted = file.has("T_robot_cam");
  if (file.has("times")) result.times = file.word("times");
  if (!file.has("frame_rate_hz")) return result;
  result.frame_rate = file.number("frame_rate_hz");
  if (!(result.frame_rate > 0.0)) file.fail("key 'frame_rate_hz' must be positive");
  return result;
}

/// A lens in headway's own calibrations: fx, fy, cx, cy and coefficients of distortion.
///
/// @throws InputError naming file and key if it is missing or impossible
RawCamera ownLens(const YamlFile& file, const std::string& key, cv::Size image_size,
                  bool is_fisheye) {
  const auto values = file.numbers(key, 4, is_fisheye ? 8 : 12);
  RawCamera lens;
  lens.width = image_size.width;
  lens.height = image_size.height;
  lens.fx = values[0];
  lens.fy = values[1];
  lens.cx = values[2];
  lens.cy = values[3];
  lens.is_fisheye = is_fisheye;
  for (std::size_t i = 4; i < values.size(); ++i) {
    const std::size_t k = i - 4;
    (k < lens.distortion.size() ? lens.distortion[k] : lens.rational[k - 5]) = values[i];
  }
  requireLens(lens, file, key);
  return lens;
}

/// The key `lens_model`. @throws InputError for models that are not known
bool isFisheye(const YamlFile& file) {
  if (!file.has("lens_model")) return false;
  const std::string model = file.word("lens_model");
  if (model != "fisheye" && model != "pinhole") {
    file.fail("key 'lens_model' is '" + model + "', known are pinhole and fisheye");
  }
  return model == "fisheye";
}

bool isTrue(const YamlFile& file, const std::string& key) {
  const std::string word = file.word(key);
  if (word != "true" && word != "false") {
    file.fail("key '" + key + "' is '" + word + "', must be true or false");
  }
  return word == "true";
}

double positiveNumber(const YamlFile& file, const std::string& key) {
  const double value = file.number(key);
  if (!(value > 0.0)) file.fail("key '" + key + "' must be positive");
  return value;
}

}  // namespace

void writeCalibration(const std::string& path, const StereoCamera& camera) {
  const std::string lens =
      formatted("[%.17g, %.17g, %.17g, %.17g]", camera.fx, camera.fy, camera.cx, camera.cy);
  OutputFile file(path);
  file.stream()
      << "# Rectified stereo camera: rows of left and right coincide.\n"
      << formatted("image_size: [%d, %d]  # width, height [px]\n", camera.width, camera.height)
      << "left: " << lens << "  # fx, fy, cx, cy [px]; (0, 0) is the centre of the first pixel\n"
      << "right: " << lens << "\n"
      << formatted("baseline_m: %.17g\n", camera.baseline_m) << depthText(camera)
      << "# Left camera (x right, y down, z forward) on the robot (x forward, y left, z up), 3x4.\n"
      << "T_robot_cam: " << poseText(camera.T_robot_cam) << "\n";
  file.commit();
}

RawStereoCamera readRawCalibration(const std::string& path,
                                   const std::vector<std::string>& also_known) {
  const YamlFile file(path);
  std::vector<std::string> known = {"image_size",   "left",        "right",     "baseline_m",
                                    "T_left_right", "T_robot_cam", "lens_model"};
  known.insert(known.end(), also_known.begin(), also_known.end());
  file.requireOnly(known);
  const auto image_size = file.imageSize("image_size");
  RawStereoCamera camera;
  const bool is_fisheye = isFisheye(file);
  camera.left = ownLens(file, "left", image_size, is_fisheye);
  camera.right = file.has("right") ? ownLens(file, "right", image_size, is_fisheye) : camera.left;
  if (file.has("T_left_right") == file.has("baseline_m")) {
    file.fail("exactly one of the keys 'baseline_m' and 'T_left_right' is required");
  }
  if (file.has("baseline_m")) {
    camera.T_left_right.translation().x() = file.number("baseline_m");
  } else {
    camera.T_left_right = file.pose("T_left_right");
  }
  if (file.has("T_robot_cam")) camera.T_robot_left = file.pose("T_robot_cam");
  requireValid(camera, path, file.has("baseline_m") ? "baseline_m" : "T_left_right");
  return camera;
}

StereoCalibrationFile readStereoCalibration(const std::string& paths,
                                            std::array<int, 2> image_size) {
  const auto comma = std::filesystem::exists(paths) ? std::string::npos : paths.find(',');
  const std::string path = paths.substr(0, comma);
  std::optional<StereoCalibrationFile> result;
  if (comma == std::string::npos) result = readMrptIni(path);
  if (!result) {
    std::vector<YamlFile> files = {YamlFile(path)};
    if (comma != std::string::npos) files.emplace_back(paths.substr(comma + 1));
    if (files.size() == 1 && files[0].has("left") && !files[0].has("cam0")) {
      return readOwn(files[0]);
    }
    result = readCameraInfoPair(files);
    if (!result) result = readKalibr(files);
    if (!result) result = readOrbSlam(files);
    if (!result) result = readOpenCv(files, image_size);
  }
  if (!result) {
    throw InputError(path +
                     ": is no stereo calibration that is known (headway, MRPT stereo .ini, ROS "
                     "camera_info, Kalibr camchain, ORB-SLAM, OpenCV; doc/formats.md)");
  }
  requireValid(result->camera, paths, "baseline");
  return *result;
}

StereoCamera readCalibration(const std::string& path) {
  const RawStereoCamera raw = readRawCalibration(path, {"depth_range_m"});
  if (!isRectified(raw)) throw InputError(path + ": the stereo pair is not rectified");
  StereoCamera camera = Rectifier(raw).camera();
  const YamlFile file(path);
  if (!file.has("depth_range_m")) return camera;
  camera.depth_reach_m = file.number("depth_range_m");
  if (!(camera.depth_reach_m > 0.0)) throw InputError(path + ": depth_range_m is not positive");
  return camera;
}

DepthCalibrationFile readDepthCalibration(const std::string& path) {
  const YamlFile file(path);
  file.requireOnly({"image_size", "left", "lens_model", "depth", "depth_size", "T_left_depth",
                    "depth_unit_m", "depth_range_m", "range_is_depth", "T_robot_cam",
                    "frame_rate_hz", "times"});
  DepthCalibrationFile result;
  RawDepthCamera& camera = result.camera;
  const cv::Size image_size = file.imageSize("image_size");
  camera.color = camera.depth = ownLens(file, "left", image_size, isFisheye(file));
  if (file.has("depth")) {
    const cv::Size size = file.has("depth_size") ? file.imageSize("depth_size") : image_size;
    camera.depth = ownLens(file, "depth", size, false);
  } else if (file.has("depth_size")) {
    file.fail("key 'depth_size' needs the key 'depth'");
  }
  if (file.has("T_left_depth")) camera.T_color_depth = file.pose("T_left_depth");
  if (file.has("T_robot_cam")) camera.T_robot_color = file.pose("T_robot_cam");
  if (file.has("depth_unit_m")) camera.metres_per_unit = positiveNumber(file, "depth_unit_m");
  camera.max_range_m = std::numeric_limits<std::uint16_t>::max() * camera.metres_per_unit;
  if (file.has("depth_range_m")) camera.max_range_m = positiveNumber(file, "depth_range_m");
  if (file.has("range_is_depth")) camera.ranges_are_depths = isTrue(file, "range_is_depth");
  if (file.has("times")) result.times = file.word("times");
  if (file.has("frame_rate_hz")) result.frame_rate = positiveNumber(file, "frame_rate_hz");
  try {
    validate(camera);
  } catch (const InputError& error) {
    file.fail(error.what());
  }
  return result;
}

}  // namespace headway::io
