// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/pose_refiner.h>

#include <random>

namespace headway::stereo {
namespace {

StereoCamera testCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 500.0;
  camera.fy = 510.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.baseline_m = 0.3;
  return camera;
}

Pose truePose() {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.05, -0.2, 0.1});
  pose.translation() << 0.4, -0.3, 0.8;
  return pose;
}

/// Measurements of random points with Gaussian noise of one sigma.
std::vector<PoseConstraint> world(int count, double noise_px, int seed) {
  const StereoCamera camera = testCamera();
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> column(0.0, camera.width), row(0.0, camera.height);
  std::uniform_real_distribution<double> depth(3.0, 40.0);
  std::normal_distribution<double> normal;
  const auto noise = [&](std::mt19937& source) { return noise_px * normal(source); };
  std::vector<PoseConstraint> constraints;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d uv(column(random), row(random));
    const Eigen::Vector3d point_cam = depth(random) * ray(uv, camera);
    PoseConstraint constraint;
    constraint.point_map = truePose() * point_cam;
    const auto uvd = project(point_cam, camera).value();
    constraint.measurement.uv = uvd.head<2>() + Eigen::Vector2d(noise(random), noise(random));
    constraint.measurement.disparity = uvd.z() + noise(random);
    constraint.measurement.stereo = true;
    constraint.measurement.sigma_px = constraint.measurement.sigma_disparity_px =
        std::max(noise_px, 0.1);
    constraints.push_back(constraint);
  }
  return constraints;
}

Eigen::Matrix<double, 6, 1> errorOf(const Pose& estimate) {
  const Pose difference = truePose().inverse() * estimate;
  Eigen::Matrix<double, 6, 1> error;
  error << difference.translation(), logSo3(difference.linear());
  return error;
}

TEST(RefinePoseTest, IsExactWithoutNoise) {
  auto constraints = world(60, 0.0, 1);
  const auto refined = refinePose(Pose::Identity(), constraints, testCamera(), {1000.0, 12, 10});
  ASSERT_TRUE(refined);
  EXPECT_LT(errorOf(refined->T_map_cam).norm(), 1e-6);
  EXPECT_EQ(refined->inliers, 60);
}

TEST(RefinePoseTest, ErrorsAreAsLargeAsItsCovarianceSays) {
  // The normalised squared error is chi-square with 6 degrees of freedom: mean 6.
  double sum = 0.0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto constraints = world(80, 0.5, 100 + trial);
    const auto refined = refinePose(truePose(), constraints, testCamera(), {1.0, 3, 8});
    ASSERT_TRUE(refined);
    const auto error = errorOf(refined->T_map_cam);
    sum += error.dot(refined->covariance.ldlt().solve(error));
  }
  EXPECT_GT(sum / kTrials, 4.0);
  EXPECT_LT(sum / kTrials, 9.0);
}

TEST(RefinePoseTest, LeavesAThirdOfWrongLandmarksOut) {
  auto constraints = world(90, 0.3, 7);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> column(0.0, 640.0), row(0.0, 480.0);
  for (std::size_t i = 0; i < constraints.size(); i += 3) {
    constraints[i].measurement.uv << column(random), row(random);
  }
  const auto refined = refinePose(truePose(), constraints, testCamera(), {4.0, 3, 10});
  ASSERT_TRUE(refined);
  EXPECT_LT(errorOf(refined->T_map_cam).norm(), 0.02);
  int wrong = 0;
  for (std::size_t i = 0; i < constraints.size(); i += 3) wrong += constraints[i].inlier ? 1 : 0;
  EXPECT_LE(wrong, 1);
  EXPECT_GE(refined->inliers, 56);  // 60 are right, 1 in 100 of them lies beyond the gate
}

TEST(RefinePoseTest, KeepsTheTrackOfAWrongStereoMatch) {
  auto constraints = world(60, 0.2, 9);
  constraints[5].measurement.disparity += 30.0;
  const auto refined = refinePose(truePose(), constraints, testCamera(), {1.0, 3, 8});
  ASSERT_TRUE(refined);
  EXPECT_TRUE(constraints[5].inlier);
  EXPECT_FALSE(constraints[5].stereo_inlier);
}

TEST(RefinePoseTest, AJointLossDiscountsTheDisparitiesOfPointsThatMove) {
  // Near the optical axis only disparities tell how far the camera moved along it. Every third
  // point moves across the view by 8 sigmas and along it by 2.
  PosePrior prior{truePose(), PoseCovariance::Zero()};
  prior.information.diagonal() << 1e9, 1e9, 0.0, 1e9, 1e9, 1e9;
  const auto errorWith = [&](RobustLoss loss) {
    std::vector<PoseConstraint> constraints;
    for (PoseConstraint& constraint : world(6000, 0.0, 4)) {
      const Eigen::Vector2d off = constraint.measurement.uv - Eigen::Vector2d(320.0, 240.0);
      if (off.norm() > 30.0) continue;
      if (constraints.size() % 3 == 0) {
        constraint.measurement.uv.x() += 0.8;
        constraint.measurement.disparity += 0.2;
      }
      constraints.push_back(constraint);
    }
    const auto refined =
        refinePose(truePose(), constraints, testCamera(), {2.0, 1, 8, loss}, &prior);
    return refined ? errorOf(refined->T_map_cam).norm() : 1e9;
  };
  EXPECT_LT(errorWith(RobustLoss::kJoint), 0.3 * errorWith(RobustLoss::kSeparate));
}

TEST(RefinePoseTest, SaysNothingWhereThereIsTooLittle) {
  std::vector<PoseConstraint> none;
  EXPECT_FALSE(refinePose(Pose::Identity(), none, testCamera(), {}));
  auto three = world(3, 0.0, 1);
  EXPECT_FALSE(refinePose(truePose(), three, testCamera(), {}));
}

TEST(RefinePoseTest, SaysNothingOfPointsBehindTheCamera) {
  auto constraints = world(40, 0.0, 1);
  Pose turned = truePose();
  turned.linear() = turned.linear() * expSo3({0.0, M_PI, 0.0});
  EXPECT_FALSE(refinePose(turned, constraints, testCamera(), {}));
}

TEST(RefinePoseTest, APriorHoldsThePoseWhereNothingIsMeasured) {
  std::vector<PoseConstraint> none;
  PosePrior prior{truePose(), PoseCovariance::Identity()};
  const auto refined = refinePose(Pose::Identity(), none, testCamera(), {1.0, 3, 20}, &prior);
  ASSERT_TRUE(refined);
  EXPECT_LT(errorOf(refined->T_map_cam).norm(), 1e-6);
  EXPECT_TRUE(refined->covariance.isApprox(PoseCovariance::Identity(), 1e-6));
}

TEST(RefinePoseTest, APriorAndMeasurementsAreWeighedByTheirInformation) {
  auto constraints = world(80, 0.0, 2);
  PosePrior wrong{Pose::Identity(), 1e-3 * PoseCovariance::Identity()};
  const auto free = refinePose(truePose(), constraints, testCamera(), {1.0, 3, 20}, &wrong);
  ASSERT_TRUE(free);
  EXPECT_LT(errorOf(free->T_map_cam).norm(), 1e-3);
  wrong.information *= 1e15;
  const auto held = refinePose(Pose::Identity(), constraints, testCamera(), {100.0, 1, 20}, &wrong);
  ASSERT_TRUE(held);
  EXPECT_TRUE(held->T_map_cam.isApprox(Pose::Identity(), 1e-4));
}

}  // namespace
}  // namespace headway::stereo
