// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_frame.h>
#include <headway/detect/surface_depth.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <memory>
#include <optional>

namespace headway::detect {

/// A 3D box found behind a 2D one.
struct LiftedBox {
  Box3d box;                                                        ///< sensor's optical frame
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< optical frame [m^2]
};

/// Gives the 2D boxes of one frame their depth, size and heading by stereo.
///
/// Depth is that of the visible surface (surfaceDepth), size the class's usual one with the height
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
