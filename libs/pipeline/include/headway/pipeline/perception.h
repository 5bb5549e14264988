#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/stage_times.h>
#include <headway/map/map_file.h>
#include <headway/map/static_grid.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/pipeline/detection_stage.h>
#include <headway/slam/stereo_slam.h>
#include <headway/stereo/rig_capability.h>

#include <memory>
#include <optional>
#include <vector>

namespace headway::pipeline {

/// How the still world becomes a grid of free and occupied cells. Section [grid].
struct GridParams {
  int every_nth_frame = 3;  ///< one frame in so many is looked at; 0: no grid
  detect::GroundScanParams scan;
  map::StaticGridParams map;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Parameters of everything that the pipeline runs.
struct PerceptionParams {
  slam::SlamParams slam;
  DetectionParams detection;
  objects::ObjectsParams objects;
  GridParams grid;

  /// Binds sections [slam], [detect] with those of the detectors, [objects] and [grid].
  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// What one frame said: where the robot is and what moves around it.
struct PerceptionUpdate {
  std::size_t frame = 0;
  Time time = 0.0;                       ///< [s]
  slam::SlamUpdate camera;               ///< status, T_map_robot and its covariance
  std::optional<Detections> detections;  ///< of all sources; nullopt: nobody looked
  objects::TrackUpdate objects;          ///< with all that was dropped, by reason
};

/// The whole of headway on one page: frame -> detectors -> slam -> detectors -> objects -> the one
/// map.
///
/// Synchronous and deterministic: same frames and parameters, same results. A robot program and
/// the replay run this same class.
///
///     Perception perception(source.camera(), params);
///     while (auto frame = source.next()) {
///       PerceptionUpdate update = perception.process(*frame);
///       avoid(update.objects.tracks);
///     }
class Perception {
 public:
  /// @param camera  of every stereo frame to come; null where only poses and boxes are given
  /// @param map     whose layers are filled, such as one described by an .ini
  /// @throws InputError for detectors that are not known or lack what they need
  Perception(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
             map::PerceptionMap map = {});
  ~Perception();

  /// Goes on in a stored map, before the first frame: the camera counts as lost until it is
  /// recognised there; then its poses are in the stored map's frame, and with slam.mapping the map
  /// grows on. What moved when the map was stored is not taken over.
  ///
  /// @throws InputError if there is no camera here, or the map holds nothing to be recognised by,
  ///         is damaged, of another version or of another camera
  void resume(const map::StoredMap& stored);

  /// The map as a file keeps it, all that resume() needs included; without configuration.
  [[nodiscard]] map::StoredMap stored() const;

  /// Takes one frame in. Frames come in order of time.
  ///
  /// With a recorded pose SLAM is not run. While the camera is lost, tracks are carried on by
  /// their predictions and the frame's detections are dropped as "camera_lost".
  /// A frame with neither images nor pose counts as lost.
  ///
  /// @throws InputError if a frame brings its own pose to a resumed map
  [[nodiscard]] PerceptionUpdate process(const RecordedFrame& frame);

  /// What the rig can see, with the parameters that replace derived values; nullopt without a
  /// camera.
  [[nodiscard]] const std::optional<stereo::RigCapability>& rig() const { return rig_; }

  /// The one map: landmarks, keyframes, free and occupied ground, and moving objects, as after the
  /// last frame.
  [[nodiscard]] const map::PerceptionMap& map() const { return map_; }

  /// Every frame so far, as corrected since.
  [[nodiscard]] std::vector<slam::FrameEstimate> trajectory() const;

  /// Takes in what still runs beside the tracking; call after the last frame, before map,
  /// trajectory or stored map are read for good. Without threads there is nothing to wait for.
  void finish();

  /// The samples that the tracker still smooths; call once, after the last frame.
  [[nodiscard]] std::vector<TrackSample> flush() { return tracker_.flush(); }

  /// Milliseconds by stage: "slam_track", "slam_map", "detect" (of frames whose images were
  /// looked at), "objects", "grid" (of frames that it looked at), "map_update", "frame".
  [[nodiscard]] StageTimes times() const;

 private:
  [[nodiscard]] bool hasGridTurn(const RecordedFrame& frame);
  [[nodiscard]] std::optional<stereo::FrameContext> contextOf(const RecordedFrame& frame);
  slam::SlamUpdate localise(const RecordedFrame& frame, const ObjectDetections& boxes);
  slam::SlamUpdate useGivenPose(const RecordedFrame& frame);
  objects::TrackUpdate track(const RecordedFrame& frame, const PerceptionUpdate& update);
  void updateMap(const PerceptionUpdate& update);
  void updateStaticMap();
  void updateGrid(const RecordedFrame& frame, const PerceptionUpdate& update);

  std::shared_ptr<const StereoCamera> camera_;
  std::unique_ptr<slam::StereoSlam> slam_;  ///< null where there is no camera
  stereo::FrontEnd front_end_;
  DetectionStage detection_;
  objects::MovingObjectTracker tracker_;
  std::optional<stereo::RigCapability> rig_;
  GridParams grid_params_;
  map::StaticGrid grid_;
  map::PerceptionMap map_;
  std::size_t grid_frames_ = 0;                   ///< that could have been scanned
  bool resumed_ = false;                          ///< the map frame is a stored map's
  FrameDetections found_;                         ///< in the newest frame
  std::vector<Track> tracks_;                     ///< of the previous frame
  std::vector<ExpectedObject> expected_;          ///< as of the previous frame
  std::vector<slam::FrameEstimate> given_poses_;  ///< frames that came with their pose
  StageTimes times_;
};

}  // namespace headway::pipeline
