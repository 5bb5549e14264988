// SPDX-License-Identifier: BSD-3-Clause
#include "visual_odometry.h"

#include <gtest/gtest.h>
#include <headway/core/statistics.h>
#include <headway_test/textured_world.h>

#include <utility>

namespace headway::slam {
namespace {

/// A drive along a wide corridor past partitions, looking ahead.
class VisualOdometryTest : public testing::Test {
 protected:
  static constexpr double kStep_m = 0.1;

  VisualOdometryTest() : VisualOdometryTest(0.0) {}
  /// @param offset_px  measured less true disparity
  explicit VisualOdometryTest(double offset_px)
      : world_(corridor(0.0)), shifted_(corridor(-offset_px)) {
    params_.features = 300;
  }

  /// @param shift_px  of the principal point
  static test::TexturedWorld corridor(double shift_px) {
    StereoCamera camera = test::smallCamera();
    camera.cx += shift_px;
    test::TexturedWorld world(camera);
    world.addRoom(40.0, 12.0, 7.0);
    using V = Eigen::Vector3d;
    for (int i = 0; i < 10; ++i) {
      const double side = i % 2 == 0 ? 1.6 : -1.6;
      world.boards.push_back(
          {V(4.0 * i - 18.0, side, -1.5), V::UnitX(), V::UnitZ(), 2.0, 2.5, {1.3 * i, 0.7 * i}});
    }
    return world;
  }

  static Pose onWay(int i) {
    Pose pose = Pose::Identity();
    pose.translation() << kStep_m * i - 18.0, 0.3 * std::sin(0.1 * i), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.05 * std::sin(0.1 * i)});
    return pose;
  }

  /// The camera's true motion to a place from the one before.
  [[nodiscard]] static Pose trueStep(int i) {
    const Pose T_robot_cam = test::smallCamera().T_robot_cam;
    return (onWay(i - 1) * T_robot_cam).inverse() * (onWay(i) * T_robot_cam);
  }

  [[nodiscard]] TrackingFrame at(int i) const {
    StereoFrame frame = world_.frame(static_cast<std::size_t>(i), 0.1 * i, onWay(i));
    frame.right = shifted_.frame(0, 0.0, onWay(i)).right;
    return makeTrackingFrame(frame, {}, *world_.camera(), params_);
  }

  test::TexturedWorld world_;
  test::TexturedWorld shifted_;  ///< that the right camera sees
  SlamParams params_;
};

/// A whole frame, as SLAM does it.
std::optional<Pose> advanced(VisualOdometry& odometry, const TrackingFrame& frame,
                             const Pose& predicted, const Pose& tracked) {
  (void)odometry.propose(frame, predicted);
  return odometry.advance(frame, tracked);
}

TEST_F(VisualOdometryTest, StepsAreWithinMillimetresOfTheTruth) {
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(at(0));
  Pose last = Pose::Identity();
  for (int i = 1; i < 30; ++i) {
    const auto step = advanced(odometry, at(i), last, trueStep(i));
    ASSERT_TRUE(step) << i;
    const Pose error = trueStep(i).inverse() * *step;
    EXPECT_LT(error.translation().norm(), 0.004) << i;
    EXPECT_LT(logSo3(error.linear()).norm(), 0.001) << i;
    last = *step;
  }
}

/// The corners of a frame share its errors, which bounds how exactly an offset can be known.
constexpr double kOffsetError_px = 0.15;
constexpr double kScaleError = 0.01;

TEST_F(VisualOdometryTest, RectifiedImagesHaveNoOffset) {
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(at(0));
  double way = 0.0, true_way = 0.0;
  Pose last = trueStep(1);
  for (int i = 1; i < 120; ++i) {
    const auto step = advanced(odometry, at(i), last, trueStep(i));
    ASSERT_TRUE(step) << i;
    last = *step;
    way += step->translation().norm();
    true_way += trueStep(i).translation().norm();
    EXPECT_NEAR(odometry.disparityOffset(), 0.0, kOffsetError_px) << i;
  }
  EXPECT_NEAR(way, true_way, kScaleError * true_way);
}

