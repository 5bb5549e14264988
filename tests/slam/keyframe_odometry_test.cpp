// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "bundle_adjustment.h"
#include "test_camera.h"
#include "wheel_odometry.h"

namespace headway::slam {
namespace {

Pose stepOf(double forward_m, double yaw_rad) {
  Pose step = Pose::Identity();
  step.translation().x() = forward_m;
  step.linear() = expSo3({0.0, 0.0, yaw_rad});
  return step;
}

MotionPrior moved(double forward_m, double yaw_rad) {
  MotionPrior prior;
  prior.T_previous_current = stepOf(forward_m, yaw_rad);
  return prior;
}

TEST(KeyframeOdometryTest, SumsUpMotionsSinceTheKeyframe) {
  KeyframeOdometry odometry(true);
  odometry.add(moved(1.0, 0.0));
  EXPECT_FALSE(odometry.link());
  odometry.restartAt(KeyframeId{3});
  odometry.add(moved(1.0, 0.2));
  odometry.add(moved(2.0, -0.1));
  ASSERT_TRUE(odometry.link());
  EXPECT_EQ(odometry.link()->from, KeyframeId{3});
  EXPECT_TRUE(odometry.link()->T_from_this.isApprox(stepOf(1.0, 0.2) * stepOf(2.0, -0.1)));
  EXPECT_NEAR(odometry.link()->path_m, 3.0, 1e-12);
  EXPECT_NEAR(odometry.link()->turn_rad, 0.3, 1e-12);
}

TEST(KeyframeOdometryTest, KnowsNoLinkOverAnUnknownMotionOrWhereItIsNotUsed) {
  KeyframeOdometry odometry(true);
  odometry.restartAt(KeyframeId{3});
  odometry.add({});
  odometry.add(moved(1.0, 0.0));
  EXPECT_FALSE(odometry.link());
  odometry.restartAt(KeyframeId{4});
  EXPECT_TRUE(odometry.link());
  KeyframeOdometry unused(false);
  unused.restartAt(KeyframeId{3});
  unused.add(moved(1.0, 0.0));
  EXPECT_FALSE(unused.link());
}

TEST(KeyframeOdometryTest, IsLessCertainOnLongerPathsAndOffThePlane) {
  const auto near = sigmaOf({{}, stepOf(1.0, 0.0), 1.0, 0.0});
  const auto far = sigmaOf({{}, stepOf(5.0, 0.5), 5.0, 0.5});
  for (const int axis : {0, 1, 2, 5}) EXPECT_GT(far[axis], near[axis]) << axis;
  EXPECT_GT(near[2], 2.0 * near[0]);
  EXPECT_GT(near[3], 2.0 * near[5]);
}

TEST(KeyframeOdometryTest, IsBridgedWhereAKeyframeIsRemoved) {
  SparseMap map;
  std::vector<KeyframeId> ids;
  for (int i = 0; i < 3; ++i) {
    Keyframe& keyframe = map.addKeyframe(0, 0.1 * i, Pose::Identity());
    if (i > 0) keyframe.odometry = OdometryLink{ids.back(), stepOf(1.0, 0.1), 1.0, 0.1};
    ids.push_back(keyframe.id);
  }
  map.removeKeyframe(ids[1]);
  const auto& bridged = map.keyframe(ids[2]).odometry;
  ASSERT_TRUE(bridged);
  EXPECT_EQ(bridged->from, ids[0]);
  EXPECT_TRUE(bridged->T_from_this.isApprox(stepOf(1.0, 0.1) * stepOf(1.0, 0.1)));
  EXPECT_NEAR(bridged->path_m, 2.0, 1e-12);
  map.removeKeyframe(ids[0]);
  EXPECT_FALSE(map.keyframe(ids[2]).odometry);
}

/// Error of the last of six keyframes, which sees few landmarks badly [m].
double errorWithPoorVision(const std::optional<OdometryLink>& odometry) {
  StereoCamera camera = testCamera();
  camera.T_robot_cam.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  SparseMap map;
  std::vector<KeyframeId> ids;
  std::vector<Pose> poses;
  for (int i = 0; i < 6; ++i) {
    Pose T_map_cam = Pose::Identity();
    T_map_cam.translation().z() = i;
    poses.push_back(T_map_cam);
    ids.push_back(map.addKeyframe(0, 0.1 * i, T_map_cam).id);
  }
  std::mt19937 random(2);
  std::uniform_real_distribution<double> x(-8.0, 8.0), y(-4.0, 2.0), z(15.0, 30.0);
  std::normal_distribution<double> noise(0.0, 4.0);
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d point(x(random), y(random), z(random));
    LandmarkId id;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const bool poor = i == 5;
      if (poor && n >= 8) continue;
      const Eigen::Vector3d uvd = project(poses[i].inverse() * point, camera).value();
      stereo::StereoMeasurement measurement{uvd.head<2>(), uvd.z(), true, 0.1, 0.1};
      if (poor) {
        measurement.uv += Eigen::Vector2d(noise(random), noise(random));
        measurement.disparity += noise(random);
        measurement.sigma_px = measurement.sigma_disparity_px = 4.0;
      }
      if (i == 0) id = map.addLandmark(point, ids[i], measurement).id;
      if (i > 0) map.observe(ids[i], id, measurement);
    }
  }
  map.keyframeToChange(ids[5]).odometry = odometry;
  static_cast<void>(adjustBundle(map, ids, camera, 30));
  return (map.keyframe(ids[5]).T_map_cam.translation() - poses[5].translation()).norm();
}

TEST(KeyframeOdometryTest, PlacesAKeyframeThatSeesLittle) {
  const double without = errorWithPoorVision(std::nullopt);
  const double with = errorWithPoorVision(OdometryLink{KeyframeId{4}, stepOf(1.0, 0.0), 1.0, 0.0});
  EXPECT_GT(without, 0.1);
  EXPECT_LT(with, 0.5 * without);
}

TEST(KeyframeOdometryTest, DoesNotPullWhereTheWheelsSlip) {
  const double without = errorWithPoorVision(std::nullopt);
  const double slipping =
      errorWithPoorVision(OdometryLink{KeyframeId{4}, stepOf(6.0, 0.0), 6.0, 0.0});
  EXPECT_LT(slipping, 1.2 * without);
}

}  // namespace
}  // namespace headway::slam
