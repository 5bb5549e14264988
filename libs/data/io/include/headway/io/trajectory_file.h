// SPDX-License-Identifier: BSD-3-Clause
// Files of trajectories, and poses between those of a trajectory.
#pragma once

#include <headway/core/pose.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace headway::io {

class TextRows;

inline constexpr double kMaxPoseGap_s = 0.5;  ///< between poses that are interpolated [s]

/// Reads `t x y z qx qy qz qw` rows; '#' starts a comment.
///
/// @throws InputError naming file and line of an error
[[nodiscard]] std::vector<Stamped<Pose>> readTum(const std::string& path);
/// Reads them row by row, as long as the file may be.
void visitTum(const std::string& path, const std::function<void(const Stamped<Pose>&)>& visit);

/// Reads them one by one.
class TumReader {
 public:
  /// @throws InputError if the file cannot be opened
  explicit TumReader(const std::string& path);
  ~TumReader();
  TumReader(const TumReader&) = delete;
  TumReader& operator=(const TumReader&) = delete;

  /// The next row; nullopt at the end. @throws InputError naming file and line of an error
  [[nodiscard]] std::optional<Stamped<Pose>> next();

 private:
  std::unique_ptr<TextRows> rows_;
};

/// Writes one row `t x y z qx qy qz qw`, all with 9 decimals, qw not negative.
void writeTumRow(std::ostream& out, const Stamped<Pose>& pose);

/// Writes one row per pose.
void writeTum(const std::string& path, const std::vector<Stamped<Pose>>& trajectory);

/// Where the odometry frame is in the map at one frame: one row of `map_odom.csv`.
struct MapOdomRow {
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  Pose T_map_odom = Pose::Identity();
  std::uint64_t revision = 0;  ///< of the map
  std::string cause;           ///< of that revision, such as "loop"
};

/// frame,time,x,y,z,qx,qy,qz,qw,revision,cause
[[nodiscard]] std::string mapOdomCsvHeader();
void writeMapOdomCsv(std::ostream& out, const MapOdomRow& row);
/// Calls back with each row. @throws InputError naming file and line of an error
void visitMapOdomCsv(const std::string& path, const std::function<void(const MapOdomRow&)>& visit);

/// Reads 3x4 row-major poses, one per row (KITTI odometry).
///
/// @throws InputError naming file and line of an error
[[nodiscard]] std::vector<Pose> readKittiPoses(const std::string& path);

/// Writes one row, a 3x4 row-major pose (KITTI odometry).
void writeKittiPoseRow(std::ostream& out, const Pose& pose);

/// Writes one row per pose.
void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses);

/// Robot poses of a side file, by time or by frame: TUM (`t x y z qx qy qz qw`, the robot's poses)
/// or KITTI (3x4, one per frame, left camera in the first one); the number of columns decides.
class PoseFile {
 public:
  /// @param T_robot_cam  pose of the camera of KITTI poses
  /// @throws InputError naming file and line of an error
  PoseFile(const std::string& path, const Pose& T_robot_cam);

  /// T_map_robot of a frame, interpolated between times at most 0.5 s apart; nullopt if the file
  /// has no pose for the frame.
  [[nodiscard]] std::optional<Pose> at(std::size_t frame, Time time) const;

 private:
  std::vector<Stamped<Pose>> by_time_;
  std::vector<Pose> by_frame_;
};

/// First sample at or after a time in a time-ordered container of Stamped values.
template <typename Samples>
[[nodiscard]] auto firstFrom(const Samples& samples, Time time) {
  return std::lower_bound(samples.begin(), samples.end(), time,
                          [](const auto& sample, Time t) { return sample.time < t; });
}

/// The samples before and after a time, with the interpolation ratio: 0 at `before`, 1 at `after`.
template <typename Value>
struct Neighbours {
  const Value& before;
  const Value& after;
  double ratio = 0.0;
};

/// The neighbours of a time, if they are at most `max_gap_s` apart, without extrapolation. A sample
/// of exactly that time is returned as both.
template <typename Samples>
[[nodiscard]] auto neighboursOf(const Samples& samples, Time time, double max_gap_s) {
  using Value = decltype(samples.begin()->value);
  std::optional<Neighbours<Value>> none;
  const auto after = firstFrom(samples, time);
  if (after == samples.end()) return none;
  if (after->time == time) return std::optional(Neighbours<Value>{after->value, after->value, 0.0});
  if (after == samples.begin()) return none;
  const auto before = after - 1;
  const double gap = after->time - before->time;
  if (gap > max_gap_s) return none;
  return std::optional(Neighbours<Value>{before->value, after->value, (time - before->time) / gap});
}

/// Pose interpolated between two samples at most `max_gap_s` apart: linear position, slerp
/// rotation.
///
/// @param poses  container of Stamped<Pose> in time order
template <typename Poses>
[[nodiscard]] std::optional<Pose> poseAt(const Poses& poses, Time time, double max_gap_s) {
  const auto around = neighboursOf(poses, time, max_gap_s);
  if (!around) return std::nullopt;
  const auto& [before, after, ratio] = *around;
  if (ratio == 0.0) return before;
  Pose pose = Pose::Identity();
  pose.translation() = (1.0 - ratio) * before.translation() + ratio * after.translation();
  pose.linear() = Eigen::Quaterniond(before.linear())
                      .slerp(ratio, Eigen::Quaterniond(after.linear()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace headway::io
