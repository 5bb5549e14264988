// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

#include <array>
#include <cstddef>

#include "manoeuvre_fit.h"

namespace headway::objects {

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
  explicit MixturePredictor(const PredictorParams& params);

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  static constexpr int kModes = 4;
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

  struct Course;
  struct Outlook;
  class Walk;
  struct Hindsight;

  [[nodiscard]] static Tables tabulate(const ManoeuvreParams& params);
  /// The paths as predicted at the last of the first `seen` positions, up to the end of `spread`.
  ///
  /// @param growth  factor of what covariances grow by
  [[nodiscard]] Outlook outlookAt(const MotionHistory& history, std::size_t seen,
                                  const Span& spread, double growth) const;
  [[nodiscard]] Hindsight lookBack(const MotionHistory& history) const;

  PerClass<ManoeuvreParams> params_;
  PerClass<Tables> tables_;
};

}  // namespace headway::objects
