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
  for (int k = 0; k < frames; ++k) estimator.add(matches(angles, 60, random), 0.5 * k);
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
  estimator.add(matches(Eigen::Vector3d::Zero(), 60, random), 0.0);
  EXPECT_FALSE(estimator.error());
  estimator.add({}, 1.0);
  EXPECT_FALSE(estimator.error());
}

/// The estimate after so many frames of each turn, half a second apart.
RectificationEstimator follow(const std::vector<std::pair<Eigen::Vector3d, int>>& turns) {
  std::mt19937 random(7);
  RectificationEstimator estimator(camera());
  double time = 0.0;
  for (const auto& [angles, frames] : turns) {
    for (int k = 0; k < frames; ++k) estimator.add(matches(angles, 60, random), time += 0.5);
  }
  return estimator;
}

TEST(RectificationTest, AKnockAtTheCameraStartsItAnewAfterThreeFrames) {
  const Eigen::Vector3d before(0.05 * kDegree, 0.0, 0.0), after(-0.3 * kDegree, 0.0, 0.2 * kDegree);
  const auto two = follow({{before, 50}, {after, 2}});
  EXPECT_FALSE(two.hasMoved());
  EXPECT_NEAR(two.error()->angles.x(), before.x(), 4.0 * two.error()->sigmas.x());
  const auto four = follow({{before, 50}, {after, 4}});
  EXPECT_TRUE(four.hasMoved());
  for (const int axis : {0, 2}) {
    EXPECT_NEAR(four.error()->angles[axis], after[axis], 4.0 * four.error()->sigmas[axis]);
  }
  EXPECT_GT(four.error()->sigmas.x(), 1.5 * two.error()->sigmas.x());
}

TEST(RectificationTest, FramesThatContradictEachOtherAreLeftOut) {
  const Eigen::Vector3d turn(0.1 * kDegree, 0.0, 0.0);
  std::vector<std::pair<Eigen::Vector3d, int>> turns = {{turn, 50}};
  for (int i = 0; i < 6; ++i) turns.push_back({{(i % 2 ? -0.4 : 0.4) * kDegree, 0.0, 0.0}, 1});
  const auto estimator = follow(turns);
  EXPECT_FALSE(estimator.hasMoved());
  EXPECT_NEAR(estimator.error()->angles.x(), turn.x(), 4.0 * estimator.error()->sigmas.x());
}

TEST(RectificationTest, FollowsAMountingThatWarmsUp) {
  std::mt19937 random(3);
  RectificationEstimator estimator(camera());
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  for (int k = 0; k < 1200; ++k) {  // ten minutes
    angles.x() = 0.02 * kDegree * k / 1200.0;
    estimator.add(matches(angles, 60, random), 0.5 * k);
  }
  EXPECT_FALSE(estimator.hasMoved());
  EXPECT_NEAR(estimator.error()->angles.x(), angles.x(), 0.004 * kDegree);
}

TEST(RectificationTest, TheUncertaintyGrowsWithoutImages) {
  auto estimator = follow({{Eigen::Vector3d::Zero(), 50}});
  const double before = estimator.error()->sigmas.x();
  estimator.add({}, 25.0 + 60.0);
  const double minute = 0.005 * kDegree;
  EXPECT_NEAR(estimator.error()->sigmas.x(), std::hypot(before, minute), 0.02 * minute);
}

TEST(RectificationTest, StartsWithWhatAnEarlierRunFound) {
  const Eigen::Vector3d known(0.2 * kDegree, 0.0, -0.1 * kDegree);
  RectificationEstimator estimator(camera(), known);
  EXPECT_NEAR(estimator.error()->angles.x(), known.x(), 0.01 * kDegree);
  EXPECT_NEAR(estimator.error()->angles.z(), known.z(), 0.01 * kDegree);
  std::mt19937 random(1);
  for (int k = 0; k < 10; ++k) estimator.add(matches(Eigen::Vector3d::Zero(), 60, random), 0.5 * k);
  EXPECT_NEAR(estimator.error()->angles.x(), 0.0, 4.0 * estimator.error()->sigmas.x())
      << "the images decide";
}

