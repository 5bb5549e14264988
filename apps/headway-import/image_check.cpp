// SPDX-License-Identifier: BSD-3-Clause
#include "image_check.h"

#include <headway/core/statistics.h>
#include <headway/core/text.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "clock_offset.h"

namespace headway::import {
namespace {

constexpr int kCheckedWidth = 640;  // images are reduced to this [px]

double ratioAbove(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0.0;
  const auto count =
      std::count_if(values.begin(), values.end(), [&](double value) { return value > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

/// Energy of the second derivative over that of the first, which falls with blur; 0 without
/// structure.
double sharpnessOf(const cv::Mat& image) {
  cv::Mat smooth, second, dx, dy;
  cv::GaussianBlur(image, smooth, {}, 1.0);
  cv::Laplacian(smooth, second, CV_32F);
  cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 0.125);
  const double first = dx.dot(dx) + dy.dot(dy);
  return first > static_cast<double>(image.total()) ? second.dot(second) / first : 0.0;
}

/// Points of an image that are found in the next one.
void track(const cv::Mat& before, const cv::Mat& after, std::vector<cv::Point2f>& from,
           std::vector<cv::Point2f>& to) {
  std::vector<cv::Point2f> corners, moved, back;
  cv::goodFeaturesToTrack(before, corners, 250, 0.01, 12.0);
  if (corners.size() < 20) return;
  std::vector<uchar> found, found_back;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(before, after, corners, moved, found, errors);
  cv::calcOpticalFlowPyrLK(after, before, moved, back, found_back, errors);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (found[i] == 0 || found_back[i] == 0 || cv::norm(back[i] - corners[i]) > 0.5) continue;
    from.push_back(corners[i]);
    to.push_back(moved[i]);
  }
}

}  // namespace

void ImageCheck::add(const StereoFrame& frame) {
  const double left = cv::mean(frame.left)[0];
  brightness_.push_back(left);
  saturated_.push_back(static_cast<double>(cv::countNonZero(frame.left > 250)) /
                       static_cast<double>(frame.left.total()));
  sharpness_.push_back(sharpnessOf(frame.left));
  if (frame.right.empty()) {
    known_depth_.push_back(static_cast<double>(cv::countNonZero(frame.disparity > 0.0F)) /
                           static_cast<double>(frame.left.total()));
  } else {
    difference_.push_back(std::abs(left - cv::mean(frame.right)[0]));
    if (frames_ % every_nth_pair_ == 0) addPair(frame);
  }
  addTurn(frame);
  ++frames_;
}

void ImageCheck::addPair(const StereoFrame& frame) {
  const auto report = io::measureCalibration(frame.left, frame.right, *frame.camera);
  matches_.push_back(static_cast<double>(report.matches));
  if (report.matches >= 20) vertical_.push_back(report.vertical_disparity_px);
}

void ImageCheck::addTurn(const StereoFrame& frame) {
  const double scale = std::min(1.0, static_cast<double>(kCheckedWidth) / frame.left.cols);
  cv::Mat image;
  cv::resize(frame.left, image, {}, scale, scale, cv::INTER_AREA);
  const cv::Mat before = std::exchange(last_, image);
  const Time begin = std::exchange(last_time_, frame.time);
  constexpr double kLongestStep = 0.5;  // [s]
  if (before.empty() || frame.time - begin > kLongestStep || frame.time <= begin) return;
  std::vector<cv::Point2f> from, to;
  track(before, image, from, to);
  if (from.size() < 20) return;
  const auto& camera = *frame.camera;
  const cv::Matx33d lens(camera.fx * scale, 0, camera.cx * scale, 0, camera.fy * scale,
                         camera.cy * scale, 0, 0, 1);
  cv::Mat inliers, turn, shift;
  const cv::Mat essential = cv::findEssentialMat(from, to, lens, cv::RANSAC, 0.999, 0.7, inliers);
  if (essential.rows != 3 ||
      cv::recoverPose(essential, from, to, lens, turn, shift, inliers) < 15) {
    return;
  }
  Eigen::Matrix3d R_after_before;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      R_after_before(row, column) = turn.at<double>(row, column);
    }
  }
  const Eigen::Vector3d angle = logSo3(R_after_before.transpose());
  constexpr double kImplausible = 0.7;  // [rad]
  if (angle.norm() > kImplausible) return;
  turns_.push_back({begin, frame.time, camera.T_robot_cam.linear() * angle});
}

