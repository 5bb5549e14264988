// SPDX-License-Identifier: BSD-3-Clause
// The paper's predictor, its ablations and baselines; each predicts a single path.
#include "paper_predictors.h"

#include <headway/core/statistics.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "recent_motion.h"

namespace headway::objects {
namespace {

// Gauss-Legendre nodes and weights on [0, 1], 5 points.
constexpr std::array<double, 5> kNodes = {0.046910077030668, 0.230765344947158, 0.5,
                                          0.769234655052842, 0.953089922969332};
constexpr std::array<double, 5> kWeights = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                            0.239314335249683, 0.118463442528095};
// Where the parametric speed varies more than this, a polynomial cannot follow its inverse.
constexpr double kSteadySpeedRatio = 0.75;
// Shorter curves are treated as straight [m].
constexpr double kNegligible_m = 0.01;

}  // namespace

BezierCurve::BezierCurve(const Eigen::Vector2d& start, const Eigen::Vector2d& control,
                         const Eigen::Vector2d& end)
    : start_(start), linear_(2.0 * (control - start)), quadratic_(start - 2.0 * control + end) {
  const double a = 4.0 * quadratic_.squaredNorm();
  const double b = 4.0 * linear_.dot(quadratic_);
  const double c = linear_.squaredNorm();
  const double min_speed_t = a > 0.0 ? std::clamp(-b / (2.0 * a), 0.0, 1.0) : 0.0;
  const double min_speed = c + min_speed_t * (b + min_speed_t * a);  // squared speeds
  const double fastest = std::max(c, a + b + c);
  if (fastest < kNegligible_m * kNegligible_m) {
    length_ = (end - start).norm();
  } else if (min_speed > kSteadySpeedRatio * kSteadySpeedRatio * fastest) {
    fitInverse();
  } else {
    tabulate();
  }
}

// Quintic Hermite interpolation of the parameter as a function of the fraction of the arc length:
// value, first and second derivative agree at both ends.
void BezierCurve::fitInverse() {
  for (std::size_t i = 0; i < kNodes.size(); ++i) length_ += kWeights[i] * speedAt(kNodes[i]);
  const Eigen::Vector2d end_tangent = linear_ + 2.0 * quadratic_;
  const double start_square = linear_.squaredNorm();
  const double end_square = end_tangent.squaredNorm();
  const double v0 = length_ / std::sqrt(start_square);
  const double v1 = length_ / std::sqrt(end_square);
  const double square = length_ * length_;
  const double a0 = -square * 2.0 * linear_.dot(quadratic_) / (start_square * start_square);
  const double a1 = -square * 2.0 * end_tangent.dot(quadratic_) / (end_square * end_square);
  inverse_ = {v0, 0.5 * a0, 10.0 - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
              -15.0 + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
              6.0 - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1};
}

void BezierCurve::tabulate() {
  tabulated_ = true;
  table_[0] = 0.0;
  constexpr double kStep = 1.0 / kTableSize;
  double speed = speedAt(0.0);
  for (int i = 0; i < kTableSize; ++i) {  // Simpson's rule in every cell
    const double next_speed = speedAt((i + 1) * kStep);
    length_ += kStep / 6.0 * (speed + 4.0 * speedAt((i + 0.5) * kStep) + next_speed);
    table_[i + 1] = length_;
    speed = next_speed;
  }
  if (length_ <= 0.0) return;
  for (double& fraction : table_) fraction /= length_;
}

double BezierCurve::tabulatedParameterAt(double fraction) const {
  if (length_ <= 0.0) return fraction;
  const auto above = std::upper_bound(table_.begin() + 1, table_.end() - 1, fraction);
  const double cell = static_cast<double>(above - table_.begin()) - 1.0;
  const double low = *(above - 1);
  const double width = *above - low;
  return (cell + (width > 0.0 ? (fraction - low) / width : 0.0)) / kTableSize;
}

double smoothedSpeed(const std::vector<TrajectoryPoint>& path, double window_s,
                     const PaperPredictorParams& params) {
  double sum = 0.0;
  double steps = 0.0;
  for (std::size_t j = path.size() - 1; j > 0; --j) {
    if (steps > 0.0 && path.back().time - path[j - 1].time > window_s + kFrameJitter_s) break;
    const double distance = (path[j].position - path[j - 1].position).head<2>().norm();
    sum += distance / (path[j].time - path[j - 1].time + params.epsilon_s);
    steps += 1.0;
  }
  return steps > 0.0 ? params.speed_factor * sum / steps : 0.0;
}

