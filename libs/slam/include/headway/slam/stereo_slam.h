#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/stage_times.h>
#include <headway/core/stereo_frame.h>
#include <headway/slam/map_view.h>
#include <headway/slam/slam_params.h>

#include <memory>
#include <vector>

namespace headway::slam {

enum class TrackingStatus {
  kTracked,  ///< the pose rests on enough landmarks of this frame
  kLost,     ///< it does not: pose and covariance are those of the motion model
};

/// What one frame said of the camera's motion.
struct SlamUpdate {
  TrackingStatus status = TrackingStatus::kLost;
  Pose T_map_robot = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< of T_map_robot
  bool is_keyframe = false;
  int features = 0;  ///< keypoints in the left image
  int inliers = 0;   ///< landmarks that the pose rests on
};

/// Localises a stereo camera and maps the still world around it.
///
/// The map frame is the robot's first pose (levelled where gravity is known). Deterministic: the
/// same frames and parameters give the same bytes, on any number of cores.
///
///     StereoSlam slam(source.camera(), params);
///     while (auto frame = source.next()) publish(slam.process(*frame->stereo, {}));
class StereoSlam {
 public:
  StereoSlam(std::shared_ptr<const StereoCamera> camera, const SlamParams& params);
  ~StereoSlam();

  /// Localises one frame and extends the map from it. Frames come in order of time.
  [[nodiscard]] SlamUpdate process(const StereoFrame& frame, const MovingRegions& moving);

  /// Landmarks and keyframes as they are now.
  [[nodiscard]] MapView map() const;

  /// Every frame processed so far, hung on its reference keyframe as corrected since.
  [[nodiscard]] std::vector<FrameEstimate> trajectory() const;

  /// Milliseconds of "slam_track" (features to pose) and "slam_map" (the rest), a frame each.
  [[nodiscard]] const StageTimes& times() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::slam
