// SPDX-License-Identifier: BSD-3-Clause
// Finishing of drawn frames: truth, detections and sensor effects.
#pragma once

#include <headway/core/detector_noise.h>
#include <headway/core/random.h>
#include <headway/sim/sim_params.h>
#include <headway/sim/simulator.h>

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "actor.h"
#include "image_formation.h"
#include "lens.h"
#include "mesh_projection.h"

namespace headway::sim {

/// A detection network's output for one image, made from the truth.
///
/// Noise grows with depth, misses with depth and occlusion; some objects are detected twice, some
/// boxes have no object, some headings are turned by 180 degrees, some ids change.
class SimulatedDetector {
 public:
  SimulatedDetector(const DetectorParams& params, const StereoCamera& camera, std::uint64_t seed);

  /// @param depth  of the left picture; false boxes stand where it has surfaces [m]
  [[nodiscard]] Detections detect(Time time, const std::vector<Actor>& actors,
                                  const std::vector<Observation>& observations,
                                  const cv::Mat& depth);

 private:
  [[nodiscard]] bool isMissed(const Actor& actor, const Observation& observation);
  [[nodiscard]] Detection measure(const Actor& actor, const Observation& observation);
  [[nodiscard]] DetectorNoise noiseAt(double depth_m) const;
  [[nodiscard]] Detection falseAlarm(const cv::Mat& depth);
  void finish(Detection& detection) const;

  DetectorParams params_;
  StereoCamera camera_;
  Random random_;
  std::map<std::int64_t, std::int64_t> detector_ids_;  ///< by truth id
  std::int64_t next_id_ = 1;
};

/// A frame as drawn, with what is needed to finish it when the world has moved on.
struct DrawnFrame {
  SimFrame frame;       ///< without pictures and what is seen in them
  cv::Mat left, right;  ///< clean drawings
  cv::Mat depth;        ///< of the left one
  std::vector<Actor> actors;
  std::vector<Mesh> meshes;  ///< the actors' meshes, relative to the robot's position
  Pose T_world_robot = Pose::Identity();
  std::size_t trigger = 0;  ///< number among all that were taken
};

/// Finishes frames that were drawn: finds the objects in them, detects them, and does to the
/// pictures what a sensor does.
///
/// Frames are finished one after another in their order.
class FrameFinisher {
 public:
  /// The lens must outlive the object.
  FrameFinisher(const SimParams& params, const Lens& lens, std::uint64_t image_seed,
                std::uint64_t detector_seed);

  [[nodiscard]] SimFrame finish(DrawnFrame drawn);

 private:
  /// What is in the frame, and what a detector makes of it.
  void annotate(SimFrame& frame, const DrawnFrame& drawn);

  const Lens& lens_;
  double truth_range_m_;
  ImageFormation image_formation_;
  DepthSensor depth_sensor_;
  bool is_depth_camera_;
  SimulatedDetector detector_;
  std::optional<Pose> T_map_world_;
};

}  // namespace headway::sim
