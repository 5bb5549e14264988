// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment: which keyframes and landmarks take part, in the tracking thread or in the
// background, and how the solution enters the map.
#include "bundle_adjustment.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "bundle_solver.h"
#include "wheel_odometry.h"

namespace headway::slam {
namespace {

/// Positions of ids in an ascending list. Fast for ids that follow each other, as those of the
/// keyframes that observe a landmark mostly do.
class IdPositions {
 public:
  explicit IdPositions(const std::vector<KeyframeId>& ids) : ids_(ids) {}

  /// @param id  one of the list
  std::size_t operator()(KeyframeId id) {
    if (next_ >= ids_.size() || ids_[next_] != id) {
      const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
      next_ = static_cast<std::size_t>(at - ids_.begin());
    }
    return next_++;
  }

 private:
  const std::vector<KeyframeId>& ids_;
  std::size_t next_ = 0;
};

constexpr double kFixed_px = 1e-3;  ///< walk of an offset that is not corrected

/// Whether a measurement contradicts the pose and the position.
bool isOutlier(const Pose& T_cam_map, const Eigen::Vector3d& position,
               stereo::StereoMeasurement measurement, double disparity_offset_px,
               const StereoCamera& camera) {
  const Eigen::Vector3d point_cam = T_cam_map * position;
  if (point_cam.z() < stereo::kMinDepth) return true;
  measurement.disparity -= disparity_offset_px;
  return stereo::stereoResidual(point_cam, measurement, camera, nullptr).squaredNorm() >
         chiSquare99(3);
}

}  // namespace

class DetachedBundle::Implementation {
 public:
  Implementation(const SparseMap& map, const std::vector<KeyframeId>& free,
                 const StereoCamera& camera)
      : camera_(camera), free_(free) {
    problem_.disparity_offset_px = map.disparityOffset();
    if (!map.isOffsetCorrected()) {
      problem_.disparity_offset_px = 0.0;
      problem_.offset_walk_px = kFixed_px;
    }
    collectPoses(collectPoints(map), map);
    collectMotions(map);
  }

  void solve(int max_iterations, const StopCondition& stop) {
    const auto is_stopped = [&] { return stop_ || stop(); };
    if (!point_ids_.empty()) {
      solution_ = solveBundle(problem_, camera_, max_iterations, is_stopped);
    }
    if (!stop_) findOutliers();
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
      summary.free_offset = solution_.free_offset;
      summary.correction = normalized(Pose(newestPose(map) * before.inverse(Eigen::Isometry)));
      moveNewerKeyframes(map, summary.correction);
    }
    summary.outliers = removeOutliers(map);
    return summary;
  }

 private:
  using Outlier = std::pair<KeyframeId, LandmarkId>;

  /// The landmarks that a free keyframe and another one see, with all their measurements.
  ///
  /// @return  the keyframes of the map, ascending; the observations name poses by places in it
  std::vector<KeyframeId> collectPoints(const SparseMap& map) {
    std::vector<KeyframeId> all;
    std::size_t seen = 0;
    for (const auto& [id, keyframe] : map.keyframes()) {
      all.push_back(id);
      seen += keyframe.landmarks.size();
    }
    IdPositions position_of(all);
    const auto add = [&](const Landmark& landmark) {
      if (landmark.observations.size() < 2) return;
      for (const auto& [keyframe, measurement] : landmark.observations) {
        problem_.observations.push_back({static_cast<int>(position_of(keyframe)), measurement});
      }
      point_ids_.push_back(landmark.id);
      problem_.points.push_back({landmark.position, problem_.observations.size()});
    };
    if (free_.size() == all.size()) {
      problem_.observations.reserve(seen);
      problem_.points.reserve(map.landmarks().size());
      for (const auto& [id, landmark] : map.landmarks()) add(landmark);
    } else {
      for (const LandmarkId id : map.seenBy(free_)) add(*map.find(id));
    }
    return all;
  }

