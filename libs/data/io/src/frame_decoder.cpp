// SPDX-License-Identifier: BSD-3-Clause
// From recorded pairs to rectified stereo frames, and what shows that a calibration does not belong
// to its images.
#include "frame_decoder.h"

#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <utility>
#include <vector>

#include "image_files.h"
#include "rectifier.h"

namespace headway::io {
namespace {

constexpr std::size_t kMinMatches = 20;        // for the detection of swapped images
constexpr double kSwappedDisparity = -1.0;     // [px]
constexpr std::size_t kComparedPairs = 5;      // by which one camera recorded twice is told
constexpr double kMaxVerticalDisparity = 0.8;  // of a good calibration [px]
constexpr double kMinDepthReachM = 0.5;        // of a depth camera; less is none
constexpr double kUnknownDepthReachM = 10.0;   // which most indoor cameras have
constexpr double kMinContrast = 3.0;           // standard deviation of grey levels

/// A patch around a corner with mean 0 and norm 1, so that dot products are correlations.
struct Corner {
  int u = 0;
  int v = 0;
  std::vector<float> patch;
};

float correlation(const std::vector<float>& a, const std::vector<float>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0F);
}

/// Offset of the vertex of a parabola from its middle sample, at most half a sample.
double parabolaVertex(float before, float middle, float after) {
  const double curvature = 2.0 * middle - before - after;
  if (curvature <= 0.0) return 0.0;
  return std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

/// Finds the corners of an image pair in each other.
class CornerMatcher {
 public:
  explicit CornerMatcher(const CalibrationMatching& params) : params_(params) {}

  [[nodiscard]] std::vector<float> normalizedPatch(const cv::Mat& image, int u, int v) const {
    const int r = params_.patch_radius_px;
    std::vector<float> patch;
    patch.reserve(static_cast<std::size_t>((2 * r + 1) * (2 * r + 1)));
    for (int y = v - r; y <= v + r; ++y) {
      const auto* row = image.ptr<unsigned char>(y);
      for (int x = u - r; x <= u + r; ++x) patch.push_back(row[x]);
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

  [[nodiscard]] bool fits(const cv::Mat& image, int u, int v) const {
    const int r = params_.patch_radius_px;
    return u >= r && v >= r && u + r < image.cols && v + r < image.rows;
  }

  [[nodiscard]] bool areNeighbours(const Corner& a, const Corner& b) const {
    return std::abs(a.u - b.u) <= params_.neighbour_px &&
           std::abs(a.v - b.v) <= params_.neighbour_px;
  }

  /// The strongest corners of each cell, without direct neighbours.
  ///
  /// FAST's non-maximum suppression is not used: it drops all corners of equal strength, which are
  /// frequent in rendered images.
  [[nodiscard]] std::vector<Corner> spreadCorners(const cv::Mat& image) const {
    std::vector<cv::KeyPoint> found;
    cv::FAST(image, found, params_.corner_threshold, false);
    std::stable_sort(found.begin(), found.end(), [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
      return a.response > b.response;
    });
    std::vector<std::vector<Corner>> cells(
        static_cast<std::size_t>(params_.cells_across * params_.cells_down));
    for (const auto& keypoint : found) {
      Corner corner{cvRound(keypoint.pt.x), cvRound(keypoint.pt.y), {}};
      if (!fits(image, corner.u, corner.v)) continue;
      auto& cell = cells[static_cast<std::size_t>(corner.v * params_.cells_down / image.rows *
                                                      params_.cells_across +
                                                  corner.u * params_.cells_across / image.cols)];
      if (cell.size() >= params_.corners_per_cell) continue;
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
  [[nodiscard]] const Corner* bestMatch(const Corner& corner, const std::vector<Corner>& candidates,
                                        double max_disparity) const {
    std::vector<std::pair<float, const Corner*>> scores;
    for (const auto& candidate : candidates) {
      if (std::abs(candidate.v - corner.v) > params_.row_band_px) continue;
      if (std::abs(candidate.u - corner.u) > max_disparity) continue;
      scores.emplace_back(correlation(corner.patch, candidate.patch), &candidate);
    }
    if (scores.empty()) return nullptr;
    const auto [best_score, best] =
        *std::max_element(scores.begin(), scores.end(),
                          [](const auto& a, const auto& b) { return a.first < b.first; });
    if (best_score < params_.min_correlation) return nullptr;
    for (const auto& [score, other] : scores) {
      if (!areNeighbours(*other, *best) && best_score - score < params_.min_margin) return nullptr;
    }
    return best;
  }

  /// Subpixel position of the match of `left` in the right image.
  [[nodiscard]] cv::Point2d refined(const Corner& left, const Corner& right,
                                    const cv::Mat& right_image) const {
    const auto scoreAt = [&](int du, int dv) {
      if (!fits(right_image, right.u + du, right.v + dv)) return -1.0F;
      return correlation(left.patch, normalizedPatch(right_image, right.u + du, right.v + dv));
    };
    const float middle = scoreAt(0, 0);
    return {right.u + parabolaVertex(scoreAt(-1, 0), middle, scoreAt(1, 0)),
            right.v + parabolaVertex(scoreAt(0, -1), middle, scoreAt(0, 1))};
  }

 private:
  const CalibrationMatching& params_;
};

/// A baseline of metres belongs to no robot: it is recorded in another unit.
void requireBaselineInMetres(const StereoCamera& camera) {
  if (camera.baseline_m <= kMaxBaseline_m) return;
  const double metres =
      camera.baseline_m * (camera.baseline_m < 10.0 * kMaxBaseline_m ? 1e-2 : 1e-3);
  throw InputError(
      formatted("stereo calibration: the baseline is %.6g m, which is in %s; write %.6g m in "
                "rightCameraPose",
                camera.baseline_m,
                camera.baseline_m < 10.0 * kMaxBaseline_m ? "centimetres" : "millimetres", metres));
}

/// Lenses of robots' cameras.
void requirePossibleLens(const StereoCamera& camera) {
  const double widths = camera.fx / camera.width;
  if (widths >= kMinFocalRatio && widths <= kMaxFocalRatio) return;
  throw InputError(
      formatted("stereo calibration: the focal length is %.6g px in images of %d px; no lens of a "
                "robot's camera has it: check the unit (pixels)",
                camera.fx, camera.width));
}

bool isTextured(const cv::Mat& image) {
  cv::Mat mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation.at<double>(0) > kMinContrast;
}

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// @param name  of the lens
void requireSize(const cv::Size& size, const RawCamera& lens, const std::string& name) {
  if (size == cv::Size(lens.width, lens.height)) return;
  throw InputError("calibration of the depth camera: the " + name + " is for " +
                   sizeText(lens.width, lens.height) + " px, but has " +
                   sizeText(size.width, size.height));
}

}  // namespace

CalibrationReport measureCalibration(const cv::Mat& left, const cv::Mat& right,
                                     const StereoCamera& camera,
                                     const CalibrationMatching& params) {
  const CornerMatcher matcher(params);
  const auto left_corners = matcher.spreadCorners(left);
  const auto right_corners = matcher.spreadCorners(right);
  const double max_disparity = params.max_disparity_ratio * left.cols;
  std::vector<double> vertical, horizontal, rows;
  for (const auto& corner : left_corners) {
    const Corner* match = matcher.bestMatch(corner, right_corners, max_disparity);
    if (match == nullptr) continue;
    const Corner* back = matcher.bestMatch(*match, left_corners, max_disparity);
    if (back == nullptr || !matcher.areNeighbours(*back, corner)) continue;
    const cv::Point2d place = matcher.refined(corner, *match, right);
    horizontal.push_back(corner.u - place.x);
    rows.push_back(corner.v - place.y);
    vertical.push_back(std::abs(rows.back()));
  }
  CalibrationReport report;
  report.baseline_m = camera.baseline_m;
  report.focal_px = camera.fx;
  report.vertical_disparity_px = median(vertical);
  report.median_disparity_px = median(horizontal);
  report.row_offset_px = median(rows);
  report.matches = horizontal.size();
  report.corners = std::min(left_corners.size(), right_corners.size());
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

std::optional<DecodedPair> FrameDecoder::decode(const RecordedPair& pair) {
  DecodedPair result;
  std::string reason;
  const auto left = pixelsOf(pair.left, image_folder_);
  if (const auto* failure = std::get_if<std::string>(&left)) {
    reason = *failure;
  } else {
    result.left = std::get<cv::Mat>(left);
    reason = decodeRight(pair, result);
  }
  const bool is_other_size =
      camera_ && result.left.size() != cv::Size(camera_->width, camera_->height);
  if (reason.empty() && is_other_size) reason = "image_size";
  if (reason.empty()) return result;
  ++skipped_[reason];
  return std::nullopt;
}

/// Adds right image or depth; returns why it cannot be used.
std::string FrameDecoder::decodeRight(const RecordedPair& pair, DecodedPair& images) const {
  if (pair.depth) {
    auto ranges = rangesOf(*pair.depth, image_folder_);
    if (const auto* failure = std::get_if<std::string>(&ranges)) return *failure;
    images.ranges = std::get<cv::Mat>(ranges);
    const bool is_other_size = registration_ && images.ranges.size() != registration_->size();
    return is_other_size ? "depth_size" : "";
  }
  const auto right = pixelsOf(pair.right, image_folder_);
  if (const auto* failure = std::get_if<std::string>(&right)) return *failure;
  images.right = std::get<cv::Mat>(right);
  return images.right.size() == images.left.size() ? "" : "image_size";
}

void FrameDecoder::calibrate(const RecordedPair& pair, const DecodedPair& images) {
  if (pair.depth) return calibrateDepth(pair, images);
  const RawStereoCamera raw = rawCameraOf(pair);
  if (!(raw.left.fx > 0.0) && !(raw.right.fx > 0.0)) {
    throw InputError(
        "stereo calibration: the images have none (focal length 0), as those of most drivers: give "
        "it to headway-live by --calibration FILE (calibration.yaml), also for its recording");
  }
  if (images.left.size() != cv::Size(raw.left.width, raw.left.height)) {
    throw InputError("stereo calibration: for images of " +
                     sizeText(raw.left.width, raw.left.height) + " px, but they have " +
                     sizeText(images.left.cols, images.left.rows));
  }
  rectifier_.emplace(raw);
  camera_ = std::make_shared<const StereoCamera>(rectifier_->camera());
  requireBaselineInMetres(*camera_);
  requirePossibleLens(*camera_);
  const StereoFrame frame = stereoFrame(images);
  report_ = measureCalibration(frame.left, frame.right, *camera_);
  report_->rectified_here = !rectifier_->passesThrough();
  requireNotSwapped(*report_);
  requireBetterThanSwapped(images);
}

void FrameDecoder::calibrateDepth(const RecordedPair& pair, const DecodedPair& images) {
  const RawDepthCamera& recorded = pair.depth->camera;
  requireSize(images.left.size(), recorded.color, "intensity image (cameraParamsIntensity)");
  requireSize(images.ranges.size(), recorded.depth, "depth image (cameraParams)");
  validate(recorded);
  rectifier_.emplace(rawCameraOf(pair));
  StereoCamera camera = rectifier_->camera();
  camera.baseline_m = equivalentBaseline(camera.fx);
  const bool is_known = recorded.max_range_m > kMinDepthReachM && recorded.max_range_m < 1e3;
  camera.depth_reach_m = is_known ? recorded.max_range_m : 0.0;
  registration_.emplace(recorded, camera);
  if (!is_known) camera.depth_reach_m = kUnknownDepthReachM;  // of objects; all depths localise
  camera_ = std::make_shared<const StereoCamera>(camera);
  const cv::Mat disparity = registration_->disparities(images.ranges);
  report_.emplace();
  report_->baseline_m = camera.baseline_m;
  report_->focal_px = camera.fx;
  report_->rectified_here = !rectifier_->passesThrough();
  report_->is_depth_camera = true;
  report_->depth_ratio =
      static_cast<double>(cv::countNonZero(disparity)) / static_cast<double>(disparity.total());
}

/// Images that are rectified here do not match at all if they are swapped.
void FrameDecoder::requireBetterThanSwapped(const DecodedPair& images) const {
  if (!report_->rectified_here || report_->vertical_disparity_px < kMaxVerticalDisparity) return;
  const auto swapped =
      measureCalibration(rectifier_->rectify(Rectifier::kLeft, greyOf(images.right)),
                         rectifier_->rectify(Rectifier::kRight, greyOf(images.left)), *camera_);
  if (swapped.matches < 2 * kMinMatches || swapped.matches < 2 * report_->matches ||
      swapped.median_disparity_px < 1.0 ||
      swapped.vertical_disparity_px > 0.5 * report_->vertical_disparity_px) {
    return;
  }
  throw InputError("stereo calibration: " + std::to_string(swapped.matches) +
                   " points match if left and right images are swapped, " +
                   std::to_string(report_->matches) +
                   " as recorded: left and right images are swapped; exchange them, for two "
                   "cameras by --sensor-label RIGHT,LEFT");
}

void FrameDecoder::requireTwoCameras(const DecodedPair& images) {
  if (registration_ || identical_pairs_ >= kComparedPairs || are_two_cameras_) return;
  if (!isTextured(images.left)) return;
  const bool same_type = images.left.type() == images.right.type();
  if (!same_type || cv::norm(images.left, images.right, cv::NORM_INF) > 0.0) {
    are_two_cameras_ = true;
    return;
  }
  if (++identical_pairs_ < kComparedPairs) return;
  throw InputError("stereo images: left and right are identical in the first " +
                   std::to_string(kComparedPairs) +
                   " pairs: the same camera was recorded twice; record the right camera, or select "
                   "two labels by --sensor-label LEFT,RIGHT");
}

void FrameDecoder::requireMatching(const StereoFrame& frame) {
  constexpr double kDarkGrey = 20.0;       // mean grey level below which corners are noise
  constexpr double kSpacingS = 0.2;        // of the compared pairs: they span a second
  constexpr std::size_t kMinCorners = 80;  // of each image, of up to 1,024: enough for 20 matches
  constexpr double kMaxTurnRad = 0.045;    // of a camera in its mounting, which is no reason here
  constexpr double kMaxDisparityRatio = 0.5;  // of the width, at 0.2 m or farther
  constexpr double kMaxRowChangePx = 4.0;     // a rig's rows are constant to 0.5 px
  if (frame.right.empty() || compared_ >= kComparedPairs ||
      (compared_ > 0 && std::abs(frame.time - last_compared_) < kSpacingS) ||
      cv::mean(frame.left)[0] < kDarkGrey || cv::mean(frame.right)[0] < kDarkGrey) {
    return;
  }
  CalibrationMatching wide;
  wide.max_disparity_ratio = kMaxDisparityRatio;
  auto report = measureCalibration(frame.left, frame.right, *camera_, wide);
  if (report.corners < kMinCorners) return;
  wide.row_band_px = std::max(wide.row_band_px, kMaxTurnRad * camera_->fy);
  if (report.matches < kMinMatches) {
    report = measureCalibration(frame.left, frame.right, *camera_, wide);
  }
  last_compared_ = frame.time;
  most_matches_ = std::max(most_matches_, report.matches);
  if (report.matches >= kMinMatches) rows_px_.push_back(report.row_offset_px);
  if (++compared_ < kComparedPairs) return;
  std::string reason;
  if (most_matches_ < kMinMatches) {
    reason = formatted(" (at most %zu matches a pair", most_matches_);
  } else {
    const auto [lowest, highest] = std::minmax_element(rows_px_.begin(), rows_px_.end());
    if (*highest - *lowest < kMaxRowChangePx) return;
    reason = formatted(" (rows differ by %+.1f to %+.1f px from pair to pair", *lowest, *highest);
  }
  throw InputError(std::string("stereo images: ") + kNothingMatches + reason + ", in the first " +
                   std::to_string(kComparedPairs) +
                   " compared); check their order and times, and trigger the cameras together");
}

StereoFrame FrameDecoder::stereoFrame(const DecodedPair& images) const {
  StereoFrame frame;
  frame.left = rectifier_->rectify(Rectifier::kLeft, greyOf(images.left));
  if (registration_) {
    frame.disparity = registration_->disparities(images.ranges);
  } else {
    frame.right = rectifier_->rectify(Rectifier::kRight, greyOf(images.right));
  }
  if (images.left.channels() == 3) {
    frame.left_colour = rectifier_->rectify(Rectifier::kLeft, images.left);
  }
  frame.camera = camera_;
  return frame;
}

RecordedFrame FrameDecoder::frameOf(PendingFrame pending) {
  RecordedFrame frame;
  frame.index = pending.index;
  frame.time = pending.time;
  frame.T_map_robot = pending.T_map_robot;
  frame.detections = std::move(pending.detections);
  frame.laser_scans = std::move(pending.laser_scans);
  return frame;
}

RecordedFrame FrameDecoder::frameOf(PendingFrame pending, const DecodedPair& images) const {
  RecordedFrame frame = frameOf(std::move(pending));
  const auto start = std::chrono::steady_clock::now();
  frame.stereo = stereoFrame(images);
  frame.rectify_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  frame.stereo->index = frame.index;
  frame.stereo->time = frame.time;
  if (frame.detections) rectifyBoxes(*frame.detections);
  return frame;
}

cv::Mat FrameDecoder::rightColour(const DecodedPair& images) const {
  if (images.right.channels() != 3) return {};
  return rectifier_->rectify(Rectifier::kRight, images.right);
}

void FrameDecoder::rectifyBoxes(Detections& detections) const {
  if (!rectifier_) return;
  const bool is_other_image =
      detections.image_width > 0 &&
      (detections.image_width != camera_->width || detections.image_height != camera_->height);
  if (is_other_image) return;
  for (auto& item : detections.items) {
    if (item.box2d) item.box2d = rectifier_->rectify(*item.box2d);
  }
}

}  // namespace headway::io
