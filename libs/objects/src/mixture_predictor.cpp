#include "mixture_predictor.h"

#include <algorithm>
#include <cmath>

#include "path_spread.h"

namespace headway::objects {
namespace {

constexpr int kModes = 4;

double square(double x) { return x * x; }

// A unit vector for each step, turned on from the present direction.
struct Directions {
  std::array<double, kPredictionSamples> x;
  std::array<double, kPredictionSamples> y;
};

}  // namespace

MixturePredictor::Tables MixturePredictor::tabulate(const ManoeuvreParams& params) {
  Tables tables;
  const auto faded = [](double t, double time) { return -time * std::expm1(-t / time); };
  for (int j = 0; j < kPredictionSamples; ++j) {
    const double t = (j + 1) * kPredictionStep_s;
    const double fade = params.acceleration_fade_s;
    tables.gained[j] = fade * (t - faded(t, fade));
    tables.turned[j] = faded(t - 0.5 * kPredictionStep_s, params.turn_fade_s);
    tables.drift[j] = square(params.velocity_sigma * t);
    tables.along[j] = square(params.acceleration_sigma * 0.5 * t * t);
    tables.across[j] = square(params.lateral_sigma * 0.5 * t * t);
  }
  return tables;
}

MixturePredictor::MixturePredictor(const PredictorParams& params)
    : params_(params.manoeuvres),
      tables_{tabulate(params.manoeuvres.vehicle), tabulate(params.manoeuvres.cyclist),
              tabulate(params.manoeuvres.pedestrian)} {}

void MixturePredictor::predictInto(const MotionHistory& history,
                                   std::vector<PredictedPath>& paths) const {
  if (history.path.empty()) return paths.clear();
  const ManoeuvreParams& params = params_.of(history.object_class);
  const Tables& tables = tables_.of(history.object_class);
  const Manoeuvre now = fitManoeuvre(history, params);

  Directions turning;
  for (int j = 0; j < kPredictionSamples; ++j) {
    const double angle = std::clamp(now.turn_rate * tables.turned[j], -M_PI, M_PI);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    turning.x[j] = now.direction.x() * c - now.direction.y() * s;
    turning.y[j] = now.direction.x() * s + now.direction.y() * c;
  }
  Directions straight;
  straight.x.fill(now.direction.x());
  straight.y.fill(now.direction.y());

  const double moves = square(now.speed) / (square(now.speed) + square(params.cruising_speed));
  const double other = moves * params.other_acceleration;
  const std::array<double, kModes> accelerations = {now.acceleration, 0.0, now.acceleration - other,
                                                    now.acceleration + other};
  constexpr std::array<double, kModes> kProbabilities = {0.55, 0.25, 0.1, 0.1};
  const Eigen::Vector3d start = history.path.back().position;
  const double start_variance = square(history.position_sigma_m) + square(0.03);

  paths.resize(kModes);
  for (int mode = 0; mode < kModes; ++mode) {
    PredictedPath& path = paths[mode];
    const Directions& directions = mode == 1 ? straight : turning;
    path.mode = mode;
    path.probability = kProbabilities[mode];
    path.points.resize(kPredictionSamples);
    double x = start.x();
    double y = start.y();
    double walked = 0.0;
    for (int j = 0; j < kPredictionSamples; ++j) {
      PredictedPoint& point = path.points[j];
      point.horizon_s = (j + 1) * kPredictionStep_s;
      // A braking object stops; it does not roll back.
      const double distance =
          std::max(walked, now.speed * point.horizon_s + accelerations[mode] * tables.gained[j]);
      const double c = directions.x[j];
      const double s = directions.y[j];
      x += (distance - walked) * c;
      y += (distance - walked) * s;
      walked = distance;
      point.position = {x, y, start.z()};
      const double common = start_variance + tables.drift[j];
      const double along = common + moves * tables.along[j];
      const double across = common + moves * tables.across[j];
      point.covariance << along * c * c + across * s * s, (along - across) * c * s,
          (along - across) * c * s, along * s * s + across * c * c;
    }
  }
}

}  // namespace headway::objects
