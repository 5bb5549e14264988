// SPDX-License-Identifier: BSD-3-Clause
// The views of pictures, and the scale of a scene.
#pragma once

#include <headway/scene/snapshot.h>

#include <array>
#include <opencv2/core/types.hpp>
#include <utility>

namespace headway::scene {

/// Size of a scene relative to that of a car's: 1 for a rig that sees obstacles 20 m away or
/// farther, and without a camera; less for the rig of a robot. Distances, widths and spacings of
/// pictures are proportional to it.
[[nodiscard]] double sceneScale(const SnapshotInput& input);

/// Spacing of the lines of the ground grid: 10 m at scale 1, rounded down to 1, 2 or 5 times a
/// power of ten.
[[nodiscard]] double gridSpacing(double scale);

/// Height of the ground around the robot in the map frame [m].
///
/// Median of the lower faces of boxes within 40 m (at scale 1); with too few boxes a low percentile
/// of the landmark heights; with too few landmarks the robot's own height.
[[nodiscard]] double groundHeight(const SnapshotInput& input);

/// The external views `follow`, `top` and `orbit`.
[[nodiscard]] render::PinholeView externalView(const SnapshotOptions& options,
                                               const SnapshotInput& input, double ground_z);

/// The robot's left camera, with its image scaled to `size`.
[[nodiscard]] render::PinholeView cameraView(const StereoCamera& camera, const Pose& T_map_robot,
                                             const cv::Size& size);

/// Largest centred rectangle in a picture with the aspect ratio of an image.
[[nodiscard]] cv::Rect fittedInto(const cv::Size& image, const cv::Size& picture);

using Edge = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// The left camera's viewing frustum up to a depth, 1.8 m at scale 1: four edges of the far face,
/// then the four edges from the camera to its corners [m, map frame].
[[nodiscard]] std::array<Edge, 8> frustumEdges(const StereoCamera& camera, const Pose& T_map_robot,
                                               double scale);

}  // namespace headway::scene
