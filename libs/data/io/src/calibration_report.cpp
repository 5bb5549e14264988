// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <utility>
#include <vector>

#include "rectifier.h"

namespace headway::io {
namespace {

constexpr int kCornerThreshold = 20;
constexpr int kRadius = 5;  // of patches [px]
constexpr int kSide = 2 * kRadius + 1;
constexpr int kCellsAcross = 16;  // cells for evenly distributed corners
constexpr int kCellsDown = 8;
constexpr std::size_t kCornersPerCell = 8;
constexpr double kRowBand = 4.0;             // maximum row difference of a match [px]
constexpr double kMaxDisparityRatio = 0.25;  // of the image width
constexpr float kMinCorrelation = 0.9F;
constexpr int kNeighbourDistance = 3;       // [px]
constexpr float kDistinctness = 0.05F;      // minimum margin to the second best
constexpr std::size_t kMinMatches = 20;     // for the detection of swapped images
constexpr double kSwappedDisparity = -1.0;  // [px]

/// A patch around a corner with mean 0 and norm 1, so that dot products are correlations.
struct Corner {
  int u = 0;
  int v = 0;
  std::vector<float> patch;
};

std::vector<float> normalizedPatch(const cv::Mat& image, int u, int v) {
  std::vector<float> patch;
  patch.reserve(kSide * kSide);
  for (int y = v - kRadius; y <= v + kRadius; ++y) {
    const auto* row = image.ptr<unsigned char>(y);
    for (int x = u - kRadius; x <= u + kRadius; ++x) patch.push_back(row[x]);
  }
  const float mean =
      std::accumulate(patch.begin(), patch.end(), 0.0F) / static_cast<float>(patch.size());
  float square_sum = 0.0F;
  for (auto& value : patch) {
    value -= mean;
    square_sum += value * value;
  }
  const float scale = square_sum > 0.0F ? 1.0F / std::sqrt(square_sum) : 0.0F;
  for (auto& value : patch) value *= scale;
  return patch;
}

float correlation(const std::vector<float>& a, const std::vector<float>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0F);
}

bool fits(const cv::Mat& image, int u, int v) {
  return u >= kRadius && v >= kRadius && u + kRadius < image.cols && v + kRadius < image.rows;
}

bool areNeighbours(const Corner& a, const Corner& b) {
  return std::abs(a.u - b.u) <= kNeighbourDistance && std::abs(a.v - b.v) <= kNeighbourDistance;
}

/// The strongest corners of each cell, without direct neighbours.
///
/// FAST's non-maximum suppression is not used: it drops all corners of equal strength, which are
/// frequent in rendered images.
std::vector<Corner> spreadCorners(const cv::Mat& image) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(image, found, kCornerThreshold, false);
  std::stable_sort(found.begin(), found.end(), [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    return a.response > b.response;
  });
  std::vector<std::vector<Corner>> cells(kCellsAcross * kCellsDown);
  for (const auto& keypoint : found) {
    Corner corner{cvRound(keypoint.pt.x), cvRound(keypoint.pt.y), {}};
    if (!fits(image, corner.u, corner.v)) continue;
    auto& cell = cells[static_cast<std::size_t>(corner.v * kCellsDown / image.rows * kCellsAcross +
                                                corner.u * kCellsAcross / image.cols)];
    if (cell.size() >= kCornersPerCell) continue;
    if (std::any_of(cell.begin(), cell.end(),
                    [&](const Corner& other) { return areNeighbours(corner, other); })) {
      continue;
    }
    corner.patch = normalizedPatch(image, corner.u, corner.v);
    cell.push_back(std::move(corner));
  }
  std::vector<Corner> corners;
  for (auto& cell : cells) {
    std::move(cell.begin(), cell.end(), std::back_inserter(corners));
  }
  return corners;
}

/// The corner with the highest correlation, if it is distinct; null otherwise.
///
/// Direct neighbours of the best corner show the same point and are not compared with it.
const Corner* bestMatch(const Corner& corner, const std::vector<Corner>& candidates,
                        double max_disparity) {
  std::vector<std::pair<float, const Corner*>> scores;
  for (const auto& candidate : candidates) {
    if (std::abs(candidate.v - corner.v) > kRowBand) continue;
    if (std::abs(candidate.u - corner.u) > max_disparity) continue;
    scores.emplace_back(correlation(corner.patch, candidate.patch), &candidate);
  }
  if (scores.empty()) return nullptr;
  const auto [best_score, best] = *std::max_element(
      scores.begin(), scores.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (best_score < kMinCorrelation) return nullptr;
  for (const auto& [score, other] : scores) {
    if (!areNeighbours(*other, *best) && best_score - score < kDistinctness) return nullptr;
  }
  return best;
}

/// Offset of the vertex of a parabola from its middle sample, at most half a sample.
double parabolaVertex(float before, float middle, float after) {
  const double curvature = 2.0 * middle - before - after;
  if (curvature <= 0.0) return 0.0;
  return std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

/// Subpixel position of the match of `left` in the right image.
cv::Point2d refined(const Corner& left, const Corner& right, const cv::Mat& right_image) {
  const auto scoreAt = [&](int du, int dv) {
    if (!fits(right_image, right.u + du, right.v + dv)) return -1.0F;
    return correlation(left.patch, normalizedPatch(right_image, right.u + du, right.v + dv));
  };
  const float middle = scoreAt(0, 0);
  return {right.u + parabolaVertex(scoreAt(-1, 0), middle, scoreAt(1, 0)),
          right.v + parabolaVertex(scoreAt(0, -1), middle, scoreAt(0, 1))};
}

}  // namespace

CalibrationReport measureCalibration(const cv::Mat& left, const cv::Mat& right,
                                     const StereoCamera& camera) {
  const auto left_corners = spreadCorners(left);
  const auto right_corners = spreadCorners(right);
  const double max_disparity = kMaxDisparityRatio * left.cols;
  std::vector<double> vertical;
  std::vector<double> horizontal;
  for (const auto& corner : left_corners) {
    const Corner* match = bestMatch(corner, right_corners, max_disparity);
    if (match == nullptr) continue;
    const Corner* back = bestMatch(*match, left_corners, max_disparity);
    if (back == nullptr || !areNeighbours(*back, corner)) continue;
    const cv::Point2d place = refined(corner, *match, right);
    horizontal.push_back(corner.u - place.x);
    vertical.push_back(std::abs(corner.v - place.y));
  }
  CalibrationReport report;
  report.baseline_m = camera.baseline_m;
  report.focal_px = camera.fx;
  report.vertical_disparity_px = median(vertical);
  report.median_disparity_px = median(horizontal);
  report.matches = horizontal.size();
  return report;
}

void requireNotSwapped(const CalibrationReport& report) {
  if (report.matches < kMinMatches || report.median_disparity_px > kSwappedDisparity) return;
  throw InputError(
      "stereo calibration: the median disparity of " + std::to_string(report.matches) +
      " matches is " + std::to_string(report.median_disparity_px) +
      " px; it must be positive: left and right images are swapped; exchange them, for two "
      "cameras by --sensor-label RIGHT,LEFT");
}

}  // namespace headway::io
