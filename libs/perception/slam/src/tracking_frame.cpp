// SPDX-License-Identifier: BSD-3-Clause
#include "tracking_frame.h"

#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/stereo/patch.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "dynamic_rejection.h"

namespace headway::slam {
namespace {

void requireImages(const StereoFrame& frame, const StereoCamera& camera) {
  const bool is_depth = !frame.disparity.empty();
  for (const cv::Mat* image : {&frame.left, is_depth ? &frame.disparity : &frame.right}) {
    const int type = image == &frame.disparity ? CV_32FC1 : CV_8UC1;
    if (image->type() == type && image->cols == camera.width && image->rows == camera.height) {
      continue;
    }
    throw InputError("stereo frame " + std::to_string(frame.index) + ": an image is " +
                     std::to_string(image->cols) + "x" + std::to_string(image->rows) +
                     ", must be 8-bit grey and " + std::to_string(camera.width) + "x" +
                     std::to_string(camera.height) + " as calibrated");
  }
}

/// Cells so small that those outside of the excluded regions are about `features`, in steps of two,
/// so that they stay the same from frame to frame; not smaller than a patch, because neighbouring
/// landmarks would measure the same pixels.
FeatureGrid gridOutside(const cv::Mat& excluded, const StereoCamera& camera, int features) {
  const double area = static_cast<double>(camera.width) * camera.height;
  const double usable = excluded.empty() ? area : area - cv::countNonZero(excluded);
  const double factor = std::exp2(std::round(std::log2(area / std::max(usable, 1.0))));
  const double most = std::max<double>(features, area / square(stereo::kPatchSize));
  return {camera.width, camera.height, static_cast<int>(std::min(factor * features, most))};
}

}  // namespace

TrackingFrame makeTrackingFrame(const stereo::FrameContext& context, const MovingRegions& moving,
                                const StereoCamera& camera, const SlamParams& params) {
  const StereoFrame& frame = context.frame();
  requireImages(frame, camera);
  TrackingFrame current;
  current.index = frame.index;
  current.time = frame.time;
  current.left = context.left();
  current.right = context.right();
  current.excluded = excludedMask(moving, params.dynamic_rejection, frame.left.size());
  current.suspect = suspectMask(moving, params.dynamic_rejection, frame.left.size());
  current.grid = gridOutside(current.excluded, camera, params.features);
  return current;
}

}  // namespace headway::slam
