#include "view.h"

#include <algorithm>
#include <cmath>

namespace headway::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFollowFov = 64.0 * kPi / 180.0;
constexpr double kTopFov = 40.0 * kPi / 180.0;
constexpr double kTopHeightM = 95.0;
constexpr double kOrbitRadiusM = 38.0;
constexpr double kOrbitHeightM = 20.0;
constexpr double kFramesPerTurn = 360.0;
constexpr double kFarM = 400.0;

Eigen::Vector3d levelDirection(double yaw) { return {std::cos(yaw), std::sin(yaw), 0.0}; }

}  // namespace

render::PinholeView outsideView(const SnapshotOptions& options, const SnapshotInput& input,
                                double ground_z) {
  const Eigen::Vector3d forward = levelDirection(yawOf(input.T_map_robot));
  Eigen::Vector3d place = input.T_map_robot.translation();
  place.z() = ground_z;
  const auto viewFromPlace = [&](double fov, const Pose& pose) {
    auto view = render::makeView(options.width, options.height, fov, pose);
    view.far_m = kFarM;
    return view;
  };
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  if (options.view == View::kTop) {
    const Eigen::Vector3d middle = place + 16.0 * forward;
    return viewFromPlace(kTopFov, render::lookAt(middle + kTopHeightM * up, middle, forward));
  }
  if (options.view == View::kOrbit) {
    const double turn = 2.0 * kPi * static_cast<double>(input.frame) / kFramesPerTurn;
    const Eigen::Vector3d middle = place + 8.0 * forward;
    const Eigen::Vector3d eye =
        middle + kOrbitRadiusM * levelDirection(turn + 0.75 * kPi) + kOrbitHeightM * up;
    return viewFromPlace(kFollowFov, render::lookAt(eye, middle));
  }
  return viewFromPlace(kFollowFov,
                       render::lookAt(place - 11.0 * forward + 7.5 * up, place + 15.0 * forward));
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
  view.far_m = kFarM;
  return view;
}

cv::Rect fittedInto(const cv::Size& image, const cv::Size& picture) {
  const double scale = std::min(static_cast<double>(picture.width) / image.width,
                                static_cast<double>(picture.height) / image.height);
  const int width = std::max(1, static_cast<int>(std::lround(image.width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(image.height * scale)));
  return {(picture.width - width) / 2, (picture.height - height) / 2, width, height};
}

}  // namespace headway::scene
