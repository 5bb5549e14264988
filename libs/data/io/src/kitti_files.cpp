// SPDX-License-Identifier: BSD-3-Clause
#include "kitti_files.h"

#include <headway/core/error.h>

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

}  // namespace headway::io
