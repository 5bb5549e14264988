// SPDX-License-Identifier: BSD-3-Clause
#include "guide.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace headway::app {
namespace {

using Eigen::Vector2d;
using Places = std::vector<Vector2d>;

constexpr double kWidth_m = 0.4;

/// Places a metre apart along corners.
Places courseThrough(const Places& corners) {
  Places course = {corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector2d way = corners[i] - corners[i - 1];
    for (double s = 1.0; s < way.norm() + 0.5; s += 1.0) {
      course.push_back(corners[i - 1] + s * way.normalized());
    }
  }
  return course;
}

void addWall(const Vector2d& from, const Vector2d& to, Places& obstacles) {
  const double length = (to - from).norm();
  for (double s = 0.0; s <= length; s += 0.05) {
    obstacles.push_back(from + s / length * (to - from));
  }
}

/// Distance of the line from the robot to a target to the nearest obstacle [m].
double roomTo(const Vector2d& robot, const Vector2d& target, const Places& obstacles) {
  double room = std::numeric_limits<double>::infinity();
  for (double s = 0.0; s <= 1.0; s += 0.01) {
    for (const Vector2d& place : obstacles) {
      room = std::min(room, (robot + s * (target - robot) - place).norm());
    }
  }
  return room;
}

TEST(GuideTest, LeadsStraightToTheCourseAhead) {
  Guide guide(courseThrough({{0, 0}, {12, 0}}), kWidth_m);
  EXPECT_LT((guide.lead({0.0, 0.0}, {}) - Vector2d(4.0, 0.0)).norm(), 1e-6);
  EXPECT_FALSE(guide.isLast());
  for (double x = 0.5; x < 9.0; x += 0.5) guide.lead({x, 0.3}, {});
  EXPECT_LT((guide.lead({9.0, 0.3}, {}) - Vector2d(12.0, 0.0)).norm(), 1e-6);
  EXPECT_TRUE(guide.isLast());
}

TEST(GuideTest, LeadsRoundAGroupOfPeople) {
  Guide guide(courseThrough({{0, 0}, {12, 0}}), kWidth_m);
  Places group;
  addWall({1.5, -1.2}, {1.5, 0.5}, group);
  Vector2d robot(0.0, 0.0);
  for (int i = 0; i < 60; ++i) {  // steps of 0.1 m
    const Vector2d target = guide.lead(robot, group);
    ASSERT_GT(roomTo(robot, target, group), 0.5 * kWidth_m) << robot.transpose();
    robot += 0.1 * (target - robot).normalized();
  }
  EXPECT_GT(robot.x(), 4.0) << "of 6 m of way";
  EXPECT_LT(std::abs(robot.y()), 0.3) << "back on its course";
}

TEST(GuideTest, CutsNoCornerOfWalls) {
  Guide guide(courseThrough({{0, 0}, {2, 0}, {2, 6}}), kWidth_m);
  Places walls;
  addWall({-1.0, 0.5}, {1.5, 0.5}, walls);
  addWall({1.5, 0.5}, {1.5, 6.0}, walls);
  Vector2d robot(0.0, 0.0);
  for (int i = 0; i < 60; ++i) {
    const Vector2d target = guide.lead(robot, walls);
    ASSERT_GT(roomTo(robot, target, walls), 0.5 * kWidth_m) << robot.transpose();
    robot += 0.1 * (target - robot).normalized();
  }
  EXPECT_GT(robot.y(), 3.0);
}

TEST(GuideTest, WaitsBeforeAClosedDoor) {
  Guide guide(courseThrough({{0, 0}, {12, 0}}), kWidth_m);
  Places room;
  const Places corners = {{-1, -1}, {2, -1}, {2, 1}, {-1, 1}};
  for (std::size_t i = 0; i < 4; ++i) addWall(corners[i], corners[(i + 1) % 4], room);
  EXPECT_EQ(Vector2d(1.0, 0.0), guide.lead({0.0, 0.0}, room));
}

/// A corridor from which a door leads into a room beside it, and a second one back.
TEST(GuideTest, WaitsForPeopleInACorridorInsteadOfTheWayThroughARoom) {
  Guide guide(courseThrough({{0, 0}, {12, 0}}), kWidth_m);
  Places walls;
  addWall({-3.0, -1.2}, {8.0, -1.2}, walls);
  addWall({-3.0, 1.2}, {0.5, 1.2}, walls);
  addWall({1.8, 1.2}, {3.0, 1.2}, walls);
  addWall({4.3, 1.2}, {8.0, 1.2}, walls);
  Places people = walls;
  addWall({2.4, -1.2}, {2.4, 2.3}, people);  // into the room, so that the way round is 3 m off
  const Vector2d waiting = guide.lead({0.0, 0.0}, people);
  EXPECT_LT(std::abs(waiting.y()), 0.3) << waiting.transpose();
  EXPECT_LT(waiting.x(), 2.4);
  EXPECT_LT((guide.lead({1.0, 0.0}, walls) - Vector2d(5.0, 0.0)).norm(), 1e-6) << "they have left";
  // Who is in the room all the same finds back.
  const Vector2d back = guide.lead({1.2, 3.0}, walls);
  EXPECT_LT(back.y(), 2.8) << back.transpose();
}

}  // namespace
}  // namespace headway::app
