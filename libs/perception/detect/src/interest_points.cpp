// SPDX-License-Identifier: BSD-3-Clause
#include "interest_points.h"

#include <headway/stereo/disparity.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <tuple>

namespace headway::detect {
namespace {

constexpr int kReduce = 2;
constexpr int kBorder = 8;               // from the image's edges [px]
constexpr float kMinStrength = 2e-4F;    // smaller eigenvalue, of an image scaled to 0 ... 1
constexpr float kOfPeople = 8.0F;        // corners where people may be count so much stronger
constexpr double kHead = 2.0;            // above ground, [m]
constexpr double kElsewhereRatio = 0.1;  // of the points, outside of the zone

struct Corner {
  float strength = 0.0F;
  cv::Point2f place;
  bool in_zone = false;
};

bool inZone(const cv::Point2f& place, double disparity, const StereoCamera& camera,
            const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone) {
  const auto point = triangulate({place.x, place.y, disparity}, camera);
  if (point->z() > zone.range_m) return false;
  if (!ground) return true;
  return !ground->isGround(*point) && ground->heightOf(*point) < zone.max_height_m;
}

// Strongest pixel of a square of the reduced image.
Corner strongestIn(const cv::Mat& strength, const cv::Rect& square) {
  Corner best;
  for (int row = square.y; row < square.y + square.height; ++row) {
    const float* values = strength.ptr<float>(row);
    for (int column = square.x; column < square.x + square.width; ++column) {
      if (values[column] <= best.strength) continue;
      best.strength = values[column];
      best.place = {(static_cast<float>(column) + 0.5F) * kReduce - 0.5F,
                    (static_cast<float>(row) + 0.5F) * kReduce - 0.5F};
    }
  }
  return best;
}

// The strongest corner of each free square, with more weight where people may be.
std::vector<Corner> cornersIn(const cv::Mat& strength, const cv::Mat& occupied, int side,
                              const stereo::DisparityImage& disparity, const StereoCamera& camera,
                              const std::optional<stereo::GroundPlane>& ground,
                              const InterestZone& zone) {
  std::vector<Corner> corners;
  const int border = (kBorder / kReduce + side - 1) / side * side;  // whole squares
  for (int row = border; row + side + border < strength.rows; row += side) {
    for (int column = border; column + side + border < strength.cols; column += side) {
      if (occupied.at<unsigned char>(row / side, column / side) != 0) continue;
      Corner corner = strongestIn(strength, {column, row, side, side});
      if (corner.strength * kOfPeople < kMinStrength) continue;
      const double d = disparity.at(corner.place.x, corner.place.y);
      if (d <= 0.0) continue;
      if (inZone(corner.place, d, camera, ground, {zone.people_m, kHead, zone.people_m})) {
        corner.strength *= kOfPeople;
      }
      if (corner.strength < kMinStrength) continue;
      corner.in_zone = inZone(corner.place, d, camera, ground, zone);
      corners.push_back(corner);
    }
  }
  return corners;
}

}  // namespace

std::vector<cv::Point2f> interestPoints(
    const cv::Mat& image, const stereo::DisparityImage& disparity, const StereoCamera& camera,
    const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone,
    const std::vector<cv::Point2f>& taken, int spacing_px, int wanted) {
  if (wanted <= 0) return {};
  cv::Mat strength;
  cv::cornerMinEigenVal(stereo::reducedImage(image, kReduce), strength, 3, 3);
  const int side = std::max(2, spacing_px / kReduce);
  cv::Mat occupied(strength.rows / side + 1, strength.cols / side + 1, CV_8U, cv::Scalar(0));
  for (const auto& place : taken) {
    const int row = static_cast<int>(place.y) / kReduce / side;
    const int column = static_cast<int>(place.x) / kReduce / side;
    occupied.at<unsigned char>(row, column) = 1;
  }
  auto corners = cornersIn(strength, occupied, side, disparity, camera, ground, zone);
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
  auto elsewhere = static_cast<int>(kElsewhereRatio * wanted);
  auto in_zone = wanted - elsewhere;
  std::vector<cv::Point2f> chosen;
  for (const auto& corner : corners) {
    int& left = corner.in_zone ? in_zone : elsewhere;
    if (left <= 0) continue;
    --left;
    chosen.push_back(corner.place);
  }
  return chosen;
}

}  // namespace headway::detect
