#include "calibration_report.h"

#include <headway/core/error.h>
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <utility>
#include <vector>

namespace headway::io {
namespace {

constexpr int kCornerThreshold = 20;
constexpr int kRadius = 5;  // of the compared patches [px]
constexpr int kSide = 2 * kRadius + 1;
constexpr int kCellsAcross = 16;  // corners are spread over cells
constexpr int kCellsDown = 8;
constexpr std::size_t kCornersPerCell = 8;
constexpr double kRowBand = 4.0;          // rows that a match may be off [px]
constexpr double kDisparityShare = 0.25;  // largest disparity, of the image's width
constexpr float kSmallestCorrelation = 0.9F;
constexpr int kBeside = 3;                  // [px]
constexpr float kDistinctness = 0.05F;      // by which the best beats its rivals
constexpr std::size_t kEnoughMatches = 20;  // to say that images are swapped
constexpr double kSwappedDisparity = -1.0;  // [px]

/// A patch around a corner with mean 0 and length 1: products of two are their correlation.
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

bool areBeside(const Corner& a, const Corner& b) {
  return std::abs(a.u - b.u) <= kBeside && std::abs(a.v - b.v) <= kBeside;
}

/// The strongest corners of each cell of the image, none beside another one of its cell.
///
/// FAST's own suppression of neighbours is not used: it drops all corners of equal strength, and
/// in drawn pictures many are equal.
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
                    [&](const Corner& other) { return areBeside(corner, other); })) {
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

/// The corner that looks most like `corner`, if it does so clearly; null if none does.
///
/// Corners right beside the best one show the same thing and are no rivals to it.
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
  if (best_score < kSmallestCorrelation) return nullptr;
  for (const auto& [score, rival] : scores) {
    if (!areBeside(*rival, *best) && best_score - score < kDistinctness) return nullptr;
  }
  return best;
}

/// Offset of a parabola's top from its middle sample, within half a sample.
double parabolaTop(float before, float middle, float after) {
  const double curvature = 2.0 * middle - before - after;
  if (curvature <= 0.0) return 0.0;
  return std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

/// (u, v) of the place in the right image that looks like `left`, to a fraction of a pixel.
cv::Point2d refined(const Corner& left, const Corner& right, const cv::Mat& right_image) {
  const auto scoreAt = [&](int du, int dv) {
    if (!fits(right_image, right.u + du, right.v + dv)) return -1.0F;
    return correlation(left.patch, normalizedPatch(right_image, right.u + du, right.v + dv));
  };
  const float middle = scoreAt(0, 0);
  return {right.u + parabolaTop(scoreAt(-1, 0), middle, scoreAt(1, 0)),
          right.v + parabolaTop(scoreAt(0, -1), middle, scoreAt(0, 1))};
}

}  // namespace

CalibrationReport measureCalibration(const cv::Mat& left, const cv::Mat& right,
                                     const StereoCamera& camera) {
  const auto left_corners = spreadCorners(left);
  const auto right_corners = spreadCorners(right);
  const double max_disparity = kDisparityShare * left.cols;
  std::vector<double> vertical;
  std::vector<double> horizontal;
  for (const auto& corner : left_corners) {
    const Corner* match = bestMatch(corner, right_corners, max_disparity);
    if (match == nullptr) continue;
    const Corner* back = bestMatch(*match, left_corners, max_disparity);
    if (back == nullptr || !areBeside(*back, corner)) continue;
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
  if (report.matches < kEnoughMatches || report.median_disparity_px > kSwappedDisparity) return;
  throw InputError("stereo calibration: the median disparity of " + std::to_string(report.matches) +
                   " matches is " + std::to_string(report.median_disparity_px) +
                   " px; it must be positive: left and right images are swapped");
}

}  // namespace headway::io
