// SPDX-License-Identifier: BSD-3-Clause
// Depth, size and heading of 2D boxes by stereo.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/object_class.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace headway::detect {

/// How large objects of a class usually are.
struct ClassSize {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< (length, width, height) [m]
  double spread = 0.1;  ///< standard deviation of the height, ratio to it [-]
};

inline constexpr double kMaxVanHeight_m =
    2.75;  ///< trucks are higher; a panel van with a high roof

/// What is known of a class's size; nullopt for Unknown and Misc, which may be anything.
///
/// @see  Geiger et al. 2012: means over the boxes of the KITTI benchmark
[[nodiscard]] std::optional<ClassSize> classSize(ObjectClass object_class);

/// Depth of what a 2D box was drawn around.
struct SurfaceDepth {
  double disparity = 0.0;  ///< of the visible surface [px]
  double sigma = 0.0;      ///< its standard deviation [px]
  int cells = 0;           ///< that agree with it; 0: derived from the box's height alone
};

/// A 3D box found behind a 2D one.
struct LiftedBox {
  Box3d box;                                                        ///< sensor's optical frame
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< optical frame [m^2]
};

/// Gives the 2D boxes of one frame their depth, size and heading by stereo.
///
/// Depth is that of the visible surface, size the class's usual one with the height
/// that the box shows, heading that of the visible side; front and back cannot be told apart, so
/// the front is taken to look away from the camera. Boxes are those of the frame's left image.
///
///     StereoLifter lifter(frame, params);
///     liftAll(detections, lifter);
///     tracker.update(index, pose, detections);
class StereoLifter {
 public:
  /// Matches the frame densely, once.
  StereoLifter(const StereoFrame& frame, const stereo::DisparityParams& params);

  /// Takes what another step found already.
  StereoLifter(std::shared_ptr<const StereoCamera> camera, stereo::DisparityImage disparity,
               std::optional<stereo::GroundPlane> ground);

  /// nullopt for a box that is not finite, hardly overlaps the image, or whose depth follows
  /// neither from stereo nor from its class's size.
  [[nodiscard]] std::optional<LiftedBox> lift(const Box2d& box, ObjectClass object_class) const;

  /// Depth of the visible surface alone.
  [[nodiscard]] std::optional<SurfaceDepth> surfaceOf(const Box2d& box,
                                                      ObjectClass object_class) const;

 private:
  std::shared_ptr<const StereoCamera> camera_;
  stereo::DisparityImage disparity_;
  std::optional<stereo::GroundPlane> ground_;
};

/// Adds 3D boxes to the detections of a frame that have a 2D one alone; those whose depth cannot be
/// told stay as they were.
void liftAll(Detections& detections, const StereoLifter& lifter);

}  // namespace headway::detect
