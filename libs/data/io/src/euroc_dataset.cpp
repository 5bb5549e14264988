// SPDX-License-Identifier: BSD-3-Clause
// Recordings in EuRoC's layout.
#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/trajectory_file.h>

#include <array>
#include <charconv>
#include <filesystem>

#include "image_files.h"
#include "text_rows.h"
#include "yaml_file.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxTruthGap = 0.2;  // [s]

using Nanoseconds = std::int64_t;

Time secondsOf(Nanoseconds time) { return static_cast<double>(time) * 1e-9; }

/// A time stamp in nanoseconds, which exceeds the precision of a double.
Nanoseconds nanosecondsAt(const TextRows& rows) {
  const std::string& text = rows.fields()[0];
  Nanoseconds time = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error != std::errc() || end != text.data() + text.size()) {
    rows.fail("'" + text + "' is not a time in nanoseconds");
  }
  return time;
}

struct Camera {
  RawCamera lens;
  Pose T_body_cam = Pose::Identity();
  std::map<Nanoseconds, std::string> images;
};

RawCamera readLens(const YamlFile& file) {
  const cv::Size size = file.imageSize("resolution");
  const auto intrinsics = file.numbers("intrinsics", 4, 4);
  const auto distortion = file.numbers("distortion_coefficients", 4, 5);
  for (const auto& [key, expected] :
       {std::pair("camera_model", "pinhole"), std::pair("distortion_model", "radial-tangential")}) {
    if (file.word(key) != expected) {
      file.fail(std::string("key '") + key + "' is '" + file.word(key) + "', only '" + expected +
                "' is supported");
    }
  }
  RawCamera lens;
  lens.width = size.width;
  lens.height = size.height;
  lens.fx = intrinsics[0];
  lens.fy = intrinsics[1];
  lens.cx = intrinsics[2];
  lens.cy = intrinsics[3];
  std::copy(distortion.begin(), distortion.end(), lens.distortion.begin());
  return lens;
}

Camera readCamera(const fs::path& folder) {
  Camera camera;
  const YamlFile file((folder / "sensor.yaml").string());
  camera.lens = readLens(file);
  camera.T_body_cam = file.pose("T_BS");
  TextRows rows((folder / "data.csv").string());
  while (rows.next()) {
    rows.requireSize(2, "a row of images (time, file)");
    camera.images[nanosecondsAt(rows)] = (folder / "data" / rows.fields()[1]).string();
  }
  return camera;
}

/// Rotation of the robot frame in the body: x along the mean viewing direction, y from the right to
/// the left camera.
Pose robotInBody(const Pose& T_body_left, const Pose& T_body_right) {
  const Eigen::Vector3d forward =
      (T_body_left.linear().col(2) + T_body_right.linear().col(2)).normalized();
  const Eigen::Vector3d to_left = T_body_left.translation() - T_body_right.translation();
  const Eigen::Vector3d left = (to_left - to_left.dot(forward) * forward).normalized();
  Pose T_body_robot = Pose::Identity();
  T_body_robot.linear() << forward, left, forward.cross(left);
  return T_body_robot;
}

/// `time,x,y,z,qw,qx,qy,qz,...` in nanoseconds and metres.
std::vector<Stamped<Pose>> readStateCsv(const std::string& path) {
  std::vector<Stamped<Pose>> poses;
  TextRows rows(path);
  while (rows.next()) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(rows.number(1), rows.number(2), rows.number(3));
    const Eigen::Quaterniond rotation(rows.number(4), rows.number(5), rows.number(6),
                                      rows.number(7));
    if (!(rotation.norm() > 0.5)) rows.fail("the quaternion has zero length");
    pose.linear() = rotation.normalized().toRotationMatrix();
    poses.push_back({secondsOf(nanosecondsAt(rows)), pose});
  }
  return poses;
}

class Euroc : public Dataset {
 public:
  explicit Euroc(const fs::path& folder) {
    const fs::path mav = folder / "mav0";
    if (!fs::is_directory(mav)) throw InputError(mav.string() + ": is not a folder");
    const Camera left = readCamera(mav / "cam0");
    const Camera right = readCamera(mav / "cam1");
    T_body_robot_ = robotInBody(left.T_body_cam, right.T_body_cam);
    camera_.left = left.lens;
    camera_.right = right.lens;
    camera_.T_robot_left = T_body_robot_.inverse() * left.T_body_cam;
    camera_.T_left_right = left.T_body_cam.inverse() * right.T_body_cam;
    pairImages(left, right, mav.string());
    readTruth(folder);
    if (fs::exists(mav / "imu0" / "data.csv")) readInertial(mav / "imu0");
  }

  std::size_t size() const override { return pairs_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const auto& pair = pairs_.at(index);
    DatasetFrame frame;
    frame.time = pair.time;
    frame.left = requireImage(pair.left);
    frame.right = requireImage(pair.right);
    frame.truth_T_map_robot = poseAt(truth_, pair.time, kMaxTruthGap);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return camera_; }
  std::vector<DatasetInertial> inertial() const override { return inertial_; }
  std::map<std::string, std::vector<Time>> droppedTimes() const override {
    return {{"unpaired_image", unpaired_}};
  }

 private:
  struct Pair {
    Time time = 0.0;
    std::string left;
    std::string right;
  };

  void pairImages(const Camera& left, const Camera& right, const std::string& folder) {
    for (const auto& [time, path] : left.images) {
      const auto partner = right.images.find(time);
      if (partner != right.images.end()) {
        pairs_.push_back({secondsOf(time), path, partner->second});
      }
    }
    for (const auto& [images, others] :
         {std::pair(&left.images, &right.images), std::pair(&right.images, &left.images)}) {
      for (const auto& [time, path] : *images) {
        if (others->count(time) == 0) unpaired_.push_back(secondsOf(time));
      }
    }
    if (pairs_.empty()) throw InputError(folder + ": cam0 and cam1 have no common time stamp");
  }

  void readTruth(const fs::path& folder) {
    const fs::path tum = folder / "groundtruth.tum";
    const fs::path states = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv";
    if (fs::exists(tum)) {
      truth_ = readTum(tum.string());
    } else if (fs::exists(states)) {
      truth_ = readStateCsv(states.string());
    }
    for (auto& pose : truth_) pose.value = pose.value * T_body_robot_;
  }

  void readInertial(const fs::path& folder) {
    const Pose T_body_sensor = YamlFile((folder / "sensor.yaml").string()).pose("T_BS");
    const Eigen::Matrix3d R_robot_sensor =
        T_body_robot_.linear().transpose() * T_body_sensor.linear();
    TextRows rows((folder / "data.csv").string());
    while (rows.next()) {
      rows.requireSize(7, "a row of inertial samples (time, angular velocity, acceleration)");
      const Eigen::Vector3d omega(rows.number(1), rows.number(2), rows.number(3));
      const Eigen::Vector3d acceleration(rows.number(4), rows.number(5), rows.number(6));
      inertial_.push_back(
          {secondsOf(nanosecondsAt(rows)), R_robot_sensor * omega, R_robot_sensor * acceleration});
    }
  }

  Pose T_body_robot_ = Pose::Identity();
  RawStereoCamera camera_;
  std::vector<Pair> pairs_;
  std::vector<Stamped<Pose>> truth_;  ///< robot in the dataset's world
  std::vector<DatasetInertial> inertial_;
  std::vector<Time> unpaired_;  ///< of images
};

}  // namespace

std::unique_ptr<Dataset> openEuroc(const std::string& folder) {
  return std::make_unique<Euroc>(folder);
}

}  // namespace headway::io
