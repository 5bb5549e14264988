// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/formatted.h>
#include <headway/core/statistics.h>
#include <headway/pipeline/stereo_check.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace headway::pipeline {
namespace {

constexpr double kIntervalS = 0.4;
constexpr int kMaxWhole = 480;  // width of images that are not reduced to a half [px]
// Of the reduced images:
constexpr int kMaxCorners = 80;
constexpr double kMinSpacing = 8.0;  // of corners [px]
constexpr double kMaxSpacing = 20.0;
constexpr int kRadius = 5;                   // of patches [px]
constexpr int kRows = 6;                     // searched above and below [px]
constexpr int kNegative = 16;                // searched disparities below 0 [px]
constexpr double kMaxDisparityRatio = 0.15;  // of the width
constexpr double kMinCorrelation = 0.9;
constexpr double kMinMargin = 0.05;  // of the correlation to the next best place
// Of the images as they are:
constexpr std::size_t kMinMatches = 20;
constexpr double kMaxOffset = 1.5;       // median difference of rows [px]
constexpr double kMaxScatter = 0.9;      // median deviation from it [px]
constexpr double kSwappedPx = -2.0;      // median disparity [px]
constexpr std::size_t kMinSwapped = 12;  // matches, of which
constexpr double kSwappedRatio = 0.8;    // so many have no point before the cameras
constexpr double kMinAgreement = 0.7;    // ratio of points that agree on an offset

struct Match {
  stereo::RowMatch row;
  double disparity = 0.0;  ///< [px]
};

/// Offset of the vertex of a parabola through three samples from the middle one.
double vertex(float before, float middle, float after) {
  const double curvature = 2.0 * middle - before - after;
  return curvature <= 0.0 ? 0.0 : std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

/// The distinct place of a corner of the left image in the right one; false if there is none.
///
/// @param reduction  of both images
bool match(const cv::Mat& left, const cv::Mat& right, int reduction, const cv::Point& corner,
           Match& result) {
  const int max_disparity = static_cast<int>(kMaxDisparityRatio * left.cols);
  const int side = 2 * kRadius + 1;
  const cv::Rect patch(corner.x - kRadius, corner.y - kRadius, side, side);
  const cv::Rect wanted(patch.x - max_disparity, patch.y - kRows, side + max_disparity + kNegative,
                        side + 2 * kRows);
  const cv::Rect band = wanted & cv::Rect(0, 0, right.cols, right.rows);
  if (band.height < wanted.height || band.width < 4 * side) return false;
  cv::Mat scores;
  cv::matchTemplate(right(band), left(patch), scores, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::Point at;
  cv::minMaxLoc(scores, nullptr, &best, nullptr, &at);
  const bool is_inside = at.x > 0 && at.y > 0 && at.x + 1 < scores.cols && at.y + 1 < scores.rows;
  if (best < kMinCorrelation || !is_inside) return false;
  const auto score = [&](int du, int dv) { return scores.at<float>(at.y + dv, at.x + du); };
  result.disparity =
      reduction * (patch.x - (band.x + at.x + vertex(score(-1, 0), score(0, 0), score(1, 0))));
  result.row.rows =
      reduction * (band.y + at.y + vertex(score(0, -1), score(0, 0), score(0, 1)) - patch.y);
  result.row.right = {reduction * corner.x - result.disparity,
                      reduction * corner.y + result.row.rows};
  cv::Mat others = scores;
  cv::rectangle(others, cv::Rect(at.x - 2, at.y - 2, 5, 5) & cv::Rect({0, 0}, scores.size()), 0.0,
                cv::FILLED);
  double next = 0.0;
  cv::minMaxLoc(others, nullptr, &next);
  return best - next > kMinMargin;
}

std::vector<Match> matchesOf(const StereoFrame& frame) {
  cv::Mat left, right;
  const int reduction = frame.left.cols > kMaxWhole ? 2 : 1;
  const double scale = 1.0 / reduction;
  cv::resize(frame.left, left, {}, scale, scale, cv::INTER_AREA);
  cv::resize(frame.right, right, {}, scale, scale, cv::INTER_AREA);
  std::vector<cv::Point2f> corners;
  constexpr double kPlaces = 3.0;  // for each corner
  const double spacing = std::sqrt(static_cast<double>(left.total()) / (kPlaces * kMaxCorners));
  cv::goodFeaturesToTrack(left, corners, kMaxCorners, 0.02,
                          std::clamp(spacing, kMinSpacing, kMaxSpacing));
  std::vector<Match> matches;
  Match one;
  const cv::Rect inside(kRadius, kRadius, left.cols - 2 * kRadius, left.rows - 2 * kRadius);
  for (const cv::Point corner : corners) {
    if (inside.contains(corner) && match(left, right, reduction, corner, one))
      matches.push_back(one);
  }
  return matches;
}

}  // namespace

StereoCheck::Finding StereoCheck::compare(const StereoFrame& frame, double& rows_px) {
  const auto matches = matchesOf(frame);
  const auto is_swapped = [](const Match& one) { return one.disparity < kSwappedPx; };
  const auto swapped = std::count_if(matches.begin(), matches.end(), is_swapped);
  if (matches.size() >= kMinSwapped &&
      static_cast<double>(swapped) > kSwappedRatio * static_cast<double>(matches.size())) {
    return Finding::kSwapped;
  }
  if (matches.size() < kMinMatches) return Finding::kNone;
  if (estimator_) {
    std::vector<stereo::RowMatch> rows_by_place;
    for (const auto& one : matches) rows_by_place.push_back(one.row);
    estimator_->add(rows_by_place);
  }
  std::vector<double> disparities, rows, deviations;
  for (const auto& one : matches) {
    disparities.push_back(one.disparity);
    rows.push_back(one.row.rows);
  }
  const double offset = median(rows);
  for (const double row : rows) deviations.push_back(std::abs(row - offset));
  const double scatter = median(deviations);
  if (median(disparities) < kSwappedPx) return Finding::kSwapped;
  rows_px = std::max(std::abs(offset), scatter);
  if (scatter > kMaxScatter) return Finding::kScattered;
  const auto agrees = [&](double deviation) { return deviation < 0.5 * std::abs(offset); };
  const auto agreeing = std::count_if(deviations.begin(), deviations.end(), agrees);
  const bool is_common =
      static_cast<double>(agreeing) > kMinAgreement * static_cast<double>(rows.size());
  return std::abs(offset) > kMaxOffset && is_common ? Finding::kOffset : Finding::kNone;
}

std::optional<stereo::RectificationError> StereoCheck::rectification() const {
  return estimator_ ? estimator_->error() : std::nullopt;
}

void StereoCheck::add(const StereoFrame& frame, Warnings& warnings) {
  if (frame.right.empty()) return;  // of a depth camera
  if (last_ && std::abs(frame.time - *last_) < kIntervalS) return;
  last_ = frame.time;
  if (!estimator_ && frame.camera != nullptr) estimator_.emplace(*frame.camera);
  double rows_px = 0.0;
  const Finding before = finding_;
  finding_ = compare(frame, rows_px);
  persists_ = finding_ != Finding::kNone && finding_ == before;
  if (!persists_) return;
  if (finding_ == Finding::kSwapped) {
    addWarning("images_swapped", frame.index,
               "left and right images are swapped: most points have a negative disparity; check "
               "the order of the cameras",
               warnings);
  } else if (finding_ == Finding::kOffset) {
    addWarning(
        "vertical_offset", frame.index,
        formatted("the rows of left and right images differ by %.1f px; a camera has moved in "
                  "its mounting: calibrate the cameras",
                  rows_px),
        warnings);
  } else {
    addWarning(
        "images_not_simultaneous", frame.index,
        formatted("the rows of left and right images differ by %.1f px, by place: the images "
                  "are not of the same time, or the calibration is wrong; check the cameras' "
                  "trigger",
                  rows_px),
        warnings);
  }
}

}  // namespace headway::pipeline
