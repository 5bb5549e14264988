#pragma once

#include <headway/eval/pose_pairs.h>

#include <optional>
#include <vector>

namespace headway::eval {

/// What may be moved before estimate and truth are compared.
enum class Alignment {
  kSe3,    ///< the estimate, as a rigid body, for the least squared distance of positions
  kScale,  ///< the same, and its size too (monocular systems)
  kNone,   ///< nothing
};

struct TrajectoryErrorParams {
  Alignment alignment = Alignment::kSe3;
  /// Lengths of the path over which the relative errors of KITTI are taken [m].
  std::vector<double> segment_lengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
  std::size_t segment_step = 10;  ///< frames between the starts of two segments
};

/// RMSE, mean, standard deviation, median and maximum of errors; rmse^2 = mean^2 + sd^2.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double sd = 0.0;
  double median = 0.0;  ///< mean of the two in the middle where their number is even
  double max = 0.0;
};

/// Errors over segments of the path: means over all segments of all lengths.
struct SegmentErrors {
  double trans_percent = 0.0;  ///< translation error per length of path [%]
  double rot_deg_per_m = 0.0;  ///< rotation error per length of path [deg/m]
  std::size_t segments = 0;    ///< number of segments they rest on
};

/// How far an estimated trajectory is from the truth.
struct TrajectoryError {
  std::size_t frames = 0;          ///< poses of the estimate
  std::size_t frames_matched = 0;  ///< those of them with a partner: all below rests on them
  std::size_t truth_poses = 0;
  double path_m = 0.0;               ///< length of the true path through the matched poses
  std::optional<double> path_ratio;  ///< estimated length (not scaled) / true; none at a standstill
  ErrorStatistics ate_m;             ///< absolute trajectory error: distances of positions [m]
  double rpe_trans_rmse_m = 0.0;     ///< relative pose error from one matched pose to the next
  double rpe_rot_rmse_deg = 0.0;
  std::optional<SegmentErrors> kitti;  ///< none where the path is too short for every length

  Pose T_truth_estimate = Pose::Identity();  ///< the alignment used
  double scale = 1.0;                        ///< it multiplies the estimate's positions first
  std::vector<PosePair> aligned;             ///< the pairs, estimates aligned
  std::vector<double> errors_m;              ///< distance of positions, of each pair [m]
};

/// Compares an estimated trajectory with the truth.
///
/// The absolute error needs positions only, so a constant turn between the frames carried by
/// truth and estimate does not matter to it; the relative errors compare full poses of one and
/// the same frame. With kScale the relative errors are those of the scaled estimate.
///
///     const auto error = trajectoryError(pairByTime(truth, estimate, 0.02), {});
///     std::cout << error.ate_m.rmse;
///
/// @throws InputError if there are too few pairs to align and compare (3; without alignment 2),
///         or the estimate never moves and its scale is asked for
/// @see Umeyama 1991, "Least-squares estimation of transformation parameters between two point
///      patterns"; Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems",
///      eqs. 1-5 (relative pose error over one frame, absolute trajectory error); Geiger et al.
///      2012, "Are we ready for autonomous driving? The KITTI vision benchmark suite", eqs. 2-3
///      (errors over path segments of 100, 200 ... 800 m)
[[nodiscard]] TrajectoryError trajectoryError(const PosePairs& pairs,
                                              const TrajectoryErrorParams& params);

/// Statistics of a list; all zero if it is empty.
[[nodiscard]] ErrorStatistics statisticsOf(std::vector<double> errors);

}  // namespace headway::eval
