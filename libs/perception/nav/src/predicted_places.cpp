// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/contact_probability.h>
#include <headway/nav/predicted_places.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

constexpr double kStepBeyond_s = 0.1;  ///< between samples beyond the prediction

PredictedPlace placeAt(const map::PathSample& sample, double from_now_s, double yaw) {
  return {sample.centre, yaw, sample.covariance, {from_now_s, from_now_s}};
}

/// Makes each place last from when its predecessor is left to when its successor is reached.
void joinTimes(std::vector<PredictedPlace>& places, double end_s) {
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    places[i].when.to_s = places[i + 1].when.from_s;
  }
  for (std::size_t i = places.size() - 1; i > 0; --i) {
    places[i].when.from_s = places[i - 1].when.from_s;
  }
  places.back().when.to_s =
      places.size() == 1 ? std::numeric_limits<double>::infinity() : std::max(0.0, end_s);
}

}  // namespace

void predictPlaces(const Track& track, const PredictedPath& path, double age_s, double horizon_s,
                   double spacing_m, std::vector<PredictedPlace>& out) {
  out.clear();
  const double last_s = path.points.empty() ? 0.0 : path.points.back().horizon_s;
  out.push_back(placeAt(map::samplePath(track, path, std::min(age_s, last_s)), 0.0, track.yaw));
  double end_s = 0.0;
  const auto walkTo = [&](const map::PathSample& sample, double time_s) {
    if (!(time_s > age_s) || !(time_s <= horizon_s + 1e-9)) return;
    end_s = time_s - age_s;
    const Vector2d step = sample.centre - out.back().centre;
    if (!(step.squaredNorm() >= spacing_m * spacing_m)) return;
    out.push_back(placeAt(sample, end_s, std::atan2(step.y(), step.x())));
  };
  for (const auto& point : path.points) {
    walkTo({point.position.head<2>(), point.covariance}, point.horizon_s);
  }
  for (int i = 1; last_s > 0.0 && last_s + i * kStepBeyond_s <= horizon_s + 1e-9; ++i) {
    const double time_s = last_s + i * kStepBeyond_s;
    walkTo(map::samplePath(track, path, time_s), time_s);
  }
  joinTimes(out, end_s);
}

}  // namespace headway::nav
