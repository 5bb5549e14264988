// SPDX-License-Identifier: BSD-3-Clause
// Errors of trajectories: pairing of poses, alignment, absolute and relative errors.
#include <headway/core/error.h>
#include <headway/eval/trajectory_error.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

namespace headway::eval {
namespace {

void requirePoses(bool empty, const std::string& which) {
  if (empty) throw InputError("the " + which + " is empty");
}

void requireFinite(const Pose& pose, std::size_t row, const std::string& which) {
  if (!pose.matrix().allFinite()) {
    throw InputError("the " + which + " contains a pose that is not finite (row " +
                     std::to_string(row + 1) + ")");
  }
}

std::vector<Stamped<Pose>> sorted(const std::vector<Stamped<Pose>>& trajectory,
                                  const std::string& which) {
  requirePoses(trajectory.empty(), which);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    requireFinite(trajectory[i].value, i, which);
    if (!std::isfinite(trajectory[i].time)) {
      throw InputError("the " + which + " contains a time that is not finite (row " +
                       std::to_string(i + 1) + ")");
    }
  }
  auto result = trajectory;
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return result;
}

std::size_t nearest(const std::vector<Stamped<Pose>>& trajectory, Time time) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), time,
                       [](const Stamped<Pose>& pose, Time t) { return pose.time < t; });
  if (after == trajectory.begin()) return 0;
  const auto before = after - 1;
  const bool is_before_nearer =
      after == trajectory.end() || time - before->time <= after->time - time;
  return static_cast<std::size_t>((is_before_nearer ? before : after) - trajectory.begin());
}

std::string spanOf(const std::vector<Stamped<Pose>>& trajectory) {
  return std::to_string(trajectory.front().time) + " .. " + std::to_string(trajectory.back().time) +
         " s";
}

}  // namespace

PosePairs pairByTime(const std::vector<Stamped<Pose>>& truth,
                     const std::vector<Stamped<Pose>>& estimate, double max_difference_s) {
  const auto true_poses = sorted(truth, "true trajectory");
  const auto estimates = sorted(estimate, "estimated trajectory");
  std::map<std::size_t, std::size_t> estimate_of;  // index of the true pose -> of the estimate
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const std::size_t j = nearest(true_poses, estimates[i].time);
    const double difference = std::abs(true_poses[j].time - estimates[i].time);
    if (difference > max_difference_s) continue;
    const auto [previous, inserted] = estimate_of.emplace(j, i);
    if (inserted) continue;
    if (difference < std::abs(true_poses[j].time - estimates[previous->second].time)) {
      previous->second = i;
    }
  }
  if (estimate_of.empty()) {
    throw InputError("no estimated pose has a true pose within " +
                     std::to_string(max_difference_s) + " s: truth spans " + spanOf(true_poses) +
                     ", estimate " + spanOf(estimates));
  }
  PosePairs result{{}, truth.size(), estimate.size()};
  for (const auto& [j, i] : estimate_of) {
    result.pairs.push_back({estimates[i].time, true_poses[j].value, estimates[i].value});
  }
  return result;
}

PosePairs pairByIndex(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  requirePoses(truth.empty(), "true trajectory");
  requirePoses(estimate.empty(), "estimated trajectory");
  PosePairs result{{}, truth.size(), estimate.size()};
  for (std::size_t i = 0; i < std::min(truth.size(), estimate.size()); ++i) {
    requireFinite(truth[i], i, "true trajectory");
    requireFinite(estimate[i], i, "estimated trajectory");
    result.pairs.push_back({static_cast<double>(i), truth[i], estimate[i]});
  }
  return result;
}

