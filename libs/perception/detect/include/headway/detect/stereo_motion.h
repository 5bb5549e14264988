// SPDX-License-Identifier: BSD-3-Clause
// Detection of moving objects by stereo, without a network.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/moving_regions.h>
#include <headway/core/params.h>
#include <headway/core/stereo_frame.h>
#include <headway/core/track.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rectification.h>

#include <memory>
#include <optional>
#include <vector>

namespace headway::detect {

/// Section [stereo_motion].
struct StereoMotionParams {
  int max_points = 1200;          ///< tracked at a time
  int spacing_px = 8;             ///< between points [px]
  double window_s = 0.6;          ///< time window of a point's observations [s]
  double segment_window_s = 1.0;  ///< time window of a segment's observations [s]
  double max_range_m = 0.0;       ///< of tracked points; 0: RigCapability::vehicles_to_m [m]
  double min_height_m = 0.0;      ///< of points on objects; 0: 4/3 of GroundPlane::clearance_m [m]
  double max_height_m = 3.5;      ///< above ground, of points on objects [m]
  double sigma_px = 0.4;          ///< noise of an image position, each way [px]
  double sigma_disparity_px = 0.4;    ///< [px]
  double significance = 30.0;         ///< of a point's motion, chi-square, 3 degrees of freedom [-]
  double min_speed_mps = 0.6;         ///< slower objects are static [m/s]
  double max_speed_mps = 60.0;        ///< of an object [m/s]
  int min_points = 3;                 ///< of an object
  double max_point_distance_m = 1.0;  ///< between neighbours of one object, over the ground [m]
  double min_moving_ratio = 0.6;      ///< of the points within an object's outline [-]
  double max_segment_range_m = 0.0;   ///< of upright segments; 0: 1.5 people_to_m of the rig [m]
  double segment_significance = 15.0;  ///< of its motion, chi-square, 2 degrees of freedom [-]
  double max_moving_ratio = 0.4;  ///< of all points; above, the camera's motion is rejected [-]
  bool classify = true;           ///< by size and speed; else every object is Unknown

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "stereo_motion"); }  ///< @throws InputError
};

/// Moving objects of one frame.
struct MotionDetections {
  /// With 2D and 3D box, mask and velocity each; nullopt where the frame cannot be used, for a
  /// reason that `dropped` counts.
  std::optional<Detections> detections;
  bool tested = false;  ///< objects were searched for; not so in the first frames after a reset
  DropCounts dropped;   ///< frames that cannot be used and detections that are not plausible
  Eigen::Vector3d camera_velocity = Eigen::Vector3d::Zero();   ///< of points seen from it [m/s]
  Eigen::Vector3d camera_turn_rate = Eigen::Vector3d::Zero();  ///< of points seen from it [rad/s]
  std::vector<stereo::OffsetEvidence> static_points;  ///< on the disparities' offset, this frame
  double max_ahead_s = 0.0;                           ///< for which regionsAt() extrapolates [s]

  /// Where these objects are in the image at another time if they and the camera keep their
  /// velocities; empty more than `max_ahead_s` after the frame.
  [[nodiscard]] MovingRegions regionsAt(Time at, const StereoCamera& camera) const;
};

/// Detects moving objects by geometry alone, without a network, weights or classes.
///
/// Corners are tracked through time and matched between both cameras. With the camera's motion
/// known, each is fitted twice to its observations of the last half second, as static and as
/// moving; where only motion explains them, and neighbours on the ground move alike, there is an
/// object. Dense disparities give its outline. Segments of a person's size are tracked as wholes,
/// too, since people often show no corners: by their outline, and by the difference of their dense
/// flow from that of a static scene. Requires a frame rate at which objects move by less than their
/// length between frames, and a scene that is static for the most part.
///
/// @see  Franke et al. 2005, "6D-Vision"; Lenz et al. 2011, "Sparse scene flow segmentation"
class StereoMotion {
 public:
  /// @param camera  of every frame to come
  StereoMotion(std::shared_ptr<const StereoCamera> camera, const StereoMotionParams& params);
  ~StereoMotion();
  StereoMotion(StereoMotion&&) noexcept;

  /// Frames come in order of time.
  ///
  /// Objects that move are found by their motion alone, without tracks. Expected objects that were
  /// not found so are searched for by less evidence: flow or appearance.
  ///
  /// @param T_map_robot  nullopt where the robot's pose is unknown: the frame cannot be used
  /// @param expected     by the tracker, as of the frame before
  [[nodiscard]] MotionDetections detect(const stereo::FrameContext& context,
                                        const std::optional<Pose>& T_map_robot,
                                        const std::vector<ExpectedObject>& expected = {});

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::detect
