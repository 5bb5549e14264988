// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval_files/camera_poses.h>
#include <headway/io/trajectory_file.h>

#include <fstream>
#include <sstream>

namespace headway::eval_files {

PoseFormat poseFormatOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened");
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::size_t columns = 0;
    for (std::string word; words >> word;) ++columns;
    if (columns == 8) return PoseFormat::kTum;
    if (columns == 12) return PoseFormat::kKitti;
    if (columns > 0) {
      throw InputError(path + ": rows have " + std::to_string(columns) +
                       " columns; TUM has 8 (t x y z qx qy qz qw), KITTI 12 (3x4 matrix)");
    }
  }
  throw InputError(path + ": contains no poses");
}

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

}  // namespace headway::eval_files
