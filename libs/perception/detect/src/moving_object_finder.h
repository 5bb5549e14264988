// SPDX-License-Identifier: BSD-3-Clause
// Moving objects of a frame by motion alone: clusters of points and segments, overlaps merged,
// pieces joined.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/detect/stereo_motion.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <optional>
#include <vector>

#include "camera_path.h"
#include "disparity_drift.h"
#include "object_extent.h"
#include "point_follower.h"
#include "point_motion.h"
#include "segment_follower.h"

namespace headway::detect {

/// A frame as the search for moving objects needs it.
struct MotionFrame {
  const CameraPath& path;
  const cv::Mat& image;  ///< left, on the disparity grid
  const stereo::DisparityImage& disparity;
  const std::optional<stereo::GroundPlane>& ground;
  const Eigen::Vector3d& up;  ///< normal of the ground, world of the path
  const std::vector<PointTrack>& points;
  const std::vector<PointClass>& classes;  ///< one for each point
  double noise_scale = 1.0;                ///< true errors of observations over those assumed [-]
  DisparityDrift drift = {};               ///< measured in the same images
};

/// A moving object as detected in one frame.
struct MovingObject {
  ObjectExtent extent;
  MeasuredVelocity velocity;            ///< over the ground, world of the path
  int first_frame = 0;                  ///< the velocity was measured since then
  int points = 0;                       ///< observations that support it
  std::vector<std::size_t> members;     ///< indices of points that move with it
  std::vector<SegmentTrack*> segments;  ///< that belong to it
  DetectionEvidence evidence;
  std::int64_t group = -1;                ///< that its points and segments belong to
  std::optional<TrackId> searched_track;  ///< that it was searched for
};

/// Whether an extent overlaps an object in the image at its depth, or on the ground.
[[nodiscard]] bool isPartOf(const ObjectExtent& part, const MovingObject& object);

/// Whether it is part of any of them.
[[nodiscard]] bool isPartOfAny(const ObjectExtent& part, const std::vector<MovingObject>& objects);

/// Whether two velocities are similar enough for parts of one object.
[[nodiscard]] bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

/// Whether two velocities are opposite, so that they belong to different objects.
[[nodiscard]] bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

/// Points that move together.
struct MotionCluster {
  std::vector<std::size_t> members;                    ///< indices of points, ascending
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< over the ground, world of the path [m/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
};

/// Parameters of clusterMotion().
struct ClusterParams {
  double reach_m = 1.0;                ///< points nearer than this over the ground are linked [m]
  double reach_per_m = kGatePerMetre;  ///< growth of the reach with depth [m/m]
  double speed_difference = 1.0;       ///< and if their velocities differ by less [m/s]
  double speed_ratio = 0.2;            ///< or by this ratio of the speed [-]
  int min_points = 3;
};

/// Joins moving points that are near to each other on the ground and move alike; smaller clusters
/// than `min_points` are left out.
///
/// @param classes  one for each point
/// @param up        unit normal of the ground, in the world of the path
[[nodiscard]] std::vector<MotionCluster> clusterMotion(const std::vector<PointTrack>& points,
                                                       const std::vector<PointClass>& classes,
                                                       const CameraPath& path,
                                                       const Eigen::Vector3d& up,
                                                       const ClusterParams& params);

/// Ratio of moving points among the classified ones inside an object's outline and depth:
/// mismatches on a repetitive structure such as a fence are a minority there. 1 without classified
/// points.
///
/// @param outline   [px]
/// @param nearest   depth of the object's near side [m]
/// @param farthest  and of its far side [m]
[[nodiscard]] double movingRatio(const std::vector<PointTrack>& points,
                                 const std::vector<PointClass>& classes, const CameraPath& path,
                                 const Box2d& outline, double nearest, double farthest);

/// Joins the pieces of one vehicle, which are found apart where few points of it can be followed.
///
/// Pieces touch, move with the same velocity within its uncertainty and faster than people walk,
/// one of them is a vehicle by itself, and together they are no larger than vehicles may be.
///
/// @param objects  of this frame; those without evidence of motion are left as they are
void joinPieces(const MotionFrame& frame, const StereoCamera& camera,
                std::vector<MovingObject>& objects);

/// Parameters of point classification, from those of the detector.
[[nodiscard]] PointClassParams pointClassParams(const StereoMotionParams& params);

/// Finds moving objects in a frame by motion alone: clusters of points that move alike, and
/// segments that move as a whole. Clusters and segments that overlap are merged to one object.
class MovingObjectFinder {
 public:
  MovingObjectFinder(const StereoCamera& camera, const StereoMotionParams& params)
      : camera_(camera), params_(params) {}

  /// @param segments  followed; the objects found point into them
  [[nodiscard]] std::vector<MovingObject> find(const MotionFrame& frame,
                                               std::vector<SegmentTrack>& segments);

  /// Number of objects rejected since the last call: too small, off the ground, or among static
  /// points.
  [[nodiscard]] std::size_t takeImplausible();

 private:
  void addClusters(const MotionFrame& frame, std::vector<MovingObject>& objects);
  void addSegments(const MotionFrame& frame, bool newcomers, std::vector<SegmentTrack>& segments,
                   std::vector<MovingObject>& objects);
  /// Whether a velocity is more than slow, its own errors and the drift of disparities explain.
  [[nodiscard]] bool isFast(const MeasuredVelocity& velocity, const PointTrack& at,
                            const MotionFrame& frame) const;
  [[nodiscard]] std::optional<MeasuredVelocity> velocityOf(const SegmentTrack& segment,
                                                           const MotionFrame& frame) const;
  [[nodiscard]] std::optional<ObjectExtent> plausibleExtent(const std::vector<ObjectCell>& cells,
                                                            const MeasuredVelocity& velocity,
                                                            const stereo::GroundPlane& floor,
                                                            double min_ratio,
                                                            const MotionFrame& frame);

  StereoCamera camera_;
  StereoMotionParams params_;
  std::size_t implausible_ = 0;
};

}  // namespace headway::detect
