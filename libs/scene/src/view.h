#pragma once

#include <headway/scene/snapshot.h>

#include <opencv2/core/types.hpp>

namespace headway::scene {

/// The view from outside: `follow`, `top` or `orbit`.
[[nodiscard]] render::PinholeView outsideView(const SnapshotOptions& options,
                                              const SnapshotInput& input, double ground_z);

/// The robot's left camera, for a picture of its image's proportions but any size.
[[nodiscard]] render::PinholeView cameraView(const StereoCamera& camera, const Pose& T_map_robot,
                                             const cv::Size& size);

/// The largest place of an image's proportions in the middle of a picture.
[[nodiscard]] cv::Rect fittedInto(const cv::Size& image, const cv::Size& picture);

}  // namespace headway::scene
