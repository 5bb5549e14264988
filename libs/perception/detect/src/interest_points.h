// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// Where objects could be, above the ground.
struct InterestZone {
  double range_m = 50.0;      ///< depth [m]
  double max_height_m = 3.5;  ///< above ground [m]
  double people_m = 28.0;     ///< depth to which people are looked for [m]
};

/// The best corners to track, at most one to a square of `spacing_px`, strongest first.
///
/// Corners that may be on a person (below 2 m, within `people_m`) are preferred to others, of which
/// trees have the strongest. Nine tenths lie in the zone; the rest anywhere with a disparity.
/// Squares that hold one of the points `taken` are skipped. Without a ground plane heights are not
/// tested.
///
/// @see  Shi & Tomasi 1994: the smaller eigenvalue, here in an image reduced to a half
[[nodiscard]] std::vector<cv::Point2f> interestPoints(
    const cv::Mat& image, const stereo::DisparityImage& disparity, const StereoCamera& camera,
    const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone,
    const std::vector<cv::Point2f>& taken, int spacing_px, int wanted);

}  // namespace headway::detect
