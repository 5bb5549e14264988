// SPDX-License-Identifier: BSD-3-Clause
// Frame-to-frame visual odometry without a map, which moves the odometry frame.
#pragma once

#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/pose_refiner.h>
#include <headway/stereo/rectification.h>
#include <headway/stereo/stereo_match.h>

#include <optional>
#include <vector>

#include "landmark_tracker.h"

namespace headway::slam {

/// Motion of the camera from one frame to the next by the images alone.
///
/// It uses no map, so that no correction of one changes it: what is tracked and predicted in the
/// odometry frame does not notice a loop. Corners are followed from frame to frame; the disparity
/// of each is filtered over the frames in which it is followed.
///
/// The offset of the disparities is estimated from corners that are lost: by how far they moved in
/// the image, the camera's motion gives their depths up to its scale, so that a line through
/// measured and expected disparities has the scale as its slope and the offset as its intercept.
///
/// Where the image moves farther than corners are followed, or is blurred, ORB features of both
/// frames are matched instead, and the motion is the one that more of them agree on than chance
/// explains.
///
/// @see  Nister et al. 2004, "Visual odometry"; Moisan & Stival 2004, "A probabilistic criterion to
///       detect rigid point matches between two images"
class VisualOdometry {
 public:
  VisualOdometry(const StereoCamera& camera, const SlamParams& params);

  /// The motion from the last frame to this one on which most corners agree, before the frame is
  /// tracked in the map.
  ///
  /// @param predicted  motion of the camera
  /// @return           nullopt if too few corners agree on a motion
  [[nodiscard]] std::optional<Pose> propose(const TrackingFrame& frame, const Pose& predicted);

  /// The same by features of both frames, where too few corners are followed.
  [[nodiscard]] std::optional<Pose> proposeWide(const TrackingFrame& frame);

  /// The same after it, and goes on from this frame.
  ///
  /// @param tracked  the motion as tracked in the map, which knows what is static: it decides only
  ///                 where most corners move otherwise; nullopt: it was not tracked in both
  [[nodiscard]] std::optional<Pose> advance(const TrackingFrame& frame,
                                            const std::optional<Pose>& tracked);

  /// Of the last motion that was proposed or advanced by (right perturbation).
  [[nodiscard]] const PoseCovariance& stepCovariance() const { return step_covariance_; }

  /// Starts at a frame without a motion since the last one.
  void restart(const TrackingFrame& frame);

  /// Measured less true disparity, so far [px].
  [[nodiscard]] double disparityOffset() const { return offset_px_; }
  /// The right images are turned back by other angles from now on (see StereoSlam).
  void turnRightCamera(const Eigen::Vector3d& before, const Eigen::Vector3d& now);

 private:
  struct Corner {
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< in the last frame [px]
    double disparity_px = 0.0;                     ///< filtered, less the offset
    double variance_px2 = 0.0;                     ///< of the disparity
    Eigen::Vector2d first_uv = Eigen::Vector2d::Zero();
    Pose T_start_first = Pose::Identity();  ///< camera where it was first seen
  };
  /// Disparity of a corner that is lost.
  struct Evidence {
    double measured_px = 0.0;
    double expected_px = 0.0;  ///< by its motion in the image, up to the scale of the camera's
    double measured_variance = 0.0;  ///< [px^2]
    double expected_variance = 0.0;  ///< [px^2]
  };
  /// Measured disparities over expected ones.
  struct Line {
    double slope = 1.0;
    double offset_px = 0.0;
    double offset_variance = 0.0;  ///< [px^2]
  };

  /// Corners in both frames and the motion that they agree on.
  struct Followed {
    std::vector<stereo::PoseConstraint> constraints;  ///< points in the previous camera's frame
    std::vector<Corner> before;                       ///< the same, in the previous frame
    std::optional<Pose> motion;
    bool by_features = false;  ///< which may be those of an object: a tracked motion decides
  };

  [[nodiscard]] Followed follow(const TrackingFrame& frame, const Pose& expected) const;
  [[nodiscard]] std::optional<Pose> stepByDescriptors(const TrackingFrame& frame);
  void removeOtherwiseMoving(const Pose& tracked, Followed& followed) const;
  void refine(const Pose& expected, const stereo::PoseRefinerOptions& gates, Followed& followed);
  [[nodiscard]] bool agree(const Followed& followed, const Pose& tracked) const;
  [[nodiscard]] std::vector<Corner> cornersOf(const Followed& followed) const;
  void replenish(const TrackingFrame& frame);
  void addEvidence(const std::vector<Corner>& before);
  void estimateOffset();
  [[nodiscard]] static std::optional<Line> fitLine(const std::vector<Evidence>& points);

  StereoCamera camera_;
  SlamParams params_;
  stereo::StereoMatcher matcher_;
  FeatureGrid grid_;
  stereo::ImagePyramid left_;                 ///< of the last frame
  stereo::SecondView right_;                  ///< of the last frame
  std::vector<DescribedPoint> features_;      ///< of the last frame, where they were sought
  std::vector<DescribedPoint> new_features_;  ///< of the frame that is proposed
  std::vector<Corner> corners_;
  Followed followed_;  ///< of propose()
  PoseCovariance step_covariance_ = PoseCovariance::Zero();
  std::size_t most_corners_ = 0;         ///< after the last search for new ones
  Pose T_start_cam_ = Pose::Identity();  ///< of the last frame
  std::vector<Evidence> evidence_;       ///< since the last estimate of the offset
  double offset_px_ = 0.0;
  stereo::OffsetRecord offset_record_;
  bool is_turned_ = false;  ///< the right camera, in yaw: its offset is corrected in any case
};

}  // namespace headway::slam
