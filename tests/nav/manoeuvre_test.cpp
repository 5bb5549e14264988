// SPDX-License-Identifier: BSD-3-Clause
#include "manoeuvre.h"

#include <gtest/gtest.h>

#include <vector>

namespace headway::app {
namespace {

using Eigen::Vector2d;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;

const Vector2d kRobotSize(0.5, 0.4);
const Manoeuvre::IsAdmitted kAll = [](const auto&) { return true; };

CSimplePointsMap pointsAt(const std::vector<Vector2d>& places) {
  CSimplePointsMap points;
  for (const Vector2d& place : places) {
    points.insertPoint(static_cast<float>(place.x()), static_cast<float>(place.y()), 0.4F);
  }
  return points;
}

TEST(ManoeuvreTest, TurnsOnTheSpotToATargetBehind) {
  Manoeuvre manoeuvre(kRobotSize);
  EXPECT_FALSE(manoeuvre.isDue(0.0, {}, {4.0, 1.0})) << "the navigator's arcs lead there";
  ASSERT_TRUE(manoeuvre.isDue(0.1, {}, {-4.0, -1.0}));
  const auto motion = manoeuvre.command(pointsAt({{0.6, 0.0}}), kAll);
  ASSERT_TRUE(motion);
  EXPECT_EQ(0.0, motion->speed);
  EXPECT_LT(motion->turn_rate, 0.0) << "the shorter way round";
  EXPECT_FALSE(manoeuvre.command(pointsAt({{0.0, 0.25}}), kAll)) << "a corner would touch it";
  EXPECT_FALSE(manoeuvre.command(pointsAt({{0.37, 0.0}}), kAll)) << "somebody comes";
}

TEST(ManoeuvreTest, TurnsUntilTheTargetIsAhead) {
  Manoeuvre manoeuvre(kRobotSize);
  EXPECT_TRUE(manoeuvre.isDue(0.0, {0.0, 0.0, 1.2}, {4.0, 0.0}));
  EXPECT_TRUE(manoeuvre.isDue(0.5, {0.0, 0.0, 0.8}, {4.0, 0.0}));
  EXPECT_FALSE(manoeuvre.isDue(1.0, {0.0, 0.0, 0.2}, {4.0, 0.0}));
  EXPECT_FALSE(manoeuvre.isDue(1.5, {0.0, 0.0, 0.8}, {4.0, 0.0}));
}

TEST(ManoeuvreTest, DoesNotTurnToAndFro) {
  Manoeuvre manoeuvre(kRobotSize);
  const auto turnTo = [&](double time_s, const Vector2d& target) {
    EXPECT_TRUE(manoeuvre.isDue(time_s, {}, target));
    const auto motion = manoeuvre.command({}, kAll);
    return motion ? motion->turn_rate : 0.0;
  };
  EXPECT_GT(turnTo(0.0, {0.0, 3.0}), 0.0);
  EXPECT_EQ(turnTo(0.1, {0.0, -3.0}), 0.0) << "it may be there for a moment only";
  EXPECT_EQ(turnTo(0.3, {0.0, -3.0}), 0.0);
  EXPECT_LT(turnTo(0.6, {0.0, -3.0}), 0.0);
}

TEST(ManoeuvreTest, LeavesWhatItTouchesAfterItHasStood) {
  Manoeuvre manoeuvre(kRobotSize);
  // Somebody's elbow at a front corner, a wall ahead: no arc of the navigator begins there.
  const auto obstacles = pointsAt({{0.26, -0.2}, {0.4, 0.1}, {0.4, 0.0}, {0.4, -0.1}});
  const TPose2D here;
  EXPECT_FALSE(manoeuvre.isDue(0.0, here, {4.0, 0.0}));
  EXPECT_FALSE(manoeuvre.isDue(2.5, here, {4.0, 0.0}));
  ASSERT_TRUE(manoeuvre.isDue(3.5, here, {4.0, 0.0}));
  const auto motion = manoeuvre.command(obstacles, kAll);
  ASSERT_TRUE(motion);
  EXPECT_LT(motion->speed, 0.0) << "only backwards there is room";
  ASSERT_TRUE(manoeuvre.isDue(4.0, here, {4.0, 0.0})) << "for a second";
  EXPECT_TRUE(manoeuvre.command(obstacles, kAll));
  EXPECT_FALSE(manoeuvre.command(pointsAt({{-0.29, 0.0}}), kAll))
      << "somebody has come behind it meanwhile";
}

TEST(ManoeuvreTest, StepsWhereItLooksUnlessOnlyBehindItThereIsRoom) {
  Manoeuvre manoeuvre(kRobotSize);
  (void)manoeuvre.isDue(0.0, {}, {4.0, 0.0});
  ASSERT_TRUE(manoeuvre.isDue(3.5, {}, {4.0, 0.0}));
  const auto motion = manoeuvre.command(pointsAt({{2.0, 0.0}}), kAll);
  ASSERT_TRUE(motion);
  EXPECT_GE(motion->speed, 0.0) << "nothing is near";
}

TEST(ManoeuvreTest, LeavesAPlaceWhereToTurnHasNotHelped) {
  Manoeuvre manoeuvre(kRobotSize);
  const auto obstacles = pointsAt({{0.35, 0.0}, {-0.58, 0.0}});
  const auto after = [&](double time_s) {
    EXPECT_TRUE(manoeuvre.isDue(time_s, {}, {2.5, 3.0}));
    return manoeuvre.command(obstacles, kAll).value_or(sim::DriveCommand{});
  };
  EXPECT_FALSE(manoeuvre.isDue(0.0, {}, {2.5, 3.0}));
  const auto first = after(3.5);
  EXPECT_EQ(0.0, first.speed);
  EXPECT_NE(0.0, first.turn_rate) << "there is more room";
  EXPECT_FALSE(manoeuvre.isDue(4.8, {}, {2.5, 3.0}));
  EXPECT_NE(0.0, after(8.0).speed);
}

TEST(ManoeuvreTest, DoesNotChooseWhatIsNotLetPass) {
  Manoeuvre manoeuvre(kRobotSize);
  (void)manoeuvre.isDue(0.0, {}, {4.0, 0.0});
  ASSERT_TRUE(manoeuvre.isDue(3.5, {}, {4.0, 0.0}));
  const auto motion = manoeuvre.command(pointsAt({{2.0, 0.0}}),
                                        [](const auto& wanted) { return wanted.speed < 0.0; });
  ASSERT_TRUE(motion);
  EXPECT_LT(motion->speed, 0.0);
}

}  // namespace
}  // namespace headway::app
