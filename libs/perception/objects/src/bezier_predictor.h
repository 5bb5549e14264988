// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

#include <cmath>

namespace headway::objects {

/// The paper's predictor: a quadratic Bezier curve from the heading and the recent path
/// (Sec. III-B), and its ablations of Table II.
class BezierPredictor : public Predictor {
 public:
  /// Parts that an ablation replaces.
  struct Ablation {
    bool distance_is_length = false;  ///< DM: d_se = |C_p| for every angle
    bool detected_heading = false;    ///< HD: V_h is the detected heading only
    bool instant_speed = false;       ///< SV: the speed of the last step, not smoothed
  };

  BezierPredictor(const PredictorParams& params, const Ablation& ablation)
      : params_(params),
        ablation_(ablation),
        min_cosine_(std::cos(params.paper.heading_limit_rad)) {}

  void predictInto(const MotionHistory& history, std::vector<PredictedPath>& paths) const override;

 private:
  [[nodiscard]] Eigen::Vector2d headDirection(const MotionHistory& history) const;
  [[nodiscard]] Eigen::Vector2d predictionDirection(const MotionHistory& history,
                                                    const Eigen::Vector2d& fallback) const;
  [[nodiscard]] double endDistance(double curve_length, double alpha) const;

  PredictorParams params_;
  Ablation ablation_;
  double min_cosine_;  ///< of the angle tau_theta
};

/// Speed smoothed over the last `samples` steps, eq. (1) with j = k-h ... k-1 [m/s].
[[nodiscard]] double smoothedSpeed(const std::vector<TrajectoryPoint>& path, int samples,
                                   const PaperPredictorParams& params);

/// d_se of an arc whose chord is at the angle alpha to its tangent, eq. (3) [m].
///
/// Eq. (3) is |C| sin(alpha) / alpha, with the limit |C|, eq. (2), for alpha = 0.
[[nodiscard]] double chordOfArc(double arc_length, double alpha);

}  // namespace headway::objects