std::vector<CheckItem> ImageCheck::items() const {
  std::vector<CheckItem> items;
  CheckItem exposure{"exposure",
                     formatted("mean grey %.0f, overexposed %.1f %%", median(brightness_),
                               100.0 * median(saturated_)),
                     Verdict::kOk, ""};
  if (!difference_.empty()) {
    exposure.value += formatted(", left and right differ by %.1f", median(difference_));
  }
  if (median(brightness_) < 25.0 || median(saturated_) > 0.3) {
    exposure.verdict = Verdict::kBad;
    exposure.advice = "too dark or overexposed: change light, exposure or gain";
  } else if (median(brightness_) < 45.0 || median(saturated_) > 0.1 || median(difference_) > 25.0) {
    exposure.verdict = Verdict::kWarning;
    exposure.advice = difference_.empty()
                          ? "let the camera use the whole range of grey"
                          : "let both cameras use the same exposure and gain, and the whole range "
                            "of grey";
  }
  items.push_back(exposure);
  const double usual = median(sharpness_);
  std::vector<double> softness;
  for (const double sharpness : sharpness_) softness.push_back(usual / std::max(sharpness, 1e-9));
  const double blurred = ratioAbove(softness, 2.0);
  CheckItem blur{"blur",
                 formatted("%.1f %% of the images less than half as sharp as usual (%.2f)",
                           100.0 * blurred, usual),
                 usual < 0.05 ? Verdict::kBad : verdictOf(blurred, 0.03, 0.2), ""};
  if (blur.verdict != Verdict::kOk) {
    blur.advice = usual < 0.05 ? "all images are blurred: check the focus"
                               : "shorten the exposure and raise the gain, or turn more slowly";
  }
  items.push_back(blur);
  items.push_back(known_depth_.empty() ? pairItem() : depthItem());
  return items;
}

CheckItem ImageCheck::depthItem() const {
  const double known = median(known_depth_);
  CheckItem depth{"depth", formatted("%.0f %% of the pixels", 100.0 * known),
                  verdictOf(1.0 - known, 0.7, 0.95), ""};
  if (depth.verdict != Verdict::kOk) {
    depth.advice = "little within reach of the depth camera, sunlight, or a wrong calibration";
  }
  return depth;
}

CheckItem ImageCheck::pairItem() const {
  const double vertical = median(vertical_);
  CheckItem offset{"vertical offset",
                   formatted("median %.2f px, %.0f matches a pair", vertical, median(matches_)),
                   verdictOf(vertical, 0.5, 1.5), ""};
  if (offset.verdict != Verdict::kOk) offset.advice = "calibrate again and tighten the cameras";
  if (vertical_.empty()) {
    offset.verdict = Verdict::kBad;
    offset.advice = "left and right show nothing in common: is it the right camera? swapped?";
  }
  return offset;
}

std::vector<CheckItem> ImageCheck::clockItems(const std::vector<TurnSample>& samples) const {
  if (samples.empty()) return {};
  std::vector<TurnStep> steps;
  for (const auto& turn : turns_) steps.push_back({turn.begin, turn.end, turn.angle.norm()});
  const auto offset = clockOffset(steps, samples);
  CheckItem item{"camera against inertial sensor", "", Verdict::kOk, ""};
  if (!offset) {
    item.value = "not measurable";
    item.verdict = Verdict::kWarning;
    item.advice = "turn the camera in the recording, so that both sensors see it";
  } else {
    item.value = formatted("inertial times %+.0f ms, correlation %.2f", 1e3 * offset->offset_s,
                           offset->correlation);
    item.verdict = verdictOf(std::abs(offset->offset_s), 0.01, 0.03);
    if (item.verdict != Verdict::kOk) {
      item.advice = "the clocks or latencies differ: use one clock, and times of capture";
    }
  }
  return {item};
}

}  // namespace headway::import
