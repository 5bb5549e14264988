// SPDX-License-Identifier: BSD-3-Clause
// KITTI's odometry benchmark, and what all recordings of KITTI have in common: numbered images,
// calibrations.
#include "kitti_odometry.h"

#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/trajectory_file.h>

#include <filesystem>
#include <optional>

#include "image_files.h"
#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

/// Number of an image named "000012.png"; nullopt for any other name.
std::optional<std::size_t> frameNumber(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  if (stem.empty() || stem.size() > 10 || stem.find_first_not_of("0123456789") != stem.npos) {
    return std::nullopt;
  }
  return std::stoul(stem);
}

RawCamera lensOf(const KittiProjection& P, cv::Size size) {
  RawCamera lens;
  lens.width = size.width;
  lens.height = size.height;
  lens.fx = P(0, 0);
  lens.fy = P(1, 1);
  lens.cx = P(0, 2);
  lens.cy = P(1, 2);
  return lens;
}

/// Centre of a camera with projection K [I | t] in rectified camera 0.
Eigen::Vector3d centreOf(const KittiProjection& P) {
  return -P.leftCols<3>().partialPivLu().solve(P.col(3));
}

class KittiOdometry : public Dataset {
 public:
  KittiOdometry(const fs::path& folder, const std::string& sequence)
      : folder_(folder / "sequences" / sequence) {
    if (!fs::is_directory(folder_)) throw InputError(folder_.string() + ": is not a folder");
    const bool is_grey = fs::is_directory(folder_ / "image_0");
    findFrames(is_grey ? "image_0" : "image_2", is_grey ? "image_1" : "image_3");
    readCamera(is_grey ? "P0" : "P2", is_grey ? "P1" : "P3");
    readFrameTimes();
    const fs::path official = folder / "poses" / (sequence + ".txt");
    const fs::path beside = folder_ / "poses.txt";
    if (fs::exists(official)) {
      readTruth(official);
    } else if (fs::exists(beside)) {
      readTruth(beside);
    }
  }

  std::size_t size() const override { return frames_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const Files& files = frames_.at(index);
    DatasetFrame frame;
    frame.time = files.time;
    frame.left = requireImage(files.left);
    frame.right = requireImage(files.right);
    frame.truth_T_map_robot = files.truth;
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return camera_; }
  std::map<std::string, std::size_t> dropped() const override { return dropped_; }

 private:
  struct Files {
    std::size_t number = 0;
    Time time = 0.0;
    std::string left;
    std::string right;
    std::optional<Pose> truth;
  };

  void findFrames(const char* left_folder, const char* right_folder) {
    for (auto& [number, left, right] :
         kittiImagePairs(folder_, left_folder, right_folder, dropped_)) {
      const Time time = kKittiFramePeriod * static_cast<double>(number);
      frames_.push_back({number, time, std::move(left), std::move(right), std::nullopt});
    }
  }

  void readCamera(const char* left_name, const char* right_name) {
    const std::string path = (folder_ / "calib.txt").string();
    const auto projections = readKittiProjections(path);
    const auto left = projections.find(left_name);
    const auto right = projections.find(right_name);
    if (left == projections.end() || right == projections.end()) {
      throw InputError(path + ": no line '" + left_name + ":' or '" + right_name + ":'");
    }
    camera_ = kittiCamera(left->second, requireImage(frames_.front().left).size(), right->second,
                          requireImage(frames_.front().right).size());
  }

  void readFrameTimes() {
    const fs::path path = folder_ / "times.txt";
    if (!fs::exists(path)) return;
    const auto times = readTimes(path.string());
    for (auto& frame : frames_) {
      if (frame.number >= times.size()) {
        throw InputError(path.string() + ": has " + std::to_string(times.size()) +
                         " times, none for image " + std::to_string(frame.number));
      }
      frame.time = times[frame.number];
    }
  }

  void readTruth(const fs::path& path) {
    const auto poses = readKittiPoses(path.string());
    for (auto& frame : frames_) {
      if (frame.number >= poses.size()) {
        ++dropped_["frame_without_truth"];
        continue;
      }
      frame.truth = robotFromOptical() * poses[frame.number] * robotFromOptical().inverse();
    }
  }

