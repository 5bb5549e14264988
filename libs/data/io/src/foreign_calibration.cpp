// SPDX-License-Identifier: BSD-3-Clause
#include "foreign_calibration.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/camera_info.h>

#include <algorithm>

namespace headway::io {
namespace {

constexpr std::size_t kMaxCoefficients = 14;  // that OpenCV's models have

template <std::size_t kSize>
std::array<double, kSize> arrayAt(const YamlFile& file, const std::string& key) {
  std::array<double, kSize> result{};
  const auto values = file.numbers(key, kSize, kSize);
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

int sideFrom(const YamlFile& file, const std::string& key, double value) {
  if (!(value >= 1.0 && value <= 1e5) || value != static_cast<int>(value)) {
    file.fail("key '" + file.prefix() + key + "': the size of images is not a number of pixels");
  }
  return static_cast<int>(value);
}

void setLens(RawCamera& lens, const std::vector<double>& fx_fy_cx_cy) {
  lens.fx = fx_fy_cx_cy[0];
  lens.fy = fx_fy_cx_cy[1];
  lens.cx = fx_fy_cx_cy[2];
  lens.cy = fx_fy_cx_cy[3];
}

/// Calls a conversion of camera_info and names the file in its errors.
template <typename Conversion>
auto inFile(const YamlFile& file, const Conversion& conversion) {
  try {
    return conversion();
  } catch (const InputError& error) {
    file.fail(error.what());
  }
}

CameraInfo cameraInfoFrom(const YamlFile& file) {
  CameraInfo info;
  info.width = sideFrom(file, "image_width", file.number("image_width"));
  info.height = sideFrom(file, "image_height", file.number("image_height"));
  if (file.has("distortion_model")) info.distortion_model = file.word("distortion_model");
  info.D = file.numbers("distortion_coefficients", 0, kMaxCoefficients);
  info.K = arrayAt<9>(file, "camera_matrix");
  info.R = arrayAt<9>(file, "rectification_matrix");
  info.P = arrayAt<12>(file, "projection_matrix");
  return info;
}

/// Settings of ORB-SLAM2 that contain matrices of both cameras below LEFT and RIGHT.
CameraInfo cameraInfoOf(const YamlFile& file, const std::string& side) {
  CameraInfo info;
  info.width = sideFrom(file, side + ".width", file.number(side + ".width"));
  info.height = sideFrom(file, side + ".height", file.number(side + ".height"));
  info.D = file.numbers(side + ".D", 0, kMaxCoefficients);
  info.K = arrayAt<9>(file, side + ".K");
  info.R = arrayAt<9>(file, side + ".R");
  info.P = arrayAt<12>(file, side + ".P");
  return info;
}

/// The pair of two infos, each of a file.
RawStereoCamera pairFrom(const CameraInfo& left, const YamlFile& left_file, const CameraInfo& right,
                         const YamlFile& right_file) {
  RawStereoCamera camera;
  camera.left = inFile(left_file, [&] { return lensFrom(left, ImageKind::kRaw); });
  camera.right = inFile(right_file, [&] { return lensFrom(right, ImageKind::kRaw); });
  const auto T = inFile(right_file, [&] { return rightInLeft(left, right, ImageKind::kRaw); });
  if (!T) {
    right_file.fail(
        "projection_matrix contains no baseline (its fourth number is 0): is this the right "
        "camera, calibrated as stereo pair?");
  }
  requireBaseline(*T, right_file, "projection_matrix");
  camera.T_left_right = *T;
  return camera;
}

RawCamera kalibrLens(const YamlFile& file) {
  if (file.word("camera_model") != "pinhole") {
    file.fail("key '" + file.prefix() + "camera_model' is '" + file.word("camera_model") +
              "', only 'pinhole' is supported; calibrate with pinhole-radtan or pinhole-equi");
  }
  RawCamera lens;
  const auto size = file.numbers("resolution", 2, 2);
  lens.width = sideFrom(file, "resolution", size[0]);
  lens.height = sideFrom(file, "resolution", size[1]);
  setLens(lens, file.numbers("intrinsics", 4, 4));
  const std::string model = file.word("distortion_model");
  if (model == "none") return lens;
  if (model != "radtan" && model != "equidistant") {
    file.fail("key '" + file.prefix() + "distortion_model' is '" + model +
              "', supported are radtan and equidistant");
  }
  lens.is_fisheye = model == "equidistant";
  const auto values = file.numbers("distortion_coeffs", 4, 4);
  std::copy(values.begin(), values.end(), lens.distortion.begin());
  return lens;
}

/// `Camera1.fx` and so on.
RawCamera orbSlamLens(const YamlFile& file, const std::string& name, const std::string& type) {
  const auto number = [&](const std::string& key, double otherwise) {
    const std::string whole = name + "." + key;
    return file.has(whole) ? file.number(whole) : otherwise;
  };
  RawCamera lens;
  lens.width = sideFrom(file, "Camera.width", file.number("Camera.width"));
  lens.height = sideFrom(file, "Camera.height", file.number("Camera.height"));
  setLens(lens, {file.number(name + ".fx"), file.number(name + ".fy"), file.number(name + ".cx"),
                 file.number(name + ".cy")});
  if (type == "KannalaBrandt8") {
    lens.is_fisheye = true;
    lens.distortion = {number("k1", 0.0), number("k2", 0.0), number("k3", 0.0), number("k4", 0.0)};
  } else if (type != "Rectified") {
    lens.distortion = {number("k1", 0.0), number("k2", 0.0), number("p1", 0.0), number("p2", 0.0),
                       number("k3", 0.0)};
    lens.rational = {number("k4", 0.0), number("k5", 0.0), number("k6", 0.0)};
  }
  return lens;
}

/// The right camera in the left one.
Pose orbSlamPose(const YamlFile& file, const std::string& first) {
  for (const char* key : {"Stereo.T_c1_c2", "Tlr"}) {
    if (!file.has(key)) continue;
    const Pose T_left_right = file.pose(key);
    requireBaseline(T_left_right, file, key);
    return T_left_right;
  }
  Pose T_left_right = Pose::Identity();
  auto& baseline = T_left_right.translation().x();
  if (file.has("Stereo.b")) {
    baseline = file.number("Stereo.b");
  } else if (file.has("Camera.bf")) {
    baseline = file.number("Camera.bf") / file.number(first + ".fx");
  } else {
    file.fail(
        "none of the keys Stereo.T_c1_c2, Stereo.b, Tlr and Camera.bf: is this the setting "
        "of a stereo camera?");
  }
  requireBaseline(T_left_right, file, file.has("Stereo.b") ? "Stereo.b" : "Camera.bf");
  return T_left_right;
}

}  // namespace

void requireLens(const RawCamera& lens, const YamlFile& file, const std::string& key) {
  const std::string fault = lensFault(lens);
  if (!fault.empty()) file.fail("key '" + key + "': " + fault);
}

void requireBaseline(const Pose& T_left_right, const YamlFile& file, const std::string& key) {
  const double baseline = T_left_right.translation().norm();
  const std::string fault = baselineFault(baseline);
  if (fault.empty()) return;
  file.fail("key '" + key + "': the baseline is " + formatted("%.6g", baseline) + ": " + fault);
}

std::optional<StereoCalibrationFile> readCameraInfoPair(const std::vector<YamlFile>& files) {
  const auto is_info = [](const YamlFile& file) {
    return file.has("camera_matrix") && file.has("projection_matrix");
  };
  if (!std::any_of(files.begin(), files.end(), is_info)) return std::nullopt;
  if (files.size() != 2) {
    files[0].fail("is the camera_info of one camera; give those of both: LEFT.yaml,RIGHT.yaml");
  }
  const CameraInfo left = cameraInfoFrom(files[0]);
  const CameraInfo right = cameraInfoFrom(files[1]);
  StereoCalibrationFile result;
  result.format = "ROS camera_info";
  result.camera = pairFrom(left, files[0], right, files[1]);
  requireLens(result.camera.left, files[0], "camera_matrix");
  requireLens(result.camera.right, files[1], "camera_matrix");
  return result;
}

std::optional<StereoCalibrationFile> readKalibr(const std::vector<YamlFile>& files) {
  if (!files[0].has("cam0")) return std::nullopt;
  if (!files[0].has("cam1")) files[0].fail("contains one camera only, cam1 is missing");
  StereoCalibrationFile result;
  result.format = "Kalibr camchain";
  const YamlFile cam0 = files[0].within("cam0");
  const YamlFile cam1 = files[0].within("cam1");
  result.camera.left = kalibrLens(cam0);
  result.camera.right = kalibrLens(cam1);
  requireLens(result.camera.left, files[0], "cam0.intrinsics");
  requireLens(result.camera.right, files[0], "cam1.intrinsics");
  result.camera.T_left_right = cam1.pose("T_cn_cnm1").inverse();
  requireBaseline(result.camera.T_left_right, files[0], "cam1.T_cn_cnm1");
  return result;
}

std::optional<StereoCalibrationFile> readOrbSlam(const std::vector<YamlFile>& files) {
  const YamlFile& file = files[0];
  const std::string first = file.has("Camera1.fx") ? "Camera1" : "Camera";
  if (!file.has(first + ".fx")) return std::nullopt;
  StereoCalibrationFile result;
  result.format = "ORB-SLAM settings";
  if (file.has("Camera.fps")) result.frame_rate = file.number("Camera.fps");
  if (file.has("LEFT.K")) {
    result.camera = pairFrom(cameraInfoOf(file, "LEFT"), file, cameraInfoOf(file, "RIGHT"), file);
  } else {
    const std::string type = file.has("Camera.type") ? file.word("Camera.type") : "PinHole";
    result.camera.left = orbSlamLens(file, first, type);
    result.camera.right =
        file.has("Camera2.fx") ? orbSlamLens(file, "Camera2", type) : result.camera.left;
    result.camera.T_left_right = orbSlamPose(file, first);
  }
  requireLens(result.camera.left, file, file.has("LEFT.K") ? "LEFT.K" : first + ".fx");
  requireLens(result.camera.right, file, file.has("LEFT.K") ? "RIGHT.K" : "Camera2.fx");
  return result;
}

}  // namespace headway::io
