// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

namespace headway::slam {
namespace {

/// A camera carried through a room at 0.5 m/s, whose images or wheels are wrong at times.
class UnreliablePoseTest : public testing::Test {
 protected:
  UnreliablePoseTest() : world_(test::smallCamera()) {
    world_.addRoom(12.0, 8.0, 4.0);
    params_.features = 300;
  }

  /// The next place of the path.
  [[nodiscard]] Pose here() const {
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * place_, 0.2 * std::sin(0.05 * place_), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.1 * std::sin(0.04 * place_)});
    return pose;
  }

  SlamUpdate next(ImageEvidence images = ImageEvidence::kNone,
                  const std::optional<Pose>& by_wheels = std::nullopt) {
    if (slam_ == nullptr) slam_ = std::make_unique<StereoSlam>(world_.camera(), params_);
    const bool is_frozen = images == ImageEvidence::kSeenBefore;
    if (!is_frozen) image_ = world_.frame(0, 0.0, here());
    StereoFrame frame = image_;
    frame.index = static_cast<std::size_t>(frames_);
    frame.time = time_;
    time_ += interval_s_;
    ++frames_;
    frame.motion_prior.T_previous_current = by_wheels;
    if (shift_px_ > 0) {
      frame.right = image_.right.clone();
      const int columns = frame.right.cols;
      image_.right.colRange(0, columns - shift_px_)
          .copyTo(frame.right.colRange(shift_px_, columns));
    }
    return slam_->process(frame, {}, images);
  }

  void move() {
    const Pose before = here();
    place_ += way_ / 0.05;
    step_ = before.inverse() * here();
  }

  void walk(int frames) {
    for (int i = 0; i < frames; ++i) {
      ASSERT_EQ(next().status, TrackingStatus::kTracked) << frames_;
      move();
    }
  }

  [[nodiscard]] double errorOf(const SlamUpdate& update) const {
    return (update.T_map_robot.translation() - here().translation()).norm();
  }

  test::TexturedWorld world_;
  SlamParams params_;
  std::unique_ptr<StereoSlam> slam_;
  Pose step_ = Pose::Identity();  ///< the latest motion
  double interval_s_ = 0.1;       ///< between frames
  double way_ = 0.05;             ///< between frames [m]
  int shift_px_ = 0;              ///< of the right image to the right

 private:
  StereoFrame image_;
  double place_ = 0.0;  ///< in steps of 5 cm
  int frames_ = 0;
  Time time_ = 0.0;
};

TEST_F(UnreliablePoseTest, ARightImageThatContradictsTheMapIsDoubtedAndNotMapped) {
  walk(15);
  shift_px_ = 4;
  for (int i = 0; i < 15; ++i) {
    const auto update = next();
    EXPECT_EQ(update.status, TrackingStatus::kUnreliable) << i;
    EXPECT_EQ(update.doubt, Doubt::kImages) << i;
    EXPECT_FALSE(update.is_keyframe) << i;
    move();
  }
  shift_px_ = 0;
  for (int i = 1; i < 10; ++i) {
    EXPECT_EQ(next().status, TrackingStatus::kUnreliable) << "for a second after " << i;
    move();
  }
  const auto update = next();
  EXPECT_EQ(update.status, TrackingStatus::kTracked);
  EXPECT_LT(errorOf(update), 0.03);
}

TEST_F(UnreliablePoseTest, RelocalisationIsNoMotionForTheWheelsToContradict) {
  walk(15);
  const std::string saved = slam_->save();
  slam_ = std::make_unique<StereoSlam>(world_.camera(), params_);
  slam_->load(saved);
  for (int i = 0; i < 3; ++i) {
    const auto update = next(ImageEvidence::kNone, step_);
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT(errorOf(update), 0.03);
    move();
  }
}

TEST_F(UnreliablePoseTest, FrozenImagesAreNotUsedAndTheCameraIsFoundAgain) {
  walk(15);
  for (int i = 0; i < 10; ++i) {
    const auto update = next(ImageEvidence::kSeenBefore);
    EXPECT_EQ(update.status, TrackingStatus::kUnreliable);
    EXPECT_EQ(update.doubt, Doubt::kFrozen);
    EXPECT_LT(errorOf(update), 0.2) << "it is assumed to move on";
    move();
  }
  const auto update = next();
  EXPECT_EQ(update.status, TrackingStatus::kTracked);
  EXPECT_LT(errorOf(update), 0.03);
  const auto path = slam_->trajectory();
  EXPECT_EQ(std::count_if(path.begin(), path.end(), [](const auto& at) { return !at.tracked; }),
            10);
}

