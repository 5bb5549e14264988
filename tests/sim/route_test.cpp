// SPDX-License-Identifier: BSD-3-Clause
#include "route.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <fstream>

#include "road_network.h"

namespace headway::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string errorOf(const RouteParams& params) {
  try {
    (void)makeRoute(params, 0.0);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RouteTest, LaneStartsAtTheOriginLookingForward) {
  const Route route = makeRoute({}, 0.0);
  const PathPoint start = route.street.at(route.start_s);
  EXPECT_LT(start.position.head<2>().norm(), 0.5);
  EXPECT_NEAR(start.yaw, 0.0, 1e-3);
  EXPECT_GT(route.street.length(), route.end_s + 100.0);  // the view is filled at the end
}

TEST(RouteTest, ShapeTurnsAsFarAsItSays) {
  RouteParams params;
  params.shape = "straight 30, left 40 90, straight 60";
  const Route route = makeRoute(params, 0.0);
  EXPECT_NEAR(route.street.at(route.end_s).yaw, M_PI / 2, 0.01);
}

TEST(RouteTest, BadShapesNameTheKey) {
  RouteParams params;
  for (const char* shape : {"", "straight", "straight -5", "left 40", "left 3 90", "jump 7",
                            "left 40 400", "straight 10, right x 9"}) {
    params.shape = shape;
    EXPECT_THAT(errorOf(params), HasSubstr("[route] shape")) << shape;
  }
}

TEST(RouteTest, LoopCloses) {
  RouteParams params;
  params.kind = RouteParams::Kind::kLoop;
  params.laps = 2;
  const Route route = makeRoute(params, 2.0);
  ASSERT_TRUE(route.street.closed());
  EXPECT_NEAR(route.end_s, 2.0 * route.street.length(), 1e-6);
  EXPECT_LT(
      (route.street.at(0.0).position - route.street.at(route.street.length()).position).norm(),
      1e-6);
  EXPECT_NEAR(route.ahead(route.street.length() - 3.0, 4.0), 7.0, 1e-9);
}

TEST(RouteTest, KittiPosesAreDrivenInTheRightLane) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "poses.txt").string();
  std::ofstream out(file);
  for (int i = 0; i < 200; ++i) {  // straight on: KITTI's z is forward; rising 2 cm a metre
    out << "1 0 0 0 0 1 0 " << -0.02 * i << " 0 0 1 " << i << "\n";
  }
  out.close();
  RouteParams params;
  params.kind = RouteParams::Kind::kKittiPoses;
  params.file = file;
  const Route route = makeRoute(params, 0.0);
  const Eigen::Vector3d robot = route.street.beside(route.start_s + 50.0, route.robot_left);
  EXPECT_NEAR(robot.y(), 0.0, 0.05);
  EXPECT_NEAR(robot.z(), 1.0, 0.1);
}

/// KITTI poses along x right, y down, z forward, and the error of a route along them.
std::string errorOfPoses(const std::vector<Eigen::Vector3d>& places) {
  const test::TemporaryFolder folder;
  RouteParams params;
  params.kind = RouteParams::Kind::kKittiPoses;
  params.file = (folder / "poses.txt").string();
  std::ofstream out(params.file);
  for (const auto& at : places) {
    out << "1 0 0 " << at.x() << " 0 1 0 " << at.y() << " 0 0 1 " << at.z() << "\n";
  }
  out.close();
  return errorOf(params);
}

TEST(RouteTest, APathThatLeavesTheWorldNamesItsKeyAndWhere) {
  std::vector<Eigen::Vector3d> street;
  for (int i = 0; i < 100; ++i) street.emplace_back(0, 0, i);
  EXPECT_EQ(errorOfPoses(street), "");

  auto jump = street;
  for (std::size_t i = 40; i < jump.size(); ++i) jump[i].x() += 25.0;
  EXPECT_THAT(errorOfPoses(jump), AllOf(HasSubstr("[route] file"), HasSubstr("row 41")));

  auto flight = street;
  for (std::size_t i = 40; i < flight.size(); ++i)
    flight[i].y() -= 0.8 * static_cast<double>(i - 40);
  EXPECT_THAT(errorOfPoses(flight), AllOf(HasSubstr("[route] file"), HasSubstr("steeper")));

  EXPECT_THAT(errorOfPoses({street.begin(), street.begin() + 4}), HasSubstr("less than 5 m"));

  RouteParams endless;
  endless.shape = "straight 45000";
  EXPECT_THAT(errorOf(endless), AllOf(HasSubstr("[route] shape"), HasSubstr("leaves the world")));
}

