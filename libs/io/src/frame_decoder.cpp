#include "frame_decoder.h"

#include <headway/core/error.h>

#include <array>
#include <utility>

#include "image_files.h"
#include "rectifier.h"

namespace headway::io {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

std::optional<DecodedPair> FrameDecoder::decode(const RecordedPair& pair) {
  DecodedPair result;
  const std::array<std::pair<const mrpt::img::CImage*, cv::Mat*>, 2> sides = {
      {{&pair.left, &result.left}, {&pair.right, &result.right}}};
  for (const auto& [recorded, pixels] : sides) {
    const auto loaded = pixelsOf(*recorded, image_folder_);
    if (const auto* reason = std::get_if<std::string>(&loaded)) {
      ++skipped_[*reason];
      return std::nullopt;
    }
    *pixels = std::get<cv::Mat>(loaded);
  }
  const bool is_other_size =
      result.left.size() != result.right.size() ||
      (camera_ && result.left.size() != cv::Size(camera_->width, camera_->height));
  if (!is_other_size) return result;
  ++skipped_["image_size"];
  return std::nullopt;
}

void FrameDecoder::calibrate(const RecordedPair& pair, const DecodedPair& images) {
  const RawStereoCamera raw = rawCameraOf(pair);
  if (images.left.size() != cv::Size(raw.left.width, raw.left.height)) {
    throw InputError("stereo calibration: for images of " +
                     sizeText(raw.left.width, raw.left.height) + " px, but they have " +
                     sizeText(images.left.cols, images.left.rows));
  }
  rectifier_.emplace(raw);
  camera_ = std::make_shared<const StereoCamera>(rectifier_->camera());
  const StereoFrame frame = stereoFrame(images);
  report_ = measureCalibration(frame.left, frame.right, *camera_);
  report_->rectified_here = !rectifier_->passesThrough();
  requireNotSwapped(*report_);
}

StereoFrame FrameDecoder::stereoFrame(const DecodedPair& images) const {
  StereoFrame frame;
  frame.left = rectifier_->rectify(Rectifier::kLeft, greyOf(images.left));
  frame.right = rectifier_->rectify(Rectifier::kRight, greyOf(images.right));
  if (images.left.channels() == 3) {
    frame.left_colour = rectifier_->rectify(Rectifier::kLeft, images.left);
  }
  frame.camera = camera_;
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
