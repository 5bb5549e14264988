// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "loop_closer.h"

namespace headway::slam {
namespace {

/// Two keyframes that share no landmarks, and the edge between them.
PoseGraphEdge edgeOfGap(const std::optional<OdometryLink>& odometry) {
  std::map<KeyframeId, Keyframe> keyframes;
  for (const std::int64_t id : {4, 5}) {
    Keyframe& keyframe = keyframes[KeyframeId{id}];
    keyframe.id = KeyframeId{id};
    keyframe.T_map_cam.translation().z() = 3.0 * static_cast<double>(id);
  }
  keyframes.at(KeyframeId{5}).odometry = odometry;
  const auto edges = edgesOf(keyframes);
  EXPECT_EQ(edges.size(), 1U);
  return edges.front();
}

TEST(LoopCorrectionTest, WheelOdometryIsAnEdgeAcrossAGap) {
  const auto weak = edgeOfGap(std::nullopt);
  const auto by_wheels = edgeOfGap(OdometryLink{KeyframeId{4}, Pose::Identity(), 3.0, 0.1});
  EXPECT_GT(weak.sigma_m, 10.0);
  EXPECT_LT(by_wheels.sigma_m, 0.5);
  EXPECT_LT(by_wheels.sigma_rad, 0.2);
  EXPECT_NEAR(by_wheels.T_a_b.translation().z(), 3.0, 1e-12);
}

TEST(LoopCorrectionTest, OdometryFromAnotherKeyframeIsNot) {
  const auto edge = edgeOfGap(OdometryLink{KeyframeId{2}, Pose::Identity(), 3.0, 0.1});
  EXPECT_GT(edge.sigma_m, 10.0);
}

}  // namespace
}  // namespace headway::slam
