// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_frame.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::test {

/// A car of KITTI stereo 2015: the box around its mask and its true disparity.
struct RealCar {
  Box2d box;
  double median_disparity = 0.0;  ///< [px]
};

/// A pair of KITTI stereo 2015 with nominal calibration, and its cars.
struct KittiStereoPair {
  StereoFrame frame;
  std::vector<RealCar> cars;  ///< those with 30 true disparities or more
  bool complete = false;      ///< whether all files of the pair could be read
};

/// The median of the true disparities under a mask, and nothing where there are too few.
inline std::optional<double> medianUnder(const cv::Mat& mask, const cv::Mat& truth) {
  std::vector<double> disparities;
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.cols; ++column) {
      const double d = truth.at<std::uint16_t>(row, column) / 256.0;
      if (mask.at<unsigned char>(row, column) != 0 && d > 0.0) disparities.push_back(d);
    }
  }
  if (disparities.size() < 30) return std::nullopt;
  return median(std::move(disparities));
}

/// @param folder  holds image_02, image_03, disp_occ_0 and obj_map
/// @param file    of the pair in each of them, "000002_10.png" or the like
inline KittiStereoPair readKittiStereo(const std::filesystem::path& folder,
                                       const std::string& file) {
  const auto path = [&](const char* kind) { return (folder / kind / file).string(); };
  KittiStereoPair pair;
  pair.frame.left = cv::imread(path("image_02"), cv::IMREAD_GRAYSCALE);
  pair.frame.right = cv::imread(path("image_03"), cv::IMREAD_GRAYSCALE);
  const cv::Mat truth = cv::imread(path("disp_occ_0"), cv::IMREAD_UNCHANGED);
  const cv::Mat masks = cv::imread(path("obj_map"), cv::IMREAD_UNCHANGED);
  pair.complete =
      !(pair.frame.left.empty() || pair.frame.right.empty() || truth.empty() || masks.empty());
  if (!pair.complete) return pair;
  auto camera = std::make_shared<StereoCamera>();
  camera->width = pair.frame.left.cols;
  camera->height = pair.frame.left.rows;
  camera->fx = camera->fy = 721.5;
  camera->cx = 609.6;
  camera->cy = 172.9;
  camera->baseline_m = 0.54;
  pair.frame.camera = camera;
  for (int id = 1; id < 255; ++id) {
    const cv::Mat mask = masks == id;
    const auto disparity = medianUnder(mask, truth);
    if (!disparity) continue;
    const cv::Rect rect = cv::boundingRect(mask);
    pair.cars.push_back(
        {{rect.x + 0.0, rect.y + 0.0, rect.br().x - 1.0, rect.br().y - 1.0}, *disparity});
  }
  return pair;
}

}  // namespace headway::test
