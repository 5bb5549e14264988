// SPDX-License-Identifier: BSD-3-Clause
// Worlds in which actors cover a requested ratio of the image.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>
#include <headway_test/repeats.h>

#include <numeric>
#include <opencv2/core.hpp>
#include <set>

namespace headway::sim {
namespace {

constexpr int kFrames = test::repeats(40, 10);

SimParams crowdedStreet(double image_share, int seed) {
  SimParams params;
  params.camera.width = 310;
  params.camera.height = 94;
  params.camera.focal_px = 179.5;
  params.camera.noise_grey = 0.0;
  params.traffic.image_share = image_share;
  params.world.seed = seed;
  params.recording.frames = kFrames;
  return params;
}

/// Share of dynamic pixels in each frame, as drawn.
std::vector<double> sharesOf(const SimParams& params) {
  Simulator simulator(params);
  std::vector<double> shares;
  while (const auto frame = simulator.next()) {
    const cv::Mat mask = dynamicMask(*frame);
    shares.push_back(cv::countNonZero(mask) / static_cast<double>(mask.total()));
  }
  return shares;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class ImageShareTest : public ::testing::TestWithParam<double> {};

TEST_P(ImageShareTest, IsReachedFromTheFirstFrameOn) {
  for (int seed = 1; seed <= test::repeats(2, 1); ++seed) {
    const auto shares = sharesOf(crowdedStreet(GetParam(), seed));
    ASSERT_EQ(static_cast<int>(shares.size()), kFrames);
    EXPECT_NEAR(meanOf(shares), GetParam(), 0.2 * GetParam()) << "seed " << seed;
    EXPECT_NEAR(shares.front(), GetParam(), 0.25 * GetParam()) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Shares, ImageShareTest, ::testing::Values(0.1, 0.3, 0.5));

TEST(CoverTest, PeopleCoverTheViewOfARobotOnACampus) {
  for (const double cover : {0.3, 0.6}) {
    SimParams params;
    applyRig("small", params.camera);
    params.world.kind = WorldParams::Kind::kCampus;
    params.traffic.pedestrians = 0;
    params.traffic.vehicles = params.traffic.cyclists = 0;
    params.traffic.cover = cover;
    params.recording.frames = 40;  // a mean over some seconds
    EXPECT_NEAR(meanOf(sharesOf(params)), cover, 0.1);
  }
}

TEST(EscortTest, DrivesAlongWithTheRobotAndIsTheSameForTheSameSeed) {
  SimParams params = crowdedStreet(0.3, 4);
  Simulator once(params), again(params);
  std::optional<SimFrame> last;
  while (auto frame = once.next()) {
    const auto other = again.next();
    ASSERT_TRUE(other);
    EXPECT_EQ(cv::norm(frame->instances, other->instances, cv::NORM_INF), 0.0);
    last = std::move(frame);
  }
  ASSERT_TRUE(last);
  EXPECT_GT(last->T_map_robot.translation().norm(), 0.2 * kFrames);  // the road is not blocked
}

TEST(EscortTest, AShareBeyondWhatVehiclesCanCoverNamesItsKey) {
  SimParams params = crowdedStreet(0.5, 1);
  params.camera.focal_px = 50.0;  // so wide that all around looks small
  params.camera.height = 310;
  try {
    const Simulator simulator(params);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("[traffic] image_share"));
  }
}

TEST(ActorsAtTheStartTest, StandBeforeTheCameraInTheFirstFrame) {
  SimParams params = crowdedStreet(0.0, 5);
  params.traffic.vehicles = params.traffic.cyclists = params.traffic.pedestrians = 0;
  EXPECT_EQ(sharesOf(params).front(), 0.0);
  params.traffic.in_front_at_start = 12;
  Simulator simulator(params);
  const auto first = simulator.next();
  std::set<std::int64_t> near;
  for (const TruthObject& object : first->objects) {
    if (!object.parked && object.visible > 0.0 && object.box3d.centre.z() < 20.0) {
      near.insert(object.id);
    }
  }
  EXPECT_GE(near.size(), 6U);  // the rest hide behind each other or stand beside the image
  EXPECT_GT(cv::countNonZero(dynamicMask(*first)), 0.02 * 310 * 94);
}

}  // namespace
}  // namespace headway::sim
