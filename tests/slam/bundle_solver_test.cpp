// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_solver.h"

#include <gtest/gtest.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/stereo_residual.h>

#include <random>

#include "test_camera.h"

namespace headway::slam {
namespace {

StereoCamera solverCamera() {
  StereoCamera camera = testCamera();
  camera.T_robot_cam.linear() = expSo3({-1.2, 0.1, -1.3});
  camera.T_robot_cam.translation() << 0.3, -0.1, 0.8;
  return camera;
}

stereo::Tangent randomTangent(std::mt19937& random, double sigma) {
  std::normal_distribution<double> noise;
  stereo::Tangent xi;
  for (double& value : xi) value = sigma * noise(random);
  return xi;
}

/// Exact measurements of points along a path; each point is seen by the poses within 20 m.
BundleProblem exactProblem(int poses, double offset_px = 0.0) {
  const StereoCamera camera = solverCamera();
  BundleProblem problem;
  for (int i = 0; i < poses; ++i) {
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0.0, 0.01 * i, 0.005 * i});
    pose.translation() << 0.05 * i, 0.02 * i, 0.8 * i;
    problem.poses.push_back(pose);
    problem.is_fixed.push_back(i == 0);
  }
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-8.0, 8.0), y(-4.0, 2.0), z(4.0, 19.0);
  for (int n = 0; n < 25 * poses; ++n) {
    const Eigen::Vector3d point = problem.poses[static_cast<std::size_t>(n / 25)] *
                                  Eigen::Vector3d(x(random), y(random), z(random));
    for (int i = 0; i < poses; ++i) {
      const Eigen::Vector3d point_cam =
          problem.poses[static_cast<std::size_t>(i)].inverse(Eigen::Isometry) * point;
      const auto uvd = project(point_cam, camera);
      if (!uvd || point_cam.z() < 1.0 || point_cam.z() > 20.0) continue;
      problem.observations.push_back(
          {i, {uvd->head<2>(), uvd->z() + offset_px, n % 7 != 0, 0.5, 0.4}});
    }
    problem.points.push_back({point, problem.observations.size()});
  }
  return problem;
}

void disturb(BundleProblem& problem, double sigma) {
  std::mt19937 random(8);
  for (std::size_t i = 1; i < problem.poses.size(); ++i) {
    problem.poses[i] = stereo::retract(problem.poses[i], randomTangent(random, sigma));
  }
  for (auto& point : problem.points) {
    point.position += randomTangent(random, 10.0 * sigma).head<3>();
  }
}

class OneStepTest : public testing::TestWithParam<int> {};

