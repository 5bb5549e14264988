// SPDX-License-Identifier: BSD-3-Clause
// The closed loop in small simulated halls.
#include "drive.h"

#include <gtest/gtest.h>
#include <headway/map/map_query.h>
#include <headway/nav/speed_governor.h>

#include <cmath>

#include "policy_figures.h"

namespace headway::app {
namespace {

/// A hall with so many people, seen by a small camera.
DriveSetup hallWith(int people, Sense sense) {
  DriveSetup setup;
  setup.sense = sense;
  sim::SimParams& world = setup.world;
  world.world.kind = sim::WorldParams::Kind::kHall;
  world.traffic = {};
  world.traffic.vehicles = world.traffic.cyclists = 0;
  world.traffic.pedestrians = people;
  world.camera.width = 320;
  world.camera.height = 240;
  world.camera.focal_px = 200.0;
  world.camera.baseline_m = 0.12;
  world.camera.mount_height_m = 0.5;
  world.camera.pitch_down_deg = 10.0;
  world.camera.colour = false;
  setup.nav.robot.radius_m = setup.robot.radius();
  setup.nav.robot.length_m = setup.robot.length_m;
  setup.nav.robot.width_m = setup.robot.width_m;
  return setup;
}

TEST(DriveTest, APerfectEyeReachesItsGoalInAnEmptyHall) {
  const TrialResult result = DriveRunner(hallWith(0, Sense::kTruth)).run(16);
  const DriveResult& drive = *result.drive;
  EXPECT_TRUE(result.goal_reached);
  EXPECT_GE(drive.course_m, 15.0);
  EXPECT_LE(drive.course_m, 30.0);
  EXPECT_LT(drive.goal_error_m, 0.6);
  EXPECT_LT(result.time_to_goal_s, 1.6 * drive.course_m) << "at up to 1 m/s";
  EXPECT_EQ(0u, drive.contacts.with_things);
}

TEST(DriveTest, ItsImagesLeadARobotAsFarAsAPerfectEye) {
  DriveSetup setup = hallWith(0, Sense::kTruth);
  setup.robot.time_limit_s = 6.0;
  const TrialResult truth = DriveRunner(setup).run(16);
  setup.sense = Sense::kImages;
  const TrialResult images = DriveRunner(setup).run(16);
  EXPECT_EQ(0u, images.drive->contacts.with_things);
  EXPECT_LT(images.drive->lost_s, 0.3);
  // Both are on their way still; the images cost it no more than a metre of six.
  EXPECT_NEAR(truth.drive->goal_error_m, images.drive->goal_error_m, 1.0);
  EXPECT_LT(images.drive->goal_error_m, images.drive->course_m);
}

TEST(DriveTest, APerfectEyeMovesIntoNobody) {
  for (const std::uint64_t seed : {16, 21}) {
    DriveSetup setup = hallWith(4, Sense::kTruth);
    setup.robot.time_limit_s = 25.0;
    const TrialResult result = DriveRunner(setup).run(seed);
    EXPECT_EQ(0u, result.drive->contacts.by_robot) << seed;
    EXPECT_LT(result.min_distance_m, 1.0) << seed << ": it has met somebody";
  }
}

TEST(DriveTest, WithoutPredictionsWhatIsBlockedNowCountsToo) {
  const auto obstaclesOf = [](bool predicts, bool layer) {
    DriveSetup setup = hallWith(0, Sense::kImages);
    setup.local_layer = layer;
    setup.robot.time_limit_s = 0.6;
    if (!predicts) setup.nav.policy = nav::ObstaclePolicy::kStatic;
    std::size_t count = 0;
    (void)DriveRunner(setup).run(
        16, [&](const TrialMoment& moment) { count += moment.obstacles.size(); });
    return count;
  };
  const std::size_t with_layer = obstaclesOf(false, true);
  EXPECT_GT(with_layer, 2 * obstaclesOf(false, false)) << "seen before it is mapped";
  EXPECT_EQ(with_layer, obstaclesOf(true, true)) << "where nothing moves";
}

/// A robot in an empty hall that does what its speed governor admits of each command, by images.
class GovernedDrive {
 public:
  GovernedDrive()
      : world_(setup_.world, {setup_.robot.length_m, setup_.robot.width_m}),
        eye_(makeEye(Sense::kImages, setup_.robot, setup_.objects, true)),
        governor_(setup_.nav) {}
  void drive(double seconds, const sim::DriveCommand& command) {
    const double end_s = world_.now() + seconds, period_s = 1.0 / setup_.world.camera.rate_hz;
    while (world_.now() < end_s - 1e-6) {
      const Knowledge knowledge = eye_->perceive(world_);
      const double ratio = knowledge.pose ? ratioOf(command, knowledge) : 0.0;
      const int steps = static_cast<int>(std::ceil(period_s / 0.02));
      for (int i = 0; i < steps; ++i) {
        world_.advance(period_s / steps, {ratio * command.speed, ratio * command.turn_rate});
      }
    }
  }
  [[nodiscard]] sim::DrivenRobot robot() const { return world_.robot(); }

