#include "tracking_frame.h"

#include <headway/core/error.h>

#include <string>

#include "dynamic_rejection.h"

namespace headway::slam {
namespace {

void requireImages(const StereoFrame& frame, const StereoCamera& camera) {
  for (const cv::Mat* image : {&frame.left, &frame.right}) {
    if (image->type() == CV_8UC1 && image->cols == camera.width && image->rows == camera.height) {
      continue;
    }
    throw InputError("stereo frame " + std::to_string(frame.index) + ": an image is " +
                     std::to_string(image->cols) + "x" + std::to_string(image->rows) +
                     ", must be 8-bit grey and " + std::to_string(camera.width) + "x" +
                     std::to_string(camera.height) + " as calibrated");
  }
}

}  // namespace

TrackingFrame makeTrackingFrame(const stereo::FrameContext& context, const MovingRegions& moving,
                                const StereoCamera& camera, DynamicRejection mode) {
  const StereoFrame& frame = context.frame();
  requireImages(frame, camera);
  TrackingFrame current;
  current.index = frame.index;
  current.time = frame.time;
  current.left = context.left();
  current.right = context.right();
  current.excluded = excludedMask(moving, mode, frame.left.size());
  current.suspect = suspectMask(moving, mode, frame.left.size());
  return current;
}

}  // namespace headway::slam
