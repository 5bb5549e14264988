// SPDX-License-Identifier: BSD-3-Clause
// headway-export kitti-odometry: a rawlog's stereo frames as a KITTI odometry sequence.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/stereo_frame.h>
#include <headway/core/text.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "commands.h"

namespace headway::exporting {
namespace {

/// Whether a file is one that KittiWriter writes, by its path in the folder.
bool isExported(const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string();
  if (folder.empty()) return file == "times.txt" || file == "calib.txt" || file == "poses.txt";
  return folder.size() == 7 && folder.rfind("image_", 0) == 0 && program::isNumberedPicture(file);
}

/// One line of calib.txt: K [I | (offset, 0, 0)], row-major.
std::string projectionLine(const char* name, const StereoCamera& camera, double offset) {
  return formatted("%s: %.12e 0 %.12e %.12e 0 %.12e %.12e 0 0 0 1 0\n", name, camera.fx, camera.cx,
                   offset, camera.fy, camera.cy);
}

/// Writes stereo frames as a KITTI odometry sequence: `image_0/`, `image_1/` rectified grey,
/// `image_2/`, `image_3/` the same in colour if available, `times.txt`, `calib.txt`, and
/// `poses.txt` if all frames have a true pose. Frames are numbered from 0 in order of writing.
/// Images are PNG, thus lossless.
class KittiWriter {
 public:
  /// @throws InputError if the folder cannot be written
  explicit KittiWriter(const std::filesystem::path& folder)
      : folder_(folder), times_(folder / "times.txt") {}

  /// @param right_colour  empty if the images are grey
  /// @throws InputError on a write error
  void write(const StereoFrame& frame, const cv::Mat& right_colour) {
    writeImage("image_0", frame.left);
    writeImage("image_1", frame.right);
    if (!frame.left_colour.empty()) writeImage("image_2", frame.left_colour);
    if (!right_colour.empty()) writeImage("image_3", right_colour);
    times_.stream() << formatted("%.9f\n", frame.time);
    times_.endRows();
    ++size_;
  }

  /// Writes calib.txt and closes times.txt.
  void finish(const StereoCamera& camera) {
    times_.close();
    const double offset = -camera.fx * camera.baseline_m;
    writeFile(folder_ / "calib.txt",
              projectionLine("P0", camera, 0.0) + projectionLine("P1", camera, offset) +
                  projectionLine("P2", camera, 0.0) + projectionLine("P3", camera, offset));
  }

  /// Writes poses.txt: left camera in the first left camera, one row per frame.
  void writeTruth(const std::vector<Pose>& T_map_robot, const StereoCamera& camera) const {
    std::vector<Pose> T_first_cam;
    for (const auto& pose : T_map_robot) {
      T_first_cam.push_back((T_map_robot.front() * camera.T_robot_cam).inverse() * pose *
                            camera.T_robot_cam);
    }
    io::writeKittiPoses((folder_ / "poses.txt").string(), T_first_cam);
  }

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void writeImage(const char* name, const cv::Mat& image) const {
    const auto folder = folder_ / name;
    std::error_code error;
    if (size_ == 0) std::filesystem::create_directories(folder, error);
    if (error) throw InputError(folder.string() + ": cannot be created: " + error.message());
    std::vector<unsigned char> bytes;
    cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
    writeFile(folder / formatted("%06zu.png", size_),
              {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  std::filesystem::path folder_;
  GrowingFile times_;
  std::size_t size_ = 0;
};

/// The true pose of each frame; empty if a frame has none.
std::vector<Pose> truthAt(const std::vector<Time>& times, const std::string& rawlog) {
  const auto truth = io::readTruth(rawlog).poses;
  std::vector<Pose> poses;
  for (const Time time : times) {
    const auto found = std::find_if(truth.begin(), truth.end(), [time](const auto& pose) {
      return std::abs(pose.time - time) < 1e-3;  // of one frame, but for rounding [s]
    });
    if (found == truth.end()) return {};
    poses.push_back(found->value);
  }
  return poses;
}

void report(const ExportOptions& options, const KittiWriter& writer, const io::RawlogSource& source,
            bool has_truth) {
  std::cout << printable(options.output) << ": " << writer.size() << " frames, "
            << (has_truth ? "with" : "without") << " poses.txt"
            << (program::interrupted() ? ", interrupted" : "");
  for (const auto& [reason, count] : source.skipped()) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

}  // namespace

int runKittiOdometryExport(int argc, const char** argv) {
  ExportOptions options;
  io::RawlogSourceOptions reading;
  std::optional<std::size_t> from_index;
  const auto more = [&](program::CommandLine& line) {
    line.option(reading.sensor_label, 0, "sensor-label", "LABEL",
                "Stereo camera to use if the rawlog contains several");
    line.option(from_index, 0, "from-index", "N", "Index of the first frame");
    line.option(reading.to_index, 0, "to-index", "N", "Index of the last frame");
  };
  if (!parse(argc, argv,
             {"kitti-odometry",
              "Writes a rawlog's rectified stereo frames as a KITTI odometry sequence.",
              "IN.rawlog", "Rawlog to read", "DIR", true},
             options, more)) {
    return program::kDone;
  }
  reading.from_index = from_index.value_or(0);
  program::catchInterrupts();
  io::RawlogSource source(options.input, reading);
  if (!source.camera()) throw InputError(options.input + ": contains no stereo images");
  if (source.camera()->isDepthCamera()) {
    throw InputError(options.input +
                     ": is the recording of a depth camera; KITTI's layout consists "
                     "of the images of two cameras");
  }
  program::requireWritable(options.output, options.overwrite);
  program::OutputFolder folder(options.output, options.overwrite, {options.input}, isExported);
  KittiWriter writer(folder.path());
  std::vector<Time> times;
  {
    program::Progress progress("frames", options.quiet);
    while (!program::interrupted()) {
      const auto frame = source.next();
      if (!frame) break;
      writer.write(*frame->stereo, source.rightColour());
      times.push_back(frame->time);
      progress.update(times.size(), source.progress());
    }
  }
  writer.finish(*source.camera());
  const auto truth = truthAt(times, options.input);
  if (!truth.empty()) writer.writeTruth(truth, *source.camera());
  folder.publish();
  if (source.truncation()) {
    std::cerr << "headway-export: " << printable(*source.truncation()) << std::endl;
  }
  if (!options.quiet) report(options, writer, source, !truth.empty());
  return program::kDone;
}

}  // namespace headway::exporting
