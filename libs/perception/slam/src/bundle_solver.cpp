// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bundle_step.h"

namespace headway::slam {

namespace {

/// What a solve changes of a problem.
struct State {
  std::vector<Pose> poses;
  std::vector<BundleProblem::Point> points;
  double disparity_offset_px = 0.0;

  void copyFrom(const BundleProblem& problem) {
    poses = problem.poses;
    points = problem.points;
    disparity_offset_px = problem.disparity_offset_px;
  }
  void swapInto(BundleProblem& problem) {
    std::swap(problem.poses, poses);
    std::swap(problem.points, points);
    problem.disparity_offset_px = disparity_offset_px;
  }
};

}  // namespace

BundleSolution solveBundle(BundleProblem& problem, const StereoCamera& camera, int max_iterations,
                           const StopCondition& stop) {
  constexpr double kMinGain = 1e-3;    ///< accepted ratio of actual to predicted decrease
  constexpr double kTolerance = 1e-4;  ///< relative decrease of the cost at convergence
  const double previous_offset = problem.disparity_offset_px;
  BundleSolution solution;
  double cost = solution.initial_cost = costOf(problem, camera, previous_offset);
  if (!std::isfinite(cost)) return solution;
  BundleStep step(problem, camera, previous_offset);
  State before;
  double radius = 1e4;  // of the trust region
  double shrink = 2.0;
  for (; solution.iterations < max_iterations && !stop(); ++solution.iterations) {
    if (!step.compute(radius)) break;
    before.copyFrom(problem);
    step.applyTo(problem);
    const double decrease = cost - costOf(problem, camera, previous_offset);
    const double gain = decrease / step.predictedDecrease();
    if (gain > kMinGain) {
      cost -= decrease;
      radius = std::min(1e16, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      shrink = 2.0;
    } else {
      before.swapInto(problem);
      radius /= shrink;
      shrink *= 2.0;
    }
    if (std::abs(decrease) <= kTolerance * cost) break;
  }
  solution.usable = !stop();
  if (solution.usable) solution.free_offset = step.freeOffset();
  solution.final_cost = cost;
  return solution;
}

}  // namespace headway::slam
