// SPDX-License-Identifier: BSD-3-Clause
#include "kitti_raw_drive.h"

#include <headway/core/error.h>
#include <headway/io/image_decoding.h>

#include "image_files.h"
#include "oxts.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

/// Pose of a rigid motion in a calibration file: "R:" row-major and "T:".
Pose readRigid(const fs::path& path) {
  const auto matrices = readKittiCalibration(path.string());
  const auto R = kittiMatrix(matrices, "R", 9, path.string());
  const auto T = kittiMatrix(matrices, "T", 3, path.string());
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(T.data());
  return normalized(pose);
}

/// Calibration of one day of recording.
struct DayCalibration {
  KittiProjection P_left, P_right;
  cv::Size size;
  Pose T_cam_velo = Pose::Identity();  ///< lidar frame in rectified camera 0
  Pose T_cam_imu = Pose::Identity();   ///< GNSS and inertial unit in rectified camera 0
};

DayCalibration readDay(const fs::path& folder) {
  const std::string path = (folder / "calib_cam_to_cam.txt").string();
  const auto matrices = readKittiCalibration(path);
  const auto matrix = [&](const char* name, std::size_t size) {
    return kittiMatrix(matrices, name, size, path).data();
  };
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  DayCalibration day;
  day.P_left = Eigen::Map<const RowMajor34>(matrix("P_rect_00", 12));
  day.P_right = Eigen::Map<const RowMajor34>(matrix("P_rect_01", 12));
  const double* size = matrix("S_rect_00", 2);
  for (const double side : {size[0], size[1]}) {
    if (!(side >= 1.0 && side <= kMaxImageSide)) throw InputError(path + ": S_rect_00 is no size");
  }
  day.size = cv::Size(static_cast<int>(size[0]), static_cast<int>(size[1]));
  Pose T_rectified_cam = Pose::Identity();
  T_rectified_cam.linear() = Eigen::Map<const RowMajor33>(matrix("R_rect_00", 9));
  day.T_cam_velo = normalized(T_rectified_cam * readRigid(folder / "calib_velo_to_cam.txt"));
  day.T_cam_imu = day.T_cam_velo * readRigid(folder / "calib_imu_to_velo.txt");
  return day;
}

void readFrames(const fs::path& folder, KittiRawDrive& drive) {
  const auto left = (fs::path("image_00") / "data").string();
  const auto right = (fs::path("image_01") / "data").string();
  const auto pairs = kittiImagePairs(folder, left, right, drive.dropped);
  const std::string path = (folder / "image_00" / "timestamps.txt").string();
  const auto times = readKittiTimestamps(path);
  for (const auto& pair : pairs) {
    if (pair.number >= times.size()) {
      throw InputError(path + ": has " + std::to_string(times.size()) + " times, none for image " +
                       std::to_string(pair.number));
    }
    drive.frames.push_back({times[pair.number], pair, std::nullopt});
  }
}

void requireRectified(const cv::Mat& image, cv::Size size, const std::string& path) {
  if (image.size() == size) return;
  const auto text = [](cv::Size s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
  };
  throw InputError(path + ": the image has " + text(image.size()) +
                   " pixels, but the calibration's rectified images have " + text(size) +
                   "; only rectified drives (DATE_drive_NNNN_sync) can be read");
}

/// Level frame at the position and heading of a pose.
Pose levelled(const Pose& pose) {
  Pose level = Pose::Identity();
  level.linear() = Eigen::AngleAxisd(yawOf(pose), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  level.translation() = pose.translation();
  return level;
}

void addTruth(const std::vector<Stamped<Pose>>& T_world_imu, const Pose& T_imu_robot,
              KittiRawDrive& drive) {
  std::optional<Pose> T_map_world;
  for (auto& frame : drive.frames) {
    const auto pose = oxtsPoseAt(T_world_imu, frame.time);
    if (!pose) {
      ++drive.dropped["frame_without_truth"];
      continue;
    }
    const Pose T_world_robot = *pose * T_imu_robot;
    if (!T_map_world) T_map_world = levelled(T_world_robot).inverse();
    frame.truth_T_map_robot = *T_map_world * T_world_robot;
  }
}

void addSensors(const std::vector<OxtsPacket>& packets, const Pose& T_robot_imu,
                KittiRawDrive& drive) {
  const Eigen::Matrix3d R_robot_imu = T_robot_imu.linear();
  for (const auto& packet : packets) {
    drive.inertial.push_back(
        {packet.time, R_robot_imu * packet.angular_velocity, R_robot_imu * packet.acceleration});
    drive.gnss.push_back({packet.time, T_robot_imu, packet.latitude_deg, packet.longitude_deg,
                          packet.altitude_m, packet.velocity, packet.satellites,
                          packet.position_sigma_m});
  }
}

}  // namespace

DatasetFrame KittiRawDrive::Frame::load() const {
  DatasetFrame frame;
  frame.time = time;
  frame.left = requireImage(images.left);
  frame.right = requireImage(images.right);
  frame.truth_T_map_robot = truth_T_map_robot;
  return frame;
}

KittiRawDrive readKittiRawDrive(const fs::path& folder, OxtsPath path) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": is not a folder");
  const fs::path given = folder.filename().empty() ? folder.parent_path() : folder;
  const auto day = readDay(fs::absolute(given).parent_path());
  KittiRawDrive drive;
  readFrames(folder, drive);
  const auto& first = drive.frames.front().images;
  requireRectified(requireImage(first.left), day.size, first.left);
  drive.camera = kittiCamera(day.P_left, day.size, day.P_right, requireImage(first.right).size());
  drive.T_cam_velo = day.T_cam_velo;
  if (fs::is_directory(folder / "oxts")) {
    const auto packets = readOxts((folder / "oxts").string(), drive.dropped);
    const Pose T_robot_imu = robotFromOptical() * day.T_cam_imu;
    addTruth(oxtsPath(packets, path), T_robot_imu.inverse(), drive);
    addSensors(packets, T_robot_imu, drive);
  }
  return drive;
}

}  // namespace headway::io
