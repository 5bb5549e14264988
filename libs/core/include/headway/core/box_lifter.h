#pragma once

#include <headway/core/detection.h>

#include <optional>

namespace headway {

/// A 3D box found behind a 2D one.
struct LiftedBox {
  Box3d box;                                                        ///< sensor's optical frame
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< optical frame [m^2]
};

/// Gives 2D boxes the depth, size and heading that their detector did not.
///
/// An implementation holds what it needs of the frame (disparity, camera, ground); whoever made it
/// for a frame hands it on together with that frame's detections.
class BoxLifter {
 public:
  virtual ~BoxLifter() = default;

  /// The 3D box of one object; nullopt where its depth cannot be told (expected, not an error).
  [[nodiscard]] virtual std::optional<LiftedBox> lift(const Box2d& box,
                                                      ObjectClass object_class) const = 0;
};

}  // namespace headway
