// SPDX-License-Identifier: BSD-3-Clause
#include "mixture_predictor.h"

#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace headway::objects {
namespace {

// Frequency at which each path was the nearest to the true one, rounded.
constexpr std::array<double, 4> kProbabilities = {0.55, 0.25, 0.1, 0.1};
constexpr double kMinPositionSigma_m = 0.03;
constexpr double kMaxTurnRate = 3.0;  // [rad/s]

// Hindsight: how long ago predictions are looked back at, and how much it counts. Errors at the
// three times are nearly the same, so their likelihoods count as less than one.
constexpr std::array<double, 3> kLookBack_s = {0.3, 0.6, 1.0};
constexpr double kMaxLookBack_s = 1.5;  // at low frame rates
constexpr double kLikelihoodWeight = 0.25;
constexpr double kUsualError = 2.0;      // expected squared error in standard deviations, 2 axes
constexpr double kMaxError = 32.0;       // an outlier's counts as this
constexpr double kSurpriseFade_s = 4.0;  // of the horizon, after which growth is the usual one

// The direction turned by a small angle: by series, exact to 3e-7 at the fastest turn.
Eigen::Vector2d turnedBy(const Eigen::Vector2d& direction, double angle) {
  const double a2 = angle * angle;
  const double c = 1.0 - a2 * (1.0 / 2.0 - a2 * (1.0 / 24.0));
  const double s = angle * (1.0 - a2 * (1.0 / 6.0 - a2 * (1.0 / 120.0)));
  return {c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y()};
}

Eigen::Matrix2d ellipse(double along, double across, const Eigen::Vector2d& direction) {
  const double c = direction.x();
  const double s = direction.y();
  const double cross = (along - across) * c * s;
  Eigen::Matrix2d covariance;
  covariance << along * c * c + across * s * s, cross, cross, along * s * s + across * c * c;
  return covariance;
}

}  // namespace

/// The directions that a path takes step by step, and the spread about it.
struct MixturePredictor::Course {
  std::array<Eigen::Vector2d, kPredictionSamples> directions;
  std::array<Eigen::Matrix2d, kPredictionSamples> covariances;  ///< [m^2]
};

/// The paths from one position. Mode 1 is straight; the others take the turning course.
struct MixturePredictor::Outlook {
  Course turning, straight;
  double speed = 0.0;                          ///< [m/s]
  std::array<double, kModes> accelerations{};  ///< of each mode [m/s^2]

  [[nodiscard]] const Course& courseOf(int mode) const { return mode == 1 ? straight : turning; }
};

/// Moves along one path of an outlook step by step.
class MixturePredictor::Walk {
 public:
  Walk(const Outlook& outlook, const Tables& tables, int mode, const Eigen::Vector2d& start)
      : course_(outlook.courseOf(mode)),
        tables_(tables),
        speed_(outlook.speed),
        acceleration_(outlook.accelerations[mode]),
        position_(start) {}

  /// The position after a time, from the start, between two samples [s].
  Eigen::Vector2d to(double horizon_s) {
    const double steps = horizon_s / kPredictionStep_s;
    const int whole = static_cast<int>(steps);
    Eigen::Vector2d reached = position_;
    for (int j = 0; j < whole; ++j) reached = step(j);
    return reached + (steps - whole) * (step(whole) - reached);
  }

  /// The position at sample j, which follows the one before.
  const Eigen::Vector2d& step(int j) {
    const double distance =
        speed_ * (j + 1) * kPredictionStep_s + acceleration_ * tables_.gained[j];
    if (distance > walked_) {  // a braking object stops; it does not roll back
      position_ += (distance - walked_) * course_.directions[j];
      walked_ = distance;
    }
    return position_;
  }

 private:
  const Course& course_;
  const Tables& tables_;
  double speed_, acceleration_;
  double walked_ = 0.0;  // [m]
  Eigen::Vector2d position_;
};

/// What follows from earlier predictions and what came.
struct MixturePredictor::Hindsight {
  double growth = 1.0;  ///< factor of what covariances grow by
  std::array<double, kModes> probabilities = kProbabilities;

  Hindsight() = default;
  /// @param squared      mean squared error of the first mode, in standard deviations
  /// @param likelihoods  mean log-likelihood of what came by each mode
  Hindsight(double squared, const std::array<double, kModes>& likelihoods)
      : growth((kUsualError + squared) / (2.0 * kUsualError)) {
    double sum = 0.0;
    for (int mode = 0; mode < kModes; ++mode) {
      probabilities[mode] *= std::exp(kLikelihoodWeight * (likelihoods[mode] - likelihoods[0]));
      sum += probabilities[mode];
    }
    for (double& probability : probabilities) probability /= sum;
  }
};

