// SPDX-License-Identifier: BSD-3-Clause
// Stereo visual SLAM: localises each frame in the map that it builds.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/moving_regions.h>
#include <headway/core/stage_times.h>
#include <headway/slam/map_view.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rectification.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::slam {

enum class TrackingStatus {
  kTracked,             ///< the pose rests on enough landmarks of this frame
  kTrackedInNewSubmap,  ///< the same, in a submap whose place in the map is not known
  kUnreliable,          ///< it must not be trusted, for the reason in SlamUpdate::doubt
  kLost,  ///< it rests on too few landmarks: pose and covariance are those of the motion model
};

/// "tracked", "tracked_in_new_submap", "unreliable" or "lost".
[[nodiscard]] const char* toString(TrackingStatus status);

/// Whether the pose was measured, in whichever submap.
[[nodiscard]] inline bool isTracked(TrackingStatus status) {
  return status == TrackingStatus::kTracked || status == TrackingStatus::kTrackedInNewSubmap;
}

/// What changed the poses of the map.
enum class MapChange {
  kStart,             ///< nothing so far
  kBundleAdjustment,  ///< of a new keyframe and its neighbours
  kGravity,           ///< the map was levelled
  kRightCamera,       ///< the right camera is turned against its calibration
  kRelocalised,       ///< the camera, which was lost, was found in the map
  kNewSubmap,         ///< a submap was started, because the camera was not found
  kLoop,              ///< a place was seen again
  kSubmapJoined,      ///< a place was recognised in another submap, which this one is part of now
  kMapsJoined,        ///< the maps of several recordings were joined
  kMounting,          ///< the camera is mounted otherwise than was assumed
  kBridged,           ///< the map goes on where odometry led, because the camera was not found
};

/// "start", "bundle_adjustment", "gravity", "right_camera", "relocalised", "new_submap", "loop",
/// "submap_joined", "maps_joined", "mounting" or "bridged".
[[nodiscard]] const char* toString(MapChange cause);

/// State of the poses in the map. As long as its number is the same, T_map_odom changes by the
/// odometry's drift alone.
struct MapRevision {
  std::uint64_t number = 0;             ///< of changes so far
  MapChange cause = MapChange::kStart;  ///< of the newest change; of several since the frame
                                        ///< before, an adjustment counts least
};

/// What is known about a frame's images before they are used.
enum class ImageEvidence {
  kNone,           ///< nothing is wrong with them
  kContradictory,  ///< left and right do not fit each other
  kSeenBefore,     ///< they are those of the frame before
  kOneUseless,     ///< one shows nothing, came before or is the other one: nothing is measured
};

/// Whether a pose and objects can be measured in images.
[[nodiscard]] constexpr bool canMeasure(ImageEvidence images) {
  return images == ImageEvidence::kNone || images == ImageEvidence::kContradictory;
}

/// Why a pose is unreliable.
enum class Doubt {
  kNone,
  kImages,    ///< left and right images contradict each other, or the right one the map
  kFrozen,    ///< the same images again, though the camera has or may have moved: it is predicted
  kOdometry,  ///< camera and wheels differ by more than 3 sigma over the last second
  kSpeed,     ///< faster than slam.max_speed
};

/// What becomes of the inertial sensor.
enum class ImuStatus {
  kAbsent,                    ///< no samples around the frames so far
  kUsed,                      ///< it predicts turns and levels the map
  kGyroscopeContradicts,      ///< left out: its turns are not the camera's
  kAccelerometerContradicts,  ///< left out: its forces are not those of the camera's motion
};

/// Outcome of a loop candidate.
enum class LoopOutcome {
  kClosed,         ///< the map was corrected
  kNotRecognised,  ///< too few descriptors agree on a pose
  kTooFewInliers,  ///< too few of its landmarks are measured here, or too many are missing
  kTooFarOff,      ///< it lies farther off than drift explains
};

/// One loop candidate with its test values and their thresholds.
struct LoopAttempt {
  LoopOutcome outcome = LoopOutcome::kNotRecognised;
  KeyframeId keyframe;   ///< the new one
  KeyframeId candidate;  ///< the old one with similar descriptors
  int inliers = 0;
  int inliers_needed = 0;
  double offset_m = 0.0;          ///< between both estimates of the new keyframe's position [m]
  double offset_allowed_m = 0.0;  ///< [m]; 0 where an earlier test failed
  bool joins_submaps = false;     ///< the old keyframe is in another submap than the new one
};

/// Result of one frame.
struct SlamUpdate {
  TrackingStatus status = TrackingStatus::kLost;
  Doubt doubt = Doubt::kNone;                              ///< of kUnreliable
  Pose T_map_robot = Pose::Identity();                     ///< T_map_odom T_odom_robot
  PoseCovariance covariance = PoseCovariance::Identity();  ///< of T_map_robot
  /// By the images alone, without the map: it drifts, never jumps, and moves no faster than
  /// slam.max_speed. While the camera is lost it goes on by wheel odometry or the gyroscope, else
  /// it slows down to a stop within 1 s.
  Pose T_odom_robot = Pose::Identity();
  bool is_motion_seen = true;  ///< of the odometry since the frame before, in the images
  Pose T_map_odom = Pose::Identity();
  PoseCovariance map_odom_covariance = PoseCovariance::Identity();  ///< of T_map_odom
  MapRevision revision;  ///< of the map in which T_map_robot is
  int submap = 0;        ///< that the camera is in; 0: the one with the map's origin
  bool is_keyframe = false;
  ImuStatus imu = ImuStatus::kAbsent;
  int features = 0;                ///< keypoints in the left image
  int inliers = 0;                 ///< landmarks that the pose rests on
  std::vector<LoopAttempt> loops;  ///< candidates of a new keyframe, in order; in live operation
                                   ///< those of an earlier one whose search has ended
};

