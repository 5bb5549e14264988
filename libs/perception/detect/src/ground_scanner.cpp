// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/detect/ground_scanner.h>

#include <cmath>

#include "column_scanner.h"
#include "left_out_cells.h"

namespace headway::detect {
namespace {

constexpr double kMaxUpY = -0.3;  // of "up" in the camera: columns must cross the ground

}  // namespace

void GroundScanParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("reach", reach_m, 0.0, 100.0, "m",
           "Maximum distance of free cells and of obstacles of the minimum height from the camera; "
           "a robot's grid has higher ones up to 1.3 times as far; 0: derived from the rig");
  user.add(
      "min_obstacle_height_m", min_obstacle_height_m, 0.0, 2.0, "m",
      "Height above ground from which the robot cannot drive over an obstacle; 0: 0.12 m for "
      "a camera mounted below 1 m, else 0.3 m; refused below the noise of the ground's height");
  user.add("max_obstacle_height_m", max_obstacle_height_m, 0.3, 10.0, "m",
           "Height above ground from which the robot can drive under an obstacle");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of an obstacle's disparity");
  section.add("max_error_m", max_error_m, 0.05, 10.0, "m",
              "Maximum uncertainty of the distance of an obstacle that is entered");
}

stereo::RigAssumptions GroundScanParams::configured() const {
  stereo::RigAssumptions result;
  result.min_obstacle_height_m = min_obstacle_height_m;
  result.sigma_disparity_px = sigma_disparity_px;
  result.obstacles_to_m = reach_m;
  return result;
}

stereo::RigCapability GroundScanParams::capabilityOf(const StereoCamera& camera) const {
  const auto rig = stereo::rigCapability(camera, configured());
  if (min_obstacle_height_m <= 0.0) return rig;
  const auto ground = stereo::groundPlane(rig, stereo::mountedUp(camera), rig.camera_height_m);
  const double detectable = ColumnScanner::minDetectableHeight(ground, rig.obstacles_from_m);
  const double centimetres = std::floor(100.0 * detectable);
  if (min_obstacle_height_m < 0.01 * centimetres) {
    throw InputError(formatted(
        "[grid] min_obstacle_height_m = %.3g: this camera tells obstacles from ground and ramps "
        "from %.2f m on (%.3f m is the noise of the ground's height at %.1f m); give that or more, "
        "or 0 for the camera's value",
        min_obstacle_height_m, 0.01 * centimetres, ground.tolerance(rig.obstacles_from_m),
        rig.obstacles_from_m));
  }
  return rig;
}

GroundScanParams GroundScanParams::forRig(const stereo::RigCapability& rig) const {
  GroundScanParams params = *this;
  params.reach_m = rig.obstacles_to_m;
  params.min_obstacle_height_m = rig.min_obstacle_height_m;
  return params;
}

GroundScan scanGround(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                      const stereo::GroundPlane& ground, const MovingRegions& moving,
                      const GroundScanParams& params) {
  GroundScan scan;
  if (ground.up.y() > kMaxUpY) return scan;
  const cv::Mat left_out = leftOutCells(moving, disparity);
  const auto rig = params.capabilityOf(camera);
  const GroundScanParams for_rig = params.forRig(rig);
  const auto plane = stereo::groundPlane(rig, ground.up, ground.camera_height);
  ColumnScanner scanner(disparity, camera, plane, rig, for_rig);
  for (int column = 0; column < disparity.values.cols; ++column) {
    scanner.scan(column, left_out, scan);
  }
  return scan;
}

}  // namespace headway::detect