TEST_F(UnreliablePoseTest, ASingleRepeatedPairOfASlowCameraIsAsGoodAsTheOneBefore) {
  walk(15);
  interval_s_ = 1.0 / 30.0;
  way_ = 0.0015;
  walk(6);
  for (int i = 0; i < 10; ++i) {
    move();
    const bool is_repeated = i % 3 == 0;
    const auto update = next(is_repeated ? ImageEvidence::kSeenBefore : ImageEvidence::kNone);
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT(errorOf(update), 0.01) << i;
    EXPECT_NE(update.revision.cause, MapChange::kRelocalised) << "it was not lost";
  }
  int frozen = 0;
  for (int i = 0; i < 30; ++i) {
    frozen += next(ImageEvidence::kSeenBefore).doubt == Doubt::kFrozen ? 1 : 0;
  }
  EXPECT_GE(frozen, 28) << "it may have started, which nobody saw";
}

TEST_F(UnreliablePoseTest, FrozenImagesOfARobotThatDrivesGiveThePoseOfItsWheels) {
  walk(15);
  for (int i = 0; i < 25; ++i) {
    const auto update = next(ImageEvidence::kSeenBefore, step_);
    EXPECT_EQ(update.doubt, Doubt::kFrozen);
    EXPECT_LT(errorOf(update), 0.03);
    move();
  }
  EXPECT_LT(errorOf(next(ImageEvidence::kNone, step_)), 0.03);
}

TEST_F(UnreliablePoseTest, FrozenImagesOfARobotThatStandsByItsWheelsAreRight) {
  walk(15);
  (void)next();
  for (int i = 0; i < 10; ++i) {
    const auto update = next(ImageEvidence::kSeenBefore, Pose::Identity());
    EXPECT_EQ(update.status, TrackingStatus::kTracked);
    EXPECT_LT(errorOf(update), 0.03);
  }
}

TEST_F(UnreliablePoseTest, FrozenImagesConfirmNoRobotThatDrivesAtAnyFrameRate) {
  for (const double rate_hz : {10.0, 30.0, 100.0}) {
    slam_.reset();
    interval_s_ = 0.1;
    walk(15);
    interval_s_ = 1.0 / rate_hz;
    (void)next();
    Pose step = Pose::Identity();
    step.translation().x() = 0.29 * interval_s_;
    for (int i = 0; i < rate_hz; ++i) {
      EXPECT_EQ(next(ImageEvidence::kSeenBefore, step).doubt, Doubt::kFrozen) << rate_hz << " Hz";
    }
  }
}

TEST_F(UnreliablePoseTest, FrozenImagesAreRightOnlyUpToTheNoiseOfCreepingWheels) {
  walk(15);
  (void)next();
  Pose step = Pose::Identity();
  step.translation().x() = 0.0008;  // 8 mm/s
  int confirmed = 0;
  for (int i = 1; i <= 50; ++i) {
    if (next(ImageEvidence::kSeenBefore, step).status != TrackingStatus::kTracked) continue;
    EXPECT_LE(0.0008 * i, 0.01);
    ++confirmed;
  }
  EXPECT_GE(confirmed, 10);
}

TEST_F(UnreliablePoseTest, ImagesThatContradictEachOtherAreUsedWithoutTrust) {
  walk(15);
  const auto update = next(ImageEvidence::kContradictory);
  EXPECT_EQ(update.status, TrackingStatus::kUnreliable);
  EXPECT_EQ(update.doubt, Doubt::kImages);
  EXPECT_LT(errorOf(update), 0.03);
  move();
  walk(3);
}

TEST_F(UnreliablePoseTest, WheelsThatContradictTheCameraMakeItUnreliable) {
  walk(5);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(next(ImageEvidence::kNone, step_).status, TrackingStatus::kTracked);
    move();
  }
  Pose by_wheels = step_;
  by_wheels.translation().x() += 0.2;
  const auto update = next(ImageEvidence::kNone, by_wheels);
  EXPECT_EQ(update.status, TrackingStatus::kUnreliable);
  EXPECT_EQ(update.doubt, Doubt::kOdometry);
  EXPECT_LT(errorOf(update), 0.03) << "the camera's pose stays";
  params_.use_odometry = false;
  slam_.reset();
  walk(5);
  EXPECT_EQ(next(ImageEvidence::kNone, by_wheels).status, TrackingStatus::kTracked);
}

TEST_F(UnreliablePoseTest, NothingDrivesFasterThanItsSpeedLimit) {
  params_.max_speed_mps = 1.0;
  walk(10);
  move();
  move();
  const auto update = next();
  EXPECT_EQ(update.status, TrackingStatus::kUnreliable);
  EXPECT_EQ(update.doubt, Doubt::kSpeed);
  move();
  walk(3);
}

}  // namespace
}  // namespace headway::slam
