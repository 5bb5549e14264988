// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "consistency.h"
#include "measured_box.h"

namespace headway::objects {

/// Online estimate of the ratio of a detector's true noise to its configured noise.
///
/// With correct noise the mean squared Mahalanobis distance of a detection from its prediction is 2
/// (chi-squared). Larger distances increase the scale, smaller ones decrease it.
///
/// @see Bar-Shalom et al. 2001, "Estimation with applications to tracking and navigation", 5.4
class NoiseScale {
 public:
  /// @param adaptation  rate at which the scale follows the distances; 0 keeps it at 1
  explicit NoiseScale(double adaptation) : adaptation_(adaptation) {}

  /// Updates the scale by the distance of a detection from its prediction.
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
