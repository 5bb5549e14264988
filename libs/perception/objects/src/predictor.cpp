// SPDX-License-Identifier: BSD-3-Clause
// Prediction of an object's path: the mixture of manoeuvres, the default; parameters and choice of
// the predictor.
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/objects/predictor.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "paper_predictors.h"
#include "recent_motion.h"

namespace headway::objects {
namespace {

/// Current motion of an object, estimated from its recent path.
struct Manoeuvre {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();           ///< of the velocity, unit length
  double speed = 0.0;                                             ///< [m/s]
  double acceleration = 0.0;                                      ///< along the path [m/s^2]
  double turn_rate = 0.0;                                         ///< [rad/s]
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();  ///< [m^2/s^2]
};

// Weighted moments of the first `seen` positions about the last of them, and of time.
struct Moments {
  double t1 = 0.0;                      // of v
  double t2 = 0.0, t3 = 0.0, t4 = 0.0;  // of v * v, v * a and a * a in the normal equations
  Eigen::Vector2d dt1 = Eigen::Vector2d::Zero();
  Eigen::Vector2d dt2 = Eigen::Vector2d::Zero();

  Moments(const std::vector<TrajectoryPoint>& path, std::size_t seen, double memory_s) {
    const TrajectoryPoint& now = path[seen - 1];
    const double rate = 1.0 / memory_s;
    for (std::size_t i = seen - 1; i-- > 0;) {
      const double t = path[i].time - now.time;
      const double freshness = 1.0 + t * rate;
      if (freshness <= 0.0 && i + 2 < seen) break;  // the last step is always used
      const double weight = std::max(freshness * freshness, kMinWeight);
      const double half_square = 0.5 * t * t;
      const Eigen::Vector2d offset = (path[i].position - now.position).head<2>();
      t1 += weight * t;
      t2 += weight * t * t;
      t3 += weight * t * half_square;
      t4 += weight * half_square * half_square;
      dt1 += weight * t * offset;
      dt2 += weight * half_square * offset;
    }
  }

 private:
  static constexpr double kMinWeight = 1e-3;
};

// The fit along one axis.
struct AxisFit {
  double velocity = 0.0;      // [m/s]
  double acceleration = 0.0;  // [m/s^2]
  double variance = 0.0;      // of the velocity, from the noise of the places before and the prior
  double gain = 0.0;          // by which an error of the newest place becomes one of velocity [1/s]

