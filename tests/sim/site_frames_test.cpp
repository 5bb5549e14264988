// SPDX-License-Identifier: BSD-3-Clause
// Laws of frames drawn in hall, campus and warehouse, with every rig.
#include <gtest/gtest.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>
#include <headway_test/repeats.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "site_environment.h"

namespace headway::sim {
namespace {

using Kind = WorldParams::Kind;

/// A rig with a quarter of its pixels a side.
SimParams quartered(Kind kind, const std::string& rig) {
  SimParams params;
  params.world.kind = kind;
  params.route.speed_mps = 1.0;
  params.traffic.vehicles = 2;
  params.traffic.pedestrians = 8;
  params.traffic.idle_people = 4;
  applyRig(rig, params.camera);
  params.camera.width /= 4;
  params.camera.height /= 4;
  params.camera.focal_px /= 4;
  params.recording.frames = 2;
  params.laser.enabled = true;
  return params;
}

std::vector<SimFrame> drawnFrames(const SimParams& params) {
  Simulator simulator(params);
  std::vector<SimFrame> frames;
  while (auto frame = simulator.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<std::string> rigs() {
  std::vector<std::string> names = {"small", "robot", "car"};
  names.resize(test::repeats(3, 1));
  return names;
}

class SiteFramesTest : public ::testing::TestWithParam<std::tuple<Kind, std::string>> {};

TEST_P(SiteFramesTest, EveryPixelShowsSomethingAndSeedsGiveTheSameBytes) {
  const auto& [kind, rig] = GetParam();
  const SimParams params = quartered(kind, rig);
  const auto frames = drawnFrames(params), again = drawnFrames(params);
  ASSERT_EQ(frames.size(), 2U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(cv::norm(frames[i].left, again[i].left, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(frames[i].right, again[i].right, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(frames[i].depth, again[i].depth, cv::NORM_INF), 0.0);
    EXPECT_EQ(frames[i].laser->ranges, again[i].laser->ranges);
    cv::Scalar mean, deviation;
    cv::meanStdDev(frames[i].left, mean, deviation);
    EXPECT_GT(deviation[1], 12.0);
    if (kind == Kind::kHall) {  // but for windows, a hall has no sky
      const double sky = cv::countNonZero(frames[i].depth == 0.0F);
      EXPECT_LT(sky / static_cast<double>(frames[i].depth.total()), 0.2);
    }
  }
  EXPECT_EQ(frames[0].drops.empty(), false);
  EXPECT_TRUE(frames[1].drops.empty());
}

TEST_P(SiteFramesTest, TheFloorLiesWhereTheMountingSaysAndTheLaserAgreesWithTheDepth) {
  const auto& [kind, rig] = GetParam();
  SimParams params = quartered(kind, rig);
  params.traffic.vehicles = params.traffic.pedestrians = params.traffic.idle_people = 0;
  params.camera.ride_deg = 0.0;
  params.robot.standing = true;
  params.recording.frames = 1;
  params.laser.sigma_m = params.laser.miss_ratio = 0.0;
  Simulator simulator(params);
  const StereoCamera camera = simulator.camera();
  const auto frame = simulator.next();
  ASSERT_TRUE(frame);
  const Pose& T_robot_laser = frame->laser->T_robot_laser;
  int on_floor = 0, compared = 0, agreeing = 0;
  for (int v = 0; v < frame->depth.rows; ++v) {
    for (int u = 0; u < frame->depth.cols; ++u) {
      const double z = frame->depth.at<float>(v, u);
      if (z <= 0.0) continue;
      const Eigen::Vector3d at = camera.T_robot_cam * (z * ray(Eigen::Vector2d(u, v), camera));
      if (std::abs(at.z()) < 0.02) ++on_floor;
      const Eigen::Vector3d seen = T_robot_laser.inverse() * at;
      if (std::abs(seen.z()) > 0.01 || seen.norm() > 8.0) continue;
      const double angle = std::atan2(seen.y(), seen.x());
      const double step = frame->laser->aperture_rad / (params.laser.rays - 1);
      const auto i =
          static_cast<std::size_t>(std::lround((angle + 0.5 * frame->laser->aperture_rad) / step));
      ++compared;
      if (std::abs(frame->laser->ranges.at(i) - seen.head<2>().norm()) < 0.08) ++agreeing;
    }
  }
  // A car's cameras see the floor from 6 m on, and no room in a hall is as long.
  if (rig != "car") {
    EXPECT_GT(on_floor, static_cast<int>(frame->depth.total() / 20));
  }
  if (compared > 20) {
    EXPECT_GT(agreeing, 0.8 * compared);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SiteFramesTest,
                         ::testing::Combine(::testing::Values(Kind::kHall, Kind::kCampus,
                                                              Kind::kWarehouse),
                                            ::testing::ValuesIn(rigs())));

}  // namespace
}  // namespace headway::sim
