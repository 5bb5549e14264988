// SPDX-License-Identifier: BSD-3-Clause
// The odometry frame never jumps, whatever moves the map.
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

#include <chrono>
#include <functional>
#include <set>
#include <thread>

namespace headway::slam {
namespace {

constexpr double kMaxExtra_m = 0.002;                  ///< of a step of odometry
constexpr double kMaxTurnError = 0.02 * M_PI / 180.0;  ///< [rad]

/// A camera that is carried through a room at 0.5 m/s.
class OdometryFrameTest : public testing::Test {
 protected:
  OdometryFrameTest() : world_(test::smallCamera()) {
    world_.addRoom(12.0, 8.0, 4.0);
    params_.features = 250;
  }

  /// @param time  since the beginning [s]
  static Pose onPath(Time time) {
    const double way = 10.0 * time;
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * way, 0.3 * std::sin(0.05 * way), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.2 * std::sin(0.04 * way)});
    return pose;
  }

  [[nodiscard]] StereoFrame frameAt(Time time) const { return world_.frame(0, time, onPath(time)); }

  StereoSlam& slam() {
    if (slam_ == nullptr) slam_ = std::make_unique<StereoSlam>(world_.camera(), params_);
    return *slam_;
  }

  /// Processes the next frame, in which the law of both frames holds.
  const SlamUpdate& process(Time time, StereoFrame frame) {
    frame.index = updates_.size();
    frame.time = time;
    const SlamUpdate update = slam().process(frame, {});
    EXPECT_TRUE((update.T_map_odom * update.T_odom_robot).isApprox(update.T_map_robot, 1e-9));
    const MapRevision before = updates_.empty() ? MapRevision{} : updates_.back().revision;
    EXPECT_GE(update.revision.number, before.number);
    if (update.revision.number == before.number) {
      EXPECT_EQ(update.revision.cause, before.cause) << "nothing has changed";
    }
    causes_.insert(update.revision.cause);
    updates_.push_back(update);
    return updates_.back();
  }

  void walk(int first, int end) {
    for (int i = first; i < end; ++i) process(0.1 * i, frameAt(0.1 * i));
  }

  /// Forgets the run, to begin another one.
  std::vector<SlamUpdate> take() {
    slam_.reset();
    causes_.clear();
    return std::exchange(updates_, {});
  }

  [[nodiscard]] static Pose step(const std::vector<SlamUpdate>& updates, std::size_t i) {
    return updates.at(i - 1).T_odom_robot.inverse() * updates.at(i).T_odom_robot;
  }

  /// No step of the odometry is longer than the robot's.
  void expectNoJump() const {
    for (std::size_t i = 1; i < updates_.size(); ++i) {
      const Pose truth =
          onPath(0.1 * static_cast<double>(i - 1)).inverse() * onPath(0.1 * static_cast<double>(i));
      EXPECT_LT(step(updates_, i).translation().norm(), truth.translation().norm() + kMaxExtra_m)
          << i;
    }
  }

  static void expectSameBytes(const std::vector<SlamUpdate>& a, const std::vector<SlamUpdate>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].T_odom_robot.matrix(), b[i].T_odom_robot.matrix()) << i;
    }
  }

  test::TexturedWorld world_;
  SlamParams params_;
  std::vector<SlamUpdate> updates_;
  std::set<MapChange> causes_;

 private:
  std::unique_ptr<StereoSlam> slam_;
};

TEST_F(OdometryFrameTest, FollowsTheRobotWithTheMap) {
  walk(0, 20);
  EXPECT_EQ(updates_.front().revision.number, 0U);
  EXPECT_EQ(updates_.front().revision.cause, MapChange::kStart);
  EXPECT_TRUE(updates_.front().T_map_odom.isApprox(Pose::Identity(), 1e-12));
  EXPECT_EQ(causes_.count(MapChange::kBundleAdjustment), 1U) << "of the keyframes";
  EXPECT_LT((updates_.back().T_odom_robot.translation() - onPath(1.9).translation()).norm(), 0.03);
  expectNoJump();
}

