// SPDX-License-Identifier: BSD-3-Clause
// The pipeline of one frame: detectors, SLAM, objects, map; and maps of several runs, joined.
#pragma once

#include <headway/core/log.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/stage_times.h>
#include <headway/map/map_file.h>
#include <headway/pipeline/perception_params.h>
#include <headway/pipeline/perception_update.h>
#include <headway/stereo/rig_capability.h>

#include <functional>

namespace headway::pipeline {

/// Calls to the host program, in the thread that calls Perception::process(), and before it
/// returns. Each may be empty. They must not call the Perception; an exception ends process().
struct PerceptionCallbacks {
  /// After localisation, before objects are detected: pose and covariance of the frame at a time,
  /// or that the camera is lost.
  std::function<void(Time, const slam::SlamUpdate&)> on_pose;
  /// After tracking: tracks of the frame with predictions.
  std::function<void(Time, const std::vector<Track>&)> on_tracks;
  /// After keyframes, landmarks, grid or dense points have changed: the map, which is cheap to
  /// copy.
  std::function<void(const map::PerceptionMap&)> on_map;
};

/// What a robot needs first of a frame: its pose, and a map with what is blocked now.
using LocalCall = std::function<void(const slam::SlamUpdate&, const map::PerceptionMap&)>;

struct JointMap;

/// A part of the map that is not joined to the rest.
struct Submap {
  int number = 0;  ///< SlamUpdate::submap
  map::PerceptionMap map;
};

/// The complete pipeline: frame -> detectors -> slam -> detectors -> objects -> map.
///
/// Synchronous and deterministic: same frames and parameters, same results. Robot programs and the
/// replay use this class alike.
///
///     Perception perception(source.camera(), params);
///     while (auto frame = source.next()) {
///       PerceptionUpdate update = perception.process(*frame);
///       if (const Finding* wrong = update.fatalFinding()) stop(wrong->text);
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

  /// Where the robot is in the map, roughly: there a camera that is not localised in it is searched
  /// first (see slam::StereoSlam), from the next frame on. By any thread.
  void setInitialPose(const Pose& T_map_robot);

  /// The map as stored in a file, with the data for resume(), without configuration.
  [[nodiscard]] map::StoredMap stored() const;

  /// Processes one frame. Times increase; an earlier time than the last frame's means that the
  /// clock was set back, and ends all tracks. A frame with the time of the one before is localised,
  /// but its detections are dropped as "time_repeated", because motion between both is unknown.
  ///
  /// With a recorded pose SLAM is not run. While the camera is lost, tracks are predicted and the
  /// frame's detections are dropped as "camera_lost".
  /// A frame with neither images nor pose counts as lost.
  ///
  /// What is wrong with the input is no exception: PerceptionUpdate::findings says it, and the
  /// program decides what ends it. Warnings: see warnings(). Fatal: "camera_pose" (the images show
  /// the ground elsewhere, or turn otherwise than the gyroscope), "distance_unit" (the camera moves
  /// 30 times as far as the wheels), "right_camera_turned" (by more than can be corrected). After a
  /// fatal finding no pose counts as tracked.
  ///
  /// @throws InputError for images that are not of the camera's size, and for a recorded pose in a
  ///         map that was resumed. Both are found before anything changes, so that the object is as
  ///         it was. Any other exception (no memory, a callback) leaves an object that can be read,
  ///         stored and given the next frame: that follows the last frame that was completed; the
  ///         interrupted one may be part of trajectory, tracks and map, or not.
  ///
  /// @param on_local  called with the frame's pose and a map with what is blocked now, while
  ///                  objects are detected; tracks, and grid, are still those of the frame before
  [[nodiscard]] PerceptionUpdate process(const RecordedFrame& frame, const LocalCall& on_local = {});

  /// The camera of the frames, with its mounting. Where none is stated (it is less than 0.05 m
  /// above the robot's origin) it is that of a loaded map, or by the floor in view, as soon as that
  /// shows that the camera is not mounted as on a car. Null without images.
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const;

  /// Capability of the rig at the measured rate of frames, with the parameters that replace derived
  /// values; nullopt without camera.
  [[nodiscard]] const std::optional<stereo::RigCapability>& rig() const;

  /// Sink of messages: findings when they occur first, loops, relocalisation, and with kDebug the
  /// decisions of each frame. Not to be called during process().
  void setLog(LogSink sink);

  /// Not to be called during process().
  void setCallbacks(PerceptionCallbacks callbacks);