  // `noise` is the variance of a place; the prior is given by typical speed and acceleration.
  AxisFit(const Moments& m, double dt1, double dt2, double noise, double speed,
          double typical_acceleration_mps2) {
    const double a = m.t2 + noise / square(speed);
    const double c = m.t4 + noise / square(typical_acceleration_mps2);
    const double determinant = a * c - m.t3 * m.t3;
    velocity = (c * dt1 - m.t3 * dt2) / determinant;
    acceleration = (a * dt2 - m.t3 * dt1) / determinant;
    variance = noise * c / determinant;
    gain = (0.5 * m.t3 * m.t2 - c * m.t1) / determinant;
  }
};

/// A parabola through the newest position, fitted to the path before it.
struct ParabolaFit {
  Eigen::Vector2d ahead = Eigen::Vector2d::UnitX();        ///< of the path so far, unit length
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();      ///< [m/s]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< [m/s^2]
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();
};

/// Least squares with weights that decrease with age, and with typical values of the class as a
/// prior, which limits accelerations and turns to those significant against the noise. The
/// covariance of the velocity contains the error of the newest position, which rotates the parabola
/// that passes through it, the errors of the earlier positions, and the prior.
///
/// @param seen   number of the first positions that are used, at least one
/// @param noise  variance of a position [m^2]
ParabolaFit fitParabola(const MotionHistory& history, std::size_t seen, double memory_s,
                        double noise, const ManoeuvreParams& params) {
  const MotionGroup group = motionGroupOf(history.object_class);
  const Moments m(history.path, seen, memory_s);
  ParabolaFit result;
  result.ahead = unitOr(m.dt1, Eigen::Vector2d::UnitX());
  const Eigen::Vector2d left(-result.ahead.y(), result.ahead.x());
  const auto fit = [&](const Eigen::Vector2d& axis, double typical_acceleration_mps2) {
    return AxisFit(m, m.dt1.dot(axis), m.dt2.dot(axis), noise, params.typical_speed_mps.of(group),
                   typical_acceleration_mps2);
  };
  const AxisFit along = fit(result.ahead, params.typical_acceleration_mps2.of(group));
  const AxisFit across = fit(left, params.typical_lateral_mps2.of(group));
  result.velocity = along.velocity * result.ahead + across.velocity * left;
  result.acceleration = along.acceleration * result.ahead + across.acceleration * left;
  Eigen::Matrix2d axes;
  axes << result.ahead, left;
  const Eigen::Matrix2d gain =
      axes * Eigen::Vector2d(along.gain, across.gain).asDiagonal() * axes.transpose();
  result.velocity_covariance =
      gain * history.position_covariance * gain +
      axes * Eigen::Vector2d(along.variance, across.variance).asDiagonal() * axes.transpose();
  return result;
}

/// Mean squared distance of a path from a parabola, with the weights of its fit [m^2].
double misfitOf(const ParabolaFit& fit, const std::vector<TrajectoryPoint>& path, std::size_t seen,
                double memory_s) {
  const TrajectoryPoint& now = path[seen - 1];
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = seen - 1; i-- > 0;) {
    const double t = path[i].time - now.time;
    const double freshness = 1.0 + t / memory_s;
    if (freshness <= 0.0) break;
    const Eigen::Vector2d off = (path[i].position - now.position).head<2>() - t * fit.velocity -
                                0.5 * t * t * fit.acceleration;
    sum += square(freshness) * off.squaredNorm();
    weights += square(freshness);
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

struct Forgetting {
  double misfit = 0.25;  ///< that a parabola may leave, of a position's variance
  double shorter = 0.7;  ///< ratio of the next shorter past
};
constexpr Forgetting kForgetting;

/// The motion at the last of the first `seen` positions, as it was known then: a parabola over as
/// long a past as one fits, so that who walks on is measured precisely and who has turned is not
/// measured by where he came from. Low speeds are reduced, since they may be noise of a static
/// object, and what stands may set off.
Manoeuvre fitManoeuvre(const MotionHistory& history, std::size_t seen,
                       const ManoeuvreParams& params) {
  const MotionGroup group = motionGroupOf(history.object_class);
  const double noise =
      square(params.path_noise_m.of(group)) + 0.5 * history.position_covariance.trace();
  double memory_s = params.memory_s.of(group);
  ParabolaFit fit = fitParabola(history, seen, memory_s, noise, params);
  while (memory_s > params.shortest_memory_s.of(group) &&
         misfitOf(fit, history.path, seen, memory_s) > kForgetting.misfit * noise) {
    memory_s = std::max(kForgetting.shorter * memory_s, params.shortest_memory_s.of(group));
    fit = fitParabola(history, seen, memory_s, noise, params);
  }
  Manoeuvre result;
  result.velocity_covariance = fit.velocity_covariance;
  const double speed = fit.velocity.norm();
  result.direction = unitOr(fit.velocity, fit.ahead);
  const double fourth = square(square(speed));
  const double moves = fourth / (fourth + square(square(params.standing_speed_mps.of(group))));
  result.velocity_covariance +=
      (1.0 - moves) * square(params.setting_off_mps.of(group)) * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d& d = result.direction;
  result.speed = moves * speed;
  result.acceleration = moves * fit.acceleration.dot(d);
  if (speed > kMinTurningSpeed_mps) {
    result.turn_rate =
        moves * (d.x() * fit.acceleration.y() - d.y() * fit.acceleration.x()) / speed;
  }
  return result;
}

/// The paths: the manoeuvre continued, straight on at constant speed, braking, and gaining speed.
enum Mode { kContinued, kStraightOn, kSlower, kFaster, kModes };
using Samples = std::array<double, kPredictionSamples>;

/// Quantities of a class that depend on the horizon only.
struct Tables {
  Samples gained;  ///< distance gained by an acceleration of 1 that decays [s^2]
  Samples turned;  ///< turn from step to step, for a turn rate of 1 that decays [s]
  Samples along;   ///< variance of unpredicted acceleration, along the path [m^2]
  Samples across;  ///< variance of unpredicted turning, across the path [m^2]
  Samples fading;  ///< of what surprises have added to the growth of covariances [-]
};

/// Samples whose covariances are wanted.
struct Span {
  int first = 0, end = 0;
};

// Frequency at which each path was the nearest to the true one, rounded: on 9,849 exact histories
// of KITTI's 19 tracking sequences (headway-eval predictions).
constexpr std::array<double, kModes> kProbabilities = {0.55, 0.25, 0.1, 0.1};
constexpr double kMinPositionSigma_m = 0.03;
constexpr double kMaxTurnRate = 3.0;  // [rad/s]

// How long ago predictions are looked back at, and how much it counts. Errors at the
// three times are nearly the same, so their likelihoods count as less than one.
constexpr std::array<double, 3> kLookBack_s = {0.3, 0.6, 1.0};
constexpr double kMaxLookBack_s = 1.5;  // at low frame rates
constexpr double kLikelihoodWeight = 0.25;
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

/// The directions that a path takes step by step, and the spread about it.
struct Course {
  std::array<Eigen::Vector2d, kPredictionSamples> directions;
  std::array<Eigen::Matrix2d, kPredictionSamples> covariances;  ///< [m^2]
};

/// The paths from one position. All but one take the turning course.
struct PredictedMotion {
  Course turning, straight;
  double speed = 0.0;                          ///< [m/s]
  std::array<double, kModes> accelerations{};  ///< of each mode [m/s^2]

  [[nodiscard]] const Course& courseOf(int mode) const {
    return mode == kStraightOn ? straight : turning;
  }
};

/// Moves along one path of a predicted motion step by step.
class Rollout {
 public:
  Rollout(const PredictedMotion& motion, const Tables& tables, int mode,
          const Eigen::Vector2d& start)
      : course_(motion.courseOf(mode)),
        tables_(tables),
        speed_(motion.speed),
        acceleration_(motion.accelerations[mode]),
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
    if (distance > travelled_) {  // a braking object stops; it does not roll back
      position_ += (distance - travelled_) * course_.directions[j];
      travelled_ = distance;
    }
    return position_;
  }

 private:
  const Course& course_;
  const Tables& tables_;
  double speed_, acceleration_;
  double travelled_ = 0.0;  // [m]
  Eigen::Vector2d position_;
};

/// What follows from earlier predictions and what came.
struct LookBack {
  double growth = 1.0;  ///< factor of what covariances grow by
  std::array<double, kModes> probabilities = kProbabilities;

