#include "bundle_adjustment.h"

#include <algorithm>
#include <atomic>
#include <iterator>

#include "bundle_solver.h"
#include "keyframe_odometry.h"

namespace headway::slam {
namespace {

constexpr double kGate = 11.34;  ///< chi-square, 3 degrees of freedom, 99 %

/// Removes outlier observations; returns their number.
int removeOutliers(SparseMap& map, const std::vector<KeyframeId>& keyframes,
                   const StereoCamera& camera);

}  // namespace

class DetachedBundle::Implementation {
 public:
  Implementation(const SparseMap& map, const std::vector<KeyframeId>& free,
                 const StereoCamera& camera)
      : camera_(camera), free_(free) {
    problem_.disparity_offset_px = map.disparityOffset();
    collectPoses(map);
    collectPoints(map);
    collectMotions(map);
  }

  void solve(int max_iterations) {
    if (!point_ids_.empty()) solution_ = solveBundle(problem_, camera_, max_iterations, stop_);
  }

  void stop() { stop_ = true; }

  BundleSummary writeBack(SparseMap& map) const {
    BundleSummary summary;
    summary.iterations = solution_.iterations;
    summary.initial_cost = solution_.initial_cost;
    summary.final_cost = solution_.final_cost;
    if (solution_.usable) {
      const Pose before = newestPose(map);
      applySolution(map);
      summary.correction = normalized(Pose(newestPose(map) * before.inverse(Eigen::Isometry)));
      moveNewerKeyframes(map, summary.correction);
    }
    std::vector<KeyframeId> left;
    std::copy_if(free_.begin(), free_.end(), std::back_inserter(left),
                 [&](KeyframeId id) { return map.keyframes().count(id) > 0; });
    summary.outliers = removeOutliers(map, left, camera_);
    return summary;
  }

 private:
  /// Keyframes that share landmarks with the free ones take part, those that are not free fixed.
  void collectPoses(const SparseMap& map) {
    for (const LandmarkId id : map.seenBy(free_)) {
      const Landmark& landmark = *map.find(id);
      if (landmark.observations.size() < 2) continue;
      point_ids_.push_back(id);
      for (const auto& observation : landmark.observations) {
        pose_ids_.push_back(observation.keyframe);
      }
    }
    std::sort(pose_ids_.begin(), pose_ids_.end());
    pose_ids_.erase(std::unique(pose_ids_.begin(), pose_ids_.end()), pose_ids_.end());
    bool anchored = false;
    for (const KeyframeId id : pose_ids_) {
      const bool is_fixed = !std::binary_search(free_.begin(), free_.end(), id);
      problem_.poses.push_back(map.keyframe(id).T_map_cam);
      problem_.is_fixed.push_back(is_fixed);
      anchored = anchored || is_fixed;
    }
    if (!anchored && !pose_ids_.empty()) problem_.is_fixed.front() = true;
  }

  void collectPoints(const SparseMap& map) {
    for (const LandmarkId id : point_ids_) {
      const Landmark& landmark = *map.find(id);
      for (const auto& observation : landmark.observations) {
        problem_.observations.push_back({indexOf(observation.keyframe), observation.measurement});
      }
      problem_.points.push_back({landmark.position, problem_.observations.size()});
    }
  }

  /// Wheel odometry between keyframes that take part, unless neither can move.
  void collectMotions(const SparseMap& map) {
    for (std::size_t i = 0; i < pose_ids_.size(); ++i) {
      const auto& odometry = map.keyframe(pose_ids_[i]).odometry;
      if (!odometry || !std::binary_search(pose_ids_.begin(), pose_ids_.end(), odometry->from)) {
        continue;
      }
      const int from = indexOf(odometry->from);
      if (problem_.is_fixed[i] && problem_.is_fixed[static_cast<std::size_t>(from)]) continue;
      problem_.motions.push_back(
          {from, static_cast<int>(i), odometry->T_from_this, sigmaOf(*odometry)});
    }
  }

  /// Pose in the map of the newest keyframe that took part and still exists.
  [[nodiscard]] Pose newestPose(const SparseMap& map) const {
    for (auto id = pose_ids_.rbegin(); id != pose_ids_.rend(); ++id) {
      const auto keyframe = map.keyframes().find(*id);
      if (keyframe != map.keyframes().end()) return keyframe->second.T_map_cam;
    }
    return Pose::Identity();
  }