double chordOfArc(double arc_length, double alpha) {
  constexpr double kNearlyStraight = 1e-4;  // where sin(x) / x is 1 to 2e-9
  return alpha < kNearlyStraight ? arc_length : arc_length * std::sin(alpha) / alpha;
}

namespace {

/// Growth of the uncertainty about a path that runs along one direction: errors of position, of
/// velocity and of acceleration.
class PathSpread {
 public:
  /// @param window_s   of the history by which the velocity is estimated [s]
  /// @param direction  unit length
  PathSpread(const MotionHistory& history, const ManoeuvreParams& params, double window_s,
             const Eigen::Vector2d& direction) {
    constexpr double kMinSigma_m = 0.05;
    constexpr double kUnknownSpeed = 5.0;  // of an object seen once [m/s]
    const double c = direction.x();
    const double s = direction.y();
    Eigen::Matrix2d along;
    along << c * c, c * s, c * s, s * s;
    const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - along;
    const double sigma = meanSigma(history.position_covariance);
    const double span = std::min(window_s, spanOf(history.path));
    const double velocity = span > 0.0 ? std::min(kUnknownSpeed, sigma / span) : kUnknownSpeed;
    start_ = square(std::max(sigma, kMinSigma_m)) * Eigen::Matrix2d::Identity();
    velocity_ = square(velocity) * along + square(velocity) * across;
    acceleration_ =
        0.25 * (square(params.acceleration_sigma_mps2.of(history.object_class)) * along +
                square(params.lateral_sigma_mps2.of(history.object_class)) * across);
  }

  /// Covariance at one horizon [m^2].
  [[nodiscard]] Eigen::Matrix2d covariance(double horizon_s) const {
    const double square = horizon_s * horizon_s;
    return start_ + square * (velocity_ + square * acceleration_);
  }

 private:
  Eigen::Matrix2d start_, velocity_, acceleration_;
};

/// Horizon of sample j [s].
double horizonOf(int j) { return (j + 1) * kPredictionStep_s; }

/// Where an object goes.
struct SinglePath {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< that its spread follows
  std::function<Eigen::Vector2d(int)> at;                ///< place at sample j [m]
};

/// Predicts one path; a history of one position, or of none, is the same for all.
class SinglePathPredictor : public Predictor {
 public:
  explicit SinglePathPredictor(const PredictorParams& params) : params_(params) {}

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const final {
    if (history.path.empty()) return paths.clear();
    const Eigen::Vector3d& start = history.path.back().position;
    const SinglePath single =
        history.path.size() < 2
            ? SinglePath{Eigen::Vector2d::UnitX(),
                         [&](int) -> Eigen::Vector2d { return start.head<2>(); }}
            : pathOf(history, start.head<2>());
    const PathSpread spread(history, params_.manoeuvres, params_.velocity_window_s,
                            single.direction);
    paths.resize(1);
    PredictedPath& path = paths.front();
    path.mode = 0;
    path.probability = 1.0;
    path.points.resize(kPredictionSamples);
    for (int j = 0; j < kPredictionSamples; ++j) {
      PredictedPoint& point = path.points[j];
      point.horizon_s = horizonOf(j);
      point.position << single.at(j), start.z();
      point.covariance = spread.covariance(point.horizon_s);
    }
  }

 protected:
  /// Of a history of two positions or more, the last of which is `start`.
  [[nodiscard]] virtual SinglePath pathOf(const MotionHistory& history,
                                          const Eigen::Vector2d& start) const = 0;

  PredictorParams params_;
};

double angleBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

/// The paper's predictor: a quadratic Bezier curve from the heading and the recent path
/// (Sec. III-B), and its ablations of Table II.
class BezierPredictor : public SinglePathPredictor {
 public:
  BezierPredictor(const PredictorParams& params, PredictorKind kind)
      : SinglePathPredictor(params), kind_(kind) {}