namespace {

/// Estimated motion relative to the true motion from pair `from` to pair `to`; identity if equal.
///
/// @see Sturm et al. 2012, eq. 1
Pose relativeError(const PosePair& from, const PosePair& to) {
  const Pose true_motion = from.truth.inverse() * to.truth;
  const Pose estimated_motion = from.estimate.inverse() * to.estimate;
  return true_motion.inverse() * estimated_motion;
}

/// Relative errors over segments of the true path.
///
/// A segment of length L starts at every `segment_step`-th pair and ends at the first pair more
/// than L further along the path; its errors are those of the relative pose divided by L.
///
/// @return nullopt if no segment fits
/// @see    Geiger et al. 2012, eqs. 2-3
std::optional<SegmentErrors> segmentErrors(const std::vector<PosePair>& pairs,
                                           const TrajectoryErrorParams& params) {
  const auto distances = trueDistances(pairs);
  double trans_sum = 0.0;
  double rot_sum = 0.0;
  std::size_t segments = 0;
  for (std::size_t first = 0; first < pairs.size(); first += params.segment_step) {
    for (const double length : params.segment_lengths_m) {
      const auto last =
          std::upper_bound(distances.begin(), distances.end(), distances[first] + length);
      if (last == distances.end()) continue;
      const Pose error =
          relativeError(pairs[first], pairs[static_cast<std::size_t>(last - distances.begin())]);
      trans_sum += error.translation().norm() / length;
      rot_sum += logSo3(error.linear()).norm() / length;
      ++segments;
    }
  }
  if (segments == 0) return std::nullopt;
  const auto count = static_cast<double>(segments);
  return SegmentErrors{100.0 * trans_sum / count, rot_sum / count * 180.0 / M_PI, segments};
}

struct Similarity {
  double scale = 1.0;
  Pose T_truth_estimate = Pose::Identity();
};

Similarity alignmentOf(const std::vector<PosePair>& pairs, Alignment alignment) {
  if (alignment == Alignment::kNone) return {};
  if (alignment == Alignment::kOrigin) {
    return {1.0, pairs.front().truth * pairs.front().estimate.inverse()};
  }
  Eigen::Matrix3Xd truth(3, pairs.size());
  Eigen::Matrix3Xd estimate(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    truth.col(static_cast<Eigen::Index>(i)) = pairs[i].truth.translation();
    estimate.col(static_cast<Eigen::Index>(i)) = pairs[i].estimate.translation();
  }
  const bool with_scale = alignment == Alignment::kScale;
  if (with_scale && (estimate.colwise() - estimate.col(0)).isZero(0.0)) {
    throw InputError("the estimate does not move, so its scale is undefined; use --align se3");
  }
  const Eigen::Matrix4d similarity = Eigen::umeyama(estimate, truth, with_scale);
  Similarity result;
  result.scale = std::cbrt(similarity.topLeftCorner<3, 3>().determinant());
  if (!with_scale) result.scale = 1.0;
  result.T_truth_estimate.linear() = similarity.topLeftCorner<3, 3>() / result.scale;
  result.T_truth_estimate.translation() = similarity.topRightCorner<3, 1>();
  return result;
}

std::vector<PosePair> alignedPairs(std::vector<PosePair> pairs, const Similarity& similarity) {
  for (auto& pair : pairs) {
    pair.estimate.translation() *= similarity.scale;
    pair.estimate = similarity.T_truth_estimate * pair.estimate;
  }
  return pairs;
}

constexpr double kPieceTurn_rad = 0.2;            // far above the errors of an estimate's turns
constexpr double kTurnSigma_rad = 0.1 * kDegree;  // least error of such a turn
constexpr double kPositionSigma_m = 1e-3;         // least error of a position
constexpr double kDetermined_rad = kDegree;  // an error of 2 % of the length of relative motions
constexpr double kSignificance = 3.0;        // standard deviations
constexpr double kContradiction = 0.5;       // of the motions' lengths: axes 30 degrees apart
constexpr double kPiecesOfPath = 50.0;       // whose directions are compared,
constexpr double kErrorsOfPiece = 5.0;       // so many times as long as the greatest error

/// The rotation with the greatest trace of its product with a sum of products: Kabsch 1976.
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& products) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

/// Information on a rotation by vectors that it turns; the error is that of its worst axis.
double worstSigma(const Eigen::Matrix3d& information, double sigma) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information, Eigen::EigenvaluesOnly);
  return sigma / std::sqrt(std::max(axes.eigenvalues()[0], 0.0));
}

Eigen::Matrix3d informationOf(const Eigen::Vector3d& v) {
  return v.squaredNorm() * Eigen::Matrix3d::Identity() - v * v.transpose();
}

