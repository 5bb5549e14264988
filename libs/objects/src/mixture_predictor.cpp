#include "mixture_predictor.h"

#include <algorithm>
#include <cmath>

#include "path_spread.h"
#include "recent_motion.h"

namespace headway::objects {

void MixturePredictor::predictInto(const MotionHistory& history,
                                   std::vector<PredictedPath>& paths) const {
  const ManoeuvreParams& params = params_.manoeuvres.of(history.object_class);
  const PathSpread spread = spreadOf(history, params, params.speed_window_s);
  if (history.path.size() < 2) return writeStanding(history, spread, paths);
  const double window = std::min(params.speed_window_s, 0.5 * spanOf(history.path));
  const Time now = history.path.back().time;
  const Eigen::Vector2d p0 = history.path.back().position.head<2>();
  const Eigen::Vector2d p1 = placeAt(history.path, now - window);
  const Eigen::Vector2d p2 = placeAt(history.path, now - 2.0 * window);
  const Eigen::Vector2d recent = (p0 - p1) / window;
  const Eigen::Vector2d older = (p1 - p2) / window;
  const double turn =
      std::min(recent.norm(), older.norm()) < 0.5
          ? 0.0
          : std::atan2(older.x() * recent.y() - older.y() * recent.x(), older.dot(recent)) / window;
  const double change = (recent.norm() - older.norm()) / window;
  double speed = std::max(0.0, recent.norm() + 0.5 * window * params.acceleration_gain * change);
  const Eigen::Vector2d direction = unitOr(recent, Eigen::Vector2d::UnitX());
  double heading =
      std::atan2(direction.y(), direction.x()) + 0.5 * window * params.turn_gain * turn;
  Eigen::Vector2d place = p0;
  double acceleration = params.acceleration_gain * change;
  double turn_rate = params.turn_gain * turn;
  for (PredictedPoint& point : singlePath(history, paths).points) {
    const double middle = heading + 0.5 * kPredictionStep_s * turn_rate;
    place += std::max(0.0, speed + 0.5 * kPredictionStep_s * acceleration) * kPredictionStep_s *
             Eigen::Vector2d(std::cos(middle), std::sin(middle));
    heading += kPredictionStep_s * turn_rate;
    speed = std::max(0.0, speed + kPredictionStep_s * acceleration);
    acceleration *= std::exp(-kPredictionStep_s / params.acceleration_decay_s);
    turn_rate *= std::exp(-kPredictionStep_s / params.turn_decay_s);
    point.position.head<2>() = place;
    point.covariance = spread.covariance(point.horizon_s, direction);
  }
}

}  // namespace headway::objects
