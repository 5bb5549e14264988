// SPDX-License-Identifier: BSD-3-Clause
// Corners of images and their ORB descriptors.
#include "keypoints.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <opencv2/core/hal/hal.hpp>
#include <opencv2/features2d.hpp>
#include <optional>

namespace headway::slam {
namespace {

constexpr int kBorder = 10;       ///< no corner is nearer to the image's edge [px]
constexpr double kMinScore = 20;  ///< grey values squared; flat ground lies below

/// Smaller eigenvalue of the mean structure tensor over 7x7 pixels.
double shiTomasiScore(const cv::Mat& image, int u, int v) {
  constexpr int kRadius = 3;
  int uu = 0, uv = 0, vv = 0;
  for (int r = v - kRadius; r <= v + kRadius; ++r) {
    const auto* above = image.ptr<std::uint8_t>(r - 1);
    const auto* row = image.ptr<std::uint8_t>(r);
    const auto* below = image.ptr<std::uint8_t>(r + 1);
    for (int c = u - kRadius; c <= u + kRadius; ++c) {
      const int du = row[c + 1] - row[c - 1];
      const int dv = below[c] - above[c];
      uu += du * du;
      uv += du * dv;
      vv += dv * dv;
    }
  }
  const double half_trace = 0.5 * (uu + vv);
  const double half_difference = 0.5 * (uu - vv);
  constexpr int kSide = 2 * kRadius + 1;
  return 0.25 / (kSide * kSide) *
         (half_trace - std::sqrt(half_difference * half_difference + static_cast<double>(uv) * uv));
}

/// The best-scored of the candidates; nullopt if none is good enough or allowed.
std::optional<Keypoint> best(const std::vector<cv::KeyPoint>& candidates, const cv::Mat& image,
                             const cv::Point& origin, const cv::Mat& excluded) {
  Keypoint result;
  result.score = kMinScore;
  bool found = false;
  for (const cv::KeyPoint& candidate : candidates) {
    const int u = static_cast<int>(candidate.pt.x) + origin.x;
    const int v = static_cast<int>(candidate.pt.y) + origin.y;
    if (!excluded.empty() && excluded.at<std::uint8_t>(v, u) != 0) continue;
    const double score = shiTomasiScore(image, u, v);
    if (score <= result.score) continue;
    result = {Eigen::Vector2d(u, v), score};
    found = true;
  }
  return found ? std::optional(result) : std::nullopt;
}

}  // namespace

FeatureGrid::FeatureGrid(int width, int height, int cells)
    : width_(width),
      height_(height),
      size_(std::max(8, static_cast<int>(std::sqrt(static_cast<double>(width) * height / cells)))),
      columns_((width + size_ - 1) / size_),
      rows_((height + size_ - 1) / size_) {}

int FeatureGrid::cellOf(const Eigen::Vector2d& uv) const {
  const int column = std::clamp(static_cast<int>(uv.x()) / size_, 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(uv.y()) / size_, 0, rows_ - 1);
  return row * columns_ + column;
}

cv::Rect FeatureGrid::pixelsOf(int cell) const {
  const cv::Rect whole(0, 0, width_, height_);
  return cv::Rect(cell % columns_ * size_, cell / columns_ * size_, size_, size_) & whole;
}

std::vector<Keypoint> detectKeypoints(const cv::Mat& image, const FeatureGrid& grid,
                                      const std::vector<bool>& occupied, const cv::Mat& excluded) {
  constexpr int kFastMargin = 3;  ///< FAST leaves out this rim of what it is given [px]
  const cv::Rect allowed(kBorder - kFastMargin, kBorder - kFastMargin,
                         image.cols - 2 * (kBorder - kFastMargin),
                         image.rows - 2 * (kBorder - kFastMargin));
  std::vector<Keypoint> keypoints;
  std::vector<cv::KeyPoint> candidates;
  for (int cell = 0; cell < grid.count(); ++cell) {
    if (occupied[cell]) continue;
    cv::Rect area = grid.pixelsOf(cell);
    area = cv::Rect(area.x - kFastMargin, area.y - kFastMargin, area.width + 2 * kFastMargin,
                    area.height + 2 * kFastMargin) &
           allowed;
    if (area.width < 7 || area.height < 7) continue;
    for (const int threshold : {24, 12, 6}) {
      cv::FAST(image(area), candidates, threshold, true);
      const auto keypoint = best(candidates, image, area.tl(), excluded);
      if (!keypoint) continue;
      keypoints.push_back(*keypoint);
      break;
    }
  }
  return keypoints;
}

namespace {

constexpr int kPatchRadius = 15;  ///< of ORB's patch [px]
constexpr int kPatchSide = 2 * kPatchRadius + 1;

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
  return {static_cast<int>(descriptors.size()), static_cast<int>(sizeof(Descriptor)), CV_8U,
          const_cast<std::uint8_t*>(descriptors.front().data())};
}

/// For each row of `from` its nearest in `to` if that is near and clearly nearest, else -1.
///
/// @param are_one  whether two rows of `to` are of one corner, which do not compete
std::vector<int> clearlyNearest(const cv::Mat& from, const cv::Mat& to,
                                const std::function<bool(int, int)>& are_one) {
  constexpr float kRatio = 0.8F;  ///< Lowe 2004, fig. 11: rejects 90 % of the wrong matches
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(from, to, matches, 6);  // a few are of one corner
  std::vector<int> nearest(static_cast<std::size_t>(from.rows), -1);
  for (const auto& near : matches) {
    if (near.empty() || near[0].distance > kMaxDescriptorDistance) continue;
    const auto other = std::find_if(near.begin() + 1, near.end(), [&](const cv::DMatch& match) {
      return !are_one(near[0].trainIdx, match.trainIdx);
    });
    if (other != near.end() && near[0].distance > kRatio * other->distance) continue;
    nearest[static_cast<std::size_t>(near[0].queryIdx)] = near[0].trainIdx;
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
  std::vector<Descriptor> descriptors(points.size(), Descriptor{});
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int u = static_cast<int>(std::lround(points[i].x()));
    const int v = static_cast<int>(std::lround(points[i].y()));
    if (u < kBorder || v < kBorder || u >= image.cols - kBorder || v >= image.rows - kBorder) {
      continue;
    }
    keypoints.emplace_back(static_cast<float>(u), static_cast<float>(v), kPatchSide,
                           orientationAt(image, u, v), 1.0F, 0, static_cast<int>(i));
  }
  if (keypoints.empty()) return descriptors;
  cv::Mat rows;
  cv::ORB::create()->compute(image, keypoints, rows);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    std::memcpy(descriptors[static_cast<std::size_t>(keypoints[i].class_id)].data(),
                rows.ptr<std::uint8_t>(static_cast<int>(i)), sizeof(Descriptor));
  }
  return descriptors;
}

