#pragma once

#include <headway/scene/snapshot.h>

#include <array>
#include <opencv2/core/types.hpp>
#include <utility>

namespace headway::scene {

/// Height of the ground around the robot in the map frame [m].
///
/// Median of the lower faces of boxes within 40 m; with too few boxes a low percentile of the
/// landmark heights; with too few landmarks the robot's own height.
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

/// The left camera's viewing frustum up to a depth of 1.8 m: four edges of the far face, then the
/// four edges from the camera to its corners [m, map frame].
[[nodiscard]] std::array<Edge, 8> frustumEdges(const StereoCamera& camera, const Pose& T_map_robot);

}  // namespace headway::scene
