// SPDX-License-Identifier: BSD-3-Clause
#include "noise_scale.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr int kMinObservations = 4;
constexpr std::size_t kMinPoints = 30;
constexpr double kMedianOfChi = 0.93;    // of a chi-square of 9 degrees of freedom, over its mean
constexpr double kNewFrameWeight = 0.2;  // weight of a frame
constexpr double kMin = 0.4;
constexpr double kMax = 3.0;

}  // namespace

void NoiseScale::update(const std::vector<PointTrack>& points) {
  std::vector<double> fits;
  for (const auto& point : points) {
    if (!point.motion || point.group >= 0 || point.motion->observations < kMinObservations)
      continue;
    fits.push_back(point.motion->staticFit());
  }
  if (fits.size() < kMinPoints) return;
  const double now = std::clamp(std::sqrt(median(fits) / kMedianOfChi), kMin, kMax);
  value_ += kNewFrameWeight * (now - value_);
}

}  // namespace headway::detect
