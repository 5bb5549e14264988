#include "noise_scale.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr int kLeastSightings = 4;
constexpr std::size_t kLeastPoints = 30;
constexpr double kMedianOfChi = 0.93;  // of a chi-square of 9 degrees of freedom, over its mean
constexpr double kShareOfNew = 0.2;    // weight of a frame
constexpr double kLeast = 0.4;
constexpr double kMost = 3.0;

}  // namespace

void NoiseScale::update(const std::vector<PointTrack>& points) {
  std::vector<double> fits;
  for (const auto& point : points) {
    if (!point.motion || point.group >= 0 || point.motion->sightings < kLeastSightings) continue;
    fits.push_back(point.motion->stillFit());
  }
  if (fits.size() < kLeastPoints) return;
  const double now = std::clamp(std::sqrt(median(fits) / kMedianOfChi), kLeast, kMost);
  value_ += kShareOfNew * (now - value_);
}

}  // namespace headway::detect
