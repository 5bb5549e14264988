#pragma once

#include "consistency.h"
#include "measured_box.h"

namespace headway::objects {

/// Online estimate of a detector's true noise over its configured noise.
///
/// With the right noise the squared Mahalanobis distance of a detection from its expected place is
/// 2 on average (chi-squared). Greater distances raise the scale, smaller ones lower it.
///
/// @see Bar-Shalom et al. 2001, "Estimation with applications to tracking and navigation", 5.4
class NoiseScale {
 public:
  /// @param adaptation  rate at which the scale follows the distances; 0 keeps it at 1
  explicit NoiseScale(double adaptation) : adaptation_(adaptation) {}

  /// Updates the scale by the distance of a detection from its expected place.
  void learn(const ExpectedPlace& expected, const MeasuredBox& detection);

  /// The box with its noise scaled.
  [[nodiscard]] MeasuredBox scaled(MeasuredBox box) const;

  /// Factor on the standard deviations.
  [[nodiscard]] double value() const { return scale_; }

 private:
  double adaptation_;
  double scale_ = 1.0;
};

}  // namespace headway::objects
