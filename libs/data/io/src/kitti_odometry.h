// SPDX-License-Identifier: BSD-3-Clause
// KITTI's odometry benchmark, and what all recordings of KITTI have in common: numbered images,
// calibrations.
#pragma once

#include <headway/core/pose.h>
#include <headway/io/rawlog_sink.h>

#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::io {

inline constexpr double kKittiFramePeriod = 0.1;  ///< of recordings without times [s]

/// A 3x4 projection matrix K [I | t] of a rectified KITTI camera.
using KittiProjection = Eigen::Matrix<double, 3, 4>;

/// The images of a folder that are named by a number ("000012.png"), by that number; others are
/// ignored.
///
/// @throws InputError if the folder does not exist
[[nodiscard]] std::map<std::size_t, std::string> numberedImages(
    const std::filesystem::path& folder);

/// Images of both cameras with the same number.
struct KittiImagePair {
  std::size_t number = 0;
  std::string left;
  std::string right;
};

/// The pairs of two folders, in ascending order of their numbers.
///
/// @param dropped  counts images without a partner ("unpaired_image")
/// @throws InputError if there is no pair
[[nodiscard]] std::vector<KittiImagePair> kittiImagePairs(
    const std::filesystem::path& folder, const std::string& left, const std::string& right,
    std::map<std::string, std::size_t>& dropped);

/// The rectified pair of two projections, for images of the given sizes.
///
/// The robot frame is in rectified camera 0. The vertical offsets of the colour cameras, some
/// millimetres, are ignored.
[[nodiscard]] RawStereoCamera kittiCamera(const KittiProjection& P_left, cv::Size left_size,
                                          const KittiProjection& P_right, cv::Size right_size);

/// The matrices of a KITTI calibration file, by name: every row "NAME: " of numbers only.
///
/// @throws InputError if the file cannot be opened
[[nodiscard]] std::map<std::string, std::vector<double>> readKittiCalibration(
    const std::string& path);

/// One matrix of the file. @throws InputError naming file and matrix unless it has `size` numbers
[[nodiscard]] const std::vector<double>& kittiMatrix(
    const std::map<std::string, std::vector<double>>& matrices, const std::string& name,
    std::size_t size, const std::string& path);

}  // namespace headway::io
