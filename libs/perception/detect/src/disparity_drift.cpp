// SPDX-License-Identifier: BSD-3-Clause
// Drift of disparities that neighbouring points share, as patches of the static scene show it.
#include "disparity_drift.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace headway::detect {
namespace {

constexpr double kLeast_px = 0.1;       // below it the noise of single points hides it
constexpr double kPatchWidth_m = 0.5;   // of a person
constexpr double kPatchHeight_m = 1.0;  // of that part of a person that hides nothing else
constexpr double kPatchDepth = 1.15;    // ratio of disparities on one surface
constexpr std::size_t kMinPoints = 3;   // as clusters and segments need
constexpr double kQuantile = 0.3;       // two of five patches may move before half of it is wrong
constexpr double kChiAtQuantile = 0.1485;  // chi-square of 1 degree of freedom
constexpr double kGain = 0.25;             // of a patch on the logarithm of a variance, in 0.1 s
constexpr double kOfNextOctave = 0.25;     // weight of a patch, for disparities twice its own

/// A surface of a person's size at one depth.
using Patch = std::tuple<int, int, int>;

Patch patchOf(const Eigen::Vector3d& uvd, const StereoCamera& camera) {
  const double layer = std::floor(std::log(uvd.z()) / std::log(kPatchDepth));
  const double px_per_m = std::pow(kPatchDepth, layer) / camera.baseline_m;
  return {static_cast<int>(layer), static_cast<int>(uvd.x() / (kPatchWidth_m * px_per_m)),
          static_cast<int>(uvd.y() / (kPatchHeight_m * px_per_m))};
}

/// The points of a patch: how fast their disparities drift together.
struct PatchMotion {
  std::size_t points = 0;
  double disparity = 0.0;    ///< of the last point [px]
  double span_s = 0.0;       ///< of the longest observations
  double information = 0.0;  ///< of all [s^2/px^2]
  double sum = 0.0;          ///< of speeds times information [s/px]
};

Eigen::Vector3d rayInWorld(const Eigen::Vector3d& uvd, const CameraPath& path,
                           const StereoCamera& camera) {
  const Eigen::Vector3d in_camera = headway::ray(uvd.head<2>(), camera).normalized();
  return path.T_cam_world(path.newest()).linear().transpose() * in_camera;
}

/// Over which its motion was fitted [s].
double spanOf(const PointTrack& point, const CameraPath& path) {
  const auto fitted = static_cast<std::size_t>(point.motion->observations);
  const int first = point.observations[point.observations.size() - fitted].frame;
  return path.timeOf(path.newest()) - path.timeOf(first);
}

std::map<Patch, PatchMotion> patchesOf(const std::vector<PointTrack>& points,
                                       const CameraPath& path, const StereoCamera& camera,
                                       double noise_scale) {
  std::map<Patch, PatchMotion> patches;
  for (const PointTrack& point : points) {
    if (!point.motion || point.group >= 0 || point.motion->observations < kMinFitted) continue;
    if (point.observations.back().frame != path.newest()) continue;
    const double span_s = spanOf(point, path);
    if (span_s < kMinSpan_s) continue;
    const Eigen::Vector3d& uvd = point.observations.back().uvd;
    const Eigen::Vector3d ray = rayInWorld(uvd, path, camera);
    const double px_per_m = uvd.z() * uvd.z() / (camera.fx * camera.baseline_m);
    const double scale = std::max(noise_scale * noise_scale, point.motion->steadyFit());
    const double variance = scale * ray.dot(point.motion->steady_covariance * ray);
    const double information = 1.0 / (px_per_m * px_per_m * variance);
    PatchMotion& patch = patches[patchOf(uvd, camera)];
    ++patch.points;
    patch.disparity = uvd.z();
    patch.span_s = std::max(patch.span_s, span_s);
    patch.information += information;
    patch.sum += information * px_per_m * ray.dot(point.motion->steady_velocity);
  }
  return patches;
}

double octaveOf(double disparity, std::size_t octaves) {
  return std::clamp(std::log2(disparity), 0.0, static_cast<double>(octaves - 1));
}

}  // namespace

DisparityDrift::DisparityDrift() { log_variances_.fill(2.0 * std::log(kCommonDisparity_px)); }

void DisparityDrift::update(const std::vector<PointTrack>& points, const CameraPath& path,
                            const StereoCamera& camera, double noise_scale) {
  const double gain = kGain * tenthsOf(path.lastStep_s());
  for (const auto& [place, patch] : patchesOf(points, path, camera, noise_scale)) {
    if (patch.points < kMinPoints) continue;
    const double octave = octaveOf(patch.disparity, kOctaves);
    const double speed = patch.sum / patch.information;
    for (std::size_t k = 0; k < kOctaves; ++k) {
      const double expected = std::exp(log_variances_[k]) / patch.span_s +
                              square(kCommonDisparity_px / patch.span_s) + 1.0 / patch.information;
      const bool is_faster = speed * speed > kChiAtQuantile * expected;
      const double step = is_faster ? kQuantile : kQuantile - 1.0;
      const double weight = std::pow(kOfNextOctave, std::abs(octave - static_cast<double>(k)));
      log_variances_[k] =
          std::max(log_variances_[k] + gain * weight * step, 2.0 * std::log(kLeast_px));
    }
  }
}

double DisparityDrift::at(double disparity) const {
  const double octave = octaveOf(disparity, kOctaves);
  const auto below = std::min(static_cast<std::size_t>(octave), kOctaves - 2);
  const double weight = octave - static_cast<double>(below);
  return std::exp(0.5 *
                  ((1.0 - weight) * log_variances_[below] + weight * log_variances_[below + 1]));
}

Eigen::Matrix3d DisparityDrift::velocityCovariance(const Eigen::Vector3d& uvd, double seconds,
                                                   const CameraPath& path,
                                                   const StereoCamera& camera) const {
  const Eigen::Vector3d ray = rayInWorld(uvd, path, camera);
  const double m_per_px = camera.fx * camera.baseline_m / (uvd.z() * uvd.z());
  const double sigma = at(uvd.z()) * m_per_px;
  return sigma * sigma / seconds * ray * ray.transpose();
}

}  // namespace headway::detect
