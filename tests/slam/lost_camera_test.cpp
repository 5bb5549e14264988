// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/repeated_corridor.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace headway::slam {
namespace {

/// A camera carried through a room, covered at times, or put down in another room.
class LostCameraTest : public testing::Test {
 protected:
  LostCameraTest() : world_(test::smallCamera()), other_(test::smallCamera(), 99) {
    world_.addRoom(12.0, 8.0, 4.0);
    other_.addRoom(9.0, 7.0, 3.0);
    params_.features = 300;
  }

  static Pose onPath(int i) {
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * i, 0.3 * std::sin(0.05 * i), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.2 * std::sin(0.04 * i)});
    return pose;
  }

  /// Walks from place to place of the path; how many of the frames were lost.
  int walk(const test::TexturedWorld& world, int first_place, int end) {
    int lost = 0;
    for (int place = first_place; place < end; ++place) {
      lost += isLostIn(world.frame(0, 0.0, onPath(place)));
    }
    return lost;
  }

  /// Sees nothing for some frames; how many of them were lost.
  int cover(int frames) {
    int lost = 0;
    for (int i = 0; i < frames; ++i) lost += isLostIn(world_.covered());
    return lost;
  }

  SlamUpdate processed(StereoFrame frame, const MovingRegions& moving = {}) {
    frame.index = frames_++;
    frame.time = 0.1 * static_cast<double>(frame.index);
    return slam().process(frame, moving);
  }

  /// Walks on without seeing anything, told by wheels whose way is 1 % too long.
  SlamUpdate walkCovered(int first_place, int end) {
    SlamUpdate update;
    for (int place = first_place; place < end; ++place) {
      StereoFrame frame = world_.covered();
      addOdometry(place, frame);
      update = processed(frame);
      EXPECT_EQ(update.status, TrackingStatus::kLost);
    }
    return update;
  }

  /// Sees a place, told of the step before by the wheels.
  SlamUpdate see(const test::TexturedWorld& world, int place) {
    StereoFrame frame = world.frame(0, 0.0, onPath(place));
    addOdometry(place, frame);
    return processed(frame);
  }

  void startWithOdometry() {
    ASSERT_EQ(walk(world_, 0, 1), 0);
    for (int place = 1; place < 15; ++place) (void)see(world_, place);
  }

  static void addOdometry(int place, StereoFrame& frame) {
    Pose step = onPath(place - 1).inverse() * onPath(place);
    step.translation() *= 1.01;
    frame.motion_prior.T_previous_current = step;
  }

  static double wayBetween(int first_place, int end) {
    double way = 0.0;
    for (int place = first_place; place < end; ++place) {
      way += (onPath(place).translation() - onPath(place - 1).translation()).norm();
    }
    return way;
  }

  StereoSlam& slam() {
    if (slam_ == nullptr) slam_ = std::make_unique<StereoSlam>(world_.camera(), params_);
    return *slam_;
  }

  void startIn(const std::string& map) {
    slam_ = std::make_unique<StereoSlam>(world_.camera(), params_);
    slam_->load(map);
  }

  /// How far the last frame is from a place.
  [[nodiscard]] double errorAt(int place) const {
    const Pose last = slam_->trajectory().back().T_map_robot;
    return (last.translation() - onPath(place).translation()).norm();
  }

  test::TexturedWorld world_, other_;
  SlamParams params_;

 private:
  int isLostIn(const StereoFrame& frame) {
    return processed(frame).status == TrackingStatus::kLost ? 1 : 0;
  }

  std::size_t frames_ = 0;
  std::unique_ptr<StereoSlam> slam_;
};

TEST_F(LostCameraTest, IsFoundHoweverLongItWasCovered) {
  ASSERT_EQ(walk(world_, 0, 15), 0);
  EXPECT_EQ(cover(30), 30);
  EXPECT_EQ(walk(world_, 10, 15), 0) << "back where it was";
  EXPECT_LT(errorAt(14), 0.03);
  EXPECT_EQ(slam().map().keyframes.front().frame, 0U) << "in the map of before";
}

TEST_F(LostCameraTest, OverexposedItIsFoundWhereItIsOrNotAtAll) {
  ASSERT_EQ(walk(world_, 0, 40), 0);
  int found = 0;
  for (const double gain : {1.5, 2.5, 4.0}) {
    EXPECT_EQ(cover(5), 5);
    for (int place = 10; place < 20; ++place) {
      StereoFrame frame = world_.frame(0, 0.0, onPath(place));
      for (cv::Mat* image : {&frame.left, &frame.right})
        image->convertTo(*image, CV_8U, gain, 60.0);
      if (processed(frame).status != TrackingStatus::kTracked) continue;
      ++found;
      EXPECT_LT(errorAt(place), 0.1) << gain << " at " << place;
    }
  }
  EXPECT_GT(found, 0);
}