 private:
  [[nodiscard]] SinglePath pathOf(const MotionHistory& history,
                                  const Eigen::Vector2d& p_s) const override {
    const double window_s = kind_ == PredictorKind::kPaperSv ? 0.0 : params_.paper.speed_time_s;
    const double curve_length = smoothedSpeed(history.path, window_s, params_.paper) *
                                kPredictionSamples * kPredictionStep_s;  // |C_p| = v T_p
    const Eigen::Vector2d v_h = headDirection(history);
    const Eigen::Vector2d v_p = predictionDirection(history, v_h);
    const Eigen::Vector2d p_c = p_s + 0.5 * curve_length * v_h;
    const Eigen::Vector2d p_e = p_s + endDistance(curve_length, angleBetween(v_h, v_p)) * v_p;
    const BezierCurve curve(p_s, p_c, p_e);
    return {v_p, [curve](int j) { return curve.at((j + 1) * (1.0 / kPredictionSamples)); }};
  }

  // V_h: weighted mean of the path's tangent and the detected heading, if the two agree.
  [[nodiscard]] Eigen::Vector2d headDirection(const MotionHistory& history) const {
    const TrajectoryPoint& now = history.path.back();
    const TrajectoryPoint& before = history.path[history.path.size() - 2];
    const Eigen::Vector2d detected(std::cos(now.yaw), std::sin(now.yaw));
    if (kind_ == PredictorKind::kPaperHd) return detected;
    const Eigen::Vector2d tangent = unitOr((now.position - before.position).head<2>(), detected);
    if (tangent.dot(detected) < std::cos(params_.paper.heading_limit_rad)) return tangent;
    return unitOr(params_.paper.tangent_weight * tangent + params_.paper.heading_weight * detected,
                  tangent);
  }

  // V_p: the recent direction, extrapolated by its change from the older one.
  [[nodiscard]] Eigen::Vector2d predictionDirection(const MotionHistory& history,
                                                    const Eigen::Vector2d& fallback) const {
    const double spacing = std::min(params_.paper.spacing_s, 0.5 * spanOf(history.path));
    const Time now = history.path.back().time;
    const Eigen::Vector2d p0 = history.path.back().position.head<2>();
    const Eigen::Vector2d p1 = placeAt(history.path, now - spacing);
    const Eigen::Vector2d p2 = placeAt(history.path, now - 2.0 * spacing);
    const Eigen::Vector2d recent = unitOr(p0 - p1, fallback);
    const Eigen::Vector2d older = unitOr(p1 - p2, recent);
    return unitOr(params_.paper.recent_weight * recent + params_.paper.older_weight * older,
                  recent);
  }

  [[nodiscard]] double endDistance(double curve_length, double alpha) const {
    if (kind_ == PredictorKind::kPaperDm || alpha < params_.paper.straight_limit_rad)
      return curve_length;
    return chordOfArc(curve_length, alpha);
  }

  PredictorKind kind_;
};

// Turn rate from the mean velocities over the last window and the one before it [rad/s].
double recentTurnRate(const std::vector<TrajectoryPoint>& path, double window_s) {
  const double window = std::min(window_s, 0.5 * spanOf(path));
  if (window <= 0.0) return 0.0;
  const Time now = path.back().time;
  const Eigen::Vector2d p0 = path.back().position.head<2>();
  const Eigen::Vector2d p1 = placeAt(path, now - window);
  const Eigen::Vector2d p2 = placeAt(path, now - 2.0 * window);
  const Eigen::Vector2d recent = p0 - p1;
  const Eigen::Vector2d older = p1 - p2;
  if (std::min(recent.norm(), older.norm()) < kMinTurningSpeed_mps * window) return 0.0;
  const double cross = older.x() * recent.y() - older.y() * recent.x();
  return std::atan2(cross, older.dot(recent)) / window;
}

// Least-squares parabola of four positions one spacing apart, the last of them current.
class Parabola {
 public:
  Parabola(const std::vector<TrajectoryPoint>& path, double spacing_s) : spacing_s_(spacing_s) {
    const Time now = path.back().time;
    const Eigen::Vector2d p0 = path.back().position.head<2>();
    const Eigen::Vector2d p1 = placeAt(path, now - spacing_s);
    const Eigen::Vector2d p2 = placeAt(path, now - 2.0 * spacing_s);
    const Eigen::Vector2d p3 = placeAt(path, now - 3.0 * spacing_s);
    // Least squares in the spacings from the middle of the four: -3/2, -1/2, 1/2, 3/2.
    slope_ = (3.0 * (p0 - p3) + (p1 - p2)) / 10.0;
    bend_ = (p0 - p1 - p2 + p3) / 4.0;
  }
  /// Displacement from the current position at one time [m].
  [[nodiscard]] Eigen::Vector2d advance(double time_s) const {
    const double u = time_s / spacing_s_;
    return u * (slope_ + (u + 3.0) * bend_);
  }

