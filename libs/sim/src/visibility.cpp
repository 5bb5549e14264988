#include "visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "body_depth.h"
#include "body_projection.h"

namespace headway::sim {
namespace {

/// Uncut box around the body.
Box2d boundsOf(const std::vector<ImageTriangle>& corners) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Box2d box{kInf, kInf, -kInf, -kInf};
  for (const auto& triangle : corners) {
    for (const auto& corner : triangle) {
      box.left = std::min<double>(box.left, corner.x());
      box.right = std::max<double>(box.right, corner.x());
      box.top = std::min<double>(box.top, corner.y());
      box.bottom = std::max<double>(box.bottom, corner.y());
    }
  }
  return box;
}

/// Depth may differ by this where two drawings of one surface are compared.
float tolerance(float z) { return 0.06F + 0.006F * z; }

/// Counts and marks the pixels where the body is what the picture shows.
void compare(const cv::Mat& body, const cv::Rect& area, const cv::Mat& depth, std::uint16_t label,
             cv::Mat& instances, Sighting& sighting) {
  int all = 0, visible = 0;
  for (int v = 0; v < area.height; ++v) {
    const auto* alone = body.ptr<float>(v);
    const auto* seen = depth.ptr<float>(v + area.y) + area.x;
    auto* marks = instances.ptr<std::uint16_t>(v + area.y) + area.x;
    for (int u = 0; u < area.width; ++u) {
      const bool is_body = alone[u] != BodyDepth::kNothing;
      const bool is_seen =
          is_body & (seen[u] > 0.0F) & (std::abs(seen[u] - alone[u]) <= tolerance(alone[u]));
      all += static_cast<int>(is_body);
      visible += static_cast<int>(is_seen);
      marks[u] = is_seen ? label : marks[u];
    }
  }
  sighting.visible_pixels = visible;
  sighting.visible = all > 0 ? static_cast<double>(visible) / all : 0.0;
}

}  // namespace

Box3d opticalBox(const Mover& mover, const Pose& T_world_cam) {
  return headway::opticalBox(mover.centre(), mover.size, mover.yaw, T_world_cam.inverse());
}

std::vector<Sighting> findSightings(const Pose& T_world_robot, const StereoCamera& camera,
                                    const std::vector<Mover>& movers,
                                    const std::vector<Mesh>& bodies, const cv::Mat& depth,
                                    cv::Mat& instances) {
  instances = cv::Mat::zeros(depth.size(), CV_16U);
  const Pose T_world_cam = T_world_robot * camera.T_robot_cam;
  Pose T_origin_cam = T_world_cam;
  T_origin_cam.translation() -= T_world_robot.translation();
  const Eigen::Isometry3f T_cam_origin = T_origin_cam.inverse().cast<float>();
  const cv::Rect image(0, 0, depth.cols, depth.rows);
  BodyDepth alone(depth.size());
  std::vector<Sighting> sightings;
  for (std::size_t i = 0; i < movers.size(); ++i) {
    Sighting sighting;
    sighting.mover = i;
    sighting.box3d = opticalBox(movers[i], T_world_cam);
    const auto corners = projectBody(bodies[i], T_cam_origin, camera);
    if (corners.empty()) continue;
    const Box2d whole = boundsOf(corners);
    const cv::Rect area =
        cv::Rect(cv::Point(static_cast<int>(std::floor(std::max(whole.left, -1e4))),
                           static_cast<int>(std::floor(std::max(whole.top, -1e4)))),
                 cv::Point(static_cast<int>(std::ceil(std::min(whole.right, 1e4))) + 1,
                           static_cast<int>(std::ceil(std::min(whole.bottom, 1e4))) + 1)) &
        image;
    if (area.empty()) continue;
    sighting.whole = whole;
    sighting.box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
                    std::min(whole.right, depth.cols - 1.0),
                    std::min(whole.bottom, depth.rows - 1.0)};
    if (sighting.box.width() <= 0.0 || sighting.box.height() <= 0.0) continue;
    sighting.truncation = std::clamp(
        1.0 - sighting.box.width() * sighting.box.height() / (whole.width() * whole.height()), 0.0,
        1.0);
    compare(alone.draw(corners, area), area, depth, static_cast<std::uint16_t>(i + 1), instances,
            sighting);
    // Something whose middle is beside or behind the camera counts if an end of it is seen.
    if (sighting.box3d.centre.z() < 0.5 && sighting.visible_pixels == 0) continue;
    sightings.push_back(sighting);
  }
  return sightings;
}

}  // namespace headway::sim
