#include "make_map_view.h"

#include <headway/slam/stereo_slam.h>

#include "map_archive.h"
#include "pose_covariance.h"

namespace headway::slam {
namespace {

/// Grey value of a landmark where it was seen when its patch was cut.
std::uint8_t intensityOf(const stereo::ReferencePatch& patch) {
  const auto centre = patch.centre.array().round().cast<int>();
  return patch.pixels[centre.y() * stereo::ReferencePatch::kSize + centre.x()];
}

}  // namespace

MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot) {
  MapView view;
  for (const auto& [id, landmark] : map.landmarks()) {
    view.landmarks.push_back({id, landmark.position, static_cast<int>(landmark.observations.size()),
                              intensityOf(landmark.patch)});
  }
  for (const auto& [id, keyframe] : map.keyframes()) {
    view.keyframes.push_back(
        {id, keyframe.frame, keyframe.time, normalized(keyframe.T_map_cam * T_cam_robot),
         composedCovariance(keyframe.covariance, T_cam_robot, PoseCovariance::Zero()),
         keyframe.landmarks});
  }
  return view;
}

MapView savedMapView(const std::string& saved, const Pose& T_robot_cam) {
  return makeMapView(unpackMap(saved, {}), T_robot_cam.inverse());
}

}  // namespace headway::slam
