// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/log.h>
#include <headway/core/record_log.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/stage_times.h>
#include <headway/map/map_file.h>
#include <headway/map/static_grid.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/pipeline/camera_check.h>
#include <headway/pipeline/dense_mapper.h>
#include <headway/pipeline/detection_stage.h>
#include <headway/pipeline/laser_evidence.h>
#include <headway/pipeline/lost_diagnosis.h>
#include <headway/pipeline/mount_check.h>
#include <headway/pipeline/perception_host.h>
#include <headway/pipeline/scale_check.h>
#include <headway/pipeline/stereo_check.h>
#include <headway/slam/stereo_slam.h>
#include <headway/stereo/rig_capability.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace headway::pipeline {

/// Occupancy grid from ground scans. Section [grid].
struct GridParams {
  int every_nth_frame = 3;  ///< interval of scanned frames; 0: no grid
  detect::GroundScanParams scan;
  map::StaticGridParams map;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Parameters of the whole pipeline.
struct PerceptionParams {
  slam::SlamParams slam;
  DetectionParams detection;
  objects::ObjectsParams objects;
  GridParams grid;
  map::DenseMapParams dense;
  LaserParams laser;
  map::RobotFootprint robot{0.5, 0.4};

  /// For live operation: bundle adjustment, loop search and pose graph run beside the tracking, so
  /// that results depend on timing. A network runs on the image as a whole, without tiles, and in
  /// every second frame at most, so that two cores process 10 frames/s.
  [[nodiscard]] static PerceptionParams live() { return live(PerceptionParams()); }
  /// The same with other parameters.
  [[nodiscard]] static PerceptionParams live(PerceptionParams params);

  /// Binds sections [slam], [detect] with those of the detectors, [objects], [grid], [dense],
  /// [laser] and [robot].
  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// A frame whose pose is not SLAM's, as part of the stored trajectory.
struct GivenPose {
  std::size_t frame;
  Time time;
  StoredPose T_map_robot;
  bool is_given;  ///< false: the pose is the last one given
};

/// Result of one frame: the pose of the robot and the tracks.
struct PerceptionUpdate {
  std::size_t frame = 0;
  Time time = 0.0;                       ///< [s]
  slam::SlamUpdate camera;               ///< status, T_map_robot and its covariance
  std::optional<Detections> detections;  ///< of all sources; nullopt: no detector ran
  objects::TrackUpdate objects;          ///< with the dropped detections by reason
};

struct JointMap;  // see joint_map.h

/// The complete pipeline: frame -> detectors -> slam -> detectors -> objects -> map.
///
/// Synchronous and deterministic: same frames and parameters, same results. Robot programs and the
/// replay use this class alike.
///
///     Perception perception(source.camera(), params);
///     while (auto frame = source.next()) {
///       PerceptionUpdate update = perception.process(*frame);
///       avoid(update.objects.tracks);
///     }
class Perception {
 public:
  /// @param camera  of all stereo frames; null if only poses and boxes are given
  /// @param map     with the layers to fill, such as one configured by an .ini
  /// @throws InputError for unknown or unusable detectors and parameters out of range
  Perception(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
             map::PerceptionMap map = {});
  ~Perception();

  /// Continues in a stored map, before the first frame: the camera counts as lost until it is
  /// re-localised; then its poses are in the stored map's frame, and with slam.mapping the map is
  /// extended. Stored moving objects are not loaded.
  ///
  /// @throws InputError if there is no camera, or if the map has no places for re-localisation, is
  ///         damaged, of another version or of another camera
  void resume(const map::StoredMap& stored);

  /// The map as stored in a file, with the data for resume(), without configuration.
  [[nodiscard]] map::StoredMap stored() const;

  /// Processes one frame. Times increase; an earlier time than the last frame's means that the
  /// clock was set back, and ends all tracks.
  ///
  /// With a recorded pose SLAM is not run. While the camera is lost, tracks are predicted and the
  /// frame's detections are dropped as "camera_lost".
  /// A frame with neither images nor pose counts as lost.
  ///
  /// @throws InputError if a frame has a recorded pose and the map was resumed, or if the images
  ///         show that the camera's pose on the robot or its baseline is wrong (see MountCheck), or
  ///         that the right camera is turned by more than can be corrected (see StereoCheck)
  [[nodiscard]] PerceptionUpdate process(const RecordedFrame& frame);

