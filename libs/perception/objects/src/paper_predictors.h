// SPDX-License-Identifier: BSD-3-Clause
// The paper's predictor, its ablations and baselines; each predicts a single path.
#pragma once

#include <headway/objects/predictor.h>

#include <Eigen/Core>
#include <array>
#include <memory>

namespace headway::objects {

/// Quadratic Bezier curve on the ground plane, eq. (4) of the paper, at constant speed.
///
/// at() takes the fraction of the arc length, not the curve's own parameter.
class BezierCurve {
 public:
  /// @param start, control, end  [m]
  BezierCurve(const Eigen::Vector2d& start, const Eigen::Vector2d& control,
              const Eigen::Vector2d& end);

  /// Arc length [m].
  [[nodiscard]] double length() const { return length_; }

  /// Point at a fraction of the arc length, 0 ... 1 [m].
  [[nodiscard]] Eigen::Vector2d at(double fraction) const {
    const double t = parameterAt(fraction);
    return start_ + t * (linear_ + t * quadratic_);
  }

  /// Derivative with respect to the curve's parameter there: along the path, not of unit length.
  [[nodiscard]] Eigen::Vector2d tangentAt(double fraction) const {
    return linear_ + 2.0 * parameterAt(fraction) * quadratic_;
  }

  /// The curve's parameter at a fraction of the arc length.
  [[nodiscard]] double parameterAt(double fraction) const {
    if (!tabulated_) {
      const auto& c = inverse_;
      return fraction *
             (c[0] + fraction * (c[1] + fraction * (c[2] + fraction * (c[3] + fraction * c[4]))));
    }
    return tabulatedParameterAt(fraction);
  }

 private:
  static constexpr int kTableSize = 32;

  [[nodiscard]] double speedAt(double t) const { return (linear_ + 2.0 * t * quadratic_).norm(); }
  [[nodiscard]] double tabulatedParameterAt(double fraction) const;
  void fitInverse();
  void tabulate();

  Eigen::Vector2d start_;
  Eigen::Vector2d linear_;
  Eigen::Vector2d quadratic_;
  double length_ = 0.0;
  bool tabulated_ = false;
  std::array<double, 5> inverse_ = {
      1.0, 0.0, 0.0, 0.0,
      0.0};  ///< of the parameter as a polynomial of the fraction, from degree 1
  std::array<double, kTableSize + 1> table_;  ///< fraction of the arc length at t = i / kTableSize
};

/// Speed smoothed over the steps of the last `window_s`, the last one at least, eq. (1) with
/// j = k-h ... k-1 [m/s].
[[nodiscard]] double smoothedSpeed(const std::vector<TrajectoryPoint>& path, double window_s,
                                   const PaperPredictorParams& params);

/// d_se of an arc whose chord is at the angle alpha to its tangent, eq. (3) [m].
///
/// Eq. (3) is |C| sin(alpha) / alpha, with the limit |C|, eq. (2), for alpha = 0.
[[nodiscard]] double chordOfArc(double arc_length, double alpha);

/// The paper's predictor (Sec. III-B), its ablations of Table II, and the baselines it is compared
/// with: each predicts a single path.
///
/// @param kind  any but kMixture
[[nodiscard]] std::unique_ptr<Predictor> makePaperPredictor(PredictorKind kind,
                                                            const PredictorParams& params);

}  // namespace headway::objects
