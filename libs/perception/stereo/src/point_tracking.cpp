// SPDX-License-Identifier: BSD-3-Clause
// KLT tracking of points from one image to another.
#include <headway/stereo/point_tracking.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace headway::stereo {
namespace {

using Pixels = std::vector<cv::Point2f>;

const cv::TermCriteria kStop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02);
constexpr double kMinEigenvalue = 1e-3;  ///< of the gradients of a window, as OpenCV scales it
constexpr int kReturnLevel = 1;          ///< tracking back starts here, as the position is known

Pixels pointsFrom(const std::vector<Eigen::Vector2d>& points) {
  Pixels result;
  result.reserve(points.size());
  for (const auto& point : points) {
    result.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
  }
  return result;
}

/// The levels as OpenCV takes them: each followed by its gradients, where there are some.
std::vector<cv::Mat> opticalFlowPyramid(const ImagePyramid& pyramid) {
  if (pyramid.gradients.empty()) return pyramid.levels;
  std::vector<cv::Mat> result;
  for (int level = 0; level < pyramid.count(); ++level) {
    result.push_back(pyramid.levels[level]);
    result.push_back(pyramid.gradients[level]);
  }
  return result;
}

/// The pyramid with the mean and contrast of another, as exposures differ in time and between
/// cameras; without gradients. Nullopt where both are similar.
std::optional<ImagePyramid> withBrightnessOf(const ImagePyramid& reference,
                                             const ImagePyramid& pyramid) {
  constexpr double kSimilarGain = 0.1;
  constexpr double kSimilarMean = 8.0;  // [grey values]
  cv::Scalar mean, deviation, reference_mean, reference_deviation;
  cv::meanStdDev(reference.levels.back(), reference_mean, reference_deviation);
  cv::meanStdDev(pyramid.levels.back(), mean, deviation);
  const double gain = std::clamp(reference_deviation[0] / std::max(deviation[0], 1.0), 0.2, 5.0);
  const bool similar =
      std::abs(gain - 1.0) < kSimilarGain && std::abs(reference_mean[0] - mean[0]) < kSimilarMean;
  if (similar) return std::nullopt;
  ImagePyramid result;
  for (const cv::Mat& level : pyramid.levels) {
    const cv::Point pad(kMaxTrackingWindow, kMaxTrackingWindow);
    cv::Mat padded = level;
    padded.adjustROI(pad.y, pad.y, pad.x, pad.x);
    cv::Mat converted;
    padded.convertTo(converted, CV_8U, gain, reference_mean[0] - gain * mean[0]);
    result.levels.push_back(converted(cv::Rect(pad, level.size())));
  }
  return result;
}

/// Moves `positions` from their initial values. @return 0 for each point that is not found
std::vector<unsigned char> flow(const ImagePyramid& from, const ImagePyramid& to,
                                const Pixels& points, const PointTrackingOptions& options,
                                Pixels& positions) {
  std::vector<unsigned char> found;
  std::vector<float> errors;
  const int levels = std::min({options.coarsest_level, from.count() - 1, to.count() - 1});
  cv::calcOpticalFlowPyrLK(opticalFlowPyramid(from), opticalFlowPyramid(to), points, positions,
                           found, errors, {options.window_px, options.window_px}, levels, kStop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (errors[i] > static_cast<float>(options.max_grey_error)) found[i] = 0;
  }
  return found;
}

double correlation(const cv::Mat& a, const cv::Point2f& at_a, const cv::Mat& b,
                   const cv::Point2f& at_b, int window_px) {
  cv::Mat window_a, window_b, result;
  cv::getRectSubPix(a, {window_px, window_px}, at_a, window_a, CV_32F);
  cv::getRectSubPix(b, {window_px, window_px}, at_b, window_b, CV_32F);
  cv::matchTemplate(window_a, window_b, result, cv::TM_CCOEFF_NORMED);
  return result.at<float>(0, 0);
}

/// Clears `found` of the points that do not return to where they came from.
void trackBack(const ImagePyramid& from, const ImagePyramid& to, const Pixels& points,
               const Pixels& positions, PointTrackingOptions options,
               std::vector<unsigned char>& found) {
  options.coarsest_level = kReturnLevel;
  Pixels back = points;
  const auto returned = flow(to, from, positions, options, back);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f off = back[i] - points[i];
    const bool same = std::hypot(off.x, off.y) < options.max_return_error;
    if (returned[i] == 0 || !same) found[i] = 0;
  }
}

/// Positions of points after all tests.
std::vector<TrackedPosition> search(const ImagePyramid& from, const ImagePyramid& to,
                                    const Pixels& points,
                                    const std::vector<Eigen::Vector2d>& predicted,
                                    const PointTrackingOptions& options) {
  Pixels there = pointsFrom(predicted);
  auto found = flow(from, to, points, options, there);
  if (options.max_return_error > 0.0) trackBack(from, to, points, there, options, found);
  std::vector<TrackedPosition> tracked(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] == 0) continue;
    if (options.min_zncc > -1.0 && correlation(from.levels[0], points[i], to.levels[0], there[i],
                                               options.window_px) < options.min_zncc) {
      continue;
    }
    tracked[i].emplace(there[i].x, there[i].y);
  }
  return tracked;
}

std::ptrdiff_t countFound(const std::vector<TrackedPosition>& tracked) {
  return std::count_if(tracked.begin(), tracked.end(), [](const auto& one) { return !!one; });
}

}  // namespace

std::vector<TrackedPosition> trackPoints(const ImagePyramid& from, const ImagePyramid& to,
                                         const std::vector<Eigen::Vector2d>& points,
                                         const std::vector<Eigen::Vector2d>& predicted,
                                         const PointTrackingOptions& options) {
  if (points.empty()) return {};
  const Pixels start = pointsFrom(points);
  auto tracked = search(from, to, start, predicted, options);
  if (2 * countFound(tracked) >= static_cast<std::ptrdiff_t>(points.size())) return tracked;
  const auto adapted = withBrightnessOf(from, to);
  if (!adapted) return tracked;
  auto retried = search(from, *adapted, start, predicted, options);
  return countFound(retried) > countFound(tracked) ? retried : tracked;
}

void trackMissing(const ImagePyramid& from, const ImagePyramid& to,
                  const std::vector<Eigen::Vector2d>& points,
                  const std::vector<Eigen::Vector2d>& predicted,
                  const PointTrackingOptions& options, std::vector<TrackedPosition>& tracked) {
  std::vector<std::size_t> missing;
  std::vector<Eigen::Vector2d> missing_points;
  std::vector<Eigen::Vector2d> missing_predicted;
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    if (tracked[i]) continue;
    missing.push_back(i);
    missing_points.push_back(points[i]);
    missing_predicted.push_back(predicted[i]);
  }
  const auto found = trackPoints(from, to, missing_points, missing_predicted, options);
  for (std::size_t i = 0; i < missing.size(); ++i) tracked[missing[i]] = found[i];
}

}  // namespace headway::stereo
