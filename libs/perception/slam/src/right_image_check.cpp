// SPDX-License-Identifier: BSD-3-Clause
#include "right_image_check.h"

#include <cmath>

namespace headway::slam {
namespace {

/// How many of the landmarks that the left image shows have a disparity.
struct RightImageModel {
  double good = 0.46;       ///< ratio of them behind people; else mostly 0.9
  double bad = 0.25;        ///< mostly none; 10 rows off, where vertical edges recur
  double margin_px = 10.0;  ///< to the border and the largest disparity
  double settled_s = 1.0;   ///< of agreement, before the images count again
};
constexpr RightImageModel kModel;

/// How much more likely what the right image shows is of one that fails: the logarithm.
double ratioOf(const TrackedPose& tracked, const SparseMap& map, const StereoCamera& camera,
               const SlamParams& params) {
  const Pose T_cam_map = tracked.T_map_cam.inverse(Eigen::Isometry);
  const double max_disparity = params.max_disparity_ratio * camera.width - kModel.margin_px;
  double ratio = 0.0;
  for (const TrackedLandmark& seen : tracked.landmarks) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    const auto uvd = project(T_cam_map * landmark->position, camera);
    if (!uvd || uvd->x() - uvd->z() < kModel.margin_px || uvd->z() > max_disparity) continue;
    ratio += seen.measurement.stereo ? std::log(kModel.bad / kModel.good)
                                     : std::log((1.0 - kModel.bad) / (1.0 - kModel.good));
  }
  return ratio;
}

}  // namespace

void RightImageCheck::add(const TrackedPose* tracked, const TrackingFrame& frame,
                          const SparseMap& map, const StereoCamera& camera,
                          const SlamParams& params) {
  if (frame.right.isDepth()) return;
  const double ratio = tracked == nullptr ? 0.0 : ratioOf(*tracked, map, camera, params);
  evidence_.add(ratio);
  agrees_ = ratio < 0.0 || (ratio == 0.0 && !contradicted_);
  const bool is_refuted = tracked != nullptr && !evidence_.isSuspected();
  if (evidence_.isDecisive() || (contradicted_ && !is_refuted)) {
    contradicted_ = frame.time;
  } else if (contradicted_ && std::abs(frame.time - *contradicted_) >= kModel.settled_s) {
    contradicted_.reset();
  }
}

}  // namespace headway::slam
