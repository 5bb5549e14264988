// SPDX-License-Identifier: BSD-3-Clause
// Sequences of the TUM RGB-D benchmark.
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "image_files.h"
#include "text_rows.h"

namespace headway::io {
namespace {

constexpr double kMetresPerUnit = 1.0 / 5000.0;  // of its depth images
constexpr double kReachM = 10.0;                 // of its cameras

/// Lenses of the dataset's three cameras, as its authors publish them; else those that its tools
/// assume.
RawCamera publishedLens(const std::string& folder) {
  RawCamera lens{640, 480, 525.0, 525.0, 319.5, 239.5, {}, {}, false};
  const std::string recording = std::filesystem::absolute(folder).lexically_normal().string();
  const std::size_t parent = recording.find_last_of('/', recording.size() - 2);
  const auto is_of = [&](const char* name) {
    return recording.find(name, parent) != std::string::npos;
  };
  if (is_of("freiburg1")) {
    lens = {640, 480, 517.306408, 516.469215, 318.643040, 255.313989, {}, {}, false};
    lens.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  } else if (is_of("freiburg2")) {
    lens = {640, 480, 520.908620, 521.007327, 325.141442, 249.701764, {}, {}, false};
    lens.distortion = {0.231222, -0.784899, -0.003257, -0.000105, 0.917205};
  } else if (is_of("freiburg3")) {
    lens = {640, 480, 535.4, 539.2, 320.1, 247.6, {}, {}, false};
  }
  return lens;
}

/// An image of one of the lists.
struct ListedImage {
  Time time = 0.0;
  std::string path;
};

std::vector<ListedImage> readList(const std::filesystem::path& folder, const char* name) {
  std::vector<ListedImage> images;
  TextRows rows((folder / name).string());
  while (rows.next()) {
    rows.requireSize(2, "a row of an image list (time, file)");
    const auto inside = std::filesystem::path(rows.fields()[1]).lexically_normal();
    const auto path = folder / inside;  // may be a link to elsewhere, as in views of a dataset
    if (inside.is_absolute() || *inside.begin() == "..") {
      rows.fail("the file is outside of the folder");
    }
    if (!std::isfinite(rows.number(0))) rows.fail("the time is not a number");
    images.push_back({rows.number(0), path.string()});
  }
  const auto by_time = [](const ListedImage& a, const ListedImage& b) { return a.time < b.time; };
  std::stable_sort(images.begin(), images.end(), by_time);
  return images;
}

std::vector<Time> timesOf(const std::vector<ListedImage>& images) {
  std::vector<Time> times;
  for (const auto& image : images) times.push_back(image.time);
  return times;
}

class TumRgbd : public Dataset {
 public:
  TumRgbd(const std::filesystem::path& folder, const std::string& calibration) {
    if (calibration.empty()) {
      depth_camera_.color = depth_camera_.depth = publishedLens(folder);
      depth_camera_.metres_per_unit = kMetresPerUnit;
      depth_camera_.max_range_m = kReachM;
    } else {
      depth_camera_ = readDepthCalibration(calibration).camera;
    }
    const auto images = readList(folder, "rgb.txt");
    pairImages(images, readList(folder, "depth.txt"), folder.string());
    readAccelerometer(folder / "accelerometer.txt");
    const auto truth = folder / "groundtruth.txt";
    if (!std::filesystem::exists(truth)) return;
    truth_ = readTum(truth.string());
    const Pose T_cam_robot = depth_camera_.T_robot_color.inverse();
    for (auto& pose : truth_) pose.value = pose.value * T_cam_robot;
  }

  std::size_t size() const override { return pairs_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const auto& [image, depth] = pairs_.at(index);
    DatasetFrame frame;
    frame.time = image.time;
    frame.left = requireImageOf(image.path, depth_camera_.color);
    frame.depth = requireDepthImageOf(depth.path, depth_camera_.depth);
    frame.truth_T_map_robot = poseAt(truth_, image.time, kMaxPoseGap_s);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return leftAlone(depth_camera_); }
  std::optional<RawDepthCamera> depthCamera() const override { return depth_camera_; }
  std::vector<DatasetInertial> inertial() const override { return inertial_; }
  std::map<std::string, std::vector<Time>> droppedTimes() const override {
    return {{"no_depth", without_depth_}};
  }

 private:
  /// Each image with the nearest depth image that is not yet another's.
  void pairImages(const std::vector<ListedImage>& images, const std::vector<ListedImage>& depths,
                  const std::string& folder) {
    const auto pairs = pairedByTime(timesOf(images), timesOf(depths), kMaxDepthGapS);
    for (const auto& [image, depth] : pairs) pairs_.push_back({images[image], depths[depth]});
    without_depth_ = unpairedTimes(timesOf(images), pairs, 0);
    if (pairs_.empty()) {
      throw InputError(folder + ": no image of rgb.txt has a depth image within " +
                       formatted("%g", kMaxDepthGapS) + " s in depth.txt");
    }
  }

  /// The Kinect's axes are x left, y up, z forward, as gravity in the benchmark's sequences shows.
  void readAccelerometer(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) return;
    TextRows rows(path.string());
    while (rows.next()) {
      rows.requireSize(4, "a row of the accelerometer (time, acceleration)");
      const Eigen::Vector3d optical(-rows.number(1), -rows.number(2), rows.number(3));
      const Time time = rows.number(0);
      if (!std::isfinite(time) || !optical.allFinite()) rows.fail("a value is not a number");
      inertial_.push_back({time, std::nullopt, depth_camera_.T_robot_color.linear() * optical});
    }
    std::stable_sort(inertial_.begin(), inertial_.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
  }

  struct DepthPair {
    ListedImage image, depth;
  };

  RawDepthCamera depth_camera_;
  std::vector<DepthPair> pairs_;
  std::vector<Stamped<Pose>> truth_;  ///< robot in the dataset's world
  std::vector<DatasetInertial> inertial_;
  std::vector<Time> without_depth_;  ///< of images
};

}  // namespace

std::unique_ptr<Dataset> openTumRgbd(const std::string& folder, const std::string& calibration) {
  return std::make_unique<TumRgbd>(folder, calibration);
}

}  // namespace headway::io
