// SPDX-License-Identifier: BSD-3-Clause
// Registration of colour and depth images, by the edges of both.
#pragma once

#include <headway/core/stereo_frame.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace headway::import {

/// Motion of depth images that brings their edges onto those of colour images.
struct Registration {
  /// Right and down, of the depth camera [m]; and growth about the principal point [-].
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

/// Compares contours of near surfaces in depth images with edges of the colour images that they are
/// registered to.
///
/// A shift of the cameras moves contours by f t / z px, a wrong lens by a ratio of their distance
/// from the principal point, and the fringe of depth images outwards on all sides. The sum of the
/// colour's gradients at the contours so moved is greatest where all three are right. Its spread is
/// that of resampled frames (Efron 1979, bootstrap), and a pixel of what depth images err.
class RegistrationCheck {
 public:
  /// Takes a frame of a depth camera.
  void add(const StereoFrame& frame);
  /// nullopt with too few contours.
  [[nodiscard]] std::optional<Registration> result() const;

 private:
  /// Sums over the contours of one frame, by shift, growth and fringe.
  struct Sums {
    std::vector<float> across, down;
    std::size_t contours = 0;
  };
  [[nodiscard]] static std::optional<Eigen::Vector3d> best(const std::vector<const Sums*>& frames);

  std::vector<Sums> frames_;
  std::vector<double> depths_;  ///< of contours, median of each frame [m]
  double focal_px_ = 0.0;
  double width_px_ = 0.0;
};

}  // namespace headway::import
