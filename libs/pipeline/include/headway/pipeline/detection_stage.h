#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/params.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/track.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/ground_scanner.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::pipeline {

/// Where detections come from. Sections [detect], [disparity], [stereo_motion], [dnn] and [hog].
struct DetectionParams {
  /// "none", "auto", or names joined by "+": "recorded" and those of detect::detectorNames().
  /// "auto" is stereo_motion until the recording brings boxes of its own, and those from then on.
  std::string detector = "auto";
  detect::DetectParams detect;

  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// Throws InputError, saying what there is, unless `names` can stand for DetectionParams::detector.
void checkDetectorNames(const std::string& names);

/// Whether `names` make use of recorded boxes.
[[nodiscard]] bool usesRecordedBoxes(const std::string& names);

/// Brings together what every source says of a frame's objects, before and after the camera's
/// pose is known.
///
///     stage.begin(frame);                                    // recorded boxes, networks
///     auto camera = slam.process(*frame.stereo, stage.movingRegions(frame, tracks));
///     auto detections = stage.finish(frame, camera.T_map_robot);   // stereo_motion, fusion, depth
///     if (detections) tracker.update(index, pose, *detections);
class DetectionStage {
 public:
  /// @param camera  null where there are no images: then only recorded boxes can be had
  /// @throws InputError for detectors that are not known, need images where there are none, or
  ///                    lack a model that fits
  DetectionStage(std::shared_ptr<const StereoCamera> camera, const DetectionParams& params);
  ~DetectionStage();

  /// Takes a frame's recorded boxes and asks the detectors that need no pose.
  ///
  /// @param scanned  whether scanGround() will be asked for this frame: matching starts at once
  void begin(const RecordedFrame& frame, bool scanned = false);

  /// What may move in this frame: boxes found so far unless `previous` knows them to be still, and
  /// what moved in the frame before, moved along.
  ///
  /// @param previous  tracks of the frame before
  [[nodiscard]] MovingRegions movingRegions(const RecordedFrame& frame,
                                            const std::vector<Track>& previous) const;

  /// Asks the detectors that need the pose, and gives depth to boxes that have none.
  ///
  /// @param T_map_robot  nullopt where the camera is lost
  /// @return  all detections of the frame without doubles; nullopt if nobody looked at it
  [[nodiscard]] std::optional<Detections> finish(const RecordedFrame& frame,
                                                 const std::optional<Pose>& T_map_robot);

  /// Looks over the ground of a frame that finish() has seen, without what moves in it.
  ///
  /// @param tracks  of this frame
  /// @return        nullopt where the ground cannot be told (expected, not an error)
  [[nodiscard]] std::optional<GroundScan> scanGround(const RecordedFrame& frame,
                                                     const Pose& T_map_robot,
                                                     const std::vector<Track>& tracks,
                                                     const detect::GroundScanParams& params);

  /// What the detectors left out since the last call, by reason.
  [[nodiscard]] DropCounts takeDropped();

  /// Whether this frame's images were looked at: by a detector, or for the depth of a box.
  [[nodiscard]] bool looked() const { return looking_ || lifting_; }

 private:
  void ask(bool with_pose, const StereoFrame& frame, const std::optional<Pose>& T_map_robot);
  void lift(const StereoFrame& frame, Detections& detections);

  std::shared_ptr<const StereoCamera> camera_;
  bool use_recorded_ = false;
  bool automatic_ = false;  ///< detectors step aside once the recording brings boxes
  int every_nth_frame_ = 1;
  std::shared_ptr<stereo::DisparityMatcher> matcher_;
  std::vector<std::unique_ptr<detect::Detector>> detectors_;

  int frames_ = 0;
  bool looking_ = false;                       ///< the image detectors have their turn
  bool lifting_ = false;                       ///< a recorded box lacks its depth
  std::optional<stereo::GroundPlane> ground_;  ///< where it was looked for last
  std::vector<Detections> found_;              ///< in this frame, best informed first
  DropCounts dropped_before_;                  ///< of all detectors, as last taken
};

}  // namespace headway::pipeline
