// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

namespace headway::slam {
namespace {

constexpr int kFrames = 36;

Pose onPath(int i) {
  Pose pose = Pose::Identity();
  pose.translation() << 0.04 * i, 0.02 * i, 0.0;
  pose.linear() = expSo3({0.0, 0.0, 0.1 * std::sin(0.1 * i)});
  return pose;
}

/// A board across the view that comes in at a frame and then moves along with its own velocity.
struct Mover {
  double share = 0.0;                                        ///< of the image's width that it fills
  int from = 0;                                              ///< frame of its coming
  Eigen::Vector3d step = Eigen::Vector3d(0.03, -0.05, 0.0);  ///< a frame [m]
};

/// Root mean square error of the path through a room with a mover [m].
double errorWith(const Mover& mover, DynamicRejection mode, double room_length = 12.0) {
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(room_length, 8.0, 4.0);
  const std::size_t still = world.boards.size();
  SlamParams params;
  params.dynamic_rejection = mode;
  StereoSlam slam(world.camera(), params);
  double sum = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    world.boards.resize(still);
    if (mover.share > 0.0 && i >= mover.from) {
      constexpr double kDepth = 2.5;
      const double view = kDepth * 320.0 / 240.0;
      test::Board board;
      board.width = mover.share * view;
      board.height = 3.0;
      board.u = Eigen::Vector3d::UnitY();
      board.texture_offset << 2.2, 0.9;
      board.origin = onPath(mover.from) * Eigen::Vector3d(kDepth, -0.5 * view, -1.5) +
                     (i - mover.from) * mover.step;
      world.boards.push_back(board);
    }
    const auto update = slam.process(world.frame(i, 0.1 * i, onPath(i)), {});
    sum += (update.T_map_robot.translation() - onPath(i).translation()).squaredNorm();
  }
  return std::sqrt(sum / kFrames);
}

class MovingWorldTest : public testing::TestWithParam<double> {};

TEST_P(MovingWorldTest, AMovingObjectThatEntersDoesNotMoveTheCamera) {
  const Mover mover{GetParam(), 8};
  EXPECT_LT(errorWith(mover, DynamicRejection::kGeometric), 0.02);
}

INSTANTIATE_TEST_SUITE_P(ShareOfTheImage, MovingWorldTest,
                         testing::Values(0.0, 0.1, 0.3, 0.5, 0.65));

class MovingWorldFromTheStartTest : public testing::TestWithParam<double> {};

TEST_P(MovingWorldFromTheStartTest, WhatExtendsFarthestIsTakenAsStatic) {
  const Mover mover{GetParam(), 0, {0.1, -0.15, 0.0}};
  EXPECT_LT(errorWith(mover, DynamicRejection::kGeometric, 40.0), 0.03);
  EXPECT_GT(errorWith(mover, DynamicRejection::kNone, 40.0), 0.1);
}

INSTANTIATE_TEST_SUITE_P(ShareOfTheImage, MovingWorldFromTheStartTest, testing::Values(0.3, 0.5));

TEST(MovingWorldWithoutRejectionTest, CarriesTheCameraAlong) {
  EXPECT_GT(errorWith({0.5, 8}, DynamicRejection::kNone), 0.1);
}

}  // namespace
}  // namespace headway::slam