TEST_F(VisualOdometryTest, GoesOnAfterARestartWithoutTheMotionInBetween) {
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(at(0));
  ASSERT_TRUE(advanced(odometry, at(1), trueStep(1), trueStep(1)));
  odometry.restart(at(100));
  const auto step = advanced(odometry, at(101), trueStep(101), trueStep(101));
  ASSERT_TRUE(step);
  EXPECT_LT((trueStep(101).inverse() * *step).translation().norm(), 0.004);
}

TEST_F(VisualOdometryTest, SaysWhereNothingCanBeFollowed) {
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(at(0));
  StereoFrame blank = world_.frame(1, 0.1, onWay(1));
  blank.left = blank.right = cv::Mat(blank.left.size(), CV_8U, cv::Scalar(9));
  const auto dark = makeTrackingFrame(blank, {}, *world_.camera(), params_);
  EXPECT_FALSE(advanced(odometry, dark, trueStep(1), trueStep(1)));
  EXPECT_FALSE(advanced(odometry, at(2), trueStep(2), trueStep(2)))
      << "there were no corners before";
  EXPECT_TRUE(advanced(odometry, at(3), trueStep(3), trueStep(3)));
}

/// A bus that fills most of the view and drives beside the robot, as fast as it.
TEST_F(VisualOdometryTest, WhereMostCornersMoveOtherwiseTheTrackedMotionDecides) {
  const auto seen = [&](int i) {
    test::TexturedWorld world = corridor(0.0);
    const Eigen::Vector3d before = onWay(i).translation() + Eigen::Vector3d(3.0, 0.0, 0.0);
    using V = Eigen::Vector3d;
    world.boards.push_back({before + V(0.0, -1.1, -1.2), V::UnitY(), V::UnitZ(), 2.9, 2.4, {0.0, 0.0}});
    Pose pose = onWay(i);
    pose.linear().setIdentity();
    return makeTrackingFrame(world.frame(0, 0.1 * i, pose), {}, *world.camera(), params_);
  };
  Pose step = Pose::Identity();
  step.translation() =
      test::smallCamera().T_robot_cam.linear().transpose() * Eigen::Vector3d(kStep_m, 0.0, 0.0);
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(seen(0));
  for (int i = 1; i < 6; ++i) {
    Pose truth = step;
    truth.translation() = test::smallCamera().T_robot_cam.linear().transpose() *
                          (onWay(i).translation() - onWay(i - 1).translation());
    const auto moved = advanced(odometry, seen(i), Pose::Identity(), truth);
    ASSERT_TRUE(moved) << i;
    EXPECT_LT((moved->translation() - truth.translation()).norm(), 0.02) << i;
  }
}

class ShiftedVisualOdometryTest : public VisualOdometryTest {
 protected:
  static constexpr double kOffset_px = 0.3;
  ShiftedVisualOdometryTest() : VisualOdometryTest(kOffset_px) {}
};

TEST_F(ShiftedVisualOdometryTest, TheOffsetOfTheDisparitiesIsEstimatedOnTheWay) {
  VisualOdometry odometry(*world_.camera(), params_);
  odometry.restart(at(0));
  std::vector<double> early, late;  // relative errors of the steps' lengths
  for (int i = 1; i < 120; ++i) {
    const auto step = advanced(odometry, at(i), trueStep(i), trueStep(i));
    ASSERT_TRUE(step) << i;
    const double error = step->translation().norm() / trueStep(i).translation().norm() - 1.0;
    if (i <= 5) early.push_back(error);
    if (i > 100) late.push_back(error);
  }
  EXPECT_NEAR(odometry.disparityOffset(), kOffset_px, kOffsetError_px);
  EXPECT_LT(median(early), -0.01) << "without its knowledge all is nearer";
  EXPECT_LT(std::abs(median(late)), kScaleError);
}

}  // namespace
}  // namespace headway::slam