  /// Capability of the rig, with the parameters that replace derived values; nullopt without
  /// camera.
  [[nodiscard]] const std::optional<stereo::RigCapability>& rig() const { return rig_; }

  /// Sink of messages: warnings when they occur first, loops, relocalisation, and with kDebug the
  /// decisions of each frame. Not to be called during process().
  void setLog(LogSink sink);

  /// Not to be called during process().
  void setCallbacks(PerceptionCallbacks callbacks);

  /// Changes parameters before the next frame; callable by any thread.
  ///
  /// @param params  all of them, in range
  void change(const RuntimeParams& params);

  /// Conditions of the input that degrade the results: "imu_accelerometer" and "imu_gyroscope"
  /// (left out, they contradict the camera), "odometry_scale", "camera_frozen", "camera_dark",
  /// "camera_bright", "vertical_offset", "images_not_simultaneous", "images_swapped", "speed",
  /// "clock_set_back", "clock_jumps_ahead", "recorded_boxes_missing", and "lost_" with a
  /// LostReason.
  [[nodiscard]] const Warnings& warnings() const;

  /// Rotation of the right camera against its calibration, by the images so far, and whether it is
  /// corrected, in one line; nullopt with too few matches or without images.
  [[nodiscard]] std::optional<std::string> rectification() const;

  /// Laser scans by use ("used", "camera_lost", "ground_unknown", "between_ground_scans") and ends
  /// of their beams (see addLaserScans()); empty without a laser.
  [[nodiscard]] const std::map<std::string, std::size_t>& laserCounts() const;

  /// The map after the last frame: landmarks, keyframes, occupancy grid and moving objects; and the
  /// dense points as of updateDenseMap() or finish(), in live operation as of a second ago.
  [[nodiscard]] const map::PerceptionMap& map() const { return map_; }

  /// Fuses the depth scans of all frames so far, and updates the map's layer of dense points.
  void updateDenseMap();

  /// All frames so far, with their latest corrections.
  [[nodiscard]] std::vector<slam::FrameEstimate> trajectory() const;

  /// The same one by one, for runs of days whose frames do not fit into memory.
  void visitTrajectory(const slam::FrameVisitor& visit) const { trajectorySnapshot()(visit); }

  /// The same as the trajectory is now, for any thread.
  [[nodiscard]] slam::TrajectoryVisit trajectorySnapshot() const;

  /// Waits for background threads and applies their results; call after the last frame, before the
  /// final map and trajectory are read. Without threads it returns at once.
  void finish();

  /// The samples still in the smoothing windows; call once, after the last frame.
  [[nodiscard]] std::vector<TrackSample> flush() { return tracker_.flush(); }

  /// Milliseconds by stage: "slam_track", "slam_map", "detect" (of frames with image-based
  /// detection), "objects", "grid" (of scanned frames), "map_update", "frame"; and in other threads
  /// "dense_scan" (of scanned frames) and "dense_fuse".
  [[nodiscard]] StageTimes times() const;

