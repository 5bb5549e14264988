#include "camera_poses.h"

#include <headway/io/trajectory_file.h>

#include "pose_format.h"

namespace headway::app {

std::vector<Stamped<Pose>> readCameraPoses(const std::string& path, const Pose& T_robot_cam) {
  std::vector<Stamped<Pose>> poses;
  if (poseFormatOf(path) == PoseFormat::kTum) {
    poses = io::readTum(path);
    for (auto& pose : poses) pose.value = pose.value * T_robot_cam;
    return poses;
  }
  for (const auto& pose : io::readKittiPoses(path)) {
    const double time = kNominalFrameInterval_s * static_cast<double>(poses.size());
    poses.push_back({time, T_robot_cam * pose});
  }
  return poses;
}

}  // namespace headway::app
