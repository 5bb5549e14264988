#include "bundle_solver.h"

#include <headway/core/stop_request.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bundle_step.h"

namespace headway::slam {

BundleSolution solveBundle(BundleProblem& problem, const StereoCamera& camera, int max_iterations,
                           const std::atomic<bool>& stop) {
  constexpr double kMinGain = 1e-3;    ///< accepted ratio of actual to predicted decrease
  constexpr double kTolerance = 1e-4;  ///< relative decrease of the cost at convergence
  const double previous_offset = problem.disparity_offset_px;
  BundleSolution solution;
  double cost = solution.initial_cost = costOf(problem, camera, previous_offset);
  if (!std::isfinite(cost)) return solution;
  BundleStep step(problem, camera, previous_offset);
  BundleProblem moved = problem;
  double radius = 1e4;  // of the trust region
  double shrink = 2.0;
  const auto is_stopped = [&] { return stop || stopRequested(); };
  for (; solution.iterations < max_iterations && !is_stopped(); ++solution.iterations) {
    if (!step.compute(radius)) break;
    moved.poses = problem.poses;
    moved.points = problem.points;
    moved.disparity_offset_px = problem.disparity_offset_px;
    step.applyTo(moved);
    const double decrease = cost - costOf(moved, camera, previous_offset);
    const double gain = decrease / step.predictedDecrease();
    if (gain > kMinGain) {
      std::swap(problem.poses, moved.poses);
      std::swap(problem.points, moved.points);
      problem.disparity_offset_px = moved.disparity_offset_px;
      cost -= decrease;
      radius = std::min(1e16, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      shrink = 2.0;
    } else {
      radius /= shrink;
      shrink *= 2.0;
    }
    if (std::abs(decrease) <= kTolerance * cost) break;
  }
  solution.usable = !is_stopped();
  solution.final_cost = cost;
  return solution;
}

}  // namespace headway::slam
