// SPDX-License-Identifier: BSD-3-Clause
#include "predicted_box.h"

namespace headway::objects {

std::optional<Box2d> predictedBox(const Box2d& box, const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& to, double height) {
  constexpr double kMinDepth_m = 0.1;
  if (!(from.z() > kMinDepth_m && to.z() > kMinDepth_m && height > 0.0)) return std::nullopt;
  const double focal_px = box.height() * from.z() / height;
  const double scale = from.z() / to.z();
  const double u =
      0.5 * (box.left + box.right) + focal_px * (to.x() / to.z() - from.x() / from.z());
  const double v =
      0.5 * (box.top + box.bottom) + focal_px * (to.y() / to.z() - from.y() / from.z());
  const double half_width = 0.5 * scale * box.width();
  const double half_height = 0.5 * scale * box.height();
  return Box2d{u - half_width, v - half_height, u + half_width, v + half_height};
}

}  // namespace headway::objects
