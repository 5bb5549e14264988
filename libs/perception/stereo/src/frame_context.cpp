// SPDX-License-Identifier: BSD-3-Clause
// What SLAM and the detectors compute of a frame, each value once and when it is first used.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/image_pyramid.h>

#include <future>
#include <opencv2/core.hpp>

namespace headway::stereo {
namespace {

constexpr int kPyramidLevels = 4;

ImagePyramid stretchedPyramid(const cv::Mat& image, Gradients gradients) {
  return buildPyramid(stretched(image, stretchFor(image)), kPyramidLevels, gradients);
}

void subtractOffset(double offset_px, DisparityImage& disparity) {
  if (offset_px == 0.0) return;
  cv::subtract(disparity.values, offset_px, disparity.values, disparity.values > 0.0F);
  cv::max(disparity.values, 0.0F, disparity.values);
}

}  // namespace

void requireImages(const StereoFrame& frame, const StereoCamera& camera) {
  const bool is_depth = !frame.disparity.empty();
  for (const cv::Mat* image : {&frame.left, is_depth ? &frame.disparity : &frame.right}) {
    const int type = image == &frame.disparity ? CV_32FC1 : CV_8UC1;
    if (image->type() == type && image->cols == camera.width && image->rows == camera.height) {
      continue;
    }
    throw InputError(
        formatted("stereo frame %zu: an image is %dx%d, must be 8-bit grey and %dx%d as calibrated",
                  frame.index, image->cols, image->rows, camera.width, camera.height));
  }
}

struct FrameContext::Values {
  StereoFrame frame;
  DisparityParams params;
  double disparity_offset_px = 0.0;
  Eigen::Vector3d right_turn = Eigen::Vector3d::Zero();
  std::optional<GroundPlane> ground;  ///< of the frame before until it is found in this one
  bool ground_searched = false;
  ImagePyramid left;
  SecondView right;
  std::optional<DisparityImage> disparity;
  cv::Mat reduced_left;
  std::future<DisparityImage> pending;
};

FrameContext::FrameContext(const StereoFrame& frame)
    : FrameContext(frame, DisparityParams(), 0.0, std::nullopt) {}

FrameContext::FrameContext(const StereoFrame& frame, const DisparityParams& params,
                           double disparity_offset_px,
                           const std::optional<GroundPlane>& previous_ground,
                           const Eigen::Vector3d& right_turn)
    : values_(std::make_shared<Values>()) {
  values_->frame = frame;
  values_->params = params;
  values_->disparity_offset_px = disparity_offset_px;
  values_->ground = previous_ground;
  values_->right_turn = right_turn;
}

const StereoFrame& FrameContext::frame() const { return values_->frame; }

const ImagePyramid& FrameContext::left() const {
  if (values_->left.empty()) {
    values_->left = stretchedPyramid(values_->frame.left, Gradients::kAll);
  }
  return values_->left;
}

const SecondView& FrameContext::right() const {
  if (!values_->frame.disparity.empty()) {
    values_->right.disparities = values_->frame.disparity;
  } else if (values_->right.image.empty()) {
    values_->right.image = stretchedPyramid(values_->frame.right, Gradients::kNone);
  }
  return values_->right;
}

void FrameContext::startMatching(WorkerThread& worker) const {
  if (values_->disparity || values_->pending.valid()) return;
  values_->pending = worker.run(
      [frame = values_->frame, params = values_->params] { return denseDisparity(frame, params); });
}

const DisparityImage& FrameContext::disparity() const {
  if (!values_->disparity) {
    values_->disparity = values_->pending.valid() ? values_->pending.get()
                                                  : denseDisparity(values_->frame, values_->params);
    subtractOffset(values_->disparity_offset_px, *values_->disparity);
  }
  return *values_->disparity;
}

const cv::Mat& FrameContext::reducedLeft() const {
  if (values_->reduced_left.empty()) {
    values_->reduced_left = reducedImage(values_->frame.left, values_->params.reduce);
  }
  return values_->reduced_left;
}

double FrameContext::disparityOffset() const { return values_->disparity_offset_px; }

const Eigen::Vector3d& FrameContext::rightTurn() const { return values_->right_turn; }

const std::optional<GroundPlane>& FrameContext::ground() const {
  if (!values_->ground_searched) {
    values_->ground = findGround(disparity(), camera(), values_->ground);
    values_->ground_searched = true;
  }
  return values_->ground;
}

std::function<DisparityImage()> FrameContext::groundMatching(double to_m) const {
  if (!ground()) return {};
  return [frame = values_->frame, plane = *values_->ground, params = values_->params,
          offset_px = values_->disparity_offset_px, to_m] {
    DisparityImage disparity = groundDisparity(frame, plane, params, to_m);
    subtractOffset(offset_px, disparity);
    return disparity;
  };
}

const std::optional<GroundPlane>& FrameContext::lastGround() const { return values_->ground; }

FrontEnd::FrontEnd(const DisparityParams& params) : params_(validated(params)) {}

FrameContext FrontEnd::next(const StereoFrame& frame, double disparity_offset_px) {
  StereoFrame exact = frame;
  exact.right = right_turn_.undone(frame.right);
  FrameContext context(exact, params_, disparity_offset_px,
                       previous_ ? previous_->lastGround() : std::nullopt, right_turn_.angles());
  previous_ = context;
  return context;
}

}  // namespace headway::stereo