TEST_F(OdometryFrameTest, LevellingTurnsTheMapAlone) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.05, -0.1, 1.0).normalized();
  const auto run = [&](bool with_accelerometer) {
    const auto velocityAt = [](double t) {
      return Eigen::Vector3d(5.0 * (onPath(t + 0.1).translation() - onPath(t - 0.1).translation()));
    };
    for (int i = 0; i < 16; ++i) {
      const double t = 0.1 * i;
      StereoFrame frame = frameAt(t);
      frame.motion_prior.specific_force = 9.80665 * up;
      const Pose T_previous_first = onPath(t - 0.1).inverse();
      frame.motion_prior.R_previous_current = (T_previous_first * onPath(t)).linear();
      const Eigen::Vector3d increment = velocityAt(t) - velocityAt(t - 0.1) + 0.1 * 9.80665 * up;
      if (with_accelerometer) {
        frame.motion_prior.velocity_increment = T_previous_first.linear() * increment;
      }
      process(t, frame);
    }
  };
  run(true);
  EXPECT_EQ(causes_.count(MapChange::kGravity), 1U);
  EXPECT_GT(logSo3(updates_.back().T_map_odom.linear()).norm(), 0.08);
  const auto levelled = take();
  run(false);
  EXPECT_EQ(causes_.count(MapChange::kGravity), 0U);
  expectSameBytes(levelled, updates_);
}

TEST_F(OdometryFrameTest, ATurnedRightCameraChangesTheMapAlone) {
  const Eigen::Vector3d turn(0.0, 0.1 * M_PI / 180.0, 0.0);
  for (const double sign : {1.0, -1.0}) {
    world_.right_turn = sign * turn;
    walk(0, 20);
    slam().turnRightCamera(sign * turn, true);
    world_.right_turn.setZero();  // as if turned back
    walk(20, 40);
    EXPECT_EQ(causes_.count(MapChange::kRightCamera), 1U);
    // 0.4 px of 10: until then, steps are by about 4 % too long or too short.
    for (std::size_t i = 1; i < updates_.size(); ++i) {
      const double way = (onPath(0.1 * static_cast<double>(i)).translation() -
                          onPath(0.1 * static_cast<double>(i - 1)).translation())
                             .norm();
      const double error = step(updates_, i).translation().norm() - way;
      EXPECT_LT(error, i < 20 ? 0.1 * way : kMaxExtra_m) << i;
    }
    (void)take();
  }
}

TEST_F(OdometryFrameTest, MapsThatAreJoinedMoveTheMapAlone) {
  walk(0, 24);
  const auto alone = take();
  walk(0, 12);
  Pose move = Pose::Identity();
  move.translation() << 3.0, -5.0, 0.2;
  move.linear() = expSo3({0.0, 0.0, 1.0});
  KeyframePoses poses;
  const Pose T_robot_cam = world_.camera()->T_robot_cam;
  for (const KeyframeView& keyframe : slam().map().keyframes) {
    poses[keyframe.id] = move * keyframe.T_map_robot * T_robot_cam;
  }
  const Pose before = updates_.back().T_map_odom;
  const std::uint64_t revision = updates_.back().revision.number;
  slam().correct(poses);
  walk(12, 24);
  EXPECT_GT(updates_[12].revision.number, revision);
  EXPECT_EQ(causes_.count(MapChange::kMapsJoined), 1U);
  EXPECT_TRUE((move * before).isApprox(updates_[12].T_map_odom, 0.01));
  for (std::size_t i = 1; i < alone.size(); ++i) {
    const Pose difference = step(alone, i).inverse() * step(updates_, i);
    EXPECT_LT(difference.translation().norm(), kMaxExtra_m) << i;
    EXPECT_LT(logSo3(difference.linear()).norm(), kMaxTurnError) << i;
  }
}

