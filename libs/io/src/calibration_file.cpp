#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/calibration_file.h>

#include "rectifier.h"
#include "text_rows.h"
#include "yaml_file.h"

namespace headway::io {
namespace {

RawCamera lensFrom(const YamlFile& file, const std::string& key, cv::Size image_size) {
  const auto values = file.numbers(key, 4, 9);
  RawCamera lens;
  lens.width = image_size.width;
  lens.height = image_size.height;
  lens.fx = values[0];
  lens.fy = values[1];
  lens.cx = values[2];
  lens.cy = values[3];
  for (std::size_t i = 4; i < values.size(); ++i) lens.distortion[i - 4] = values[i];
  return lens;
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
      << formatted("baseline_m: %.17g\n", camera.baseline_m)
      << "# Left camera (x right, y down, z forward) on the robot (x forward, y left, z up), 3x4.\n"
      << "T_robot_cam: " << poseText(camera.T_robot_cam) << "\n";
  file.commit();
}

RawStereoCamera readRawCalibration(const std::string& path,
                                   const std::vector<std::string>& also_known) {
  const YamlFile file(path);
  std::vector<std::string> known = {"image_size", "left",         "right",
                                    "baseline_m", "T_left_right", "T_robot_cam"};
  known.insert(known.end(), also_known.begin(), also_known.end());
  file.requireOnly(known);
  const auto image_size = file.imageSize("image_size");
  RawStereoCamera camera;
  camera.left = lensFrom(file, "left", image_size);
  camera.right = file.has("right") ? lensFrom(file, "right", image_size) : camera.left;
  if (file.has("T_left_right") == file.has("baseline_m")) {
    file.fail("exactly one of the keys 'baseline_m' and 'T_left_right' is required");
  }
  if (file.has("baseline_m")) {
    camera.T_left_right.translation().x() = file.number("baseline_m");
  } else {
    camera.T_left_right = file.pose("T_left_right");
  }
  if (file.has("T_robot_cam")) camera.T_robot_left = file.pose("T_robot_cam");
  try {
    validate(camera);
  } catch (const InputError& error) {
    file.fail(error.what());
  }
  return camera;
}

StereoCamera readCalibration(const std::string& path) {
  const RawStereoCamera raw = readRawCalibration(path);
  if (!isRectified(raw)) throw InputError(path + ": the stereo pair is not rectified");
  return Rectifier(raw).camera();
}

}  // namespace headway::io
