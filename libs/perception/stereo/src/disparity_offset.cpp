// SPDX-License-Identifier: BSD-3-Clause
// The offset of all disparities by a yaw of the right camera, where the poses are recorded.
#include <headway/stereo/disparity_offset.h>

#include <algorithm>

namespace headway::stereo {
namespace {

constexpr double kWalk_px = 0.03;  ///< in 0.1 s: images of different instants differ in turns
constexpr double kMaxOffset_px = 4.0;

}  // namespace

void DisparityOffset::update(const std::vector<OffsetEvidence>& static_points, double seconds) {
  if (static_points.empty()) return;
  double information = 0.0;
  double gradient = 0.0;
  for (const OffsetEvidence& point : static_points) {
    const double weight = kIndependentRatio / (1.0 + point.fit);
    information += weight * point.information;
    gradient += weight * point.gradient;
  }
  variance_ += kWalk_px * kWalk_px * (seconds * FrameRate::kAssumed_hz);
  const double posterior = 1.0 / (1.0 / variance_ + information);
  value_ = std::clamp(value_ + posterior * gradient, -kMaxOffset_px, kMaxOffset_px);
  variance_ = posterior;
}

}  // namespace headway::stereo