  LookBack() = default;
  /// @param squared      mean squared error of the first mode, in standard deviations
  /// @param likelihoods  mean log-likelihood of what came by each mode
  LookBack(double squared, const std::array<double, kModes>& likelihoods)
      : growth((2.0 + squared) /
               (2.0 + 2.0))  // expected: 2, by chi-square with 2 degrees of freedom
  {
    double sum = 0.0;
    for (int mode = 0; mode < kModes; ++mode) {
      probabilities[mode] *=
          std::exp(kLikelihoodWeight * (likelihoods[mode] - likelihoods[kContinued]));
      sum += probabilities[mode];
    }
    for (double& probability : probabilities) probability /= sum;
  }
};

/// The default predictor: the current manoeuvre of an object and its alternatives.
///
/// The manoeuvre is fitted to the recent path and extrapolated; turn and acceleration decay with
/// class-dependent times. Besides this path there are three alternatives: the same path at lower
/// speed, at higher speed, and straight on at constant speed. The growth of the uncertainty depends
/// on the class and on the speed.
///
/// What it would have predicted at positions up to a second ago is compared with what came since:
/// paths that were nearer become more probable, and the uncertainty of an object grows faster the
/// more it has surprised, which fades with the horizon.
class MixturePredictor : public Predictor {
 public:
  explicit MixturePredictor(const PredictorParams& params)
      : params_(params.manoeuvres),
        tables_{tabulate(MotionGroup::kVehicle), tabulate(MotionGroup::kCyclist),
                tabulate(MotionGroup::kPedestrian)} {}

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override {
    if (history.path.empty()) return paths.clear();
    const Tables& tables = tables_.of(history.object_class);
    const LookBack look_back = lookBack(history);
    const PredictedMotion motion =
        motionAt(history, history.path.size(), {0, kPredictionSamples}, look_back.growth);
    const Eigen::Vector3d& start = history.path.back().position;
    paths.resize(kModes);
    for (int mode = 0; mode < kModes; ++mode) {
      PredictedPath& path = paths[mode];
      path.mode = mode;
      path.probability = look_back.probabilities[mode];
      path.points.resize(kPredictionSamples);
      Rollout rollout(motion, tables, mode, start.head<2>());
      for (int j = 0; j < kPredictionSamples; ++j) {
        PredictedPoint& point = path.points[j];
        point.horizon_s = (j + 1) * kPredictionStep_s;
        point.position << rollout.step(j), start.z();
        point.covariance = motion.courseOf(mode).covariances[j];
      }
    }
    std::stable_sort(paths.begin(), paths.end(),
                     [](const auto& a, const auto& b) { return a.probability > b.probability; });
  }