/// Rotations of truth and estimate over pieces of the path in which the truth turns enough.
std::vector<std::array<Eigen::Vector3d, 2>> turnsOf(const std::vector<PosePair>& pairs) {
  std::vector<std::array<Eigen::Vector3d, 2>> turns;
  std::size_t from = 0;
  const auto turn = [](const Pose& a, const Pose& b) {
    return logSo3(a.linear().transpose() * b.linear());
  };
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const Eigen::Vector3d by_truth = turn(pairs[from].truth, pairs[i].truth);
    if (by_truth.norm() < kPieceTurn_rad) continue;
    turns.push_back({by_truth, turn(pairs[from].estimate, pairs[i].estimate)});
    from = i;
  }
  return turns;
}

/// By these rotations (Park & Martin 1994, AX = XB for rotations).
BodyRotation rotationByTurns(const std::vector<std::array<Eigen::Vector3d, 2>>& turns) {
  BodyRotation result{BodyRotation::Source::kFound, Eigen::Matrix3d::Identity(), M_PI};
  if (turns.size() < 2) return result;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero(), information = Eigen::Matrix3d::Zero();
  for (const auto& [truth, estimate] : turns) products += estimate * truth.transpose();
  result.R_robot_truth = nearestRotation(products);
  double squares = 0.0;
  for (const auto& [truth, estimate] : turns) {
    squares += (estimate - result.R_robot_truth * truth).squaredNorm();
    information += informationOf(truth);
  }
  const double degrees_of_freedom = 3.0 * static_cast<double>(turns.size()) - 3.0;
  result.sigma_rad =
      worstSigma(information, std::max(kTurnSigma_rad, std::sqrt(squares / degrees_of_freedom)));
  return result;
}

/// By the attitudes, once the paths are aligned; errors of the paths do not average out.
BodyRotation rotationByPath(const std::vector<PosePair>& aligned) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  const auto count = static_cast<double>(aligned.size());
  for (const auto& pair : aligned) centre += pair.truth.translation() / count;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero(), information = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  for (const auto& [time, truth, estimate] : aligned) {
    products += estimate.linear().transpose() * truth.linear();
    information += informationOf(truth.translation() - centre) / count;
    squares += (truth.translation() - estimate.translation()).squaredNorm() / count;
  }
  const Eigen::Matrix3d R_robot_truth = nearestRotation(products);
  double attitudes = 0.0;
  for (const auto& [time, truth, estimate] : aligned) {
    attitudes +=
        logSo3(truth.linear().transpose() * estimate.linear() * R_robot_truth).squaredNorm() /
        count;
  }
  const double by_places = worstSigma(information, std::max(kPositionSigma_m, std::sqrt(squares)));
  return {BodyRotation::Source::kFound, R_robot_truth, std::hypot(by_places, std::sqrt(attitudes))};
}

/// Whether the truth turns or moves about other axes of its own than the estimate: in pieces much
/// longer than the errors of their ends.
bool areAxesContrary(const std::vector<PosePair>& pairs,
                     const std::vector<std::array<Eigen::Vector3d, 2>>& turns, double error_m) {
  double turned = 0.0, moved = 0.0, by_turns = 0.0, by_moves = 0.0;  // lengths and differences
  for (const auto& [truth, estimate] : turns) {
    turned += truth.norm();
    by_turns += (truth - estimate).norm();
  }
  const double piece =
      std::max(trueDistances(pairs).back() / kPiecesOfPath, kErrorsOfPiece * error_m);
  std::size_t from = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const Pose truth = pairs[from].truth.inverse() * pairs[i].truth;
    if (truth.translation().norm() < piece) continue;
    const Pose estimate = pairs[from].estimate.inverse() * pairs[i].estimate;
    moved += truth.translation().norm();
    by_moves += (truth.translation() - estimate.translation()).norm();
    from = i;
  }
  return by_turns > kContradiction * turned || by_moves > kContradiction * moved;
}

