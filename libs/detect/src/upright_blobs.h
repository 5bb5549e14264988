#pragma once

#include <optional>
#include <vector>

#include "object_extent.h"

namespace headway::detect {

/// Speed of a body across the line of sight, as one pair of frames shows it.
struct AcrossSpeed {
  double speed = 0.0;    ///< to the right [m/s]
  double sigma = 0.0;    ///< [m/s]
  double seconds = 0.0;  ///< between the frames
};

/// A thing of a person's size that stands on the ground, clear of its surroundings.
struct UprightBlob {
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< middle of its upper half [px]
  double width_px = 0.0;                          ///< [px]
  bool hidden = false;       ///< partly, behind something nearer or by the image's edge
  bool cut_by_flow = false;  ///< from its surroundings, which are as near
  std::vector<ObjectCell> cells;
  std::optional<AcrossSpeed> across;  ///< where its flow was measured
};

/// Cells of a disparity image that are high enough for no ground and low enough for a person.
struct StandingCells {
  cv::Mat disparities;  ///< [px] 32-bit; 0 where nothing stands
  cv::Mat heights;      ///< above the ground [m] 64-bit; undefined where nothing stands
};

/// @param range_m  farther cells are left out [m]
[[nodiscard]] StandingCells standingCells(const stereo::DisparityImage& disparity,
                                          const StereoCamera& camera,
                                          const stereo::GroundPlane& ground, double range_m);

/// Cuts things of a person's size out of a disparity image: connected cells of nearly one
/// disparity, off the ground, 0.2 to 2 m wide and 0.9 to 2.4 m high; of several heads, several
/// things.
///
/// @param range_m  farther things are left out [m]
[[nodiscard]] std::vector<UprightBlob> uprightBlobs(const stereo::DisparityImage& disparity,
                                                    const StereoCamera& camera,
                                                    const stereo::GroundPlane& ground,
                                                    double range_m);

/// The same where the standing cells are known, all or some of them.
///
/// @param disparity  of the whole image; says what is hidden behind something nearer
[[nodiscard]] std::vector<UprightBlob> uprightBlobs(const StandingCells& standing,
                                                    const stereo::DisparityImage& disparity,
                                                    const StereoCamera& camera);

}  // namespace headway::detect