 private:
  [[nodiscard]] Tables tabulate(MotionGroup group) const {
    Tables tables;
    const auto faded = [](double t, double time) { return -time * std::expm1(-t / time); };
    double turned = 0.0;
    for (int j = 0; j < kPredictionSamples; ++j) {
      const double t = (j + 1) * kPredictionStep_s;
      const double middle = faded(t - 0.5 * kPredictionStep_s, params_.turn_fade_s.of(group));
      tables.gained[j] = params_.acceleration_fade_s.of(group) *
                         (t - faded(t, params_.acceleration_fade_s.of(group)));
      tables.turned[j] = middle - turned;
      turned = middle;
      tables.fading[j] = std::exp(-t / kSurpriseFade_s);
      tables.along[j] = square(params_.acceleration_sigma_mps2.of(group) * 0.5 * t * t);
      tables.across[j] = square(params_.lateral_sigma_mps2.of(group) * 0.5 * t * t);
    }
    return tables;
  }

  /// The paths as predicted at the last of the first `seen` positions, up to the end of `spread`.
  ///
  /// @param growth  factor of what covariances grow by
  [[nodiscard]] PredictedMotion motionAt(const MotionHistory& history, std::size_t seen,
                                         const Span& spread, double growth) const {
    const MotionGroup group = motionGroupOf(history.object_class);
    const Tables& tables = tables_.of(history.object_class);
    const Manoeuvre now = fitManoeuvre(history, seen, params_);
    const double moves =
        square(now.speed) / (square(now.speed) + square(params_.cruising_speed_mps.of(group)));
    const Eigen::Matrix2d start =
        history.position_covariance + square(kMinPositionSigma_m) * Eigen::Matrix2d::Identity();

    PredictedMotion motion;
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
    lay(std::clamp(now.turn_rate, -kMaxTurnRate, kMaxTurnRate), motion.turning);
    lay(0.0, motion.straight);
    const double other = moves * params_.alternative_mps2.of(group);
    motion.speed = now.speed;
    motion.accelerations = {now.acceleration, 0.0, now.acceleration - other,
                            now.acceleration + other};
    return motion;
  }

  [[nodiscard]] LookBack lookBack(const MotionHistory& history) const {
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
      const PredictedMotion motion = motionAt(history, seen, {samples - 1, samples}, 1.0);
      for (int mode = 0; mode < kModes; ++mode) {
        Rollout rollout(motion, tables, mode, path[seen - 1].position.head<2>());
        const Eigen::Vector2d off = came - rollout.to(horizon);
        const Eigen::Matrix2d& covariance = motion.courseOf(mode).covariances[samples - 1];
        const double error = std::min(off.dot(covariance.inverse() * off), kMaxError);
        likelihoods[mode] -= 0.5 * (error + std::log(covariance.determinant()));
        if (mode == kContinued) squared += error;
      }
      ++looks;
    }
    if (looks == 0) return {};
    for (double& likelihood : likelihoods) likelihood /= looks;
    return {squared / looks, likelihoods};
  }

  ManoeuvreParams params_;
  PerClass<Tables> tables_;
};

}  // namespace

void PaperPredictorParams::describe(Params::Section section) {
  section.add("paper_tangent_weight", tangent_weight, 0.0, 1.0, "",
              "w1: weight of the path's direction in the head direction V_h");
  section.add("paper_heading_weight", heading_weight, 0.0, 1.0, "",
              "w2: weight of the detected heading in the head direction V_h");
  section.add("paper_heading_limit_rad", heading_limit_rad, 0.0, 3.15, "rad",
              "tau_theta: maximum angle of a detected heading to the path's direction");
  section.add("paper_straight_limit_rad", straight_limit_rad, 0.0, 3.15, "rad",
              "tau_alpha: angle between V_h and V_p below which the path is straight");
  section.add("paper_recent_weight", recent_weight, -10.0, 10.0, "",
              "w3: weight of the recent direction in the prediction direction V_p");
  section.add("paper_older_weight", older_weight, -10.0, 10.0, "",
              "w4: weight of the older direction in the prediction direction V_p");
  section.add("paper_spacing_s", spacing_s, 0.05, 10.0, "s",
              "Time between the three positions that give V_p");
  section.add("paper_speed_time_s", speed_time_s, 0.0, 20.0, "s",
              "h: time over which the speed is averaged, of one step at least, eq. (1)");
  section.renamed("paper_speed_samples", "paper_speed_time_s", secondsOfFrames);
  section.add("paper_speed_factor", speed_factor, 0.1, 10.0, "", "gamma of eq. (1)");
  section.add("paper_epsilon_s", epsilon_s, 0.0, 0.1, "s", "epsilon of eq. (1)");
}

