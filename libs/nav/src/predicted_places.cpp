#include <headway/nav/predicted_places.h>

#include <cmath>
#include <limits>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

struct Sample {
  double horizon_s;
  Vector2d position;
  Eigen::Matrix2d covariance;
};

/// Sample 0 is the track itself, sample i the i-th point of the path.
Sample sampleOf(const Track& track, const PredictedPath& path, std::size_t i) {
  if (i == 0) {
    return {0.0, track.position.head<2>(), track.position_covariance.topLeftCorner<2, 2>()};
  }
  const auto& point = path.points[i - 1];
  return {point.horizon_s, point.position.head<2>(), point.covariance};
}

Sample between(const Sample& a, const Sample& b, double horizon_s) {
  const double share = (horizon_s - a.horizon_s) / (b.horizon_s - a.horizon_s);
  return {horizon_s, a.position + share * (b.position - a.position),
          a.covariance + share * (b.covariance - a.covariance)};
}

/// Straight on beyond the last sample, its spread growing with time as it did until there.
Sample continued(const Sample& before, const Sample& last, double horizon_s) {
  const double growth = horizon_s / last.horizon_s;
  const double steps = (horizon_s - last.horizon_s) / (last.horizon_s - before.horizon_s);
  return {horizon_s, last.position + steps * (last.position - before.position),
          growth * growth * last.covariance};
}

PredictedPlace placeAt(const Sample& sample, double age_s, double yaw) {
  const double time = sample.horizon_s - age_s;
  return {sample.position, yaw, sample.covariance, {time, time}};
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
  const std::size_t count = path.points.size() + 1;
  std::size_t i = 0;
  while (i + 1 < count && sampleOf(track, path, i + 1).horizon_s <= age_s) ++i;
  Sample now = sampleOf(track, path, i);
  if (i + 1 < count) now = between(now, sampleOf(track, path, i + 1), std::max(age_s, 0.0));
  now.horizon_s = age_s;
  out.push_back(placeAt(now, age_s, track.yaw));
  double end_s = 0.0;
  const auto walkTo = [&](const Sample& sample) {
    end_s = sample.horizon_s - age_s;
    const Vector2d step = sample.position - out.back().centre;
    if (step.norm() < spacing_m) return;
    out.push_back(placeAt(sample, age_s, std::atan2(step.y(), step.x())));
  };
  for (++i; i < count && sampleOf(track, path, i).horizon_s <= horizon_s; ++i) {
    walkTo(sampleOf(track, path, i));
  }
  if (count > 2 && i == count) {
    const Sample last = sampleOf(track, path, count - 1);
    const Sample before = sampleOf(track, path, count - 2);
    const double step_s = last.horizon_s - before.horizon_s;
    for (double t = last.horizon_s + step_s; t <= horizon_s + 1e-9; t += step_s) {
      walkTo(continued(before, last, t));
    }
  }
  joinTimes(out, end_s);
}

}  // namespace headway::nav