TEST_F(OdometryFrameTest, RelocalisationMovesTheMapAlone) {
  walk(0, 15);
  for (int i = 15; i < 35; ++i) process(0.1 * i, world_.covered());
  walk(35, 40);
  EXPECT_EQ(updates_.back().status, TrackingStatus::kTracked);
  EXPECT_EQ(updates_[35].revision.cause, MapChange::kRelocalised);
  EXPECT_LT((updates_[35].T_map_robot.translation() - onPath(3.5).translation()).norm(), 0.03);
  const double unseen = (onPath(3.5).translation() - onPath(1.4).translation()).norm();
  const Pose jump = updates_[34].T_map_odom.inverse() * updates_[35].T_map_odom;
  EXPECT_GT(jump.translation().norm(), 0.5 * unseen) << "the map's frame takes the correction";
  expectNoJump();
}

TEST_F(OdometryFrameTest, LateAdjustmentsMoveTheMapAlone) {
  params_.keyframe_flow_ratio = 0.02;  // many keyframes, so many adjustments
  walk(0, 30);
  const auto at_once = take();
  params_.adjust_in_background = true;
  for (int i = 0; i < 30; ++i) {
    process(0.1 * i, frameAt(0.1 * i));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(causes_.count(MapChange::kBundleAdjustment), 1U);
  expectSameBytes(at_once, updates_);
}

TEST_F(OdometryFrameTest, OfALostCameraItSlowsDownToAStopWithinASecond) {
  walk(0, 15);
  for (int i = 15; i < 40; ++i) process(0.1 * i, world_.covered());
  EXPECT_GT(step(updates_, 15).translation().norm(), 0.03) << "it moves on at first";
  for (std::size_t i = 16; i < 40; ++i) {
    EXPECT_LE(step(updates_, i).translation().norm(), step(updates_, i - 1).translation().norm());
    if (i <= 24) continue;
    EXPECT_EQ(updates_[i].T_odom_robot.translation(), updates_[24].T_odom_robot.translation()) << i;
    EXPECT_EQ(updates_[i].T_map_robot.translation(), updates_[24].T_map_robot.translation()) << i;
  }
}

TEST_F(OdometryFrameTest, OfALostCameraItGoesOnByTheWheels) {
  walk(0, 15);
  for (int i = 15; i < 60; ++i) {
    StereoFrame frame = world_.covered();
    frame.motion_prior.T_previous_current = onPath(0.1 * (i - 1)).inverse() * onPath(0.1 * i);
    process(0.1 * i, frame);
    EXPECT_EQ(updates_.back().status, TrackingStatus::kLost);
  }
  EXPECT_LT((updates_.back().T_odom_robot.translation() - onPath(5.9).translation()).norm(), 0.03);
  expectNoJump();
}

TEST_F(OdometryFrameTest, IsNoFasterThanARobotWhateverTheWheelsSay) {
  params_.max_speed_mps = 2.0;
  walk(0, 10);
  StereoFrame frame = world_.covered();
  frame.motion_prior.T_previous_current = Pose(Eigen::Translation3d(40.0, 0.0, 0.0));
  process(1.0, frame);
  EXPECT_LE(step(updates_, 10).translation().norm(), 0.2 + 1e-9);
}

TEST_F(OdometryFrameTest, TheUncertaintyOfALostCameraGrowsWithTimeNotWithFrames) {
  const auto varianceAfter2s = [&](int rate) {
    walk(0, 10);
    const double tracked = updates_.back().covariance(0, 0);
    const double before = updates_.back().map_odom_covariance(0, 0);
    for (int i = 1; i <= 2 * rate; ++i)
      process(0.9 + static_cast<double>(i) / rate, world_.covered());
    EXPECT_GT(updates_.back().covariance(0, 0), 2.0 * tracked);
    EXPECT_GT(updates_.back().map_odom_covariance(0, 0), before);
    const double lost = take().back().covariance(0, 0);
    return lost - tracked;
  };
  const double at_10_hz = varianceAfter2s(10);
  EXPECT_NEAR(varianceAfter2s(30), at_10_hz, 0.02 * at_10_hz);
}

}  // namespace
}  // namespace headway::slam