TEST_F(LostCameraTest, CoveredRightAfterTheStartIsFoundInWhatLittleThereIs) {
  ASSERT_EQ(walk(world_, 0, 3), 0);
  EXPECT_EQ(cover(6), 6);
  EXPECT_EQ(walk(world_, 3, 6), 0);
  EXPECT_LT(errorAt(5), 0.03);
}

TEST_F(LostCameraTest, BeginsAnewAtOnceWhatItLostRightAfterTheStart) {
  ASSERT_EQ(walk(world_, 0, 2), 0);
  const int lost = walk(other_, 2, 12);
  EXPECT_GE(lost, 1) << "it must be said";
  EXPECT_LE(lost, 4) << "and not last for restart_after_s";
  for (const KeyframeView& keyframe : slam().map().keyframes) {
    EXPECT_GE(keyframe.frame, 2U) << "nothing is left of a beginning that was given up";
  }
  EXPECT_EQ(slam().submaps(), std::vector<int>{0}) << "so that this one has the map's origin";
  const auto path = slam().trajectory();
  ASSERT_EQ(path.size(), 12U);
  EXPECT_EQ(std::count_if(path.begin(), path.end(), [](const auto& at) { return !at.tracked; }),
            lost);
  EXPECT_LT((path[0].T_map_robot.translation() - onPath(0).translation()).norm(), 0.01);
  const Eigen::Vector3d moved =
      path[11].T_map_robot.translation() - path[9].T_map_robot.translation();
  EXPECT_NEAR(moved.norm(), (onPath(11).translation() - onPath(9).translation()).norm(), 0.02);
}

TEST_F(LostCameraTest, BoxesThatLeaveNothingInViewDoNotCostThePose) {
  ASSERT_EQ(walk(world_, 0, 15), 0);
  MovingRegions moving;
  moving.boxes.push_back({{0.0, 0.0, 320.0, 232.0}});
  for (int i = 15; i < 25; ++i) {
    const auto update = processed(world_.frame(0, 0.0, onPath(i)), moving);
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT((update.T_map_robot.translation() - onPath(i).translation()).norm(), 0.03) << i;
  }
}

TEST_F(LostCameraTest, AnObjectThatFillsTheViewDoesNotGiveThePose) {
  ASSERT_EQ(walk(world_, 0, 15), 0);
  MovingRegions moving;
  moving.boxes.push_back({{0.0, 0.0, 320.0, 232.0}});
  for (int i = 15; i < 25; ++i) {
    test::TexturedWorld with_bus = world_;
    const Eigen::Vector3d bus(onPath(i).translation().x() + 1.5, 0.1 * (i - 15) - 3.0, -1.3);
    with_bus.boards.push_back(
        {bus, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 6.0, 2.7, {0.0, 0.0}});
    const auto update = processed(with_bus.frame(0, 0.0, onPath(i)), moving);
    if (!isTracked(update.status)) continue;
    EXPECT_LT((update.T_map_robot.translation() - onPath(i).translation()).norm(), 0.05) << i;
  }
}

TEST_F(LostCameraTest, TurnsInStepsOfAThirdOfItsView) {
  constexpr double kStep = 0.35;  // 20 degrees, of 67 degrees in view
  for (int i = 0; i < 12; ++i) {
    Pose pose = onPath(3 * i);
    pose.linear() = expSo3({0.0, 0.0, kStep * i});
    const auto update = processed(world_.frame(0, 0.0, pose));
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
    const Pose error = pose.inverse(Eigen::Isometry) * update.T_map_robot;
    EXPECT_LT(logSo3(error.linear()).norm(), 0.0175) << i << ": one degree";
    EXPECT_LT(error.translation().norm(), 0.1) << i;
  }
}

TEST_F(LostCameraTest, StatesAnUncertaintyThatCoversATurnUnseen) {
  ASSERT_EQ(walk(world_, 0, 15), 0);
  Pose pose = onPath(14);
  for (int i = 1; i <= 3; ++i) {
    pose.linear() = pose.linear() * expSo3({0.0, 0.0, 0.157});  // 90 degrees a second, at 10 Hz
    const auto update = processed(world_.covered());
    ASSERT_EQ(update.status, TrackingStatus::kLost);
    const Pose error = pose.inverse(Eigen::Isometry) * update.T_map_robot;
    EXPECT_LT(logSo3(error.linear()).norm(), 3.0 * std::sqrt(update.covariance(5, 5))) << i;
  }
}

