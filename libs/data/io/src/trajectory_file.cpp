// SPDX-License-Identifier: BSD-3-Clause
// Files of trajectories, and poses between those of a trajectory.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/trajectory_file.h>

#include <cmath>

#include "text_rows.h"

namespace headway::io {
namespace {

constexpr double kUnitTolerance = 1e-2;  // files have as few as 4 decimals

/// @param first  column of x, before y z qx qy qz qw
Pose poseFromTum(const TextRows& rows, std::size_t first = 1) {
  const auto number = [&](std::size_t i) { return rows.number(first + i); };
  Eigen::Vector3d position(number(0), number(1), number(2));
  Eigen::Quaterniond rotation(number(6), number(3), number(4), number(5));
  if (!position.allFinite() || !rotation.coeffs().allFinite()) rows.fail("the pose is not finite");
  if (std::abs(rotation.norm() - 1.0) > kUnitTolerance) {
    rows.fail("the quaternion has length " + std::to_string(rotation.norm()) + ", must be 1");
  }
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

Pose poseFromKitti(const TextRows& rows) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      pose.matrix()(row, column) = rows.number(static_cast<std::size_t>(4 * row + column));
    }
  }
  if (!pose.matrix().allFinite()) rows.fail("the pose is not finite");
  if (!isRotation(pose.linear(), kUnitTolerance)) rows.fail("the left 3x3 block is not a rotation");
  return pose;
}

Eigen::Quaterniond positiveQuaternionOf(const Pose& pose) {
  Eigen::Quaterniond rotation(pose.linear());
  if (rotation.w() < 0.0) rotation.coeffs() *= -1.0;
  return rotation;
}

constexpr std::size_t kKittiColumns = 12;

}  // namespace

TumReader::TumReader(const std::string& path) : rows_(std::make_unique<TextRows>(path)) {}
TumReader::~TumReader() = default;

std::optional<Stamped<Pose>> TumReader::next() {
  if (!rows_->next()) return std::nullopt;
  rows_->requireSize(8, "a TUM row (t x y z qx qy qz qw)");
  const Time time = rows_->number(0);
  if (!std::isfinite(time)) rows_->fail("the time is not finite");
  return Stamped<Pose>{time, poseFromTum(*rows_)};
}

void visitTum(const std::string& path, const std::function<void(const Stamped<Pose>&)>& visit) {
  TumReader reader(path);
  while (const auto pose = reader.next()) visit(*pose);
}

std::vector<Stamped<Pose>> readTum(const std::string& path) {
  std::vector<Stamped<Pose>> trajectory;
  visitTum(path, [&](const Stamped<Pose>& pose) { trajectory.push_back(pose); });
  return trajectory;
}

void writeTumRow(std::ostream& out, const Stamped<Pose>& pose) {
  const Eigen::Quaterniond rotation = positiveQuaternionOf(pose.value);
  const auto& position = pose.value.translation();
  out << formatted("%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.time, position.x(),
                   position.y(), position.z(), rotation.x(), rotation.y(), rotation.z(),
                   rotation.w());
}

std::string mapOdomCsvHeader() { return "frame,time,x,y,z,qx,qy,qz,qw,revision,cause"; }

void writeMapOdomCsv(std::ostream& out, const MapOdomRow& row) {
  const Eigen::Quaterniond rotation = positiveQuaternionOf(row.T_map_odom);
  const auto& position = row.T_map_odom.translation();
  out << formatted("%zu,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%llu,", row.frame, row.time,
                   position.x(), position.y(), position.z(), rotation.x(), rotation.y(),
                   rotation.z(), rotation.w(), static_cast<unsigned long long>(row.revision))
      << row.cause << '\n';
}

void visitMapOdomCsv(const std::string& path, const std::function<void(const MapOdomRow&)>& visit) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; the header line is missing");
  const CsvColumns columns(rows, mapOdomCsvHeader());
  while (rows.next()) {
    rows.requireSize(11, "a row of map_odom.csv (" + mapOdomCsvHeader() + ")");
    visit({rows.index(columns.at("frame")), rows.number(columns.at("time")),
           poseFromTum(rows, columns.at("x")), rows.index(columns.at("revision")),
           rows.fields()[columns.at("cause")]});
  }
}

void writeTum(const std::string& path, const std::vector<Stamped<Pose>>& trajectory) {
  OutputFile file(path);
  for (const auto& pose : trajectory) writeTumRow(file.stream(), pose);
  file.commit();
}

std::vector<Pose> readKittiPoses(const std::string& path) {
  std::vector<Pose> poses;
  TextRows rows(path);
  while (rows.next()) {
    rows.requireSize(kKittiColumns, "a KITTI pose row (3x4 matrix, row-major)");
    poses.push_back(poseFromKitti(rows));
  }
  return poses;
}

void writeKittiPoseRow(std::ostream& out, const Pose& pose) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out << formatted("%.12e", pose.matrix()(row, column))
          << (row == 2 && column == 3 ? '\n' : ' ');
    }
  }
}

void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses) {
  OutputFile file(path);
  for (const auto& pose : poses) writeKittiPoseRow(file.stream(), pose);
  file.commit();
}

PoseFile::PoseFile(const std::string& path, const Pose& T_robot_cam) {
  TextRows rows(path);
  if (!rows.next()) rows.fail("contains no poses");
  if (rows.size() != kKittiColumns) {
    by_time_ = readTum(path);
    return;
  }
  for (const auto& T_first_cam : readKittiPoses(path)) {
    by_frame_.push_back(T_robot_cam * T_first_cam * T_robot_cam.inverse());
  }
}

std::optional<Pose> PoseFile::at(std::size_t frame, Time time) const {
  if (by_frame_.empty()) return poseAt(by_time_, time, kMaxPoseGap_s);
  if (frame < by_frame_.size()) return by_frame_[frame];
  return std::nullopt;
}

}  // namespace headway::io
