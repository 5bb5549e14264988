// SPDX-License-Identifier: BSD-3-Clause
#include "shadow.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {

cv::Mat drawShadow() {
  constexpr int kSize = 64;  // [px]
  cv::Mat picture(kSize, kSize, CV_8UC4);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double dx = std::abs((x + 0.5) / kSize - 0.5) * 2.0;
      const double dy = std::abs((y + 0.5) / kSize - 0.5) * 2.0;
      const double away = std::pow(std::pow(dx, 4) + std::pow(dy, 4), 0.25);
      const double dark = std::clamp((1.0 - away) / 0.3, 0.0, 1.0);
      picture.at<cv::Vec4b>(y, x) = {12, 12, 12,
                                     static_cast<uchar>(190.0 * dark * dark * (3.0 - 2.0 * dark))};
    }
  }
  return picture;
}

Mesh shadowMesh(const Actor& actor, const Eigen::Vector3d& origin) {
  const bool walks = isPerson(actor.kind);
  const double grow_l = walks ? 1.0 : 1.2, grow_w = walks ? 1.3 : 1.5;
  const Eigen::Vector3f foot =
      (actor.position - origin + Eigen::Vector3d(0, 0, 0.025)).cast<float>();
  const auto c = static_cast<float>(std::cos(actor.yaw)),
             s = static_cast<float>(std::sin(actor.yaw));
  const Eigen::Vector3f ex =
      static_cast<float>(0.5 * grow_l * actor.size.x()) * Eigen::Vector3f(c, s, 0);
  const Eigen::Vector3f ey =
      static_cast<float>(0.5 * grow_w * actor.size.y()) * Eigen::Vector3f(-s, c, 0);
  Mesh mesh;
  mesh.addQuad(foot + ex + ey, foot - ex + ey, foot - ex - ey, foot + ex - ey, UvRect{});
  return mesh;
}

}  // namespace headway::sim
