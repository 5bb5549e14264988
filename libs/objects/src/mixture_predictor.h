#pragma once

#include <headway/objects/predictor.h>

#include <array>

#include "manoeuvre_fit.h"

namespace headway::objects {

/// The default predictor: what the object does now, and what it may do instead.
///
/// Its manoeuvre is fitted to the recent path and goes on, fading with class-dependent times
/// (damped turning and speeding). Beside that most probable future stand three others: the same
/// path more slowly, the same path faster, and steadily straight on. How fast the uncertainty
/// grows depends on the class and on whether the object moves at all.
class MixturePredictor : public Predictor {
 public:
  explicit MixturePredictor(const PredictorParams& params);

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  using Samples = std::array<double, kPredictionSamples>;
  using Spread = std::array<Eigen::Matrix2d, kPredictionSamples>;

  /// What of a class depends on the horizon alone.
  struct Tables {
    Samples gained;  ///< distance gained by an acceleration of 1 that fades [s^2]
    Samples turned;  ///< turn from step to step, for a turn rate of 1 that fades [s]
    Samples along;   ///< variance from unforeseen speeding, along the path [m^2]
    Samples across;  ///< variance from unforeseen turning, across the path [m^2]
  };

  struct Course;

  [[nodiscard]] static Tables tabulate(const ManoeuvreParams& params);
  /// Of an error of place and one of velocity, whatever the course [m^2].
  [[nodiscard]] static Spread commonSpread(const Eigen::Matrix2d& place,
                                           const Eigen::Matrix2d& velocity);
  [[nodiscard]] static Course course(const Tables& tables, Eigen::Vector2d direction,
                                     double turn_rate, const Spread& common, double moves);
  /// Fills one path: along the course, with one speed and an acceleration that fades.
  static void walk(const MotionHistory& history, const Tables& tables, const Course& course,
                   double speed, double acceleration, PredictedPath& path);

  PerClass<ManoeuvreParams> params_;
  PerClass<Tables> tables_;
};

}  // namespace headway::objects
