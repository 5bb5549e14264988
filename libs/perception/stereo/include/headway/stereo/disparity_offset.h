// SPDX-License-Identifier: BSD-3-Clause
// The offset of all disparities by a yaw of the right camera, where the poses are recorded.
#pragma once

#include <headway/core/statistics.h>

#include <cmath>
#include <vector>

namespace headway::stereo {

/// A calibration rectifies a pair to about so much in its disparities: the standard deviation of
/// their offset before anything is measured [px].
inline constexpr double kRectificationSigma_px = 0.5;

/// Ratio of the information of a frame's points that counts: they share the errors of its images.
inline constexpr double kIndependentRatio = 0.05;

/// What the observations of one static point from known camera poses tell about the disparities'
/// offset, with the point's position marginalised out.
struct OffsetEvidence {
  double information = 0.0;  ///< inverse variance [1/px^2]
  double gradient = 0.0;     ///< information times the offset [1/px]
  double fit = 1.0;          ///< squared error per degree of freedom, in sigmas squared
};

/// The offset of the disparities, measured less true, as many observations together tell it.
struct OffsetEstimate {
  double px = 0.0;
  double sigma_px = 0.0;  ///< of independent observations; always positive
};

/// Estimates the offset of the disparities, measured less true, where camera poses are known.
///
/// Rectification that is off by a small angle, or images that were not taken at the same instant
/// in a turn, shift all disparities alike: near and far points then contradict each other on the
/// camera's speed. Estimated as a slow random walk. SLAM estimates poses and offset together, in
/// its bundle adjustment; this is for recordings that contain poses.
class DisparityOffset {
 public:
  /// @param static_points  of one frame; empty: no change
  /// @param seconds        since the frame before
  void update(const std::vector<OffsetEvidence>& static_points,
              double seconds = 1.0 / FrameRate::kAssumed_hz);

  [[nodiscard]] double value() const { return value_; }  ///< measured less true disparity [px]
  [[nodiscard]] OffsetEstimate estimate() const { return {value_, std::sqrt(variance_)}; }

  /// Disparities are less by so much from now on, as their cause is corrected [px].
  void subtract(double offset_px) { value_ -= offset_px; }

 private:
  double value_ = 0.0;
  double variance_ = kRectificationSigma_px * kRectificationSigma_px;  ///< [px^2]
};

}  // namespace headway::stereo
