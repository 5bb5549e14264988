// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/simulator.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "actor.h"
#include "depth_sensor.h"
#include "image_formation.h"
#include "lens.h"
#include "simulated_detector.h"

namespace headway::sim {

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