MixturePredictor::Tables MixturePredictor::tabulate(const ManoeuvreParams& params) {
  Tables tables;
  const auto faded = [](double t, double time) { return -time * std::expm1(-t / time); };
  double turned = 0.0;
  for (int j = 0; j < kPredictionSamples; ++j) {
    const double t = (j + 1) * kPredictionStep_s;
    const double middle = faded(t - 0.5 * kPredictionStep_s, params.turn_fade_s);
    tables.gained[j] = params.acceleration_fade_s * (t - faded(t, params.acceleration_fade_s));
    tables.turned[j] = middle - turned;
    turned = middle;
    tables.fading[j] = std::exp(-t / kSurpriseFade_s);
    tables.along[j] = square(params.acceleration_sigma_mps2 * 0.5 * t * t);
    tables.across[j] = square(params.lateral_sigma_mps2 * 0.5 * t * t);
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
  const Tables& tables = tables_.of(history.object_class);
  const Hindsight hindsight = lookBack(history);
  const Outlook outlook =
      outlookAt(history, history.path.size(), {0, kPredictionSamples}, hindsight.growth);
  const Eigen::Vector3d& start = history.path.back().position;
  paths.resize(kModes);
  for (int mode = 0; mode < kModes; ++mode) {
    PredictedPath& path = paths[mode];
    path.mode = mode;
    path.probability = hindsight.probabilities[mode];
    path.points.resize(kPredictionSamples);
    Walk walk(outlook, tables, mode, start.head<2>());
    for (int j = 0; j < kPredictionSamples; ++j) {
      PredictedPoint& point = path.points[j];
      point.horizon_s = (j + 1) * kPredictionStep_s;
      point.position << walk.step(j), start.z();
      point.covariance = outlook.courseOf(mode).covariances[j];
    }
  }
  std::stable_sort(paths.begin(), paths.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
}

MixturePredictor::Outlook MixturePredictor::outlookAt(const MotionHistory& history,
                                                      std::size_t seen, const Span& spread,
                                                      double growth) const {
  const ManoeuvreParams& params = params_.of(history.object_class);
  const Tables& tables = tables_.of(history.object_class);
  const Manoeuvre now = fitManoeuvre(history, seen, params);
  const double moves = square(now.speed) / (square(now.speed) + square(params.cruising_speed_mps));
  const Eigen::Matrix2d start =
      history.position_covariance + square(kMinPositionSigma_m) * Eigen::Matrix2d::Identity();

  Outlook outlook;
  const auto lay = [&](double turn_rate, Course& course) {
    Eigen::Vector2d direction = now.direction;
    for (int j = 0; j < spread.end; ++j) {
      direction = turnedBy(direction, turn_rate * tables.turned[j]);
      course.directions[j] = direction;
      if (j < spread.first) continue;
      const double grows = 1.0 + (growth - 1.0) * tables.fading[j];
      course.covariances[j] =
          start + grows * (square((j + 1) * kPredictionStep_s) * now.velocity_covariance +
                           ellipse(moves * tables.along[j], moves * tables.across[j], direction));
    }
  };
  lay(std::clamp(now.turn_rate, -kMaxTurnRate, kMaxTurnRate), outlook.turning);
  lay(0.0, outlook.straight);
  const double other = moves * params.alternative_mps2;
  outlook.speed = now.speed;
  outlook.accelerations = {now.acceleration, 0.0, now.acceleration - other,
                           now.acceleration + other};
  return outlook;
}

MixturePredictor::Hindsight MixturePredictor::lookBack(const MotionHistory& history) const {
  const auto& path = history.path;
  const Tables& tables = tables_.of(history.object_class);
  const Eigen::Vector2d came = path.back().position.head<2>();
  double squared = 0.0;  // of the first mode
  std::array<double, kModes> likelihoods{};
  int looks = 0;
  std::size_t seen = path.size();
  for (const double ago : kLookBack_s) {
    const double latest = path.back().time - ago + 0.5 * kPredictionStep_s;
    while (seen > 0 && path[seen - 1].time > latest) --seen;
    const double horizon = seen < 2 ? kMaxLookBack_s : path.back().time - path[seen - 1].time;
    if (horizon >= kMaxLookBack_s) break;  // no motion was known, or the object was not seen
    const int samples = static_cast<int>(horizon / kPredictionStep_s) + 1;
    const Outlook outlook = outlookAt(history, seen, {samples - 1, samples}, 1.0);
    for (int mode = 0; mode < kModes; ++mode) {
      Walk walk(outlook, tables, mode, path[seen - 1].position.head<2>());
      const Eigen::Vector2d off = came - walk.to(horizon);
      const Eigen::Matrix2d& covariance = outlook.courseOf(mode).covariances[samples - 1];
      const double error = std::min(off.dot(covariance.inverse() * off), kMaxError);
      likelihoods[mode] -= 0.5 * (error + std::log(covariance.determinant()));
      if (mode == 0) squared += error;
    }
    ++looks;
  }
  if (looks == 0) return {};
  for (double& likelihood : likelihoods) likelihood /= looks;
  return {squared / looks, likelihoods};
}

}  // namespace headway::objects