  void applySolution(SparseMap& map) const {
    for (std::size_t i = 0; i < pose_ids_.size(); ++i) {
      if (problem_.is_fixed[i] || map.keyframes().count(pose_ids_[i]) == 0) continue;
      map.keyframe(pose_ids_[i]).T_map_cam = problem_.poses[i];
    }
    for (std::size_t i = 0; i < point_ids_.size(); ++i) {
      if (Landmark* landmark = map.find(point_ids_[i])) {
        landmark->position = problem_.points[i].position;
      }
    }
    map.setDisparityOffset(problem_.disparity_offset_px);
  }

  /// Keyframes that came while the bundle was solved, and the landmarks that came with them.
  void moveNewerKeyframes(SparseMap& map, const Pose& correction) const {
    const KeyframeId newest = pose_ids_.back();
    for (auto at = map.keyframes().upper_bound(newest); at != map.keyframes().end(); ++at) {
      Keyframe& keyframe = map.keyframe(at->first);
      keyframe.T_map_cam = normalized(Pose(correction * keyframe.T_map_cam));
      for (const LandmarkId id : keyframe.landmarks) {
        Landmark& landmark = *map.find(id);
        const bool took_part = std::binary_search(point_ids_.begin(), point_ids_.end(), id);
        if (landmark.reference == keyframe.id && !took_part) {
          landmark.position = correction * landmark.position;
        }
      }
    }
  }

  [[nodiscard]] int indexOf(KeyframeId id) const {
    const auto at = std::lower_bound(pose_ids_.begin(), pose_ids_.end(), id);
    return static_cast<int>(at - pose_ids_.begin());
  }

  StereoCamera camera_;
  std::vector<KeyframeId> free_;
  std::atomic<bool> stop_{false};
  BundleSolution solution_;
  std::vector<KeyframeId> pose_ids_;   ///< of the problem's poses, ascending
  std::vector<LandmarkId> point_ids_;  ///< of its points, ascending
  BundleProblem problem_;
};

namespace {

int removeOutliers(SparseMap& map, const std::vector<KeyframeId>& keyframes,
                   const StereoCamera& camera) {
  std::vector<std::pair<KeyframeId, LandmarkId>> outliers;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    const Pose T_cam_map = keyframe.T_map_cam.inverse(Eigen::Isometry);
    for (const LandmarkId landmark_id : keyframe.landmarks) {
      const Landmark& landmark = *map.find(landmark_id);
      const auto observation =
          std::find_if(landmark.observations.begin(), landmark.observations.end(),
                       [id](const LandmarkObservation& o) { return o.keyframe == id; });
      const Eigen::Vector3d point_cam = T_cam_map * landmark.position;
      const auto measurement = map.corrected(observation->measurement);
      if (point_cam.z() < kMinObservedDepth ||
          stereo::stereoResidual(point_cam, measurement, camera, nullptr).squaredNorm() > kGate) {
        outliers.emplace_back(id, landmark_id);
      }
    }
  }
  for (const auto& [keyframe, landmark] : outliers) {
    if (map.find(landmark) != nullptr) map.removeObservation(keyframe, landmark);
  }
  return static_cast<int>(outliers.size());
}

}  // namespace

DetachedBundle::DetachedBundle(const SparseMap& map, const std::vector<KeyframeId>& free,
                               const StereoCamera& camera)
    : implementation_(std::make_unique<Implementation>(map, free, camera)) {}

DetachedBundle::~DetachedBundle() = default;

void DetachedBundle::solve(int max_iterations) { implementation_->solve(max_iterations); }

void DetachedBundle::stop() { implementation_->stop(); }

BundleSummary DetachedBundle::writeBack(SparseMap& map) const {
  return implementation_->writeBack(map);
}

BundleSummary adjustBundle(SparseMap& map, const std::vector<KeyframeId>& free,
                           const StereoCamera& camera, int max_iterations) {
  DetachedBundle bundle(map, free, camera);
  bundle.solve(max_iterations);
  return bundle.writeBack(map);
}

}  // namespace headway::slam
