// SPDX-License-Identifier: BSD-3-Clause
#include "depth_calibration.h"

#include <headway/core/error.h>

#include "depth_registration.h"
#include "own_lens.h"

namespace headway::io {
namespace {

constexpr double kMax16Bit = 65535.0;

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
  camera.max_range_m = kMax16Bit * camera.metres_per_unit;
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
