// SPDX-License-Identifier: BSD-3-Clause
// KLT tracking of points from one image to another.
#pragma once

#include <headway/stereo/image_pyramid.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace headway::stereo {

/// A point's position in another image [px]; nullopt where it was not found.
using TrackedPosition = std::optional<Eigen::Vector2d>;

/// Window, pyramid and tests of tracked points.
struct PointTrackingOptions {
  int window_px = 9;              ///< side of the window compared, odd, at most kMaxTrackingWindow
  int coarsest_level = 3;         ///< of the pyramids, at which the search starts
  double max_grey_error = 18.0;   ///< mean difference of both windows [grey values]
  double max_return_error = 0.7;  ///< between a point and itself tracked back; 0: no test [px]
  double min_zncc = -1.0;         ///< correlation of both windows; -1: no test
};

/// Tracks points from one image to another by their surroundings, coarse to fine.
///
/// Where less than half of the points are found, the exposures are adapted to each other and the
/// search repeated; the result with more points counts. It does not depend on the number of
/// threads.
///
/// @param from       with gradients
/// @param to         with gradients, for speed, if points are tracked back
/// @param points     [px], level 0
/// @param predicted  their positions in the other image, one each
/// @see  Lucas & Kanade 1981; Bouguet 2001 (pyramids)
[[nodiscard]] std::vector<TrackedPosition> trackPoints(
    const ImagePyramid& from, const ImagePyramid& to, const std::vector<Eigen::Vector2d>& points,
    const std::vector<Eigen::Vector2d>& predicted, const PointTrackingOptions& options);

/// Tracks the points that were not found, from other predictions or with other options.
///
/// @param points     [px], level 0
/// @param predicted  their positions in the other image, one each
/// @param tracked    of an earlier call, one each; nullopt is replaced where the point is found
void trackMissing(const ImagePyramid& from, const ImagePyramid& to,
                  const std::vector<Eigen::Vector2d>& points,
                  const std::vector<Eigen::Vector2d>& predicted,
                  const PointTrackingOptions& options, std::vector<TrackedPosition>& tracked);

}  // namespace headway::stereo
