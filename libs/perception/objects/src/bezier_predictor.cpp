// SPDX-License-Identifier: BSD-3-Clause
#include "bezier_predictor.h"

#include <algorithm>
#include <cmath>

#include "bezier_curve.h"
#include "path_spread.h"
#include "recent_motion.h"

namespace headway::objects {
namespace {

double angleBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

}  // namespace

double smoothedSpeed(const std::vector<TrajectoryPoint>& path, int samples,
                     const PaperPredictorParams& params) {
  const std::size_t steps = std::min(path.size() - 1, static_cast<std::size_t>(samples));
  if (steps == 0) return 0.0;
  double sum = 0.0;
  for (std::size_t j = path.size() - steps; j < path.size(); ++j) {
    const double distance = (path[j].position - path[j - 1].position).head<2>().norm();
    sum += distance / (path[j].time - path[j - 1].time + params.epsilon_s);
  }
  return params.speed_factor * sum / static_cast<double>(steps);
}

double chordOfArc(double arc_length, double alpha) {
  constexpr double kNearlyStraight = 1e-4;  // where sin(x) / x is 1 to 2e-9
  return alpha < kNearlyStraight ? arc_length : arc_length * std::sin(alpha) / alpha;
}

// V_h: weighted mean of the path's tangent and the detected heading, if the two agree.
Eigen::Vector2d BezierPredictor::headDirection(const MotionHistory& history) const {
  const TrajectoryPoint& now = history.path.back();
  const TrajectoryPoint& before = history.path[history.path.size() - 2];
  const Eigen::Vector2d detected(std::cos(now.yaw), std::sin(now.yaw));
  if (ablation_.detected_heading) return detected;
  const Eigen::Vector2d tangent = unitOr((now.position - before.position).head<2>(), detected);
  if (tangent.dot(detected) < min_cosine_) return tangent;
  return unitOr(params_.paper.tangent_weight * tangent + params_.paper.heading_weight * detected,
                tangent);
}

// V_p: the recent direction, extrapolated by its change from the older one.
Eigen::Vector2d BezierPredictor::predictionDirection(const MotionHistory& history,
                                                     const Eigen::Vector2d& fallback) const {
  const double spacing = std::min(params_.paper.spacing_s, 0.5 * spanOf(history.path));
  const Time now = history.path.back().time;
  const Eigen::Vector2d p0 = history.path.back().position.head<2>();
  const Eigen::Vector2d p1 = placeAt(history.path, now - spacing);
  const Eigen::Vector2d p2 = placeAt(history.path, now - 2.0 * spacing);
  const Eigen::Vector2d recent = unitOr(p0 - p1, fallback);
  const Eigen::Vector2d older = unitOr(p1 - p2, recent);
  return unitOr(params_.paper.recent_weight * recent + params_.paper.older_weight * older, recent);
}

double BezierPredictor::endDistance(double curve_length, double alpha) const {
  if (ablation_.distance_is_length || alpha < params_.paper.straight_limit_rad) return curve_length;
  return chordOfArc(curve_length, alpha);
}

void BezierPredictor::predictInto(const MotionHistory& history,
                                  std::vector<PredictedPath>& paths) const {
  const ManoeuvreParams& manoeuvre = params_.manoeuvres.of(history.object_class);
  const PathSpread spread = spreadOf(history, manoeuvre, params_.velocity_window_s);
  if (history.path.size() < 2) return writeStanding(history, spread, paths);

  const int speed_samples = ablation_.instant_speed ? 1 : params_.paper.speed_samples;
  const double curve_length = smoothedSpeed(history.path, speed_samples, params_.paper) *
                              kPredictionSamples * kPredictionStep_s;  // |C_p| = v T_p
  const Eigen::Vector2d v_h = headDirection(history);
  const Eigen::Vector2d v_p = predictionDirection(history, v_h);
  const Eigen::Vector2d p_s = history.path.back().position.head<2>();
  const Eigen::Vector2d p_c = p_s + 0.5 * curve_length * v_h;
  const Eigen::Vector2d p_e = p_s + endDistance(curve_length, angleBetween(v_h, v_p)) * v_p;
  const BezierCurve curve(p_s, p_c, p_e);

  const DirectedSpread directed(spread, v_p);
  PredictedPath& path = singlePath(history, paths);
  for (int j = 0; j < kPredictionSamples; ++j) {
    PredictedPoint& point = path.points[j];
    point.position.head<2>() = curve.at((j + 1) * (1.0 / kPredictionSamples));
    point.covariance = directed.covariance(point.horizon_s);
  }
}

}  // namespace headway::objects
