// SPDX-License-Identifier: BSD-3-Clause
// Calibrations that other programs write: ROS, Kalibr, ORB-SLAM, OpenCV, MRPT.
#include "foreign_calibration.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/raw_camera.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "text_rows.h"

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

namespace {

/// Names that programs give to the same matrix.
using Names = std::vector<std::string>;

/// Keys in one or several files.
class OpenCvKeys {
 public:
  explicit OpenCvKeys(const std::vector<YamlFile>& files) : files_(files) {}

  struct Found {
    const YamlFile* file = nullptr;
    std::string key;
  };

  [[nodiscard]] std::optional<Found> find(const Names& names) const {
    for (const YamlFile& file : files_) {
      for (const auto& name : names) {
        if (file.has(name)) return Found{&file, name};
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<double> numbers(const Names& names, std::size_t min_size,
                                            std::size_t max_size) const {
    const auto found = find(names);
    if (!found) {
      files_.back().fail("key '" + names.front() + "' is missing" +
                         (files_.size() == 1
                              ? "; if intrinsics and extrinsics are in two files, give both: "
                                "INTRINSICS.yml,EXTRINSICS.yml"
                              : ""));
    }
    return found->file->numbers(found->key, min_size, max_size);
  }

 private:
  const std::vector<YamlFile>& files_;
};

const Names kLeftMatrix = {"M1", "K1", "cameraMatrix1", "camera_matrix_1", "camera_matrix_left"};
const Names kRightMatrix = {"M2", "K2", "cameraMatrix2", "camera_matrix_2", "camera_matrix_right"};
const Names kLeftDistortion = {"D1", "distCoeffs1", "dist_coeffs_1", "distortion_left"};
const Names kRightDistortion = {"D2", "distCoeffs2", "dist_coeffs_2", "distortion_right"};
const Names kTranslation = {"T", "translation"};
const Names kRotation = {"R", "rotation"};
const Names kSize = {"image_size", "imageSize", "img_size", "size"};

RawCamera openCvLens(const OpenCvKeys& keys, const Names& matrix, const Names& distortion,
                     std::array<int, 2> size) {
  CameraInfo info;
  info.width = size[0];
  info.height = size[1];
  const auto K = keys.numbers(matrix, 9, 9);
  std::copy(K.begin(), K.end(), info.K.begin());
  info.D = keys.numbers(distortion, 1, kMaxCoefficients);
  const auto fisheye = keys.find({"fisheye_model", "fisheye"});
  const bool is_fisheye = fisheye && fisheye->file->number(fisheye->key) != 0.0;
  info.distortion_model = is_fisheye ? "fisheye" : "rational_polynomial";
  const auto found = keys.find(distortion);
  try {
    return lensFrom(info, ImageKind::kRaw);
  } catch (const InputError& error) {
    found->file->fail("key '" + found->key + "': " + error.what());
  }
}

std::array<int, 2> sizeFrom(const OpenCvKeys& keys, const YamlFile& file,
                            std::array<int, 2> of_images) {
  std::vector<double> values;
  if (const auto size = keys.find(kSize)) {
    values = size->file->numbers(size->key, 2, 2);
  } else if (keys.find({"image_width"})) {
    values = {keys.numbers({"image_width"}, 1, 1)[0], keys.numbers({"image_height"}, 1, 1)[0]};
  } else if (of_images[0] > 0) {
    return of_images;
  }
  if (values.empty())
    file.fail("the size of the images is missing: add image_size: [width, height]");
  if (!(values[0] >= 1.0 && values[0] <= 1e5 && values[1] >= 1.0 && values[1] <= 1e5)) {
    file.fail("key 'image_size' is not a number of pixels");
  }
  return {static_cast<int>(values[0]), static_cast<int>(values[1])};
}

}  // namespace

std::optional<StereoCalibrationFile> readOpenCv(const std::vector<YamlFile>& files,
                                                std::array<int, 2> image_size) {
  const OpenCvKeys keys(files);
  const auto left = keys.find(kLeftMatrix);
  const auto translation = keys.find(kTranslation);
  if (!left && !(translation && keys.find(kRotation))) return std::nullopt;
  StereoCalibrationFile result;
  result.format = "OpenCV";
  const auto size = sizeFrom(keys, files[0], image_size);
  result.camera.left = openCvLens(keys, kLeftMatrix, kLeftDistortion, size);
  result.camera.right = openCvLens(keys, kRightMatrix, kRightDistortion, size);
  const auto right = keys.find(kRightMatrix);
  requireLens(result.camera.left, *left->file, left->key);
  requireLens(result.camera.right, *right->file, right->key);
  const auto R = keys.numbers(kRotation, 9, 9);
  const auto T = keys.numbers(kTranslation, 3, 3);
  Pose T_right_left = Pose::Identity();
  T_right_left.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  T_right_left.translation() = Eigen::Vector3d(T[0], T[1], T[2]);
  if (!isRotation(T_right_left.linear())) translation->file->fail("key 'R' is not a rotation");
  requireBaseline(T_right_left, *translation->file, translation->key);
  result.camera.T_left_right = T_right_left.inverse();
  return result;
}

namespace {

std::string trimmed(const std::string& text) {
  const auto from = text.find_first_not_of(" \t\r");
  if (from == std::string::npos) return "";
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

/// Sections of numbers. MRPT's own reader evaluates expressions and variables of the environment,
/// which a calibration has no use for.
class CalibrationIni {
 public:
  explicit CalibrationIni(const std::string& path) : path_(path) {
    std::ifstream file(path);
    std::string line, section;
    for (std::size_t bytes = 0; std::getline(file, line) && bytes < kMaxCalibrationBytes;) {
      bytes += line.size();
      line = trimmed(line.substr(0, std::min({line.find("//"), line.find('#'), line.find(';')})));
      if (line.size() > 1 && line.front() == '[' && line.back() == ']') {
        section = line.substr(1, line.size() - 2);
      } else if (const auto at = line.find('='); at != std::string::npos && !section.empty()) {
        values_[section][trimmed(line.substr(0, at))] = trimmed(line.substr(at + 1));
      }
    }
  }

  /// Name before _LEFT2RIGHT_POSE; empty if there is no such section.
  [[nodiscard]] std::string prefix() const {
    const std::string ending = "_LEFT2RIGHT_POSE";
    for (const auto& [section, keys] : values_) {
      const auto at = section.size() < ending.size() ? 0 : section.size() - ending.size();
      if (at > 0 && section.compare(at, ending.size(), ending) == 0) return section.substr(0, at);
    }
    return "";
  }

  [[nodiscard]] std::string word(const std::string& section, const std::string& key,
                                 const std::string& otherwise) const {
    const auto keys = values_.find(section);
    if (keys == values_.end() || keys->second.count(key) == 0) return otherwise;
    return keys->second.at(key);
  }

  /// "[1 2 3]", "1 2 3" or "1, 2, 3".
  [[nodiscard]] std::vector<double> numbers(const std::string& section, const std::string& key,
                                            std::size_t min_size, std::size_t max_size) const {
    std::string text = word(section, key, "");
    if (text.empty()) fail(section, key, "is missing");
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
    std::istringstream words(text);
    std::vector<double> values;
    for (std::string one; words >> one;) {
      const auto value = parseNumber(one);
      if (!value) fail(section, key, "contains '" + one + "', which is not a number");
      values.push_back(*value);
    }
    if (values.size() < min_size || values.size() > max_size) {
      fail(
          section, key,
          "has " + std::to_string(values.size()) + " numbers, must be " + std::to_string(min_size));
    }
    return values;
  }

  [[noreturn]] void fail(const std::string& section, const std::string& key,
                         const std::string& reason) const {
    throw InputError(path_ + ": section [" + section + "], key '" + key + "' " + reason);
  }

 private:
  std::string path_;
  std::map<std::string, std::map<std::string, std::string>> values_;
};

RawCamera mrptLens(const CalibrationIni& ini, const std::string& section) {
  RawCamera lens;
  const auto size = ini.numbers(section, "resolution", 2, 2);
  const auto is_side = [](double side) { return side >= 1.0 && side <= 1e5; };
  if (!is_side(size[0]) || !is_side(size[1])) ini.fail(section, "resolution", "is not in pixels");
  lens.width = static_cast<int>(size[0]);
  lens.height = static_cast<int>(size[1]);
  lens.fx = ini.numbers(section, "fx", 1, 1)[0];
  lens.fy = ini.numbers(section, "fy", 1, 1)[0];
  lens.cx = ini.numbers(section, "cx", 1, 1)[0];
  lens.cy = ini.numbers(section, "cy", 1, 1)[0];
  // MRPT writes distortion_model, and its documentation says distortion.
  const std::string model =
      ini.word(section, "distortion_model", ini.word(section, "distortion", "plumb_bob"));
  if (model == "kannala_brandt") {
    lens.is_fisheye = true;
    const auto k = ini.numbers(section, "dist", 4, 8);
    const std::size_t third = k.size() >= 6 ? 4 : 2;  // some leave room for tangential ones
    lens.distortion = {k[0], k[1], k[third], k[third + 1], 0.0};
  } else if (model == "plumb_bob") {
    const auto k = ini.numbers(section, "dist", 4, 8);
    for (std::size_t i = 0; i < k.size(); ++i) {
      (i < lens.distortion.size() ? lens.distortion[i] : lens.rational[i - 5]) = k[i];
    }
  } else if (model != "none") {
    ini.fail(section, "distortion_model",
             "is '" + model + "', known are none, plumb_bob and kannala_brandt");
  }
  const std::string fault = lensFault(lens);
  if (!fault.empty()) ini.fail(section, "fx", ": " + fault);
  return lens;
}

}  // namespace

std::optional<StereoCalibrationFile> readMrptIni(const std::string& path) {
  const CalibrationIni ini(path);
  const std::string prefix = ini.prefix();
  if (prefix.empty()) return std::nullopt;
  StereoCalibrationFile result;
  result.format = "MRPT stereo .ini";
  result.camera.left = mrptLens(ini, prefix + "_LEFT");
  result.camera.right = mrptLens(ini, prefix + "_RIGHT");
  const std::string section = prefix + "_LEFT2RIGHT_POSE";
  const auto q = ini.numbers(section, "pose_quaternion", 7, 7);
  const Eigen::Quaterniond rotation(q[3], q[4], q[5], q[6]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-2)) {
    ini.fail(
        section, "pose_quaternion",
        "is not x y z qr qx qy qz: its quaternion has length " + formatted("%g", rotation.norm()));
  }
  result.camera.T_left_right.linear() = rotation.normalized().toRotationMatrix();
  result.camera.T_left_right.translation() = Eigen::Vector3d(q[0], q[1], q[2]);
  const double baseline = result.camera.T_left_right.translation().norm();
  const std::string fault = baselineFault(baseline);
  if (!fault.empty()) {
    ini.fail(section, "pose_quaternion",
             "is a baseline of " + formatted("%.6g", baseline) + ": " + fault);
  }
  return result;
}

}  // namespace headway::io
