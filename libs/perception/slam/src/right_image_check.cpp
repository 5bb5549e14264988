// SPDX-License-Identifier: BSD-3-Clause
#include "right_image_check.h"

#include <cmath>

namespace headway::slam {
namespace {

struct RightImageLimits {
  double min_agreement = 0.25;  ///< of the landmarks; good pairs: mostly 0.9, behind people 0.46
  double margin_px = 10.0;      ///< to the border and the largest disparity
  double settled_s = 1.0;       ///< of agreement, before the images count again
};
constexpr RightImageLimits kLimits;

/// Whether the right image shows landmarks where the map says; nullopt with too few. Fewer suffice
/// to show that it does.
std::optional<bool> agreementOf(const TrackedPose& tracked, const SparseMap& map,
                                const StereoCamera& camera, const SlamParams& params) {
  const Pose T_cam_map = tracked.T_map_cam.inverse(Eigen::Isometry);
  const double max_disparity = params.max_disparity_ratio * camera.width - kLimits.margin_px;
  int expected = 0, agreeing = 0;
  for (const TrackedLandmark& seen : tracked.landmarks) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    const auto uvd = project(T_cam_map * landmark->position, camera);
    if (!uvd || uvd->x() - uvd->z() < kLimits.margin_px || uvd->z() > max_disparity) continue;
    ++expected;
    agreeing += seen.measurement.stereo ? 1 : 0;
  }
  const bool agrees = agreeing >= kLimits.min_agreement * expected;
  if (expected < (agrees ? 1 : 3) * params.min_inliers) return std::nullopt;
  return agrees;
}

}  // namespace

void RightImageCheck::add(const TrackedPose* tracked, const TrackingFrame& frame,
                          const SparseMap& map, const StereoCamera& camera,
                          const SlamParams& params) {
  if (frame.right.isDepth()) return;
  std::optional<bool> agreement;
  if (tracked != nullptr) agreement = agreementOf(*tracked, map, camera, params);
  agrees_ = agreement.value_or(!contradicted_);
  if (!agrees_) {
    contradicted_ = frame.time;
  } else if (contradicted_ && std::abs(frame.time - *contradicted_) >= kLimits.settled_s) {
    contradicted_.reset();
  }
}

}  // namespace headway::slam
