#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/stage_times.h>
#include <headway/core/stereo_frame.h>
#include <headway/slam/map_view.h>
#include <headway/slam/slam_params.h>

#include <memory>
#include <string>
#include <vector>

namespace headway::slam {

enum class TrackingStatus {
  kTracked,  ///< the pose rests on enough landmarks of this frame
  kLost,     ///< it does not: pose and covariance are those of the motion model
};

/// What became of a place that looked like one seen before.
enum class LoopOutcome {
  kClosed,         ///< the map was corrected
  kNotRecognised,  ///< too few descriptors agree on a pose
  kTooFewInliers,  ///< too few of its landmarks are measured here
  kTooFarOff,      ///< it lies farther off than drift explains
};

/// One look at a possible loop, with what was needed and what there was.
struct LoopAttempt {
  LoopOutcome outcome = LoopOutcome::kNotRecognised;
  KeyframeId keyframe;   ///< the new one
  KeyframeId candidate;  ///< the old one that looks alike
  int inliers = 0;
  int inliers_needed = 0;
  double offset_m = 0.0;          ///< between both estimates of the new keyframe's place [m]
  double offset_allowed_m = 0.0;  ///< [m]; 0 where it did not come to that
};

/// What one frame said of the camera's motion.
struct SlamUpdate {
  TrackingStatus status = TrackingStatus::kLost;
  Pose T_map_robot = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< of T_map_robot
  bool is_keyframe = false;
  int features = 0;                ///< keypoints in the left image
  int inliers = 0;                 ///< landmarks that the pose rests on
  std::vector<LoopAttempt> loops;  ///< of a keyframe that looked like older ones, in order
};

/// Localises a stereo camera and maps the still world around it.
///
/// The map frame is the robot's first pose (levelled where gravity is known). A camera that is lost
/// is looked for in the whole map at each frame; after slam.restart_after_frames lost frames in a
/// row, or at once where the map was only just begun, a new part of the map is begun at the guessed
/// pose. Deterministic: the same frames and parameters give the same bytes, on any number of cores.
///
///     StereoSlam slam(source.camera(), params);
///     while (auto frame = source.next()) publish(slam.process(*frame->stereo, {}));
class StereoSlam {
 public:
  StereoSlam(std::shared_ptr<const StereoCamera> camera, const SlamParams& params);
  ~StereoSlam();

  /// Localises one frame and extends the map from it. Frames come in order of time.
  ///
  /// @throws InputError if the images or the mask are not of the camera's size
  [[nodiscard]] SlamUpdate process(const StereoFrame& frame, const MovingRegions& moving);

  /// Landmarks and keyframes as they are now.
  [[nodiscard]] MapView map() const;

  /// Every frame processed so far, hung on its reference keyframe as corrected since.
  [[nodiscard]] std::vector<FrameEstimate> trajectory() const;

  /// The whole map as bytes, to go on with later: see load().
  [[nodiscard]] std::string save() const;

  /// Takes a saved map up again, before the first frame. The camera counts as lost until it is
  /// recognised somewhere in it; then it is tracked, and with slam.mapping the map grows on.
  ///
  /// @throws InputError if the bytes are cut off, damaged, of another version or of another camera
  void load(const std::string& bytes);

  /// Waits for an adjustment that still runs beside and takes it into map and trajectory; for the
  /// end of a recording, where no frame comes that would. More frames may follow.
  void finish();

  /// Milliseconds of "slam_track" (features to pose) and "slam_map" (the rest), a frame each.
  [[nodiscard]] const StageTimes& times() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::slam
