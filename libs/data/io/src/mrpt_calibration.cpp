// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/camera_info.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "foreign_calibration.h"
#include "text_rows.h"

namespace headway::io {
namespace {

constexpr std::size_t kMaxIniBytes = 1 << 20;

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
    for (std::size_t bytes = 0; std::getline(file, line) && bytes < kMaxIniBytes;) {
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
  const Eigen::Quaterniond turn(q[3], q[4], q[5], q[6]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-2)) {
    ini.fail(section, "pose_quaternion",
             "is not x y z qr qx qy qz: its quaternion has length " + formatted("%g", turn.norm()));
  }
  result.camera.T_left_right.linear() = turn.normalized().toRotationMatrix();
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