TEST_F(LostCameraTest, WaitsForAMapThatIsWorthIt) {
  params_.restart_after_s = 0.6;
  ASSERT_EQ(walk(world_, 0, 15), 0);
  EXPECT_EQ(walk(other_, 15, 21), 6);
  EXPECT_EQ(walk(other_, 21, 24), 0) << "a new submap";
  EXPECT_EQ(slam().submaps(), (std::vector<int>{0, 1}));
  EXPECT_GE(slam().map().keyframes.front().frame, 21U) << "which is shown alone";
  EXPECT_EQ(slam().map(0).keyframes.front().frame, 0U) << "the old one stays";
  EXPECT_LE(walk(world_, 10, 15), 1) << "and is known as well as before";
  EXPECT_LT(errorAt(14), 0.03);
  EXPECT_EQ(slam().map().keyframes.front().frame, 0U);
  EXPECT_EQ(slam().submaps(), (std::vector<int>{0, 1})) << "nothing joins both";
}

constexpr double kMaxCost = 0.02;  ///< of the way that was driven covered

TEST_F(LostCameraTest, IsCarriedOnByTheWheelsWithTheirUncertainty) {
  startWithOdometry();
  const auto early = walkCovered(15, 20);
  const auto late = walkCovered(20, 65);
  const double way = wayBetween(15, 65);
  EXPECT_LT(errorAt(64), kMaxCost * way);
  const auto sigmaOf = [](const SlamUpdate& update) {
    return std::sqrt(update.covariance.diagonal().head<3>().maxCoeff());
  };
  EXPECT_GT(sigmaOf(late), 2.0 * sigmaOf(early));
  EXPECT_GT(3.0 * sigmaOf(late), errorAt(64));
  EXPECT_LT(sigmaOf(late), 0.2 * way) << "no more than the wheels' errors explain";
}

TEST_F(LostCameraTest, GoesOnWhereTheWheelsHaveBroughtItAmongNewSurroundings) {
  startWithOdometry();
  (void)walkCovered(15, 65);
  SlamUpdate update;
  std::set<MapChange> causes;
  for (int place = 65; place < 70; ++place) {
    update = see(other_, place);
    causes.insert(update.revision.cause);
  }
  EXPECT_EQ(causes.count(MapChange::kBridged), 1U);
  EXPECT_EQ(causes.count(MapChange::kRelocalised) + causes.count(MapChange::kNewSubmap), 0U);
  EXPECT_EQ(update.status, TrackingStatus::kTracked);
  EXPECT_EQ(slam().submaps(), std::vector<int>{0}) << "its place is known by the wheels";
  EXPECT_LT(errorAt(69), kMaxCost * wayBetween(15, 70));
  EXPECT_EQ(slam().map().keyframes.front().frame, 0U) << "beside the map of before";
}

TEST_F(LostCameraTest, GoesOnInItsMapWhereItRecognisesIt) {
  startWithOdometry();
  (void)walkCovered(15, 45);
  const auto update = see(world_, 45);
  EXPECT_EQ(update.status, TrackingStatus::kTracked);
  EXPECT_LT(errorAt(45), 0.02) << "by its landmarks, not by its wheels";
}

TEST_F(LostCameraTest, AnInitialPoseIsSearchedInASubmapOfItsOwnToo) {
  const test::TexturedWorld corridor = test::repeatedCorridor();
  const auto seen = [&](double at_m) {
    Pose pose = Pose::Identity();
    pose.translation().x() = at_m;
    return processed(corridor.frame(0, 0.0, pose));
  };
  for (int i = 0; i < 110; ++i) (void)seen(0.15 * i);
  const std::string map = slam().save();
  for (const double repeats : {0.0, 1.0}) {
    startIn(map);
    SlamUpdate update;
    for (int i = 0; i < 30; ++i) update = seen(0.5 + 0.01 * i);
    ASSERT_GT(update.submap, 0) << "both places of the map look like this one";
    Pose initial = Pose::Identity();
    initial.translation().x() = test::kCorridorRepeat_m * repeats + 1.0;
    slam().setInitialPose(initial);
    double at_m = 0.8;
    for (; at_m < 4.0 && update.submap > 0; at_m += 0.1) update = seen(at_m + 0.1);
    EXPECT_EQ(update.submap, 0);
    EXPECT_NEAR(update.T_map_robot.translation().x(), test::kCorridorRepeat_m * repeats + at_m,
                0.05);
  }
}

}  // namespace
}  // namespace headway::slam