BodyRotation bodyRotation(const std::vector<PosePair>& pairs, const TrajectoryErrorParams& params) {
  if (params.R_robot_truth) return {BodyRotation::Source::kStated, *params.R_robot_truth, 0.0};
  if (!params.finds_rotation) return {};
  const auto turns = turnsOf(pairs);
  BodyRotation best = rotationByTurns(turns);
  double error_m = 0.0;
  if (params.alignment == Alignment::kSe3 || params.alignment == Alignment::kScale) {
    const auto aligned = alignedPairs(pairs, alignmentOf(pairs, params.alignment));
    const auto by_path = rotationByPath(aligned);
    if (by_path.sigma_rad < best.sigma_rad) best = by_path;
    for (const auto& pair : aligned) {
      error_m = std::max(error_m, (pair.truth.translation() - pair.estimate.translation()).norm());
    }
  }
  if (best.sigma_rad <= kDetermined_rad) {
    const double limit = std::max(kSignificance * best.sigma_rad, kDetermined_rad);
    return logSo3(best.R_robot_truth).norm() > limit ? best : BodyRotation();
  }
  if (!areAxesContrary(pairs, turns, error_m)) return {};
  return {BodyRotation::Source::kUnknown, Eigen::Matrix3d::Identity(), 0.0};
}

void requireEnough(const PosePairs& pairs, Alignment alignment) {
  const bool is_fitted = alignment == Alignment::kSe3 || alignment == Alignment::kScale;
  const std::size_t needed = is_fitted ? 3 : 2;
  if (pairs.pairs.size() >= needed) return;
  throw InputError(
      "only " + std::to_string(pairs.pairs.size()) + " of " + std::to_string(pairs.estimate_poses) +
      " estimated poses have a true one; at least " + std::to_string(needed) + " are needed");
}

double estimatedLength(const std::vector<PosePair>& pairs) {
  double length = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    length += (pairs[i].estimate.translation() - pairs[i - 1].estimate.translation()).norm();
  }
  return length;
}

void addRelativeErrors(TrajectoryError& result) {
  std::vector<double> trans;
  std::vector<double> rot;
  for (std::size_t i = 1; i < result.aligned.size(); ++i) {
    const Pose error = relativeError(result.aligned[i - 1], result.aligned[i]);
    trans.push_back(error.translation().norm());
    rot.push_back(logSo3(error.linear()).norm() * 180.0 / M_PI);
  }
  result.rpe_trans_rmse_m = statisticsOf(trans).rmse;
  result.rpe_rot_rmse_deg = statisticsOf(rot).rmse;
}

}  // namespace

ErrorStatistics statisticsOf(std::vector<double> errors) {
  if (errors.empty()) return {};
  ErrorStatistics result;
  const auto count = static_cast<double>(errors.size());
  for (const double error : errors) result.mean += error / count;
  double variance = 0.0;
  for (const double error : errors) {
    variance += (error - result.mean) * (error - result.mean) / count;
  }
  result.sd = std::sqrt(variance);
  result.rmse = std::hypot(result.mean, result.sd);
  std::sort(errors.begin(), errors.end());
  const std::size_t middle = errors.size() / 2;
  result.median =
      errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  result.max = errors.back();
  return result;
}

std::vector<double> trueDistances(const std::vector<PosePair>& pairs) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double step =
        i == 0 ? 0.0 : (pairs[i].truth.translation() - pairs[i - 1].truth.translation()).norm();
    distances.push_back(i == 0 ? 0.0 : distances.back() + step);
  }
  return distances;
}

TrajectoryError trajectoryError(const PosePairs& pairs, const TrajectoryErrorParams& params) {
  requireEnough(pairs, params.alignment);
  TrajectoryError result;
  result.frames = pairs.estimate_poses;
  result.frames_matched = pairs.pairs.size();
  result.truth_poses = pairs.truth_poses;
  result.path_m = trueDistances(pairs.pairs).back();
  if (result.path_m > 0.0) result.path_ratio = estimatedLength(pairs.pairs) / result.path_m;
  result.body = bodyRotation(pairs.pairs, params);
  auto with_body = pairs.pairs;
  for (auto& pair : with_body) pair.estimate.linear() *= result.body.R_robot_truth;
  const auto similarity = alignmentOf(with_body, params.alignment);
  result.scale = similarity.scale;
  result.T_truth_estimate = similarity.T_truth_estimate;
  result.aligned = alignedPairs(std::move(with_body), similarity);
  for (const auto& pair : result.aligned) {
    result.errors_m.push_back((pair.truth.translation() - pair.estimate.translation()).norm());
  }
  result.ate_m = statisticsOf(result.errors_m);
  addRelativeErrors(result);
  result.kitti = segmentErrors(result.aligned, params);
  return result;
}

}  // namespace headway::eval
