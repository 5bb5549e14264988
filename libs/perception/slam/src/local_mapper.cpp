// SPDX-License-Identifier: BSD-3-Clause
#include "local_mapper.h"

#include <algorithm>

#include "map_culling.h"

namespace headway::slam {
namespace {

constexpr double kRenewStretch = 0.6;  ///< patches stretched further than 1 / this are replaced

}  // namespace

LocalMapper::LocalMapper(const StereoCamera& camera, const SlamParams& params,
                         BundleAdjuster& adjuster)
    : camera_(camera),
      params_(params),
      adjuster_(adjuster),
      matcher_(static_cast<int>(params.max_disparity_ratio * camera.width), params.min_zncc),
      odometry_(params.use_odometry) {}

KeyframeId LocalMapper::insert(const TrackingFrame& frame, const Pose& T_map_cam,
                               const PoseCovariance& covariance, int submap,
                               std::vector<TrackedLandmark>& tracked, SparseMap& map) {
  Keyframe& keyframe = map.addKeyframe(frame.index, frame.time, T_map_cam);
  keyframe.covariance = covariance;
  keyframe.submap = submap;
  keyframe.odometry = odometry_.link();
  const KeyframeId id = keyframe.id;
  odometry_.restartAt(id);
  linkTracked(frame, id, tracked, map);
  addLandmarks(frame, id, tracked, map);
  describeNew(frame, id, tracked, map);
  adjuster_.adjust(map, map.neighbourhood(id, params_.window), params_.max_ba_iterations);
  cullLandmarks(id, params_.window, map);
  tracked.erase(std::remove_if(tracked.begin(), tracked.end(),
                               [&](const auto& t) { return map.find(t.id) == nullptr; }),
                tracked.end());
  return id;
}

void LocalMapper::linkTracked(const TrackingFrame& frame, KeyframeId keyframe,
                              const std::vector<TrackedLandmark>& tracked, SparseMap& map) const {
  for (const TrackedLandmark& seen : tracked) {
    Landmark* landmark = map.findToChange(seen.id);
    if (landmark == nullptr) continue;
    map.observe(keyframe, seen.id, seen.measurement);
    if (seen.patch_scale > kRenewStretch) continue;
    landmark->reference = keyframe;
    landmark->reference_level = seen.level;
    landmark->T_reference_cut.setIdentity();
    landmark->patch = std::make_shared<stereo::ReferencePatch>(stereo::cutReference(
        frame.left.levels[seen.level], seen.measurement.uv / (1 << seen.level)));
  }
}

void LocalMapper::addLandmarks(const TrackingFrame& frame, KeyframeId keyframe,
                               std::vector<TrackedLandmark>& tracked, SparseMap& map) const {
  std::vector<bool> occupied(frame.grid.count(), false);
  for (const auto& seen : tracked) occupied[frame.grid.cellOf(seen.measurement.uv)] = true;
  const Pose T_map_cam = map.keyframe(keyframe).T_map_cam;
  const cv::Mat& image = frame.left.levels.front();
  for (const Keypoint& keypoint : detectKeypoints(image, frame.grid, occupied, frame.excluded)) {
    const auto disparity = matcher_.search(frame.left, frame.right, keypoint.uv);
    if (!disparity) continue;
    const Eigen::Vector3d uvd(keypoint.uv.x(), keypoint.uv.y(), *disparity - map.disparityOffset());
    const auto point_cam = triangulate(uvd, camera_);
    if (!point_cam) continue;
    TrackedLandmark seen;
    seen.measurement = {keypoint.uv, *disparity, true, params_.sigma_px,
                        params_.sigma_disparity_px};
    Landmark& landmark = map.addLandmark(T_map_cam * *point_cam, keyframe, seen.measurement);
    landmark.patch =
        std::make_shared<stereo::ReferencePatch>(stereo::cutReference(image, keypoint.uv));
    seen.id = landmark.id;
    tracked.push_back(seen);
  }
}

void LocalMapper::describeNew(const TrackingFrame& frame, KeyframeId keyframe,
                              const std::vector<TrackedLandmark>& tracked, SparseMap& map) const {
  std::vector<Landmark*> landmarks;
  std::vector<Eigen::Vector2d> points;
  for (const TrackedLandmark& seen : tracked) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr || landmark->reference != keyframe) continue;
    landmarks.push_back(map.findToChange(seen.id));
    points.push_back(seen.measurement.uv);
  }
  const auto descriptors = describe(frame.left.levels.front(), points);
  for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i]->descriptor = descriptors[i];
}

}  // namespace headway::slam
