// SPDX-License-Identifier: BSD-3-Clause
// Upright segments of a person's size in the disparity image, and their flow across the line of
// sight.
#pragma once

#include <headway/core/stereo_camera.h>

#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "object_extent.h"
#include "residual_flow.h"

namespace headway::detect {

/// Speed across the line of sight that flow shows by itself [m/s].
inline constexpr double kMinAcross = 0.3;
/// Rows below the upper edge of the image without disparities [cells].
inline constexpr int kImageEdge = 6;

/// Splits people who walk abreast.
///
/// They touch in the disparity image but for their heads: every run of columns with cells in the
/// uppermost fifth of the height is a head, and each cell belongs to the nearest one.
///
/// @param cells           connected, of nearly one disparity
/// @param heights         of each above the ground [m]
/// @param metres_per_cell at their depth
/// @return                for each cell the number of its person, 0 ... n - 1, from left to right
[[nodiscard]] std::vector<int> personOfCells(const std::vector<cv::Point>& cells,
                                             const std::vector<double>& heights,
                                             double metres_per_cell);

/// Speed of a segment across the line of sight, measured by the flow of one pair of frames.
struct LateralSpeed {
  double speed = 0.0;    ///< to the right [m/s]
  double sigma = 0.0;    ///< [m/s]
  double seconds = 0.0;  ///< between the frames
};

/// Connected cells of the disparity image of about a person's size, upright on the ground.
struct UprightSegment {
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< centre of its upper half [px]
  double width_px = 0.0;                          ///< [px]
  bool cut_by_flow = false;  ///< separated from surroundings of the same depth by flow
  bool is_new = false;       ///< it stands where space was empty
  std::vector<ObjectCell> cells;
  std::optional<LateralSpeed> across;  ///< nullopt: flow not measured
};

/// Cells of a disparity image above the ground and below a person's height.
struct StandingCells {
  cv::Mat disparities;  ///< [px] 32-bit; 0 elsewhere
  cv::Mat heights;      ///< above the ground [m] 64-bit; undefined elsewhere
};

/// @param range_m  maximum depth [m]
[[nodiscard]] StandingCells standingCells(const stereo::DisparityImage& disparity,
                                          const StereoCamera& camera,
                                          const stereo::GroundPlane& ground, double range_m);

/// Segments a disparity image into connected cells of nearly one disparity above the ground, 0.2 to
/// 2 m wide and 0.9 to 2.4 m high. Segments with several heads are split.
///
/// @param range_m  maximum depth [m]
[[nodiscard]] std::vector<UprightSegment> uprightSegments(const stereo::DisparityImage& disparity,
                                                          const StereoCamera& camera,
                                                          const stereo::GroundPlane& ground,
                                                          double range_m);

/// The same for given cells, all or some of those standing.
///
/// @param disparity  of the whole image, to recognise occluders
[[nodiscard]] std::vector<UprightSegment> uprightSegments(const StandingCells& standing,
                                                          const stereo::DisparityImage& disparity,
                                                          const StereoCamera& camera);

/// Segments the disparity image as uprightSegments() does and measures the flow of each segment.
///
/// What stands where space was empty is segmented first, without its surroundings. Cells that flow
/// to one side significantly are segmented once more without the others, so that a person close to
/// a wall, or in front of others, becomes a segment of its own.
///
/// @param flow    may be empty: uprightSegments() alone
/// @param segments  newcomers
[[nodiscard]] std::vector<UprightSegment> segmentsByFlow(const stereo::DisparityImage& disparity,
                                                         const ResidualFlow& flow,
                                                         const StereoCamera& camera,
                                                         const StandingCells& standing,
                                                         std::vector<UprightSegment> segments);

}  // namespace headway::detect