/// The measurements are exact, so that a Gauss-Newton step from nearby leads to zero residuals.
TEST_P(OneStepTest, SolvesANearlyLinearProblem) {
  const StereoCamera camera = solverCamera();
  BundleProblem problem = exactProblem(GetParam());
  for (int i = 1; i < GetParam(); i += 2) {
    BundleProblem::Motion motion{i - 1, i, Pose::Identity(), {}};
    motion.sigma.setConstant(0.05);
    const auto a = static_cast<std::size_t>(motion.a), b = static_cast<std::size_t>(motion.b);
    motion.T_a_b = camera.T_robot_cam * problem.poses[a].inverse() * problem.poses[b] *
                   camera.T_robot_cam.inverse();
    problem.motions.push_back(motion);
  }
  const BundleProblem truth = problem;
  ASSERT_LT(costOf(truth, camera, 0.0), 1e-12);
  disturb(problem, 1e-6);
  const double before = costOf(problem, camera, 0.0);
  BundleStep step(problem, camera, 0.0);
  ASSERT_TRUE(step.compute(1e12));
  BundleProblem moved = problem;
  step.applyTo(moved);
  EXPECT_NEAR(step.predictedDecrease(), before, 1e-3 * before);
  EXPECT_LT(costOf(moved, camera, 0.0), 1e-4 * before);
  const Pose error = truth.poses.back().inverse() * moved.poses.back();
  EXPECT_LT(error.translation().norm(), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(DenseAndSparse, OneStepTest, testing::Values(4, 20, 120));

TEST(SolveBundleTest, ConvergesFromFarAwayAndFindsTheOffset) {
  const StereoCamera camera = solverCamera();
  BundleProblem problem = exactProblem(8, 0.1);
  const BundleProblem truth = problem;
  disturb(problem, 0.01);
  const auto solution = solveBundle(problem, camera, 50);
  ASSERT_TRUE(solution.usable);
  EXPECT_LT(solution.final_cost, 0.01 * solution.initial_cost);
  EXPECT_NEAR(problem.disparity_offset_px, 0.1, 0.03);
  EXPECT_LT((problem.poses.back().translation() - truth.poses.back().translation()).norm(), 0.02);
}

TEST(SolveBundleTest, LeavesFixedPosesWhereTheyAre) {
  BundleProblem problem = exactProblem(5);
  disturb(problem, 0.01);
  problem.is_fixed[2] = true;
  const Pose before = problem.poses[2];
  ASSERT_TRUE(solveBundle(problem, solverCamera(), 20).usable);
  EXPECT_EQ(problem.poses[2].matrix(), before.matrix());
}

TEST(SolveBundleTest, AdjustsPointsWhereAllPosesAreFixed) {
  BundleProblem problem = exactProblem(3);
  const Eigen::Vector3d before = problem.points[1].position;
  problem.points[1].position *= 1.01;
  problem.is_fixed.assign(3, true);
  ASSERT_TRUE(solveBundle(problem, solverCamera(), 20).usable);
  EXPECT_LT((problem.points[1].position - before).norm(), 1e-3);
}

TEST(SolveBundleTest, IsNotUsableWithPointsBehindTheCameraOrWhenStopped) {
  BundleProblem problem = exactProblem(4);
  disturb(problem, 0.01);
  EXPECT_FALSE(solveBundle(problem, solverCamera(), 20, [] { return true; }).usable);
  problem.points.front().position.z() = -50.0;
  EXPECT_FALSE(solveBundle(problem, solverCamera(), 20).usable);
}

TEST(MotionFactorTest, DerivativesAreThoseOfTheResidual) {
  std::mt19937 random(3);
  const Pose T_robot_cam = solverCamera().T_robot_cam;
  std::vector<Pose> poses;
  for (int i = 0; i < 2; ++i) {
    poses.push_back(stereo::retract(Pose::Identity(), randomTangent(random, 0.7)));
  }
  BundleProblem::Motion motion{0, 1, Pose::Identity(), {}};
  motion.T_a_b =
      stereo::retract(T_robot_cam * poses[0].inverse() * poses[1] * T_robot_cam.inverse(),
                      randomTangent(random, 0.01));
  motion.sigma << 2.0, 3.0, 4.0, 5.0, 6.0, 7.0;  // so wide that the loss is a square
  const MotionTerms terms = linearised(motion, poses, T_robot_cam);
  EXPECT_NEAR(terms.residual.squaredNorm(), motionLoss(motion, poses, T_robot_cam), 1e-6);
  constexpr double kStep = 1e-6;
  for (int pose = 0; pose < 2; ++pose) {
    for (int k = 0; k < 6; ++k) {
      auto moved = poses;
      const auto at = static_cast<std::size_t>(pose);
      moved[at] = stereo::retract(poses[at], kStep * stereo::Tangent::Unit(k));
      const stereo::Tangent numeric =
          (linearised(motion, moved, T_robot_cam).residual - terms.residual) / kStep;
      const stereo::Tangent analytic = (pose == 0 ? terms.by_a : terms.by_b).col(k);
      EXPECT_LT((numeric - analytic).norm(), 1e-4) << pose << " " << k;
    }
  }
}

/// The last pose sees nothing of what the others see.
BundleProblem problemWithABlindPose(const StereoCamera& camera) {
  BundleProblem problem = exactProblem(4);
  const Pose step = problem.poses[2].inverse() * problem.poses[3];
  problem.poses.push_back(problem.poses[3] * step);
  problem.is_fixed.push_back(false);
  BundleProblem::Motion motion{3, 4, camera.T_robot_cam * step * camera.T_robot_cam.inverse(), {}};
  motion.sigma.setConstant(0.02);
  problem.motions.push_back(motion);
  return problem;
}

TEST(SolveBundleTest, PlacesAPoseWithoutObservationsByMeasuredMotion) {
  const StereoCamera camera = solverCamera();
  BundleProblem problem = problemWithABlindPose(camera);
  const Pose expected = problem.poses[4];
  problem.poses[4].translation() += Eigen::Vector3d(0.02, -0.01, 0.03);
  ASSERT_TRUE(solveBundle(problem, camera, 30).usable);
  EXPECT_LT((problem.poses[4].translation() - expected.translation()).norm(), 1e-3);
}

TEST(SolveBundleTest, IgnoresAMotionThatContradictsTheObservations) {
  const StereoCamera camera = solverCamera();
  BundleProblem problem = exactProblem(5);
  const BundleProblem truth = problem;
  BundleProblem::Motion motion{3, 4, Pose::Identity(), {}};  // the wheels stood
  motion.sigma.setConstant(0.02);
  problem.motions.push_back(motion);
  ASSERT_TRUE(solveBundle(problem, camera, 30).usable);
  EXPECT_LT((problem.poses[4].translation() - truth.poses[4].translation()).norm(), 1e-3);
}

}  // namespace
}  // namespace headway::slam
