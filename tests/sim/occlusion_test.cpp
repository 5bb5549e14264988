// SPDX-License-Identifier: BSD-3-Clause
#include "occlusion.h"

#include <gtest/gtest.h>
#include <headway/core/random.h>

#include "ray.h"

namespace headway::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

StereoCamera smallCamera() {
  StereoCamera camera;
  camera.width = 96;
  camera.height = 48;
  camera.fx = camera.fy = 60.0;
  camera.cx = 47.5;
  camera.cy = 23.5;
  return camera;
}

/// Upright in the camera's own frame (y down): as wide, deep and high as asked, standing at y
/// = 1.6.
Block blockAt(double x, double z, double yaw, const Vector3d& size) {
  Block block;
  const double sx[] = {-1, 1, 1, -1}, sz[] = {-1, -1, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d corner =
        Eigen::Rotation2Dd(yaw) * Eigen::Vector2d(0.5 * sx[i] * size.x(), 0.5 * sz[i] * size.z());
    block[i] = Vector3d(x + corner.x(), 1.6, z + corner.y()).cast<float>();
    block[4 + i] = block[i] - Vector3f(0, static_cast<float>(size.y()), 0);
  }
  return block;
}

std::vector<std::array<Vector3d, 3>> facesOf(const Block& block) {
  const std::size_t quads[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                   {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::vector<std::array<Vector3d, 3>> faces;
  for (const auto& q : quads) {
    const auto at = [&](int i) { return Vector3d(block[q[i]].cast<double>()); };
    faces.push_back({at(0), at(1), at(2)});
    faces.push_back({at(0), at(2), at(3)});
  }
  return faces;
}

/// Pixels in which a triangle is nearer than all blocks.
int pixelsShown(const StereoCamera& camera, const std::vector<Vector3f>& triangle,
                const std::vector<Block>& blocks) {
  const std::array<Vector3d, 3> corners = {triangle[0].cast<double>(), triangle[1].cast<double>(),
                                           triangle[2].cast<double>()};
  int count = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const test::Ray ray{Vector3d::Zero(),
                          {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0}};
      const auto at = test::meet(ray, corners);
      if (!at) continue;
      bool hidden = false;
      for (const Block& block : blocks) {
        for (const auto& face : facesOf(block)) {
          const auto before = test::meet(ray, face);
          hidden = hidden || (before && *before < *at);
        }
      }
      count += hidden ? 0 : 1;
    }
  }
  return count;
}

TEST(OcclusionTest, WhatItHidesShowsInNoPixel) {
  const StereoCamera camera = smallCamera();
  Random random(5);
  int hidden = 0, shown = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Block> blocks;
    Occlusion occlusion(camera, Eigen::Isometry3d::Identity());
    for (int i = 0; i < 5; ++i) {
      // Some reach behind the camera, beside it.
      const double side = random.chance(0.5) ? 1.0 : -1.0;
      blocks.push_back(blockAt(side * random.uniform(4.0, 9.0), random.uniform(1.0, 30.0),
                               random.uniform(-0.4, 0.4),
                               {random.uniform(3.0, 5.0), random.uniform(3.0, 12.0), 8.0}));
      occlusion.add(blocks.back(), Vector3d::Zero());
    }
    for (int i = 0; i < 40; ++i) {
      const Vector3d middle(random.uniform(-25, 25), random.uniform(-5, 2), random.uniform(5, 60));
      std::vector<Vector3f> triangle;
      for (int k = 0; k < 3; ++k) {
        triangle.push_back(
            (middle + Vector3d(random.uniform(-3, 3), random.uniform(-2, 2), random.uniform(-3, 3)))
                .cast<float>());
      }
      const bool hides = occlusion.hides(triangle, Vector3d::Zero());
      const int pixels = pixelsShown(camera, triangle, blocks);
      EXPECT_TRUE(!hides || pixels == 0) << trial << ' ' << i;
      (hides ? hidden : shown) += 1;
    }
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(shown, 200);
}

class BehindAWallTest : public testing::Test {
 protected:
  BehindAWallTest() { occlusion.add(blockAt(0.0, 10.0, 0.0, {8.0, 4.0, 2.0}), Vector3d::Zero()); }
  [[nodiscard]] bool hidesAt(const Vector3d& place) const {
    return occlusion.hides({Vector3f(-0.3F, 0, 0), Vector3f(0.3F, 0, 0), Vector3f(0, -0.5F, 0.2F)},
                           place);
  }
  Occlusion occlusion{smallCamera(), Eigen::Isometry3d::Identity()};
};

TEST_F(BehindAWallTest, IsHidden) { EXPECT_TRUE(hidesAt({0.5, 0.0, 20.0})); }
TEST_F(BehindAWallTest, InFrontIsNot) { EXPECT_FALSE(hidesAt({0.5, 0.0, 6.0})); }
TEST_F(BehindAWallTest, InsideIsNot) { EXPECT_FALSE(hidesAt({0.5, 0.0, 10.0})); }
TEST_F(BehindAWallTest, WhatLooksOutAboveIsNot) { EXPECT_FALSE(hidesAt({0.5, -6.0, 20.0})); }
TEST_F(BehindAWallTest, WhatLooksOutBesideIsNot) { EXPECT_FALSE(hidesAt({9.0, 0.0, 20.0})); }
TEST_F(BehindAWallTest, WhatIsBesideTheImageIsHidden) { EXPECT_TRUE(hidesAt({30.0, 0.0, 20.0})); }
TEST_F(BehindAWallTest, WhatReachesBehindTheCameraIsNot) { EXPECT_FALSE(hidesAt({0.0, 0.0, 0.0})); }

TEST(OcclusionTest, ACameraSeesFromWhereItIs) {
  Eigen::Isometry3d T_cam_origin = Eigen::Isometry3d::Identity();
  T_cam_origin.translation().z() = -15.0;  // it stands beyond the wall
  Occlusion occlusion(smallCamera(), T_cam_origin);
  occlusion.add(blockAt(0.0, 10.0, 0.0, {8.0, 5.0, 2.0}), Vector3d::Zero());
  EXPECT_FALSE(occlusion.hides({Vector3f(0, 0, 0), Vector3f(0.3F, 0, 0)}, {0.5, 0.0, 20.0}));
}

}  // namespace
}  // namespace headway::sim
