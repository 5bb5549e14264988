// SPDX-License-Identifier: BSD-3-Clause
// The views of pictures, and the scale of a scene.
#include "view.h"

#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>

namespace headway::scene {
namespace {

/// The external views, at scale 1.
struct ViewLayout {
  double follow_fov_rad = 64.0 * M_PI / 180.0, top_fov_rad = 40.0 * M_PI / 180.0;
  double top_height_m = 95.0;
  double orbit_radius_m = 38.0, orbit_height_m = 20.0;
  double frames_per_orbit = 360.0;
  double far_m = 400.0;  ///< nothing farther is drawn
};
constexpr ViewLayout kLayout{};

/// What the height of the ground is estimated from.
struct GroundSamples {
  double radius_m = 40.0;  ///< around the robot, at scale 1
  std::size_t min_boxes = 3, min_landmarks = 50;
  double percentile = 0.08;  ///< of the landmark heights
};
constexpr GroundSamples kGround{};

bool isNear(const Eigen::Vector3d& point, const SnapshotInput& input) {
  return (point - input.T_map_robot.translation()).head<2>().norm() <
         kGround.radius_m * sceneScale(input);
}

double percentileOf(std::vector<double>& values, double ratio) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(ratio * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Eigen::Vector3d levelDirection(double yaw) { return {std::cos(yaw), std::sin(yaw), 0.0}; }

}  // namespace

double sceneScale(const SnapshotInput& input) {
  if (input.camera == nullptr) return 1.0;
  return std::clamp(stereo::rigCapability(*input.camera).obstacles_to_m / 20.0,  // of a car
                    0.28, 1.0);
}

double gridSpacing(double scale) {
  const double wanted = 10.0 * scale;
  const double power = std::pow(10.0, std::floor(std::log10(wanted) + 1e-9));
  const double digit = wanted / power + 1e-9;
  return power * (digit >= 5.0 ? 5.0 : digit >= 2.0 ? 2.0 : 1.0);
}

double groundHeight(const SnapshotInput& input) {
  std::vector<double> heights;
  for (const auto& track : input.map.movingObjects().tracks()) {
    if (isNear(track.position, input)) {
      heights.push_back(track.position.z() - 0.5 * track.size.z());
    }
  }
  if (heights.size() >= kGround.min_boxes) return percentileOf(heights, 0.5);
  heights.clear();
  for (const auto& landmark : input.map.staticMap()->landmarks) {
    if (isNear(landmark.position, input)) heights.push_back(landmark.position.z());
  }
  if (heights.size() >= kGround.min_landmarks) return percentileOf(heights, kGround.percentile);
  return input.T_map_robot.translation().z();
}

render::PinholeView externalView(const SnapshotOptions& options, const SnapshotInput& input,
                                 double ground_z) {
  const double scale = sceneScale(input);
  const Eigen::Vector3d forward = levelDirection(yawOf(input.T_map_robot));
  Eigen::Vector3d foot = input.T_map_robot.translation();
  foot.z() = ground_z;
  const auto makeExternalView = [&](double fov, const Pose& pose) {
    auto view = render::makeView(options.width, options.height, fov, pose);
    view.far_m = kLayout.far_m;
    return view;
  };
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  if (options.view == View::kTop) {
    const Eigen::Vector3d centre = foot + 16.0 * scale * forward;
    return makeExternalView(
        kLayout.top_fov_rad,
        render::lookAt(centre + kLayout.top_height_m * scale * up, centre, forward));
  }
  if (options.view == View::kOrbit) {
    const double angle = 2.0 * M_PI * static_cast<double>(input.frame) / kLayout.frames_per_orbit;
    const Eigen::Vector3d centre = foot + 8.0 * scale * forward;
    const Eigen::Vector3d viewpoint =
        centre + scale * (kLayout.orbit_radius_m * levelDirection(angle + 0.75 * M_PI) +
                          kLayout.orbit_height_m * up);
    return makeExternalView(kLayout.follow_fov_rad, render::lookAt(viewpoint, centre));
  }
  return makeExternalView(
      kLayout.follow_fov_rad,
      render::lookAt(foot + scale * (7.5 * up - 11.0 * forward), foot + 15.0 * scale * forward));
}

render::PinholeView cameraView(const StereoCamera& camera, const Pose& T_map_robot,
                               const cv::Size& size) {
  const double scale_x = static_cast<double>(size.width) / camera.width;
  const double scale_y = static_cast<double>(size.height) / camera.height;
  render::PinholeView view;
  view.width = size.width;
  view.height = size.height;
  view.fx = camera.fx * scale_x;
  view.fy = camera.fy * scale_y;
  view.cx = (camera.cx + 0.5) * scale_x - 0.5;
  view.cy = (camera.cy + 0.5) * scale_y - 0.5;
  view.T_map_camera = T_map_robot * camera.T_robot_cam;
  view.far_m = kLayout.far_m;
  return view;
}

cv::Rect fittedInto(const cv::Size& image, const cv::Size& picture) {
  const double scale = std::min(static_cast<double>(picture.width) / image.width,
                                static_cast<double>(picture.height) / image.height);
  const int width = std::max(1, static_cast<int>(std::lround(image.width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(image.height * scale)));
  return {(picture.width - width) / 2, (picture.height - height) / 2, width, height};
}

std::array<Edge, 8> frustumEdges(const StereoCamera& camera, const Pose& T_map_robot,
                                 double scale) {
  const double depth = 1.8 * scale;
  const Pose T_map_cam = T_map_robot * camera.T_robot_cam;
  const auto corner = [&](double u, double v) {
    return Eigen::Vector3d(T_map_cam * (depth * ray({u, v}, camera)));
  };
  const std::array<Eigen::Vector3d, 4> corners = {corner(0, 0), corner(camera.width, 0),
                                                  corner(camera.width, camera.height),
                                                  corner(0, camera.height)};
  std::array<Edge, 8> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges[i] = {corners[i], corners[(i + 1) % 4]};
    edges[4 + i] = {T_map_cam.translation(), corners[i]};
  }
  return edges;
}

}  // namespace headway::scene
