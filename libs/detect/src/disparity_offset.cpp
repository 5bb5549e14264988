#include "disparity_offset.h"

#include <algorithm>

namespace headway::detect {
namespace {

constexpr double kWalk = 0.03;         // from frame to frame [px]
constexpr double kIndependent = 0.05;  // share of the points' information: neighbours err together
constexpr double kMostOffset = 4.0;    // [px]

}  // namespace

void DisparityOffset::update(const std::vector<PointTrack>& points,
                             const std::vector<PointClass>& classes) {
  double information = 0.0;
  double push = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& point = points[i];
    if (!point.motion || point.group >= 0 || classes[i] == PointClass::kMismatch) continue;
    const double weight = kIndependent / (1.0 + point.motion->stillFit());
    information += weight * point.motion->offset_information;
    push += weight * point.motion->offset_push;
  }
  variance_ += kWalk * kWalk;
  const double posterior = 1.0 / (1.0 / variance_ + information);
  value_ = std::clamp(value_ + posterior * push, -kMostOffset, kMostOffset);
  variance_ = posterior;
}

}  // namespace headway::detect
