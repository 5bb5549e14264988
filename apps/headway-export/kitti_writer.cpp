#include "kitti_writer.h"

#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

namespace headway::exporting {
namespace {

template <typename... Arguments>
std::string formatted(const char* format, Arguments... arguments) {
  std::array<char, 512> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, arguments...);
  return buffer.data();
}

void makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be created: " + error.message());
}

std::ofstream openFor(const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string() + ": cannot be written");
  return file;
}

void close(std::ofstream& file, const std::filesystem::path& path) {
  file.close();
  if (!file) throw InputError(path.string() + ": not written completely; check the disk space");
}

/// One line of calib.txt: K [I | (offset, 0, 0)], row-major.
std::string projectionLine(const char* name, const StereoCamera& camera, double offset) {
  return formatted("%s: %.12e 0 %.12e %.12e 0 %.12e %.12e 0 0 0 1 0\n", name, camera.fx, camera.cx,
                   offset, camera.fy, camera.cy);
}

}  // namespace

KittiWriter::KittiWriter(const std::filesystem::path& folder) : folder_(folder) {
  makeFolder(folder_);
  times_ = openFor(folder_ / "times.txt");
}

void KittiWriter::write(const StereoFrame& frame, const cv::Mat& right_colour) {
  writeImage("image_0", frame.left);
  writeImage("image_1", frame.right);
  if (!frame.left_colour.empty()) writeImage("image_2", frame.left_colour);
  if (!right_colour.empty()) writeImage("image_3", right_colour);
  times_ << formatted("%.9f\n", frame.time);
  ++size_;
}

void KittiWriter::finish(const StereoCamera& camera) {
  close(times_, folder_ / "times.txt");
  const std::filesystem::path path = folder_ / "calib.txt";
  const double offset = -camera.fx * camera.baseline_m;
  auto file = openFor(path);
  file << projectionLine("P0", camera, 0.0) << projectionLine("P1", camera, offset)
       << projectionLine("P2", camera, 0.0) << projectionLine("P3", camera, offset);
  close(file, path);
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
  auto file = openFor(path);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  close(file, path);
}

}  // namespace headway::exporting
