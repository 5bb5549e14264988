// SPDX-License-Identifier: BSD-3-Clause
#include "keypoints.h"

#include <cmath>
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
  constexpr double kScale = 0.25 / ((2 * kRadius + 1) * (2 * kRadius + 1));
  const double half_trace = 0.5 * (uu + vv);
  const double half_difference = 0.5 * (uu - vv);
  return kScale *
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

}  // namespace headway::slam