std::vector<DescribedPoint> detectAndDescribe(const cv::Mat& image, int count,
                                              const cv::Mat& excluded) {
  cv::Mat allowed;
  if (!excluded.empty()) allowed = excluded == 0;
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat rows;
  const auto orb = cv::ORB::create(count);
  orb->setFastThreshold(10);  // half of OpenCV's, so that poor texture yields corners as well
  orb->detectAndCompute(image, allowed, keypoints, rows);
  std::vector<DescribedPoint> points(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    points[i].uv = Eigen::Vector2d(keypoints[i].pt.x, keypoints[i].pt.y);
    std::memcpy(points[i].descriptor.data(), rows.ptr<std::uint8_t>(static_cast<int>(i)),
                sizeof(Descriptor));
  }
  addSpreadCorners(image, count, excluded, points);
  return points;
}

std::vector<Descriptor> descriptorsOf(const std::vector<DescribedPoint>& points) {
  std::vector<Descriptor> descriptors;
  for (const DescribedPoint& point : points) descriptors.push_back(point.descriptor);
  return descriptors;
}

int distance(const Descriptor& a, const Descriptor& b) {
  return cv::hal::normHamming(a.data(), b.data(), static_cast<int>(a.size()));
}

std::vector<std::pair<int, int>> matchDescriptors(const std::vector<Descriptor>& a,
                                                  const std::vector<Descriptor>& b,
                                                  const SameCorner& are_one) {
  std::vector<std::pair<int, int>> pairs;
  if (a.empty() || b.empty()) return pairs;
  const auto forward = clearlyNearest(rowsOf(a), rowsOf(b), are_one.in_b);
  const auto backward = clearlyNearest(rowsOf(b), rowsOf(a), are_one.in_a);
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (forward[i] < 0) continue;
    const int at = static_cast<int>(i);
    const int back = backward[static_cast<std::size_t>(forward[i])];
    if (back == at || (back >= 0 && are_one.in_a(back, at))) pairs.emplace_back(at, forward[i]);
  }
  return pairs;
}

}  // namespace headway::slam