void ManoeuvreParams::describe(Params::Section section, const std::string& prefix,
                               double Values::*of) {
  section.add(prefix + "memory_s", memory_s.*of, 0.1, 100.0, "s",
              "Age beyond which positions have no weight in the fit of the motion");
  section.add(prefix + "shortest_memory_s", shortest_memory_s.*of, 0.1, 100.0, "s",
              "The same for an object that has just changed its motion");
  section.add(prefix + "path_noise_m", path_noise_m.*of, 0.001, 10.0, "m",
              "Deviation of exactly known paths from a parabola");
  section.add(prefix + "typical_speed_mps", typical_speed_mps.*of, 0.01, 1000.0, "m/s",
              "Prior of the speed, for short paths");
  section.add(prefix + "typical_acceleration_mps2", typical_acceleration_mps2.*of, 1e-3, 100.0,
              "m/s^2", "Prior of the acceleration along the path");
  section.add(prefix + "typical_lateral_mps2", typical_lateral_mps2.*of, 1e-3, 100.0, "m/s^2",
              "Prior of the acceleration across the path");
  section.add(prefix + "acceleration_fade_s", acceleration_fade_s.*of, 0.05, 1000.0, "s",
              "Decay time of an acceleration");
  section.add(prefix + "turn_fade_s", turn_fade_s.*of, 0.05, 1000.0, "s", "Decay time of a turn");
  section.add(prefix + "standing_speed_mps", standing_speed_mps.*of, 0.001, 10.0, "m/s",
              "Speed below which motion may be noise of a stationary object");
  section.add(prefix + "setting_off_mps", setting_off_mps.*of, 0.0, 10.0, "m/s",
              "Unpredicted velocity of a stationary object, which may set off");
  section.add(prefix + "cruising_speed_mps", cruising_speed_mps.*of, 0.001, 50.0, "m/s",
              "Speed above which an object manoeuvres freely");
  section.add(prefix + "alternative_mps2", alternative_mps2.*of, 0.0, 20.0, "m/s^2",
              "Acceleration of the faster and of the slower alternative");
  section.add(prefix + "acceleration_sigma_mps2", acceleration_sigma_mps2.*of, 0.0, 20.0, "m/s^2",
              "Unpredicted acceleration along the path");
  section.add(prefix + "lateral_sigma_mps2", lateral_sigma_mps2.*of, 0.0, 20.0, "m/s^2",
              "Unpredicted acceleration across the path");
}

void PredictorParams::describe(Params::Section section) {
  paper.describe(section);
  section.add("velocity_window_s", velocity_window_s, 0.05, 5.0, "s",
              "Time over which constant_velocity and constant_turn estimate the velocity");
  manoeuvres.describe(section, "vehicle_", &PerClass<double>::vehicle);
  manoeuvres.describe(section, "cyclist_", &PerClass<double>::cyclist);
  manoeuvres.describe(section, "pedestrian_", &PerClass<double>::pedestrian);
}

const std::vector<std::string>& predictorNames() {
  static const std::vector<std::string> names = {"paper",         "paper_dm",   "paper_hd",
                                                 "paper_sv",      "polynomial", "constant_velocity",
                                                 "constant_turn", "mixture"};
  return names;
}

PredictorKind predictorKindFrom(const std::string& name) {
  const auto& names = predictorNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string known;
    for (const std::string& other : names) known += (known.empty() ? "" : "|") + other;
    throw InputError("no predictor is called '" + name + "': choose one of " + known);
  }
  return static_cast<PredictorKind>(found - names.begin());
}

std::unique_ptr<Predictor> makePredictor(PredictorKind kind, const PredictorParams& params) {
  params.validate();
  if (kind == PredictorKind::kMixture) return std::make_unique<MixturePredictor>(params);
  return makePaperPredictor(kind, params);
}

}  // namespace headway::objects