  /// Changes parameters before the next frame; callable by any thread.
  ///
  /// @param params  all of them, in range
  void change(const RuntimeParams& params);

  /// The findings of all frames that degrade the results: "imu_accelerometer" and "imu_gyroscope"
  /// (left out, they contradict the camera), "odometry_scale", "odometry_contradicts",
  /// "motion_left_out", "camera_frozen", "one_image", "camera_dark", "camera_bright",
  /// "vertical_offset", "images_not_simultaneous", "images_swapped", "images_disagree", "speed",
  /// "clock_set_back", "clock_jumps_ahead", "time_repeated", "recorded_boxes_missing",
  /// "camera_mounting", "too_near", "blurred", and "lost_" with "too_dark", "covered", "blurred",
  /// "few_features" or "moved_too_fast".
  [[nodiscard]] const Warnings& warnings() const;

  /// How the camera is mounted by the floor in view, in words; nullopt before one was seen for 2 s
  /// of motion.
  [[nodiscard]] std::optional<std::string> mounting() const;

  /// Rotation of the right camera against its calibration, by the images so far, and whether it is
  /// corrected, in one line; nullopt with too few matches or without images.
  [[nodiscard]] std::optional<std::string> rectification() const;

  /// Laser scans by use ("used", "camera_lost", "ground_unknown", "between_ground_scans") and ends
  /// of their beams ("obstacles", "on_moving_objects", "on_ground", "above_robot", "on_robot",
  /// "beyond_reach"); empty without a laser.
  [[nodiscard]] const std::map<std::string, std::size_t>& laserCounts() const;

  /// The map after the last frame, of the submap that the camera is in: landmarks, keyframes,
  /// occupancy grid and moving objects; and the
  /// dense points as of updateDenseMap() or finish(), in live operation as of a second ago.
  [[nodiscard]] const map::PerceptionMap& map() const;

  /// Fuses the depth scans of all frames so far, and updates the map's layer of dense points.
  void updateDenseMap();

  /// All frames so far, with their latest corrections.
  [[nodiscard]] std::vector<slam::FrameEstimate> trajectory() const;

  /// The same one by one, for runs of days whose frames do not fit into memory.
  void visitTrajectory(const slam::FrameVisitor& visit) const { trajectorySnapshot()(visit); }

  /// The same as the trajectory is now, for any thread.
  [[nodiscard]] slam::TrajectoryVisit trajectorySnapshot() const;

  /// Waits for background threads and applies their results; call after the last frame, before the
  /// final map and trajectory are read. map() is that of the largest submap afterwards.
  void finish();

  /// The static layers of the submaps that map() does not show: each in a frame of its own, whose
  /// place in the map is not known unless it is the one numbered 0.
  [[nodiscard]] std::vector<Submap> otherSubmaps();
  /// Number of all submaps, at least 1.
  [[nodiscard]] std::size_t submapCount() const;

  /// The samples still in the smoothing windows; call once, after the last frame.
  [[nodiscard]] std::vector<TrackSample> flush();

  /// Milliseconds by stage: "slam_track", "slam_map", "ground" (the end of stereo matching, too),
  /// "local", "objects", "grid" (of scanned frames), "map_update", "frame"; and in other threads
  /// "detect" (of frames with image-based detection), "dense_scan" (of scanned frames) and
  /// "dense_fuse".
  [[nodiscard]] StageTimes times() const;

 private:
  friend std::vector<JointMap> joinMaps(const std::vector<Perception*>& runs);
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// One map of runs that have seen the same places, or of a single run.
struct JointMap {
  std::vector<std::size_t> runs;  ///< indices, ascending; the map's frame is that of the first one
  std::vector<Pose> T_map_run;    ///< of each: by which the beginning of its own map was moved
  std::size_t links = 0;          ///< keyframes that were recognised in the map of another run
  map::StoredMap stored;          ///< landmarks, keyframes and grid, for Perception::resume()
};

/// Joins the maps of finished runs (see slam::joinMaps()) and moves the map and the trajectory of
/// each run into the joint one. The moving objects at the end of a run, whose positions rest on its
/// own map, are removed from the map of each run that was joined with others.
///
/// Runs without images or with given poses have no landmarks, so that they stay alone.
///
/// @param runs  after finish(), with the same parameters and camera; none null
/// @return      by ascending first run; each run is in one of them
/// @throws InputError if the cameras differ
[[nodiscard]] std::vector<JointMap> joinMaps(const std::vector<Perception*>& runs);

}  // namespace headway::pipeline
