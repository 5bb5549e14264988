// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bag_rig.h"

namespace headway::bags {
namespace {

TransformMessage transform(const std::string& parent, const std::string& child, double x,
                           double yaw = 0.0) {
  TransformMessage message;
  message.header.frame = parent;
  message.child_frame = child;
  message.T_parent_child.translation().x() = x;
  message.T_parent_child.linear() = expSo3({0.0, 0.0, yaw});
  return message;
}

TEST(TransformTreeTest, ConnectsFramesUpAndDown) {
  TransformTree tree;
  tree.add(transform("base", "mast", 1.0, M_PI / 2), true);
  tree.add(transform("mast", "camera", 2.0), true);
  tree.add(transform("base", "imu", 0.5), true);
  const auto T_base_camera = tree.between("base", "camera");
  ASSERT_TRUE(T_base_camera);
  EXPECT_TRUE(T_base_camera->translation().isApprox(Eigen::Vector3d(1, 2, 0), 1e-12));
  const auto T_imu_camera = tree.between("imu", "camera");
  EXPECT_TRUE(T_imu_camera->translation().isApprox(Eigen::Vector3d(0.5, 2, 0), 1e-12));
  EXPECT_TRUE((*T_imu_camera * *tree.between("camera", "imu")).isApprox(Pose::Identity(), 1e-12));
  EXPECT_FALSE(tree.between("base", "laser"));
  EXPECT_TRUE(tree.between("laser", "laser"));
  EXPECT_TRUE(tree.contains("base") && tree.contains("imu"));
  EXPECT_FALSE(tree.contains("laser"));
}

TEST(TransformTreeTest, StaticTransformsReplaceMovingOnes) {
  TransformTree tree;
  tree.add(transform("base", "camera", 1.0), false);
  tree.add(transform("base", "camera", 2.0), false);
  EXPECT_EQ(1.0, tree.between("base", "camera")->translation().x()) << "the first one is kept";
  tree.add(transform("base", "camera", 3.0), true);
  tree.add(transform("base", "camera", 4.0), false);
  EXPECT_EQ(3.0, tree.between("base", "camera")->translation().x());
}

TEST(TransformTreeTest, CyclesEnd) {
  TransformTree tree;
  tree.add(transform("a", "b", 1.0), true);
  tree.add(transform("b", "a", 1.0), true);
  EXPECT_TRUE(tree.between("a", "b"));
  EXPECT_FALSE(tree.between("c", "b"));
}

}  // namespace
}  // namespace headway::bags
