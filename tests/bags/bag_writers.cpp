// SPDX-License-Identifier: BSD-3-Clause
#include "bag_writers.h"

#include <headway_test/folders.h>
#include <headway_test/npm_packages.h>
#include <headway_test/paths.h>
#include <headway_test/process.h>

#include <map>
#include <stdexcept>

namespace headway::bags::test {
namespace {

const std::string kWriters = std::string(HEADWAY_SOURCE_DIR) + "/tests/bags/writers/";
// Debian's Python, which has rosbag; another one may come first in the path.
constexpr char kPython[] = "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 ";

bool succeeds(const std::string& command) {
  return headway::test::runProcess("(" + command + ") 2>&1").status == 0;
}

/// Why npm's packages are not there; empty if they are. Installed by the first test that asks.
const std::string& missingPackages() {
  static const std::string missing =
      headway::test::missingNpmPackages("tests/bags/writers", HEADWAY_NODE_DIR, "write ROS 2 bags");
  return missing;
}

/// Why ROS 1 bags cannot be written; empty if they can.
const std::string& missingRosbag() {
  static const std::string missing =
      succeeds(std::string(kPython) + "-c 'import rosbag, sensor_msgs, nav_msgs, tf2_msgs'")
          ? ""
          : "python3-rosbag and python3 messages are not installed; they write ROS 1 bags";
  return missing;
}

std::string writeRos1(const BagFormat& format, const std::string& form, const std::string& path) {
  if (!missingRosbag().empty()) return missingRosbag();
  const std::string call = std::string(kPython) + kWriters + "write_ros1.py " + path + " " + form +
                           " " + format.compression;
  if (!succeeds(call)) throw std::runtime_error(call);
  return "";
}

std::string writeRos2(const BagFormat& format, const std::string& form, const std::string& path) {
  if (!missingPackages().empty()) return missingPackages();
  const bool is_db3 = std::string(format.ending) == "db3";
  const std::string written = is_db3 ? path + ".json" : path;
  std::string call = "cd " HEADWAY_NODE_DIR " && " + std::string(kPython) + kWriters +
                     "recording.py " + form + " | node " + kWriters + "write_ros2.mjs " + written +
                     " " + format.compression;
  if (is_db3) {
    call += " && " + std::string(kPython) + kWriters + "write_db3.py " + path + " < " + written +
            " && rm " + written;
  }
  if (!succeeds(call)) throw std::runtime_error(call);
  return "";
}

}  // namespace

std::string writeBag(const BagFormat& format, const std::string& form,
                     const std::filesystem::path& path) {
  // Interpreters take a second to start: each bag is written once a program, and copied.
  static const headway::test::TemporaryFolder folder;
  static std::map<std::string, std::string> missing;
  const std::string name = form + "_" + format.compression + "." + format.ending;
  const std::string written = folder / name;
  if (missing.count(name) == 0) {
    const bool is_ros1 = std::string(format.ending) == "bag";
    missing[name] = is_ros1 ? writeRos1(format, form, written) : writeRos2(format, form, written);
  }
  if (!missing[name].empty()) return missing[name];
  std::filesystem::copy_file(written, path, std::filesystem::copy_options::overwrite_existing);
  return "";
}

cv::Mat recordedPicture(int frame, int offset) {
  cv::Mat image(48, 64, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>((3 * u + 5 * v + 7 * frame + offset) % 256);
    }
  }
  return image;
}

cv::Mat recordedDepth(int frame) {
  cv::Mat depth(48, 64, CV_16UC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      depth.at<std::uint16_t>(v, u) =
          u < 4 && v < 4 ? 0 : static_cast<std::uint16_t>(1000 + 10 * u + v + 100 * frame);
    }
  }
  return depth;
}

}  // namespace headway::bags::test
