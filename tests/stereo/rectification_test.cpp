// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/pose.h>
#include <headway/stereo/rectification.h>

#include <random>

namespace headway::stereo {
namespace {

constexpr double kDegree = M_PI / 180.0;

StereoCamera camera() {
  StereoCamera camera;
  camera.width = 1241;
  camera.height = 376;
  camera.fx = camera.fy = 718.0;
  camera.cx = 607.0;
  camera.cy = 185.0;
  camera.baseline_m = 0.54;
  return camera;
}

/// Matches of points in space, seen by a right camera that is turned by `angles`.
std::vector<RowMatch> matches(const Eigen::Vector3d& angles, int count, std::mt19937& random) {
  const StereoCamera rig = camera();
  std::uniform_real_distribution<double> u(60.0, 1180.0), v(20.0, 356.0), wrong(-8.0, 8.0);
  std::uniform_real_distribution<double> depth(4.0, 60.0);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::vector<RowMatch> result;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d left(u(random), v(random));
    const Eigen::Vector3d point = depth(random) * ray(left, rig);
    const Eigen::Vector3d seen =
        expSo3(angles).transpose() * (point - Eigen::Vector3d(rig.baseline_m, 0.0, 0.0));
    RowMatch match;
    match.right = {rig.fx * seen.x() / seen.z() + rig.cx, rig.fy * seen.y() / seen.z() + rig.cy};
    match.rows = match.right.y() - left.y() + noise(random);
    if (i % 10 == 0) match.rows = wrong(random);
    result.push_back(match);
  }
  return result;
}

RectificationError estimated(const Eigen::Vector3d& angles, int frames = 50, int seed = 1) {
  std::mt19937 random(static_cast<unsigned>(seed));
  RectificationEstimator estimator(camera());
  for (int k = 0; k < frames; ++k) estimator.add(matches(angles, 60, random));
  return estimator.error().value();
}

TEST(RectificationTest, EstimatesEachAxisWithItsUncertainty) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double degrees : {-0.3, 0.1, 0.3}) {
      Eigen::Vector3d angles = Eigen::Vector3d::Zero();
      angles[axis] = degrees * kDegree;
      const auto error = estimated(angles);
      for (int other = 0; other < 3; ++other) {
        EXPECT_NEAR(angles[other], error.angles[other], 4.0 * error.sigmas[other] + 1e-5)
            << "axis " << axis << ", " << degrees << " degrees, of axis " << other;
      }
      const auto found = significantAngles(error, camera());
      const bool is_shown = axis != 1;  // lens distortion causes the same
      EXPECT_EQ(is_shown, found[axis] != 0.0) << axis << ": " << degrees;
    }
  }
}

TEST(RectificationTest, NothingIsSignificantOfAnExactRig) {
  for (int seed = 1; seed <= 10; ++seed) {
    const auto error = estimated(Eigen::Vector3d::Zero(), 50, seed);
    EXPECT_TRUE(significantAngles(error, camera()).isZero()) << seed;
    EXPECT_LT(std::abs(error.offset_px), 4.0 * error.offset_sigma_px + 0.01) << seed;
    EXPECT_LT(error.offset_sigma_px, 0.05);
  }
}

TEST(RectificationTest, TheOffsetHasASign) {
  EXPECT_NEAR(718.0 * 0.1 * kDegree, estimated({0.1 * kDegree, 0.0, 0.0}).offset_px, 0.05);
  EXPECT_NEAR(-718.0 * 0.1 * kDegree, estimated({-0.1 * kDegree, 0.0, 0.0}).offset_px, 0.05);
}

TEST(RectificationTest, AFewMatchesTellNothing) {
  RectificationEstimator estimator(camera());
  EXPECT_FALSE(estimator.error());
  std::mt19937 random(1);
  estimator.add(matches(Eigen::Vector3d::Zero(), 60, random));
  EXPECT_FALSE(estimator.error());
  estimator.add({});
  EXPECT_FALSE(estimator.error());
}

TEST(RectificationTest, NamesTheAxesThatAreOff) {
  const auto rolled = describe(estimated({0.0, 0.0, 0.3 * kDegree}), camera());
  EXPECT_NE(std::string::npos, rolled.find("roll 0.30")) << rolled;
  EXPECT_NE(std::string::npos, rolled.find(": roll of the right camera")) << rolled;
  const auto exact = describe(estimated(Eigen::Vector3d::Zero()), camera());
  EXPECT_NE(std::string::npos, exact.find("not significant")) << exact;
}

}  // namespace
}  // namespace headway::stereo
