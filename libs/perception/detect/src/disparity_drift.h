// SPDX-License-Identifier: BSD-3-Clause
// Drift of disparities that neighbouring points share, as patches of the static scene show it.
#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <vector>

#include "camera_path.h"
#include "point_motion.h"

namespace headway::detect {

/// Drift of an object's disparity while its motion is observed, assumed of every camera [px].
inline constexpr double kCommonDisparity_px = 0.2;

/// Errors of disparities that the points of an object share and that last: they average out neither
/// over its points nor over the frames that a velocity is fitted to.
///
/// Depth cameras match blocks and filter in time, colour and depth do not coincide, rows are
/// exposed one after the other, the camera's motion is not exact. All of it makes a static patch of
/// an object's size move along the line of sight. How fast patches seem to move, beyond what the
/// noise of single points and the drift assumed explain, is therefore measured all the time, by
/// disparity: a low quantile over the patches, so that objects that move have little effect. Those
/// found are left out.
///
/// The drift of a disparity is a random walk, so that its variance grows with the time.
class DisparityDrift {
 public:
  DisparityDrift();

  /// @param points       with the motions fitted to their newest observations
  /// @param noise_scale  true errors of single observations over those assumed [-]
  void update(const std::vector<PointTrack>& points, const CameraPath& path,
              const StereoCamera& camera, double noise_scale);

  /// Standard deviation of what is more than assumed, in a second, at a disparity [px].
  [[nodiscard]] double at(double disparity) const;

  /// What it adds to the covariance of a velocity, in the world of the path [m^2/s^2].
  ///
  /// @param uvd      newest observation of the point or object [px]
  /// @param seconds  that its velocity was fitted over
  [[nodiscard]] Eigen::Matrix3d velocityCovariance(const Eigen::Vector3d& uvd, double seconds,
                                                   const CameraPath& path,
                                                   const StereoCamera& camera) const;

 private:
  static constexpr std::size_t kOctaves = 9;  ///< of disparity: 1 ... 512 px
  std::array<double, kOctaves> log_variances_;
};

}  // namespace headway::detect
