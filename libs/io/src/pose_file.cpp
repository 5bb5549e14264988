#include <headway/io/pose_file.h>
#include <headway/io/trajectory_file.h>

#include "interpolation.h"
#include "text_rows.h"

namespace headway::io {
namespace {

constexpr double kMostGap = 0.5;  // [s]
constexpr std::size_t kKittiColumns = 12;

}  // namespace

PoseFile::PoseFile(const std::string& path, const Pose& T_robot_cam) {
  TextRows rows(path);
  if (!rows.next()) rows.fail("holds no poses");
  if (rows.size() != kKittiColumns) {
    by_time_ = readTum(path);
    return;
  }
  for (const auto& T_first_cam : readKittiPoses(path)) {
    by_frame_.push_back(T_robot_cam * T_first_cam * T_robot_cam.inverse());
  }
}

std::optional<Pose> PoseFile::at(std::size_t frame, Time time) const {
  if (by_frame_.empty()) return poseAt(by_time_, time, kMostGap);
  if (frame < by_frame_.size()) return by_frame_[frame];
  return std::nullopt;
}

}  // namespace headway::io