TEST(RouteTest, AMissingPoseFileIsAnInputError) {
  RouteParams params;
  params.kind = RouteParams::Kind::kKittiPoses;
  params.file = "/nowhere/poses.txt";
  EXPECT_THAT(errorOf(params), HasSubstr("/nowhere/poses.txt"));
}

TEST(RoadNetworkTest, AStreetPassedAgainIsLaidOnce) {
  // Out, around a wide bend, and back along the same street on its other side.
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x <= 200; ++x) points.emplace_back(x, 0, 0);
  for (int i = 1; i < 60; ++i) {
    const double a = -M_PI / 2 + i * 2.0 * M_PI / 60;
    points.emplace_back(200 + 30 * std::cos(a), 30 + 30 * std::sin(a), 0);
  }
  for (int x = 200; x >= 0; --x) points.emplace_back(x, 3.3, 0);
  Route route{Path(points)};
  route.end_s = route.street.length();
  const RoadNetwork network(route, 0.0, 1);
  const auto& drawn = network.roads()[0].drawn;
  for (int s = 5; s < 195; ++s) EXPECT_TRUE(drawn[static_cast<std::size_t>(s)]) << s;
  const auto length = drawn.size();
  for (std::size_t back = 20; back < 150; ++back) EXPECT_FALSE(drawn[length - back]) << back;
}

TEST(RoadNetworkTest, AClosedStreetIsLaidAllAround) {
  RouteParams params;
  params.kind = RouteParams::Kind::kLoop;
  const RoadNetwork network(makeRoute(params, 0.0), 0.0, 1);
  for (const bool drawn : network.roads()[0].drawn) EXPECT_TRUE(drawn);
}

TEST(RoadNetworkTest, CrossStreetsMeetTheMainStreetAtRightAngles) {
  const Route route = makeRoute({}, 0.0);
  const RoadNetwork network(route, 70.0, 3);
  ASSERT_GT(network.roads().size(), 1U);
  for (std::size_t i = 1; i < network.roads().size(); ++i) {
    const Road& road = network.roads()[i];
    const auto main = route.street.at(road.main_s), cross = road.axis.at(road.junction_s);
    EXPECT_LT((main.position - cross.position).norm(), 0.01);
    EXPECT_NEAR(std::abs(std::sin(main.yaw - cross.yaw)), 1.0, 1e-3);
    EXPECT_TRUE(network.nearOther(main.position.head<2>(), 5.0, 0, road.main_s, false));
    EXPECT_FALSE(network.nearOther(main.position.head<2>(), 5.0, 0, road.main_s, true));
  }
}

TEST(RoadNetworkTest, CrossStreetsAreFoundByTheirPlaceInAnyLap) {
  RouteParams params;
  const Route lane = makeRoute(params, 0.0);
  params.kind = RouteParams::Kind::kLoop;
  params.loop_length_m = 400.0;
  params.loop_width_m = 300.0;
  const Route loop = makeRoute(params, 0.0);
  for (const Route* route : {&lane, &loop}) {
    const RoadNetwork network(*route, 60.0, 3);
    for (double s = -50.0; s < 1.6 * route->street.length(); s += 7.0) {
      for (const double reach : {3.0, 80.0, 900.0}) {
        std::vector<const Road*> expected;
        for (const Road& road : network.roads()) {
          if (!road.main && std::abs(route->ahead(s, road.main_s)) <= reach) {
            expected.push_back(&road);
          }
        }
        EXPECT_EQ(network.crossStreetsNear(s, reach), expected) << s << ", " << reach;
      }
    }
  }
}

}  // namespace
}  // namespace headway::sim
