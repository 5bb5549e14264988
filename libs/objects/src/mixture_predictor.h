// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

#include <array>

#include "manoeuvre_fit.h"

namespace headway::objects {

/// The default predictor: the current manoeuvre of an object and its alternatives.
///
/// The manoeuvre is fitted to the recent path and extrapolated; turn and acceleration decay with
/// class-dependent times. Besides this most probable path there are three alternatives: the same
/// path at lower speed, at higher speed, and straight on at constant speed. The growth of the
/// uncertainty depends on the class and on the speed.
class MixturePredictor : public Predictor {
 public:
  explicit MixturePredictor(const PredictorParams& params);

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  using Samples = std::array<double, kPredictionSamples>;
  using Spread = std::array<Eigen::Matrix2d, kPredictionSamples>;

  /// Quantities of a class that depend on the horizon only.
  struct Tables {
    Samples gained;  ///< distance gained by an acceleration of 1 that decays [s^2]
    Samples turned;  ///< turn from step to step, for a turn rate of 1 that decays [s]
    Samples along;   ///< variance of unpredicted acceleration, along the path [m^2]
    Samples across;  ///< variance of unpredicted turning, across the path [m^2]
  };

  struct Course;

  [[nodiscard]] static Tables tabulate(const ManoeuvreParams& params);
  /// From errors of position and velocity, for every course [m^2].
  [[nodiscard]] static Spread commonSpread(const Eigen::Matrix2d& place,
                                           const Eigen::Matrix2d& velocity);
  [[nodiscard]] static Course course(const Tables& tables, Eigen::Vector2d direction,
                                     double turn_rate, const Spread& common, double moves);
  /// Fills one path: along the course, with one speed and an acceleration that decays.
  static void walk(const MotionHistory& history, const Tables& tables, const Course& course,
                   double speed, double acceleration, PredictedPath& path);

  PerClass<ManoeuvreParams> params_;
  PerClass<Tables> tables_;
};

}  // namespace headway::objects
