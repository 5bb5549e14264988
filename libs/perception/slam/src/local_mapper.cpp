// SPDX-License-Identifier: BSD-3-Clause
// Local mapping: where a keyframe is chosen, landmarks are created, and both are culled.
#include "local_mapper.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <functional>
#include <map>

namespace headway::slam {
namespace {

/// What a frame and a keyframe both see.
struct SharedView {
  KeyframeId keyframe;
  int landmarks = 0;     ///< of the frame's, seen by the keyframe, too
  double flow_px = 0.0;  ///< median distance of their places in both images
};

/// Compares the landmarks tracked in a frame with one keyframe.
SharedView sharedView(KeyframeId keyframe, const std::vector<TrackedLandmark>& tracked,
                      const SparseMap& map) {
  std::vector<double> flow;
  for (const TrackedLandmark& seen : tracked) {
    for (const LandmarkObservation& observation : map.find(seen.id)->observations) {
      if (observation.keyframe != keyframe) continue;
      flow.push_back((observation.measurement.uv - seen.measurement.uv).norm());
    }
  }
  return {keyframe, static_cast<int>(flow.size()), percentile(flow, 0.5)};
}

/// The keyframe that saw the frame's landmarks most nearly where they are now, among those that
/// share at least half as many as the one that shares most; nullopt if none is wanted.
std::optional<SharedView> nearestView(const std::vector<TrackedLandmark>& tracked,
                                      const SparseMap& map,
                                      const std::function<bool(KeyframeId)>& wanted) {
  std::map<KeyframeId, int> shared;
  int max = 0;
  for (const TrackedLandmark& seen : tracked) {
    for (const LandmarkObservation& observation : map.find(seen.id)->observations) {
      max = std::max(max, ++shared[observation.keyframe]);
    }
  }
  std::optional<SharedView> nearest;
  for (const auto& [id, landmarks] : shared) {
    if (2 * landmarks < max || !wanted(id)) continue;
    const SharedView view = sharedView(id, tracked, map);
    if (!nearest || view.flow_px < nearest->flow_px) nearest = view;
  }
  return nearest;
}

/// Whether a frame shows so much of what a keyframe shows, and so little moved, that it needs no
/// keyframe of its own.
///
/// @param landmarks  of the frame, that count
bool isLike(const SharedView& view, std::size_t landmarks, const SlamParams& params,
            int image_width, const SparseMap& map) {
  const auto all = static_cast<double>(map.keyframe(view.keyframe).landmarks.size());
  return static_cast<double>(landmarks) >= params.keyframe_overlap * all &&
         view.flow_px <= params.keyframe_flow_ratio * image_width;
}

}  // namespace

std::optional<KeyframeId> referenceOf(const std::vector<TrackedLandmark>& landmarks,
                                      KeyframeId before, const SlamParams& params, int image_width,
                                      const SparseMap& map) {
  const SharedView shared = sharedView(before, landmarks, map);
  if (isLike(shared, static_cast<std::size_t>(shared.landmarks), params, image_width, map)) {
    return before;
  }
  const KeyframeId window = map.firstOfNewest(params.mapping ? params.window : 0);
  const auto is_old = [&](KeyframeId id) { return !window.valid() || id < window; };
  const auto old = nearestView(landmarks, map, is_old);
  if (!params.mapping) return old ? old->keyframe : before;
  if (old && isLike(*old, landmarks.size(), params, image_width, map)) return old->keyframe;
  return std::nullopt;
}

namespace {

constexpr int kReach = 3;  ///< windows of neighbours that are searched

/// Keyframes around the newest one that are not among the `window` newest, ascending.
std::vector<KeyframeId> olderNeighbours(KeyframeId newest, int window, const SparseMap& map) {
  std::vector<KeyframeId> around = map.neighbourhood(newest, kReach * window);
  const KeyframeId end = map.firstOfNewest(window);
  around.erase(std::lower_bound(around.begin(), around.end(), end), around.end());
  return around;
}

bool isRarelyFound(const Landmark& landmark) {
  // As Mur-Artal & Tardos 2015, sec. VI-B.
  constexpr int kTrial = 3;             ///< tries before a landmark is judged
  constexpr double kFoundRatio = 0.25;  ///< of tries that must succeed
  return landmark.tried >= kTrial && landmark.found < kFoundRatio * landmark.tried;
}

/// Whether enough other keyframes see a landmark from as near as this one does.
bool isObservedByOthers(const Landmark& landmark, const Keyframe& keyframe, const SparseMap& map) {
  constexpr int kOthers = 3;       ///< as Mur-Artal & Tardos 2015, sec. VI-E, like kOwnRatio
  constexpr double kAsNear = 1.2;  ///< times the distance
  const auto distance = [&](const Keyframe& from) {
    return (landmark.position - from.T_map_cam.translation()).norm();
  };
  const double limit = kAsNear * distance(keyframe);
  int others = 0;
  for (const LandmarkObservation& observation : landmark.observations) {
    if (observation.keyframe == keyframe.id) continue;
    others += distance(map.keyframe(observation.keyframe)) <= limit ? 1 : 0;
  }
  return others >= kOthers;
}

bool isRedundant(const Keyframe& keyframe, const SparseMap& map) {
  constexpr double kOwnRatio = 0.1;  ///< of its landmarks that others need not see as well
  const double allowed = kOwnRatio * static_cast<double>(keyframe.landmarks.size());
  int own = 0;
  for (const LandmarkId id : keyframe.landmarks) {
    own += isObservedByOthers(*map.find(id), keyframe, map) ? 0 : 1;
    if (own > allowed) return false;
  }
  return !keyframe.landmarks.empty();
}

}  // namespace

void cullLandmarks(KeyframeId newest, int window, SparseMap& map) {
  std::vector<LandmarkId> culled;
  for (const LandmarkId id : map.seenBy(map.neighbourhood(newest, window))) {
    if (isRarelyFound(*map.find(id))) culled.push_back(id);
  }
  for (const LandmarkId id : map.seenBy(olderNeighbours(newest, window, map))) {
    if (map.find(id)->observations.size() == 1) culled.push_back(id);
  }
  for (const LandmarkId id : culled) {
    if (map.find(id) != nullptr) map.removeLandmark(id);
  }
}

std::optional<KeyframeId> redundantKeyframe(KeyframeId newest, int window, const SparseMap& map) {
  for (const KeyframeId id : olderNeighbours(newest, window, map)) {
    const bool is_first = id == map.keyframes().begin()->first;
    if (!is_first && isRedundant(map.keyframe(id), map)) return id;
  }
  return std::nullopt;
}

KeyframeId replacementKeyframe(KeyframeId keyframe, const SparseMap& map) {
  for (const KeyframeId id : map.neighbourhood(keyframe, 2)) {
    if (id != keyframe) return id;
  }
  return map.keyframes().begin()->first;
}

namespace {

constexpr double kRenewStretch = 0.6;  ///< patches stretched further than 1 / this are replaced

}  // namespace

LocalMapper::LocalMapper(const StereoCamera& camera, const SlamParams& params,
                         BundleAdjuster& adjuster)
    : camera_(camera),
      params_(params),
      adjuster_(adjuster),
      matcher_(matcherFor(camera, params)),
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