 private:
  double ratioOf(const sim::DriveCommand& command, const Knowledge& knowledge) {
    const map::MapQuery query(knowledge.map, world_.now());
    const nav::GroundTwist motion{world_.robot().motion.speed, 0.0,
                                  world_.robot().motion.turn_rate};
    return governor_.speedRatio(
        {command.speed, 0.0, command.turn_rate},
        {{knowledge.pose->x, knowledge.pose->y}, knowledge.pose->phi, motion},
        knowledge.map.movingObjects().tracks(), 0.0,
        [&](const Eigen::Vector2d& place, double within_s) {
          return query.groundNow(place, within_s);
        });
  }

  static DriveSetup slowHall() {
    DriveSetup setup = hallWith(0, Sense::kImages);
    setup.world.camera.rate_hz = 5.0;
    return setup;
  }

  DriveSetup setup_ = slowHall();
  sim::DrivenWorld world_;
  std::unique_ptr<Eye> eye_;
  nav::SpeedGovernor governor_;
};

TEST(DriveTest, WhoStoodForAMinuteStartsTurnsAndReverses) {
  GovernedDrive drive;
  drive.drive(3.0, {0.5, 0.0});
  drive.drive(60.0, {});
  const Eigen::Vector2d stood = drive.robot().position;
  drive.drive(4.0, {-0.4, 0.0});
  EXPECT_GT((drive.robot().position - stood).norm(), 1.0) << "back on ground that it has driven on";
  const Eigen::Vector2d reversed = drive.robot().position;
  drive.drive(4.0, {0.4, 0.0});
  EXPECT_GT((drive.robot().position - reversed).norm(), 1.0);
  const double yaw = drive.robot().yaw;
  drive.drive(2.0, {0.0, 0.8});
  EXPECT_GT(std::abs(wrapAngle(drive.robot().yaw - yaw)), 1.0);
}

TEST(DriveTest, ItsWheelsMeasureItsWay) {
  const DriveSetup setup = hallWith(0, Sense::kImages);
  sim::DrivenWorld world(setup.world, {setup.robot.length_m, setup.robot.width_m});
  for (int i = 0; i < 50; ++i) world.advance(0.02, {0.8, 0.0});
  const sim::SimFrame frame = world.look();
  ASSERT_TRUE(frame.odometry);
  EXPECT_NEAR(frame.time, frame.odometry->time, 1e-6);
  const double way = world.robot().position.norm();
  EXPECT_GT(way, 0.3);
  EXPECT_NEAR(way, std::hypot(frame.odometry->x, frame.odometry->y), 0.03 * way);
}

TEST(DriveTest, TheSameSeedGivesTheSameDrive) {
  for (const Sense sense : {Sense::kTruth, Sense::kImages}) {
    DriveSetup setup = hallWith(4, sense);
    setup.robot.time_limit_s = sense == Sense::kTruth ? 10.0 : 2.0;
    DriveRunner runner(setup);
    std::vector<std::string> results;
    for (int i = 0; i < 2; ++i) {
      std::string text;
      const auto observer = [&](const TrialMoment& moment) {
        text += std::to_string(moment.robot.x) + ' ' + std::to_string(moment.robot.phi) + ' ' +
                std::to_string(moment.obstacles.size()) + '\n';
      };
      const TrialResult result = runner.run(5, observer);
      const auto json = toJson(figuresOf({{nav::ObstaclePolicy::kTimeGated, {result}}}));
      results.push_back(text + json.at("time_gated").at("drives").dump());
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_NE(results[0], "");
  }
}

}  // namespace
}  // namespace headway::app
