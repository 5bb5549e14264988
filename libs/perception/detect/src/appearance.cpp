// SPDX-License-Identifier: BSD-3-Clause
// Templates of objects: how one is cut out of an image and found in another.
#include "appearance.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "object_extent.h"

namespace headway::detect {
namespace {

constexpr double kMinContrast = 6.0;     // standard deviation [grey levels]
constexpr float kMinCorrelation = 0.5F;  // correlation; legs and what is behind them change
constexpr int kReachAcross = 8;          // sought to either side [cells]
constexpr double kMaxScale = 3.0;        // farther or nearer by more it looks otherwise
const cv::Size kMaskGaps(5, 5);          // between cells that are closed [cells]
constexpr int kMaxPeriod = 32;           // of a repeated image [cells]
constexpr double kRepeated = 0.75;       // correlation with itself at a period
constexpr double kRepeatedRise = 0.5;    // and above that at shorter shifts

cv::Mat resized(const cv::Mat& image, double scale, int interpolation) {
  cv::Mat result;
  cv::resize(image, result, {}, scale, scale, interpolation);
  return result;
}

// The place of the best match; nullopt if it is not alike.
std::optional<cv::Point> bestOf(const cv::Mat& correlations) {
  std::optional<cv::Point> best;
  float max = kMinCorrelation;
  for (int row = 0; row < correlations.rows; ++row) {
    for (int column = 0; column < correlations.cols; ++column) {
      const float correlation = correlations.at<float>(row, column);
      // Not defined without contrast, where OpenCV divides by zero.
      if (!(correlation >= max) || correlation > 1.01F) continue;
      max = correlation;
      best = cv::Point(column, row);
    }
  }
  return best;
}

// Normalised correlation of some cells with those shifted along the rows; 0 with few inside.
double shiftedCorrelation(const cv::Mat& image, const std::vector<cv::Point>& cells, int shift) {
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (const auto& cell : cells) {
    if (cell.x + shift < 0 || cell.x + shift >= image.cols) continue;
    const double a = image.at<unsigned char>(cell);
    const double b = image.at<unsigned char>(cell.y, cell.x + shift);
    n += 1.0;
    sum_a += a;
    sum_b += b;
    sum_aa += a * a;
    sum_bb += b * b;
    sum_ab += a * b;
  }
  if (n < kMinPersonCells) return 0.0;
  const double squares = (sum_aa - sum_a * sum_a / n) * (sum_bb - sum_b * sum_b / n);
  return squares > 0.0 ? (sum_ab - sum_a * sum_b / n) / std::sqrt(squares) : 0.0;
}

}  // namespace

bool repeatsAlongRows(const cv::Mat& image, const std::vector<cv::Point>& cells) {
  for (const int side : {1, -1}) {
    double min = 1.0;
    for (int shift = 1; shift <= kMaxPeriod; ++shift) {
      const double correlation = shiftedCorrelation(image, cells, side * shift);
      min = std::min(min, correlation);
      if (correlation > kRepeated && correlation > min + kRepeatedRise) return true;
    }
  }
  return false;
}

std::shared_ptr<const ObjectMask> maskOf(const std::vector<cv::Point>& cells, int reduce) {
  if (cells.empty()) return nullptr;
  const cv::Rect box = cv::boundingRect(cells);
  auto mask = std::make_shared<ObjectMask>();
  mask->corner = box.tl();
  mask->cells = cv::Mat::zeros(box.size(), CV_8U);
  for (const auto& cell : cells) mask->cells.at<unsigned char>(cell - box.tl()) = 255;
  mask->reduce = reduce;
  return mask;
}

std::optional<AppearanceTemplate> templateOf(const cv::Mat& image,
                                             const std::vector<cv::Point>& cells, int reduce) {
  if (static_cast<int>(cells.size()) < kMinPersonCells) return std::nullopt;
  const cv::Rect box = cv::boundingRect(cells);
  AppearanceTemplate appearance;
  appearance.patch = image(box).clone();
  appearance.mask = *maskOf(cells, reduce);
  cv::Mat& mask = appearance.mask.cells;
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_RECT, kMaskGaps));
  cv::Scalar mean, deviation;
  cv::meanStdDev(appearance.patch, mean, deviation, mask);
  if (deviation[0] < kMinContrast) return std::nullopt;
  return appearance;
}

std::optional<cv::Point> findTemplate(const AppearanceTemplate& appearance, const cv::Mat& image,
                                      const cv::Point2d& expected, double scale) {
  if (!(scale < kMaxScale && scale > 1.0 / kMaxScale)) return std::nullopt;
  const cv::Mat patch = resized(appearance.patch, scale, cv::INTER_LINEAR);
  const cv::Mat mask = resized(appearance.mask.cells, scale, cv::INTER_NEAREST);
  const cv::Point corner(cvRound(expected.x - 0.5 * patch.cols),
                         cvRound(expected.y - 0.5 * patch.rows));
  const cv::Rect whole({0, 0}, image.size());
  const cv::Rect shown = cv::Rect(corner, patch.size()) & whole;
  const int up = kReachAcross / 2;  // objects on the ground hardly move vertically
  const cv::Rect window = cv::Rect(shown.x - kReachAcross, shown.y - up,
                                   shown.width + 2 * kReachAcross, shown.height + 2 * up) &
                          whole;
  if (shown.empty()) return std::nullopt;
  const cv::Rect part(shown.tl() - corner, shown.size());
  if (cv::countNonZero(mask(part)) < kMinPersonCells) return std::nullopt;
  cv::Mat correlations;
  cv::matchTemplate(image(window), patch(part), correlations, cv::TM_CCOEFF_NORMED, mask(part));
  const auto best = bestOf(correlations);
  if (!best) return std::nullopt;
  return window.tl() + *best - shown.tl();
}

}  // namespace headway::detect