  /// Keyframes with an observation take part, those that are not free fixed.
  void collectPoses(const std::vector<KeyframeId>& all, const SparseMap& map) {
    std::vector<int> pose_of(all.size(), 0);
    for (const auto& observation : problem_.observations) {
      pose_of[static_cast<std::size_t>(observation.pose)] = 1;
    }
    for (std::size_t at = 0; at < all.size(); ++at) {
      if (pose_of[at] == 0) continue;
      pose_of[at] = static_cast<int>(pose_ids_.size());
      pose_ids_.push_back(all[at]);
    }
    setPoses(map);
    if (pose_ids_.size() == all.size()) return;
    for (auto& observation : problem_.observations) {
      observation.pose = pose_of[static_cast<std::size_t>(observation.pose)];
    }
  }

  void setPoses(const SparseMap& map) {
    bool anchored = false;
    for (const KeyframeId id : pose_ids_) {
      const bool is_fixed = !isFree(id);
      problem_.poses.push_back(map.keyframe(id).T_map_cam);
      problem_.is_fixed.push_back(is_fixed);
      anchored = anchored || is_fixed;
    }
    if (!anchored && !pose_ids_.empty()) problem_.is_fixed.front() = true;
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
      map.keyframeToChange(pose_ids_[i]).T_map_cam = problem_.poses[i];
    }
    for (std::size_t i = 0; i < point_ids_.size(); ++i) {
      if (Landmark* landmark = map.findToChange(point_ids_[i])) {
        landmark->position = problem_.points[i].position;
      }
    }
    map.adjustDisparityOffset(problem_.disparity_offset_px, solution_.free_offset, newRatio());
  }

  /// Ratio of the observations that no adjustment before had: those of the newest free pose.
  [[nodiscard]] double newRatio() const {
    const auto newest = std::find(problem_.is_fixed.rbegin(), problem_.is_fixed.rend(), false);
    const auto pose = std::distance(newest, problem_.is_fixed.rend()) - 1;
    const auto news = std::count_if(problem_.observations.begin(), problem_.observations.end(),
                                    [&](const auto& one) { return one.pose == pose; });
    return static_cast<double>(std::max<std::ptrdiff_t>(news, 1)) /
           static_cast<double>(problem_.observations.size());
  }

  /// Keyframes that came while the bundle was solved, and the landmarks that came with them.
  void moveNewerKeyframes(SparseMap& map, const Pose& correction) const {
    const KeyframeId newest = pose_ids_.back();
    for (auto at = map.keyframes().upper_bound(newest); at != map.keyframes().end(); ++at) {
      Keyframe& keyframe = map.keyframeToChange(at->first);
      keyframe.T_map_cam = normalized(Pose(correction * keyframe.T_map_cam));
      for (const LandmarkId id : keyframe.landmarks) {
        const bool took_part = std::binary_search(point_ids_.begin(), point_ids_.end(), id);
        if (took_part || map.find(id)->reference != keyframe.id) continue;
        Landmark& landmark = *map.findToChange(id);
        landmark.position = correction * landmark.position;
      }
    }
  }

  [[nodiscard]] bool isFree(KeyframeId id) const {
    return std::binary_search(free_.begin(), free_.end(), id);
  }

  /// Observations by free keyframes that contradict the solution.
  void findOutliers() {
    std::vector<Pose> T_cam_map;
    for (const Pose& pose : problem_.poses) T_cam_map.push_back(pose.inverse(Eigen::Isometry));
    std::vector<bool> is_free;
    for (const KeyframeId id : pose_ids_) is_free.push_back(isFree(id));
    std::size_t at = 0;
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      for (; at < problem_.points[i].observations_end; ++at) {
        const auto& [pose, measurement] = problem_.observations[at];
        const auto p = static_cast<std::size_t>(pose);
        if (is_free[p] && isOutlier(T_cam_map[p], problem_.points[i].position, measurement,
                                    problem_.disparity_offset_px, camera_)) {
          outliers_.emplace_back(pose_ids_[p], point_ids_[i]);
        }
      }
    }
  }

  /// Adds landmarks that one keyframe alone observes, a free one, if they contradict its pose: they
  /// take no part, and do not move with it.
  void addSingleOutliers(const SparseMap& map, std::vector<Outlier>& outliers) const {
    const auto test = [&](const Landmark& landmark) {
      if (landmark.observations.size() != 1) return;
      const auto& [id, measurement] = landmark.observations.front();
      if (isFree(id) && isOutlier(map.keyframe(id).T_map_cam.inverse(Eigen::Isometry),
                                  landmark.position, measurement, map.disparityOffset(), camera_)) {
        outliers.emplace_back(id, landmark.id);
      }
    };
    if (2 * free_.size() > map.keyframes().size()) {
      for (const auto& [id, landmark] : map.landmarks()) test(landmark);
      return;
    }
    for (const KeyframeId id : free_) {
      const auto keyframe = map.keyframes().find(id);
      if (keyframe == map.keyframes().end()) continue;
      for (const LandmarkId landmark : keyframe->second.landmarks) test(*map.find(landmark));
    }
  }

  /// Removes outlier observations; returns their number.
  int removeOutliers(SparseMap& map) const {
    auto outliers = outliers_;
    addSingleOutliers(map, outliers);
    std::sort(outliers.begin(), outliers.end());
    for (const auto& [keyframe, landmark] : outliers) {
      if (map.find(landmark) != nullptr && map.keyframes().count(keyframe) > 0) {
        map.removeObservation(keyframe, landmark);
      }
    }
    return static_cast<int>(outliers.size());
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
  std::vector<Outlier> outliers_;  ///< of the solution
};

