// SPDX-License-Identifier: BSD-3-Clause
#include "kitti_writer.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/trajectory_file.h>

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace headway::exporting {
namespace {

void makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be created: " + error.message());
}

/// One line of calib.txt: K [I | (offset, 0, 0)], row-major.
std::string projectionLine(const char* name, const StereoCamera& camera, double offset) {
  return formatted("%s: %.12e 0 %.12e %.12e 0 %.12e %.12e 0 0 0 1 0\n", name, camera.fx, camera.cx,
                   offset, camera.fy, camera.cy);
}

}  // namespace

bool isExported(const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string();
  if (folder.empty()) return file == "times.txt" || file == "calib.txt" || file == "poses.txt";
  const std::string number = file.stem().string();
  return folder.size() == 7 && folder.rfind("image_", 0) == 0 && file.extension() == ".png" &&
         number.size() >= 6 && number.find_first_not_of("0123456789") == std::string::npos;
}

KittiWriter::KittiWriter(const std::filesystem::path& folder)
    : folder_(folder), times_(folder / "times.txt") {}

void KittiWriter::write(const StereoFrame& frame, const cv::Mat& right_colour) {
  writeImage("image_0", frame.left);
  writeImage("image_1", frame.right);
  if (!frame.left_colour.empty()) writeImage("image_2", frame.left_colour);
  if (!right_colour.empty()) writeImage("image_3", right_colour);
  times_.stream() << formatted("%.9f\n", frame.time);
  times_.endRows();
  ++size_;
}

void KittiWriter::finish(const StereoCamera& camera) {
  times_.close();
  const double offset = -camera.fx * camera.baseline_m;
  writeFile(folder_ / "calib.txt",
            projectionLine("P0", camera, 0.0) + projectionLine("P1", camera, offset) +
                projectionLine("P2", camera, 0.0) + projectionLine("P3", camera, offset));
}

void KittiWriter::writeTruth(const std::vector<Pose>& T_map_robot,
                             const StereoCamera& camera) const {
  std::vector<Pose> T_first_cam;
  for (const auto& pose : T_map_robot) {
    T_first_cam.push_back((T_map_robot.front() * camera.T_robot_cam).inverse() * pose *
                          camera.T_robot_cam);
  }
  io::writeKittiPoses((folder_ / "poses.txt").string(), T_first_cam);
}

void KittiWriter::writeImage(const char* folder, const cv::Mat& image) const {
  if (size_ == 0) makeFolder(folder_ / folder);
  const auto path = folder_ / folder / formatted("%06zu.png", size_);
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  writeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace headway::exporting
