// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/camera_difference.h>
#include <headway/core/formatted.h>

#include <cmath>

namespace headway {
namespace {

std::string textOf(const StereoCamera& camera) {
  return formatted("%dx%d px, f %.2f %.2f px, centre %.2f %.2f px, baseline %.4f m", camera.width,
                   camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline_m);
}

}  // namespace

std::optional<std::string> differenceBetween(const StereoCamera& other, const StereoCamera& here) {
  constexpr double kTolerance = 1e-3;  ///< relative
  const auto near = [](double a, double b) { return std::abs(a - b) <= kTolerance * std::abs(b); };
  const bool same = other.width == here.width && other.height == here.height &&
                    near(other.fx, here.fx) && near(other.fy, here.fy) && near(other.cx, here.cx) &&
                    near(other.cy, here.cy) && near(other.baseline_m, here.baseline_m);
  if (same) return std::nullopt;
  return textOf(other) + "; here " + textOf(here);
}

}  // namespace headway
