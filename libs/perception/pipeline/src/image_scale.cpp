// SPDX-License-Identifier: BSD-3-Clause
// Smaller images inside the pipeline than those of the input (camera.scale).
#include "image_scale.h"

#include <headway/core/appearance.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::pipeline {
namespace {

double scaled(double pixel, double ratio) { return ratio * pixel + 0.5 * (ratio - 1.0); }

void scaleBox(double across, double down, std::optional<Box2d>& box) {
  if (!box) return;
  box = Box2d{scaled(box->left, across), scaled(box->top, down), scaled(box->right, across),
              scaled(box->bottom, down)};
}

std::shared_ptr<const ObjectMask> scaledMask(const ObjectMask& mask, double across, double down) {
  auto result = std::make_shared<ObjectMask>();
  const double columns = across * mask.reduce, rows = down * mask.reduce;  // pixels of a cell
  const cv::Point end = mask.corner + cv::Point(mask.cells.size());
  result->corner = {cvRound(columns * mask.corner.x), cvRound(rows * mask.corner.y)};
  const cv::Point scaled_end(cvRound(columns * end.x), cvRound(rows * end.y));
  const cv::Point size = scaled_end - result->corner;
  if (size.x < 1 || size.y < 1) return nullptr;
  cv::resize(mask.cells, result->cells, {size.x, size.y}, 0.0, 0.0, cv::INTER_NEAREST);
  return result;
}

Detections scaledDetections(Detections detections, double across, double down) {
  detections.image_width = cvRound(across * detections.image_width);
  detections.image_height = cvRound(down * detections.image_height);
  for (Detection& item : detections.items) {
    scaleBox(across, down, item.box2d);
    if (item.mask != nullptr) item.mask = scaledMask(*item.mask, across, down);
  }
  return detections;
}

void reduceImage(const cv::Size& size, cv::Mat& image) {
  if (image.empty()) return;
  cv::Mat reduced;
  cv::resize(image, reduced, size, 0.0, 0.0, cv::INTER_AREA);
  image = reduced;
}

/// Means of the disparities of one surface; 0 where none was measured or surfaces meet.
void reduceDisparity(const cv::Size& size, cv::Mat& disparity) {
  constexpr double kMaxSpread = 1.0;  // in a pixel: 2.5 standard deviations of a depth camera [px]
  if (disparity.empty()) return;
  cv::Mat known, squares = disparity.mul(disparity), mean = disparity;
  cv::Mat(disparity > 0.0F).convertTo(known, CV_32F, 1.0 / 255.0);
  for (cv::Mat* values : {&known, &squares, &mean}) reduceImage(size, *values);
  cv::divide(mean, known, mean);
  cv::divide(squares, known, squares);
  const cv::Mat variance = squares - mean.mul(mean);
  mean.setTo(0.0F, (known <= 0.5F) | (variance > kMaxSpread * kMaxSpread));
  disparity = mean;
}

}  // namespace

ImageScale::ImageScale(const StereoCamera* given, double scale) {
  if (given == nullptr || scale == 1.0) return;
  across_ = std::max(1.0, std::round(scale * given->width)) / given->width;
  down_ = std::max(1.0, std::round(scale * given->height)) / given->height;
}

std::shared_ptr<const StereoCamera> ImageScale::reduced(
    const std::shared_ptr<const StereoCamera>& given) const {
  if (given == nullptr || isOne()) return given;
  auto camera = std::make_shared<StereoCamera>(*given);
  camera->width = cvRound(across_ * given->width);
  camera->height = cvRound(down_ * given->height);
  camera->fx *= across_;
  camera->fy *= down_;
  camera->cx = scaled(given->cx, across_);
  camera->cy = scaled(given->cy, down_);
  if (given->isDepthCamera()) camera->baseline_m /= across_;
  return camera;
}

RecordedFrame ImageScale::reduced(RecordedFrame frame) const {
  if (isOne()) return frame;
  if (frame.detections) {
    frame.detections = scaledDetections(std::move(*frame.detections), across_, down_);
  }
  if (!frame.stereo) return frame;
  StereoFrame& stereo = *frame.stereo;
  const cv::Size size(cvRound(across_ * stereo.left.cols), cvRound(down_ * stereo.left.rows));
  reduceDisparity(size, stereo.disparity);
  for (cv::Mat* image : {&stereo.left, &stereo.right, &stereo.left_colour}) {
    reduceImage(size, *image);
  }
  return frame;
}

Detections ImageScale::enlarged(Detections detections) const {
  return isOne() ? detections : scaledDetections(std::move(detections), 1.0 / across_, 1.0 / down_);
}

std::vector<Track> ImageScale::enlarged(std::vector<Track> tracks) const {
  for (Track& track : tracks) scaleBox(1.0 / across_, 1.0 / down_, track.box2d);
  return tracks;
}

}  // namespace headway::pipeline
