// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

namespace headway::objects {

/// Straight motion with the mean velocity of the last window.
class ConstantVelocityPredictor : public Predictor {
 public:
  explicit ConstantVelocityPredictor(const PredictorParams& params) : params_(params) {}
  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  PredictorParams params_;
};

/// Circular motion: constant speed and constant turn rate (CTRV).
///
/// The turn rate comes from the velocities over the last two windows.
class ConstantTurnPredictor : public Predictor {
 public:
  explicit ConstantTurnPredictor(const PredictorParams& params) : params_(params) {}
  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  PredictorParams params_;
};

/// The paper's baseline: a parabola fitted to four past positions five frames apart, extended until
/// its end is at distance d_se from the object (Sec. IV-A).
class PolynomialPredictor : public Predictor {
 public:
  explicit PolynomialPredictor(const PredictorParams& params) : params_(params) {}
  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  PredictorParams params_;
};

}  // namespace headway::objects