  fs::path folder_;
  std::vector<Files> frames_;
  RawStereoCamera camera_;
  std::map<std::string, std::size_t> dropped_;
};

}  // namespace

std::map<std::size_t, std::string> numberedImages(const fs::path& folder) {
  std::map<std::size_t, std::string> images;
  for (const auto& path : imagesIn(folder.string())) {
    if (const auto number = frameNumber(path)) images[*number] = path;
  }
  return images;
}

std::vector<KittiImagePair> kittiImagePairs(const fs::path& folder, const std::string& left,
                                            const std::string& right,
                                            std::map<std::string, std::size_t>& dropped) {
  const auto lefts = numberedImages(folder / left);
  const auto rights = numberedImages(folder / right);
  std::vector<KittiImagePair> pairs;
  for (const auto& [number, path] : lefts) {
    const auto partner = rights.find(number);
    if (partner != rights.end()) pairs.push_back({number, path, partner->second});
  }
  const std::size_t unpaired = lefts.size() + rights.size() - 2 * pairs.size();
  if (unpaired > 0) dropped["unpaired_image"] += unpaired;
  if (pairs.empty()) {
    throw InputError(folder.string() + ": no image is both in " + left + " and in " + right);
  }
  return pairs;
}

RawStereoCamera kittiCamera(const KittiProjection& P_left, cv::Size left_size,
                            const KittiProjection& P_right, cv::Size right_size) {
  RawStereoCamera camera;
  camera.left = lensOf(P_left, left_size);
  camera.right = lensOf(P_right, right_size);
  const Eigen::Vector3d centre = centreOf(P_left);
  camera.T_left_right.translation().x() = centreOf(P_right).x() - centre.x();
  camera.T_robot_left = robotFromOptical() * Eigen::Translation3d(centre);
  return camera;
}

std::map<std::string, std::vector<double>> readKittiCalibration(const std::string& path) {
  std::map<std::string, std::vector<double>> matrices;
  TextRows rows(path);
  while (rows.next()) {
    const std::string name = rows.fields()[0];
    if (name.empty() || name.back() != ':' || rows.size() < 2) continue;
    std::vector<double> numbers;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (const auto number = parseNumber(rows.fields()[i])) numbers.push_back(*number);
    }
    if (numbers.size() + 1 != rows.size()) continue;  // the time of the calibration
    matrices[name.substr(0, name.size() - 1)] = numbers;
  }
  return matrices;
}

const std::vector<double>& kittiMatrix(const std::map<std::string, std::vector<double>>& matrices,
                                       const std::string& name, std::size_t size,
                                       const std::string& path) {
  const auto found = matrices.find(name);
  if (found == matrices.end() || found->second.size() != size) {
    throw InputError(path + ": no line '" + name + ":' of " + std::to_string(size) + " numbers");
  }
  return found->second;
}

std::unique_ptr<Dataset> openKittiOdometry(const std::string& folder, const std::string& sequence) {
  return std::make_unique<KittiOdometry>(folder, sequence);
}

std::map<std::string, Eigen::Matrix<double, 3, 4>> readKittiProjections(const std::string& path) {
  std::map<std::string, Eigen::Matrix<double, 3, 4>> matrices;
  TextRows rows(path);
  while (rows.next()) {
    const std::string name = rows.fields()[0];
    const bool is_matrix = rows.size() == 13 && !name.empty() && name.back() == ':';
    if (!is_matrix) continue;  // R0_rect has 9 numbers
    Eigen::Matrix<double, 3, 4> matrix;
    for (Eigen::Index i = 0; i < 12; ++i) {
      matrix(i / 4, i % 4) = rows.number(static_cast<std::size_t>(i + 1));
    }
    matrices[name.substr(0, name.size() - 1)] = matrix;
  }
  if (matrices.count("P0") == 0 || matrices.count("P1") == 0) {
    throw InputError(path + ": is not a KITTI calibration: no line 'P0:' or 'P1:' of 12 numbers");
  }
  return matrices;
}

}  // namespace headway::io
