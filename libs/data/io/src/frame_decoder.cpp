// SPDX-License-Identifier: BSD-3-Clause
#include "frame_decoder.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/image_file.h>

#include <chrono>
#include <opencv2/core.hpp>
#include <utility>

#include "image_files.h"
#include "rectifier.h"

namespace headway::io {
namespace {

constexpr double kMaxBaselineM = 5.0;
constexpr double kMinFocalWidths = 0.1;  // of the image
constexpr double kMaxFocalWidths = 30.0;
constexpr std::size_t kComparedPairs = 5;
constexpr std::size_t kMinMatchesSwapped = 40;
constexpr double kMaxVerticalDisparity = 0.8;  // of a good calibration [px]
constexpr double kMinDepthReachM = 0.5;        // of a depth camera; less is none
constexpr double kUnknownDepthReachM = 10.0;
constexpr double kMinContrast = 3.0;  // standard deviation of grey levels

/// A baseline of metres belongs to no robot: it is recorded in another unit.
void requireBaselineInMetres(const StereoCamera& camera) {
  if (camera.baseline_m <= kMaxBaselineM) return;
  const double metres = camera.baseline_m * (camera.baseline_m < 50.0 ? 1e-2 : 1e-3);
  throw InputError(formatted(
      "stereo calibration: the baseline is %.6g m, which is in %s; write %.6g m in "
      "rightCameraPose",
      camera.baseline_m, camera.baseline_m < 50.0 ? "centimetres" : "millimetres", metres));
}

/// Lenses of robots' cameras.
void requirePossibleLens(const StereoCamera& camera) {
  const double widths = camera.fx / camera.width;
  if (widths >= kMinFocalWidths && widths <= kMaxFocalWidths) return;
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
  camera.depth_reach_m = is_known ? recorded.max_range_m : kUnknownDepthReachM;
  registration_.emplace(recorded, camera);
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
  if (swapped.matches < kMinMatchesSwapped || swapped.matches < 2 * report_->matches ||
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