 private:
  friend std::vector<JointMap> joinMaps(const std::vector<Perception*>& runs);
  [[nodiscard]] Pose moveInto(const slam::KeyframePoses& poses);
  [[nodiscard]] bool hasGridTurn(const RecordedFrame& frame);
  [[nodiscard]] std::optional<stereo::FrameContext> contextOf(const RecordedFrame& frame);
  [[nodiscard]] bool isLocalisedBySlam(const RecordedFrame& frame) const;
  /// Measured less true disparity, as SLAM estimates it, or else as given poses show [px].
  [[nodiscard]] double disparityOffset(const RecordedFrame& frame) const;
  /// By the static points of the newest frame, whose pose is recorded.
  void estimateOffset();
  slam::SlamUpdate localise(const RecordedFrame& frame, const ObjectDetections& boxes);
  slam::SlamUpdate useGivenPose(const RecordedFrame& frame);
  /// Removes what refers to the times before, if the clock was set back. @return ended tracks
  std::vector<TrackSample> followClock(const RecordedFrame& frame);
  /// Removes boxes that are too far, and counts them.
  void shedFar(Detections& detections, DropCounts& dropped) const;
  objects::TrackUpdate track(const RecordedFrame& frame, const PerceptionUpdate& update);
  void updateMap(const PerceptionUpdate& update);
  void updateStaticMap();
  void updateGrid(const RecordedFrame& frame, const PerceptionUpdate& update, bool scan_ground);
  void updateDense(const RecordedFrame& frame, const PerceptionUpdate& update, bool scan_ground);
  /// Adds the frame's laser scans to the ground scan, or counts why they are not used.
  void addLaser(const RecordedFrame& frame, const PerceptionUpdate& update, bool scan_ground,
                std::optional<GroundScan>& scan);
  void warnAboutSpeed(const RecordedFrame& frame, const PerceptionUpdate& update);
  void warnAboutOdometry(const RecordedFrame& frame, const slam::SlamUpdate& camera);
  void warnAboutBoxes(const RecordedFrame& frame, const ObjectDetections& boxes);
  void applyChange();
  void log(LogLevel level, std::size_t frame, const std::string& text) const;
  void logLocalisation(const RecordedFrame& frame, const slam::SlamUpdate& camera);
  void logFrame(const PerceptionUpdate& update, const Warnings& before);
  void callBack(const PerceptionUpdate& update, const map::PerceptionMap& before) const;
  /// Compares left and right images, and those of the frame before, before they are used.
  void checkImages(const RecordedFrame& frame);
  /// Compares mounting and sensors with the images.
  void checkInput(const RecordedFrame& frame, const PerceptionUpdate& update, bool scan_ground);
  /// The ground of this image; without one, as the camera is mounted; nullopt if that is unknown.
  [[nodiscard]] std::optional<RobotGround> groundOf(const FrameDetections& found) const;

  std::shared_ptr<const StereoCamera> camera_;
  std::unique_ptr<slam::StereoSlam> slam_;  ///< null without camera
  stereo::FrontEnd front_end_;
  DetectionStage detection_;
  objects::MovingObjectTracker tracker_;
  std::optional<stereo::RigCapability> rig_;
  GridParams grid_params_;
  LaserParams laser_params_;
  double max_speed_mps_;  ///< of the robot, for recorded poses
  double max_box_range_m_ = RuntimeParams().max_box_range_m;
  bool is_live_ = false;  ///< no frame may be delayed by a correction of the whole map
  map::StaticGrid grid_;
  DenseMapper dense_;
  map::PerceptionMap map_;
  std::size_t grid_frames_ = 0;            ///< frames eligible for a scan
  std::optional<MountCheck> mount_check_;  ///< with a camera
  CameraCheck camera_check_;
  StereoCheck stereo_check_;
  ScaleCheck scale_check_;
  slam::ImageEvidence images_ = slam::ImageEvidence::kNone;  ///< of the newest frame
  Warnings warnings_;
  LogSink log_;
  PerceptionCallbacks callbacks_;
  bool mapping_ = true;
  std::mutex change_mutex_;
  std::optional<RuntimeParams> change_;  ///< for the next frame; guarded by change_mutex_
  LostDiagnosis lost_diagnosis_;
  bool was_tracked_ = false;                                 ///< in some frame
  std::size_t lost_frames_ = 0;                              ///< in succession
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero();  ///< of the robot, or as predicted
  std::map<std::string, std::size_t> laser_counts_;
  std::optional<Time> last_time_;                  ///< of the newest frame
  std::optional<Stamped<Pose>> last_pose_;         ///< in the newest tracked frame
  bool resumed_ = false;                           ///< the map frame is a stored map's
  FrameDetections found_;                          ///< in the newest frame
  std::vector<Track> tracks_;                      ///< of the previous frame
  std::vector<ExpectedObject> expected_;           ///< as of the previous frame
  RecordLog<GivenPose> given_poses_;               ///< frames with recorded pose
  stereo::DisparityOffset offset_at_given_poses_;  ///< where SLAM does not estimate it
  StageTimes times_;
};

}  // namespace headway::pipeline
