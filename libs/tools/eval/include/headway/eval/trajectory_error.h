// SPDX-License-Identifier: BSD-3-Clause
// Errors of trajectories: pairing of poses, alignment, absolute and relative errors.
#pragma once

#include <headway/core/pose.h>

#include <optional>
#include <vector>

namespace headway::eval {

/// True and estimated pose at one time.
struct PosePair {
  Time time = 0.0;  ///< of the estimate [s]; the row number if paired by index
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Corresponding poses of two trajectories, in order of time.
struct PosePairs {
  std::vector<PosePair> pairs;
  std::size_t truth_poses = 0;     ///< of the whole true trajectory
  std::size_t estimate_poses = 0;  ///< of the whole estimated trajectory
};

/// Pairs each estimated pose with the true pose nearest in time.
///
/// One to one: of several estimates with the same nearest true pose, only the nearest is paired.
/// The trajectories need not be sorted.
///
/// @param max_difference_s  maximum time difference of a pair [s]
/// @throws InputError if a trajectory is empty, a pose is not finite, or there is no pair; the
///         message then contains both time spans
[[nodiscard]] PosePairs pairByTime(const std::vector<Stamped<Pose>>& truth,
                                   const std::vector<Stamped<Pose>>& estimate,
                                   double max_difference_s);

/// Pairs row i with row i (KITTI odometry); surplus rows of the longer trajectory are ignored.
///
/// Lost frames are evaluated with the pose in their row (headway repeats the last one).
///
/// @throws InputError if a trajectory is empty or a pose is not finite
[[nodiscard]] PosePairs pairByIndex(const std::vector<Pose>& truth,
                                    const std::vector<Pose>& estimate);

/// Transformation of the estimate before the comparison with the truth.
enum class Alignment {
  kSe3,     ///< rigid transformation that minimises the squared position errors
  kScale,   ///< similarity transformation, for monocular systems
  kOrigin,  ///< rigid transformation that makes the first poses equal
  kNone,    ///< none
};

/// The fixed rotation of the truth's body on the robot, of which relative errors must be free.
struct BodyRotation {
  enum class Source {
    kAssumed,  ///< none
    kStated,
    kFound,    ///< by the motion, and significant
    kUnknown,  ///< the axes differ, and the motion does not determine how
  };
  Source source = Source::kAssumed;
  Eigen::Matrix3d R_robot_truth = Eigen::Matrix3d::Identity();
  double sigma_rad = 0.0;  ///< if it was found: of the axis that is known worst
};

/// How a trajectory is compared with the true one.
struct TrajectoryErrorParams {
  Alignment alignment = Alignment::kSe3;
  std::optional<Eigen::Matrix3d> R_robot_truth;  ///< the truth's body on the robot, if stated
  bool finds_rotation = false;                   ///< by the motion, if it is not stated
  /// Lengths of the path segments of KITTI's relative errors [m].
  std::vector<double> segment_lengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
  std::size_t segment_step = 10;  ///< frames between the starts of segments
};

/// RMSE, mean, standard deviation, median and maximum of errors; rmse^2 = mean^2 + sd^2.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double sd = 0.0;
  double median = 0.0;  ///< mean of the two central values if their number is even
  double max = 0.0;
};

/// Relative errors over path segments, averaged over all segments of all lengths.
struct SegmentErrors {
  double trans_percent = 0.0;  ///< translation error per path length [%]
  double rot_deg_per_m = 0.0;  ///< rotation error per path length [deg/m]
  std::size_t segments = 0;    ///< number of segments
};

/// Errors of an estimated trajectory.
struct TrajectoryError {
  std::size_t frames = 0;          ///< poses of the estimate
  std::size_t frames_matched = 0;  ///< poses with a true partner; the figures below are over these
  std::size_t truth_poses = 0;
  double path_m = 0.0;  ///< length of the true path through the matched poses
  std::optional<double>
      path_ratio;                 ///< unscaled estimated length / true length; none at standstill
  ErrorStatistics ate_m;          ///< absolute trajectory error: position distances [m]
  double rpe_trans_rmse_m = 0.0;  ///< relative pose error between consecutive matched poses
  double rpe_rot_rmse_deg = 0.0;
  std::optional<SegmentErrors> kitti;  ///< none if the path is shorter than every segment

  Pose T_truth_estimate = Pose::Identity();  ///< alignment applied
  double scale = 1.0;                        ///< factor of the estimated positions, applied first
  BodyRotation body;                         ///< applied to the estimates' axes
  std::vector<PosePair> aligned;             ///< pairs with aligned estimates
  std::vector<double> errors_m;              ///< position error of each pair [m]
};

/// Compares an estimated trajectory with the truth.
///
/// The absolute error uses positions only, so a constant rotation between the body frames of truth
/// and estimate has no effect on it; the relative errors require the same body frame. That rotation
/// is found where rotations about several axes, or a path that is not straight, determine it to a
/// degree. With kScale the relative errors are those of the scaled estimate.
///
///     const auto error = trajectoryError(pairByTime(truth, estimate, 0.02), {});
///     std::cout << error.ate_m.rmse;
///
/// @throws InputError if there are too few pairs to align and compare (3; kOrigin and kNone 2),
///         or kScale is given and the estimate does not move
/// @see Umeyama 1991, "Least-squares estimation of transformation parameters between two point
///      patterns"; Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems",
///      eqs. 1-5 (relative pose error over one frame, absolute trajectory error); Park & Martin
///      1994, "Robot sensor calibration: solving AX = XB on the Euclidean group"; Geiger et al.
///      2012, "Are we ready for autonomous driving? The KITTI vision benchmark suite", eqs. 2-3
///      (errors over path segments of 100, 200 ... 800 m)
[[nodiscard]] TrajectoryError trajectoryError(const PosePairs& pairs,
                                              const TrajectoryErrorParams& params);

/// Length of the true path from the first pair to each pair [m].
[[nodiscard]] std::vector<double> trueDistances(const std::vector<PosePair>& pairs);

/// Statistics of a list; all zero if it is empty.
[[nodiscard]] ErrorStatistics statisticsOf(std::vector<double> errors);

}  // namespace headway::eval