/// Poses of keyframes' cameras in a map, by id.
using KeyframePoses = std::map<KeyframeId, Pose>;

struct JointMap;  // see joint_map.h

/// Localises a stereo camera and maps its static surroundings.
///
/// The map frame is the robot's first pose, levelled as soon as an inertial sensor shows that the
/// robot did not stand upright. A camera that is lost
/// is relocalised in the whole map at each frame; when it was lost for slam.restart_after_s, or
/// earlier in a new submap, a new submap is initialised at the predicted pose.
/// Deterministic: the same frames and parameters give the same bytes, on any number of cores.
///
///     StereoSlam slam(source.camera(), params);
///     while (auto frame = source.next()) publish(slam.process(*frame->stereo, {}));
class StereoSlam {
 public:
  StereoSlam(std::shared_ptr<const StereoCamera> camera, const SlamParams& params);
  ~StereoSlam();

  /// Localises one frame and extends the map from it. Frames come in order of time.
  ///
  /// Images that were seen before tell nothing new. Where wheel odometry says that the robot has
  /// stood since they were new they confirm it; otherwise they are not used.
  ///
  /// @throws InputError if the images or the mask are not of the camera's size
  [[nodiscard]] SlamUpdate process(const stereo::FrameContext& frame, const MovingRegions& moving,
                                   ImageEvidence images = ImageEvidence::kNone);

  /// Measured less true disparity, as estimated by bundle adjustment so far [px].
  [[nodiscard]] double disparityOffset() const;

  /// The same as the observations of the newest bundle adjustment alone tell it, without what is
  /// assumed about it; nullopt if there was none since the last call.
  [[nodiscard]] std::optional<stereo::OffsetEstimate> takeFreeOffset();

  /// The right images of the next frames are turned back by another rotation of the right camera
  /// against its calibration than those before.
  ///
  /// @param angles     pitch, yaw, roll: rotation vector along the right camera's axes [rad]
  /// @param always_so  the camera was turned like this before, too: the map's disparities are
  ///                   converted, and the map is adjusted; false: it has moved
  void turnRightCamera(const Eigen::Vector3d& angles, bool always_so);
  /// That of the newest frame, or of a map that was loaded [rad].
  [[nodiscard]] const Eigen::Vector3d& rightTurn() const;

  /// Landmarks and keyframes of the submap that the camera is in, as they are now. What did not
  /// change since the last call is shared with what it gave.
  [[nodiscard]] MapView map();

  /// The submaps, ascending: those that are not 0 have an unknown place in the map.
  [[nodiscard]] std::vector<int> submaps() const;
  /// Landmarks and keyframes of any of them.
  [[nodiscard]] MapView map(int submap) const;

  /// Every frame processed so far, anchored to its reference keyframe as corrected since.
  [[nodiscard]] std::vector<FrameEstimate> trajectory() const {
    std::vector<FrameEstimate> all;
    visitTrajectory([&](const FrameEstimate& estimate) { all.push_back(estimate); });
    return all;
  }

  /// The same one by one, for runs of days whose frames do not fit into memory.
  void visitTrajectory(const FrameVisitor& visit) const { trajectorySnapshot()(visit); }

  /// The same as the trajectory is now, for any thread.
  [[nodiscard]] TrajectoryVisit trajectorySnapshot() const;

  /// The whole map as bytes for load().
  [[nodiscard]] std::string save() const;

  /// The same as the map is now, for any thread; the landmarks' patches, two thirds of the bytes,
  /// are shared with the map.
  [[nodiscard]] ByteSource snapshot() const;

  /// Loads a saved map, before the first frame. The camera counts as lost until it is relocalised
  /// in it; then it is tracked and, with slam.mapping, the map is extended.
  ///
  /// @throws InputError if the bytes are cut off, damaged, of another version or of another camera
  void load(const std::string& bytes);

  /// Where the robot is in the map, roughly: a camera that is lost, as it is in a map that was
  /// loaded, or tracked in a submap of its own, is searched there first, within 5 m and a right
  /// angle of where odometry has led since. Of no effect once it is tracked in the map.
  void setInitialPose(const Pose& T_map_robot);

  /// Waits for a running background search for loops and adjustment and applies both, at the end of
  /// a recording. More frames may follow.
  void finish();

  /// Replaces the poses of all keyframes; landmarks, trajectory and camera move with them.
  ///
  /// @param poses  of every keyframe of the map
  void correct(const KeyframePoses& poses);

  /// The camera is mounted otherwise than was assumed: map, odometry and camera move so that the
  /// robot's first pose is the origin again, a revision of the cause kMounting. Not during
  /// process().
  ///
  /// @param camera  the same but for T_robot_cam
  void remount(std::shared_ptr<const StereoCamera> camera);

  /// Milliseconds of "slam_track" (features to pose) and "slam_map" (the rest), a frame each.
  [[nodiscard]] const StageTimes& times() const;

 private:
  friend std::vector<JointMap> joinMaps(const std::vector<const StereoSlam*>& runs);
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::slam
