#pragma once

#include <headway/objects/predictor.h>

namespace headway::objects {

/// Damped manoeuvres: speed change and turn go on as measured, and fade with time.
class MixturePredictor : public Predictor {
 public:
  explicit MixturePredictor(const PredictorParams& params) : params_(params) {}
  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  PredictorParams params_;
};

}  // namespace headway::objects