 private:
  double spacing_s_;
  Eigen::Vector2d slope_, bend_;
};

/// Straight motion with the mean velocity of the last window.
class ConstantVelocityPredictor : public SinglePathPredictor {
 public:
  using SinglePathPredictor::SinglePathPredictor;

 private:
  [[nodiscard]] SinglePath pathOf(const MotionHistory& history,
                                  const Eigen::Vector2d& start) const override {
    const Eigen::Vector2d velocity = recentVelocity(history.path, params_.velocity_window_s);
    return {unitOr(velocity, Eigen::Vector2d::UnitX()),
            [=](int j) -> Eigen::Vector2d { return start + horizonOf(j) * velocity; }};
  }
};

/// Circular motion: constant speed and constant turn rate (CTRV).
///
/// The turn rate comes from the velocities over the last two windows.
class ConstantTurnPredictor : public SinglePathPredictor {
 public:
  using SinglePathPredictor::SinglePathPredictor;

 private:
  [[nodiscard]] SinglePath pathOf(const MotionHistory& history,
                                  const Eigen::Vector2d& start) const override {
    constexpr double kStraight = 1e-6;  // below this turn rate the circle is a line [rad/s]
    const double window = std::min(params_.velocity_window_s, spanOf(history.path));
    const double turn_rate = recentTurnRate(history.path, params_.velocity_window_s);
    // The mean velocity of a window has the object's heading at the middle of the window.
    const Eigen::Vector2d velocity = Eigen::Rotation2Dd(0.5 * window * turn_rate) *
                                     recentVelocity(history.path, params_.velocity_window_s);
    const Eigen::Vector2d sideways(-velocity.y(), velocity.x());
    return {unitOr(velocity, Eigen::Vector2d::UnitX()), [=](int j) -> Eigen::Vector2d {
              const double t = horizonOf(j);
              const double angle = turn_rate * t;
              const bool straight = std::abs(turn_rate) < kStraight;
              const double ahead = straight ? t : std::sin(angle) / turn_rate;
              const double lateral = straight ? 0.0 : (1.0 - std::cos(angle)) / turn_rate;
              return start + ahead * velocity + lateral * sideways;
            }};
  }
};

/// The paper's baseline: a parabola fitted to four past positions half a second apart, extended
/// until its end is at distance d_se from the object (Sec. IV-A).
class PolynomialPredictor : public SinglePathPredictor {
 public:
  using SinglePathPredictor::SinglePathPredictor;

 private:
  [[nodiscard]] SinglePath pathOf(const MotionHistory& history,
                                  const Eigen::Vector2d& start) const override {
    constexpr double kSpacing_s = 0.5;  // five frames at 10 Hz
    const double horizon_s = horizonOf(kPredictionSamples - 1);
    const double end_distance =
        horizon_s * smoothedSpeed(history.path, params_.paper.speed_time_s, params_.paper);
    const Parabola parabola(history.path, std::min(kSpacing_s, spanOf(history.path) / 3.0));
    const Eigen::Vector2d end = parabola.advance(horizon_s);
    const double scale = end.norm() > kNoDirection_m ? end_distance / end.norm() : 0.0;
    return {unitOr(end, Eigen::Vector2d::UnitX()), [=](int j) -> Eigen::Vector2d {
              return start + scale * parabola.advance(horizonOf(j));
            }};
  }
};

}  // namespace

std::unique_ptr<Predictor> makePaperPredictor(PredictorKind kind, const PredictorParams& params) {
  switch (kind) {
    case PredictorKind::kPolynomial:
      return std::make_unique<PolynomialPredictor>(params);
    case PredictorKind::kConstantVelocity:
      return std::make_unique<ConstantVelocityPredictor>(params);
    case PredictorKind::kConstantTurn:
      return std::make_unique<ConstantTurnPredictor>(params);
    default:
      return std::make_unique<BezierPredictor>(params, kind);
  }
}

}  // namespace headway::objects
