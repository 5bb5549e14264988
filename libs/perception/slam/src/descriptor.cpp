// SPDX-License-Identifier: BSD-3-Clause
#include "descriptor.h"

#include <cmath>
#include <cstring>
#include <opencv2/core/hal/hal.hpp>
#include <opencv2/features2d.hpp>

#include "keypoints.h"

namespace headway::slam {
namespace {

constexpr int kPatchRadius = 15;  ///< of ORB's patch [px]
constexpr int kBytes = 32;

/// Direction from a corner to the centroid of the grey values around it [degrees, 0 ... 360).
float orientationAt(const cv::Mat& image, int u, int v) {
  int moment_u = 0;
  int moment_v = 0;
  for (int dv = -kPatchRadius; dv <= kPatchRadius; ++dv) {
    const int reach = static_cast<int>(std::sqrt(kPatchRadius * kPatchRadius - dv * dv));
    const auto* row = image.ptr<std::uint8_t>(v + dv) + u;
    for (int du = -reach; du <= reach; ++du) {
      moment_u += du * row[du];
      moment_v += dv * row[du];
    }
  }
  const double angle = std::atan2(moment_v, moment_u) * 180.0 / M_PI;
  return static_cast<float>(angle < 0.0 ? angle + 360.0 : angle);
}

/// The descriptors as a matrix, one a row, sharing their memory.
cv::Mat rowsOf(const std::vector<Descriptor>& descriptors) {
  return {static_cast<int>(descriptors.size()), kBytes, CV_8U,
          const_cast<std::uint8_t*>(descriptors.front().data())};
}

/// For each row of `from` its nearest in `to` if that is near and clearly nearest, else -1.
std::vector<int> clearlyNearest(const cv::Mat& from, const cv::Mat& to) {
  constexpr float kMaxDistance = 64.0F;  ///< bits
  constexpr float kRatio = 0.8F;
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(from, to, matches, 2);
  std::vector<int> nearest(static_cast<std::size_t>(from.rows), -1);
  for (const auto& pair : matches) {
    if (pair.empty() || pair[0].distance > kMaxDistance) continue;
    if (pair.size() > 1 && pair[0].distance > kRatio * pair[1].distance) continue;
    nearest[static_cast<std::size_t>(pair[0].queryIdx)] = pair[0].trainIdx;
  }
  return nearest;
}

/// Adds corners spread over the image at full resolution, chosen as the mapper chooses its own.
void addSpreadCorners(const cv::Mat& image, int count, const cv::Mat& excluded,
                      std::vector<DescribedPoint>& points) {
  const FeatureGrid grid(image.cols, image.rows, count);
  const std::vector<bool> nowhere(static_cast<std::size_t>(grid.count()), false);
  std::vector<Eigen::Vector2d> corners;
  for (const Keypoint& keypoint : detectKeypoints(image, grid, nowhere, excluded)) {
    corners.push_back(keypoint.uv);
  }
  const auto descriptors = describe(image, corners);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (descriptors[i] != Descriptor{}) points.push_back({corners[i], descriptors[i]});
  }
}

}  // namespace

std::vector<Descriptor> describe(const cv::Mat& image, const std::vector<Eigen::Vector2d>& points) {
  constexpr int kBorder = 32;  ///< nearer to the edge ORB describes nothing [px]
  static constexpr float kSize = 2 * kPatchRadius + 1;
  std::vector<Descriptor> descriptors(points.size(), Descriptor{});
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int u = static_cast<int>(std::lround(points[i].x()));
    const int v = static_cast<int>(std::lround(points[i].y()));
    if (u < kBorder || v < kBorder || u >= image.cols - kBorder || v >= image.rows - kBorder) {
      continue;
    }
    keypoints.emplace_back(static_cast<float>(u), static_cast<float>(v), kSize,
                           orientationAt(image, u, v), 1.0F, 0, static_cast<int>(i));
  }
  if (keypoints.empty()) return descriptors;
  cv::Mat rows;
  cv::ORB::create()->compute(image, keypoints, rows);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    std::memcpy(descriptors[static_cast<std::size_t>(keypoints[i].class_id)].data(),
                rows.ptr<std::uint8_t>(static_cast<int>(i)), kBytes);
  }
  return descriptors;
}

std::vector<DescribedPoint> detectAndDescribe(const cv::Mat& image, int count,
                                              const cv::Mat& excluded) {
  constexpr int kLowThreshold = 10;  ///< of FAST, so that poor texture yields corners as well
  cv::Mat allowed;
  if (!excluded.empty()) allowed = excluded == 0;
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat rows;
  cv::ORB::create(count, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, kLowThreshold)
      ->detectAndCompute(image, allowed, keypoints, rows);
  std::vector<DescribedPoint> points(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    points[i].uv = Eigen::Vector2d(keypoints[i].pt.x, keypoints[i].pt.y);
    std::memcpy(points[i].descriptor.data(), rows.ptr<std::uint8_t>(static_cast<int>(i)), kBytes);
  }
  addSpreadCorners(image, count, excluded, points);
  return points;
}

int distance(const Descriptor& a, const Descriptor& b) {
  return cv::hal::normHamming(a.data(), b.data(), static_cast<int>(a.size()));
}

std::vector<std::pair<int, int>> matchDescriptors(const std::vector<Descriptor>& a,
                                                  const std::vector<Descriptor>& b) {
  std::vector<std::pair<int, int>> pairs;
  if (a.empty() || b.empty()) return pairs;
  const auto forward = clearlyNearest(rowsOf(a), rowsOf(b));
  const auto backward = clearlyNearest(rowsOf(b), rowsOf(a));
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (forward[i] < 0 || backward[static_cast<std::size_t>(forward[i])] != static_cast<int>(i)) {
      continue;
    }
    pairs.emplace_back(static_cast<int>(i), forward[i]);
  }
  return pairs;
}

}  // namespace headway::slam