TEST(RectificationTest, ADegreeIsRefusedWithItsAxis) {
  for (const auto& [axis, name] : {std::pair(0, "pitch"), std::pair(2, "roll")}) {
    for (const double degrees : {-1.0, 1.0}) {
      Eigen::Vector3d angles = Eigen::Vector3d::Zero();
      angles[axis] = degrees * kDegree;
      const auto error = estimated(angles, 5);
      const auto excess = excessiveTurn(error, camera());
      ASSERT_TRUE(excess) << name;
      EXPECT_NE(std::string::npos, excess->find(std::string(" degrees in ") + name)) << *excess;
      EXPECT_TRUE(correctionFor(error, Eigen::Vector3d::Zero(), camera()).isZero());
      angles[axis] = 0.3 * degrees * kDegree;
      EXPECT_FALSE(excessiveTurn(estimated(angles, 5), camera())) << name;
    }
  }
  auto error = estimated(Eigen::Vector3d::Zero());
  error.disparities = OffsetEstimate{718.0 * kDegree * 1.25, 0.3};
  const auto excess = excessiveTurn(error, camera());
  ASSERT_TRUE(excess);
  EXPECT_NE(std::string::npos, excess->find("degrees in yaw")) << *excess;
}

TEST(RectificationTest, TheCorrectionFollowsVisibleChangesOnly) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_TRUE(correctionFor(estimated(none), none, camera()).isZero());
  const auto error = estimated({0.1 * kDegree, 0.0, 0.0});
  const Eigen::Vector3d turn = correctionFor(error, none, camera());
  EXPECT_DOUBLE_EQ(turn.x(), error.angles.x());
  EXPECT_DOUBLE_EQ(turn.z(), error.angles.z()) << "once one is significant, both are undone";
  EXPECT_EQ(turn.y(), 0.0) << "rows do not tell yaw";
  auto later = error;
  later.angles.x() += 0.05 / 718.0;
  EXPECT_EQ(correctionFor(later, turn, camera()), turn);
  later.angles.x() += 0.2 / 718.0;
  EXPECT_EQ(correctionFor(later, turn, camera()).x(), later.angles.x());
}

TEST(RectificationTest, YawIsCorrectedByTheDisparities) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  auto error = estimated(none);
  const double offset_px = 1.0 / yawOfOffset(1.0, camera()) * 0.1 * kDegree;
  EXPECT_NEAR(offset_px, 718.0 * 0.1 * kDegree * (1.0 + std::pow(1241.0 / 718.0, 2) / 12.0), 1e-9);
  error.disparities = OffsetEstimate{offset_px, 0.1};
  const Eigen::Vector3d turn = correctionFor(error, none, camera());
  EXPECT_NEAR(turn.y(), 0.1 * kDegree, 1e-9);
  EXPECT_EQ(correctionFor(error, turn, camera()), turn);
  error.disparities->sigma_px = 0.5;
  EXPECT_TRUE(correctionFor(error, none, camera()).isZero()) << "not significant";
  error.disparities = OffsetEstimate{0.2, 0.01};
  EXPECT_TRUE(correctionFor(error, none, camera()).isZero()) << "left to the bundle adjustment";
}

TEST(RectificationTest, NamesTheAxesThatAreOff) {
  const auto rolled = describe(estimated({0.0, 0.0, 0.3 * kDegree}), camera());
  EXPECT_NE(std::string::npos, rolled.find("roll 0.30")) << rolled;
  EXPECT_NE(std::string::npos, rolled.find(": roll of the right camera; calibrate the cameras"))
      << rolled;
  EXPECT_NE(std::string::npos, rolled.find(", not corrected (")) << rolled;
  const Eigen::Vector3d pitch(0.1 * kDegree, 0.0, 0.0);
  const auto corrected = describe(estimated(pitch), camera(), pitch);
  EXPECT_EQ(0U, corrected.find("rectification off by 1.")) << corrected;
  EXPECT_NE(std::string::npos, corrected.find(" px, corrected (vertical offset +1.")) << corrected;
  EXPECT_NE(std::string::npos, corrected.find(": pitch of the right camera")) << corrected;
  EXPECT_EQ(std::string::npos, corrected.find("calibrate")) << "nothing is left to be calibrated";
  const auto half = describe(estimated(pitch), camera(), 0.5 * pitch);
  EXPECT_NE(std::string::npos, half.find("pitch of the right camera; calibrate the cameras"))
      << half;
  const auto exact = describe(estimated(Eigen::Vector3d::Zero()), camera());
  EXPECT_NE(std::string::npos, exact.find("not significant")) << exact;
}

}  // namespace
}  // namespace headway::stereo