DetachedBundle::DetachedBundle(const SparseMap& map, const std::vector<KeyframeId>& free,
                               const StereoCamera& camera)
    : implementation_(std::make_unique<Implementation>(map, free, camera)) {}

DetachedBundle::~DetachedBundle() = default;

void DetachedBundle::solve(int max_iterations, const StopCondition& stop) {
  implementation_->solve(max_iterations, stop);
}

void DetachedBundle::stop() { implementation_->stop(); }

BundleSummary DetachedBundle::writeBack(SparseMap& map) const {
  return implementation_->writeBack(map);
}

BundleSummary adjustBundle(SparseMap& map, const std::vector<KeyframeId>& free,
                           const StereoCamera& camera, int max_iterations,
                           const StopCondition& stop) {
  DetachedBundle bundle(map, free, camera);
  bundle.solve(max_iterations, stop);
  return bundle.writeBack(map);
}

void BundleAdjuster::adjust(SparseMap& map, const std::vector<KeyframeId>& free,
                            int max_iterations) {
  if (!in_background_) {
    free_offset_ = adjustBundle(map, free, camera_, max_iterations, stop_).free_offset;
    return;
  }
  if (job_ != nullptr || held_) return;
  job_ = std::make_unique<Job>(map, free, camera_);
  job_->solved = solver_.run([bundle = &job_->bundle, max_iterations, stop = stop_] {
    bundle->solve(max_iterations, stop);
  });
}

void BundleAdjuster::abandon() {
  free_offset_.reset();
  if (job_ == nullptr) return;
  job_->bundle.stop();
  abandoned_.push_back(std::move(job_));
}

std::optional<Pose> BundleAdjuster::applyFinished(SparseMap& map) {
  abandoned_.erase(std::remove_if(abandoned_.begin(), abandoned_.end(),
                                  [](const auto& job) { return isReady(job->solved); }),
                   abandoned_.end());
  if (job_ == nullptr || !isReady(job_->solved)) return std::nullopt;
  const std::unique_ptr<Job> job = std::move(job_);
  job->solved.get();
  const BundleSummary summary = job->bundle.writeBack(map);
  free_offset_ = summary.free_offset;
  return summary.correction;
}

std::optional<Pose> BundleAdjuster::finish(SparseMap& map) {
  if (job_ != nullptr) job_->solved.wait();
  return applyFinished(map);
}

}  // namespace headway::slam
