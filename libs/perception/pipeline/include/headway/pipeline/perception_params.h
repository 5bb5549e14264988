// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the whole pipeline.
#pragma once

#include <headway/core/params.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/ground_scanner.h>
#include <headway/map/dense_map.h>
#include <headway/map/static_grid.h>
#include <headway/objects/objects_params.h>
#include <headway/slam/slam_params.h>

#include <limits>
#include <string>
#include <vector>

namespace headway::pipeline {

/// Sources of detections. Sections [detect], [disparity], [stereo_motion], [dnn], [hog] and
/// [shape].
struct DetectionParams {
  /// "none", "auto", or names joined by "+": "recorded" and those of detect::detectorNames().
  /// "auto" is stereo_motion, with shape on robots (RigCapability::meets_drops), with dnn if
  /// detect::findModel() finds a model, until the first recorded boxes, and while they are missing;
  /// otherwise the recorded boxes only.
  std::string detector = "auto";
  /// Time without recorded boxes after which they count as missing; with "auto", stereo_motion runs
  /// until they return [s].
  double recorded_timeout_s = 2.0;
  detect::DetectParams detect;

  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// Throws InputError with the available names unless `names` is valid for
/// DetectionParams::detector.
void checkDetectorNames(const std::string& names);

/// Whether `names` include recorded boxes.
[[nodiscard]] bool usesRecordedBoxes(const std::string& names);

/// The detectors of images that a configuration names, without recorded boxes.
[[nodiscard]] std::vector<std::string> imageDetectors(const DetectionParams& params);

/// File of the network that a run with images uses; empty: none.
[[nodiscard]] std::string modelInUse(const DetectionParams& params);

/// Whether a network would be used if a model were found: the detector is "auto".
[[nodiscard]] bool wouldUseModel(const DetectionParams& params);

/// Occupancy grid from ground scans. Section [grid].
struct GridParams {
  double period_s = 0.3;  ///< of ground scans; 0: no grid [s]
  bool local = true;      ///< scan each frame for what is blocked now, see map::LocalLayer
  detect::GroundScanParams scan;
  map::StaticGridParams map;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Use of 2D laser scans for the occupancy grid. Section [laser].
struct LaserParams {
  bool use = true;
  double reach_m = 10.0;  ///< farther ends of beams are not entered [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "laser"); }  ///< @throws InputError
};

/// Size of the images that are processed. Section [camera].
struct CameraParams {
  double scale = 1.0;  ///< of images inside the pipeline; results are in pixels of the input

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "camera"); }  ///< @throws InputError
};

/// Parameters of the whole pipeline.
struct PerceptionParams {
  CameraParams camera;
  slam::SlamParams slam;
  DetectionParams detection;
  objects::ObjectsParams objects;
  GridParams grid;
  map::DenseMapParams dense;
  LaserParams laser;
  map::RobotFootprint robot{0.5, 0.4};

  /// For live operation: bundle adjustment, loop search and pose graph run in the background, so
  /// that results depend on timing. A network runs on the image as a whole, without tiles, and in
  /// five times a second at most, so that two cores process 10 frames/s.
  [[nodiscard]] static PerceptionParams live() { return live(PerceptionParams()); }
  /// The same with other parameters.
  [[nodiscard]] static PerceptionParams live(PerceptionParams params);

  /// Binds sections [camera], [slam], [detect] with those of the detectors, [objects], [grid],
  /// [dense], [laser] and [robot].
  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// Parameters that may change at run time, between two frames. All others are fixed.
struct RuntimeParams {
  double detect_period_s = 0.0;     ///< detect.period_s, >= 0 [s]
  double grid_period_s = 0.3;       ///< grid.period_s, >= 0; 0 pauses the grid [s]
  double recorded_timeout_s = 2.0;  ///< detect.recorded_timeout_s, > 0 [s]
  /// Distance beyond which boxes are not tracked, but counted as "load_shed", > 0 [m].
  double max_box_range_m = std::numeric_limits<double>::infinity();
};

}  // namespace headway::pipeline
