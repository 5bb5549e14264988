// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/worker_thread.h>
#include <headway/stereo/disparity_offset.h>
#include <headway/stereo/stereo_residual.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace headway::slam {

constexpr double kMinObservedDepth = 0.05;  ///< [m]

/// Poses and points to be adjusted to measurements of the points; indices refer to the vectors.
struct BundleProblem {
  struct Observation {
    int pose = 0;
    stereo::StereoMeasurement measurement;
  };
  /// Measured motion from one pose to a later one, by other sensors than the camera.
  struct Motion {
    int a = 0;
    int b = 0;
    Pose T_a_b = Pose::Identity();  ///< robot frames
    /// Standard deviations of translation [m] and rotation [rad] along the axes of frame b.
    Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Ones();
  };
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
    std::size_t observations_end = 0;  ///< its observations begin where the point's before end
  };

  std::vector<Pose> poses;     ///< T_map_cam
  std::vector<bool> is_fixed;  ///< of each pose; at least one is
  std::vector<Point> points;
  std::vector<Observation> observations;  ///< by point, then by pose
  std::vector<Motion> motions;
  double disparity_offset_px = 0.0;  ///< measured less true disparity, estimated as well
};

/// How a solve went.
struct BundleSolution {
  bool usable = false;  ///< the problem holds poses and points that are no worse than before
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  /// The disparities' offset by the observations alone, without what is assumed about it; nullopt
  /// if they do not tell it.
  std::optional<stereo::OffsetEstimate> free_offset;
};

/// Minimises the reprojection errors by Levenberg-Marquardt with a Huber loss.
///
/// Each point is eliminated by its 3x3 block (Schur complement), which leaves a system of the free
/// poses and of the disparities' offset. All blocks have fixed sizes: for residuals of 3 with poses
/// of 6, Ceres 2.1 falls back to dynamic ones (doc/lab/slam.md compares the times).
///
/// @param stop  cancels the solve after its present iteration, with an unusable solution
/// @see Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6;
///      Agarwal et al. 2010, "Bundle adjustment in the large", sec. 3 (step control as in Ceres)
[[nodiscard]] BundleSolution solveBundle(BundleProblem& problem, const StereoCamera& camera,
                                         int max_iterations, const StopCondition& stop = neverStop);

}  // namespace headway::slam
