#include "bundle_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <memory>

#include "pose_block.h"

namespace headway::slam {
namespace {

constexpr double kGate = 11.34;     ///< chi-square, 3 degrees of freedom, 99 %
constexpr double kMinDepth = 0.05;  ///< [m]

/// One landmark seen by one keyframe: by pose, place and offset of the disparities.
class Reprojection final : public ceres::SizedCostFunction<3, 7, 3, 1> {
 public:
  Reprojection(const stereo::StereoMeasurement& measurement, const StereoCamera& camera)
      : measurement_(measurement), camera_(camera) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Pose T_map_cam = poseFrom(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
    const Eigen::Matrix3d R_cam_map = T_map_cam.linear().transpose();
    const Eigen::Vector3d point_cam = R_cam_map * (point - T_map_cam.translation());
    if (point_cam.z() < kMinDepth) return false;
    stereo::StereoMeasurement measurement = measurement_;
    measurement.disparity -= parameters[2][0];
    Eigen::Matrix3d by_point;
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual = stereo::stereoResidual(point_cam, measurement, camera_, &by_point);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> by_pose(jacobians[0]);
      by_pose.leftCols<6>() = by_point * stereo::pointByPose(point_cam);
      by_pose.rightCols<1>().setZero();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> by_landmark(jacobians[1]);
      by_landmark = by_point * R_cam_map;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Vector3d> by_offset(jacobians[2]);
      by_offset << 0.0, 0.0, measurement_.stereo ? 1.0 / measurement_.sigma_disparity_px : 0.0;
    }
    return true;
  }

 private:
  stereo::StereoMeasurement measurement_;
  const StereoCamera& camera_;  ///< outlives it: the bundle's own
};

/// Prior on the offset of the disparities: rectification is accurate to about kOffsetSigma, and
/// the offset changes by at most about kOffsetWalk from one adjustment to the next.
class OffsetPrior final : public ceres::SizedCostFunction<2, 1> {
 public:
  explicit OffsetPrior(double previous) : previous_(previous) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residuals[0] = parameters[0][0] / kOffsetSigma;
    residuals[1] = (parameters[0][0] - previous_) / kOffsetWalk;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      jacobians[0][0] = 1.0 / kOffsetSigma;
      jacobians[0][1] = 1.0 / kOffsetWalk;
    }
    return true;
  }

 private:
  static constexpr double kOffsetSigma = 0.5;  ///< [px]
  static constexpr double kOffsetWalk = 0.05;  ///< [px]
  double previous_;
};

/// Cancels a running solve.
class Stop final : public ceres::IterationCallback {
 public:
  void request() { requested_ = true; }
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*step*/) override {
    return requested_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  std::atomic<bool> requested_{false};
};

/// Removes outlier observations; returns their number.
int removeOutliers(SparseMap& map, const std::vector<KeyframeId>& keyframes,
                   const StereoCamera& camera);

}  // namespace

/// Ceres orders equal blocks by their address: poses and points each stand in one array, in order
/// of their ids, so that the same map gives the same bytes.
class DetachedBundle::Implementation {
 public:
  Implementation(const SparseMap& map, const std::vector<KeyframeId>& free,
                 const StereoCamera& camera)
      : camera_(camera), free_(free), offset_(map.disparityOffset()) {
    collect(map, free);
    if (point_ids_.empty()) return;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      problem_.AddParameterBlock(poses_[i].data(), 7, &manifold_);
      ordering_->AddElementToGroup(poses_[i].data(), 1);
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      ordering_->AddElementToGroup(points_[i].data(), 0);
      for (const auto& observation : map.find(point_ids_[i])->observations) {
        problem_.AddResidualBlock(new Reprojection(observation.measurement, camera_), &loss_,
                                  poseOf(observation.keyframe), points_[i].data(), &offset_);
      }
    }
    problem_.AddResidualBlock(new OffsetPrior(offset_), nullptr, &offset_);
    ordering_->AddElementToGroup(&offset_, 2);
    fixOldKeyframes(free);
  }

  void solve(int max_iterations) {
    ceres::Solver::Options options;
    constexpr std::size_t kDense = 60;  ///< keyframes up to which a dense solution is faster
    options.linear_solver_type = poses_.size() <= kDense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = ordering_;
    options.max_num_iterations = max_iterations;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-4;
    options.callbacks.push_back(&stop_);
    if (!point_ids_.empty()) ceres::Solve(options, &problem_, &solved_);
  }

  void stop() { stop_.request(); }

  BundleSummary writeBack(SparseMap& map) const {
    BundleSummary summary;
    summary.iterations = static_cast<int>(solved_.iterations.size());
    summary.initial_cost = solved_.initial_cost;
    summary.final_cost = solved_.final_cost;
    if (summary.iterations > 0 && solved_.IsSolutionUsable()) {
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
  /// Fills the arrays; they do not grow afterwards.
  void collect(const SparseMap& map, const std::vector<KeyframeId>& free) {
    for (const LandmarkId id : map.seenBy(free)) {
      const Landmark& landmark = *map.find(id);
      if (landmark.observations.size() < 2) continue;
      point_ids_.push_back(id);
      points_.push_back(landmark.position);
      for (const auto& observation : landmark.observations) {
        pose_ids_.push_back(observation.keyframe);
      }
    }
    std::sort(pose_ids_.begin(), pose_ids_.end());
    pose_ids_.erase(std::unique(pose_ids_.begin(), pose_ids_.end()), pose_ids_.end());
    for (const KeyframeId id : pose_ids_) poses_.push_back(blockFrom(map.keyframe(id).T_map_cam));
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
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (problem_.IsParameterBlockConstant(poses_[i].data())) continue;
      if (map.keyframes().count(pose_ids_[i]) == 0) continue;
      map.keyframe(pose_ids_[i]).T_map_cam = poseFrom(poses_[i].data());
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (Landmark* landmark = map.find(point_ids_[i])) landmark->position = points_[i];
    }
    map.setDisparityOffset(offset_);
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

  double* poseOf(KeyframeId id) {
    const auto at = std::lower_bound(pose_ids_.begin(), pose_ids_.end(), id);
    return poses_[static_cast<std::size_t>(at - pose_ids_.begin())].data();
  }

  void fixOldKeyframes(const std::vector<KeyframeId>& free) {
    bool anchored = false;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (std::binary_search(free.begin(), free.end(), pose_ids_[i])) continue;
      problem_.SetParameterBlockConstant(poses_[i].data());
      anchored = true;
    }
    if (!anchored) problem_.SetParameterBlockConstant(poses_.front().data());
  }

  static ceres::Problem::Options problemOptions() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  StereoCamera camera_;
  std::vector<KeyframeId> free_;
  double offset_ = 0.0;  ///< of the disparities [px]
  ceres::Solver::Summary solved_;
  Stop stop_;
  PoseManifold manifold_;
  ceres::HuberLoss loss_{2.0};
  std::vector<KeyframeId> pose_ids_;
  std::vector<PoseBlock> poses_;
  std::vector<LandmarkId> point_ids_;
  std::vector<Eigen::Vector3d> points_;
  ceres::Problem problem_{problemOptions()};
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
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
      if (point_cam.z() < kMinDepth ||
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
