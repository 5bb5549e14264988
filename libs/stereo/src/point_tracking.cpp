#include <headway/stereo/point_tracking.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
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
/// cameras; without gradients. The pyramid itself where both are similar.
ImagePyramid withBrightnessOf(const ImagePyramid& reference, const ImagePyramid& pyramid) {
  constexpr double kSimilarGain = 0.1;
  constexpr double kSimilarMean = 8.0;  // [grey values]
  cv::Scalar mean, deviation, reference_mean, reference_deviation;
  cv::meanStdDev(reference.levels.back(), reference_mean, reference_deviation);
  cv::meanStdDev(pyramid.levels.back(), mean, deviation);
  const double gain = std::clamp(reference_deviation[0] / std::max(deviation[0], 1.0), 0.2, 5.0);
  const bool similar =
      std::abs(gain - 1.0) < kSimilarGain && std::abs(reference_mean[0] - mean[0]) < kSimilarMean;
  if (similar) return pyramid;
  ImagePyramid result;
  for (const cv::Mat& level : pyramid.levels) {
    constexpr int kPad = kMaxTrackingWindow;
    cv::Mat padded = level;
    padded.adjustROI(kPad, kPad, kPad, kPad);
    cv::Mat converted;
    padded.convertTo(converted, CV_8U, gain, reference_mean[0] - gain * mean[0]);
    result.levels.push_back(converted(cv::Rect({kPad, kPad}, level.size())));
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

}  // namespace

std::vector<TrackedPosition> trackPoints(const ImagePyramid& from, const ImagePyramid& to,
                                         const std::vector<Eigen::Vector2d>& points,
                                         const std::vector<Eigen::Vector2d>& predicted,
                                         const PointTrackingOptions& options) {
  std::vector<TrackedPosition> tracked(points.size());
  if (points.empty()) return tracked;
  const Pixels start = pointsFrom(points);
  Pixels there = pointsFrom(predicted);
  constexpr double kMinFound = 0.2;  // ratio of points; with fewer the exposure may have changed
  ImagePyramid other = to;
  auto found = flow(from, other, start, options, there);
  const auto count = std::count_if(found.begin(), found.end(), [](auto one) { return one != 0; });
  if (static_cast<double>(count) < kMinFound * static_cast<double>(points.size())) {
    other = withBrightnessOf(from, to);
    there = pointsFrom(predicted);
    found = flow(from, other, start, options, there);
  }
  if (options.max_return_error > 0.0) trackBack(from, other, start, there, options, found);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] != 0) tracked[i].emplace(there[i].x, there[i].y);
  }
  return tracked;
}

}  // namespace headway::stereo
