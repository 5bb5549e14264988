// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/render/pinhole_view.h>

namespace headway::render {
namespace {

TEST(LookAtTest, CentresTheTargetWithUpUpwards) {
  const Eigen::Vector3d viewpoint(3.0, -2.0, 5.0);
  const Eigen::Vector3d target(10.0, 4.0, 1.0);
  const auto view = makeView(640, 480, 1.0, lookAt(viewpoint, target));
  const auto middle = project(target, view);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->x(), 319.5, 1e-9);
  EXPECT_NEAR(middle->y(), 239.5, 1e-9);
  const auto above = project(target + Eigen::Vector3d::UnitZ(), view);
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->x(), 319.5, 1e-9);
  EXPECT_LT(above->y(), 239.5);
}

TEST(LookAtTest, GivesARightHandedRotation) {
  const Pose pose = lookAt({0, 0, 2}, {5, 1, 0});
  EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE((pose.linear().transpose() * pose.linear()).isIdentity(1e-12));
}

TEST(LookAtTest, SupportsAVerticalViewWithAGivenUp) {
  const auto view =
      makeView(101, 101, 1.0, lookAt({0, 0, 10}, {0, 0, 0}, Eigen::Vector3d::UnitX()));
  const auto ahead = project({1, 0, 0}, view);
  const auto left = project({0, 1, 0}, view);
  ASSERT_TRUE(ahead && left);
  EXPECT_NEAR(ahead->x(), 50.0, 1e-9);
  EXPECT_LT(ahead->y(), 50.0);
  EXPECT_LT(left->x(), 50.0);
}

TEST(MakeViewTest, SpansTheFieldOfViewFromEdgeToEdge) {
  const auto view = makeView(200, 100, 1.2, Pose::Identity());
  const auto edge = project({std::tan(0.6), 0.0, 1.0}, view);
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->x(), 199.5, 1e-9);
}

TEST(ProjectTest, IsNoneOutsideTheDepthRange) {
  const auto view = makeView(200, 100, 1.2, Pose::Identity());
  EXPECT_TRUE(project({0, 0, 1}, view));
  EXPECT_FALSE(project({0, 0, 0.1}, view));
  EXPECT_FALSE(project({0, 0, 301}, view));
  EXPECT_FALSE(project({0, 0, -1}, view));
}

TEST(ProjectSegmentTest, ProjectsBothEndsInFront) {
  const auto view = makeView(200, 100, 1.2, Pose::Identity());
  const Eigen::Vector3d a(1, 2, 5), b(-1, 0.5, 9);
  const auto segment = projectSegment(a, b, view);
  ASSERT_TRUE(segment);
  EXPECT_TRUE(segment->first.isApprox(*project(a, view), 1e-9));
  EXPECT_TRUE(segment->second.isApprox(*project(b, view), 1e-9));
}

TEST(ProjectSegmentTest, ClipsThePartBehind) {
  const auto view = makeView(200, 100, 1.2, Pose::Identity());
  const auto segment = projectSegment({1, 0, -4}, {1, 0, 6}, view);
  ASSERT_TRUE(segment);
  EXPECT_TRUE(segment->first.isApprox(*project({1, 0, view.near_m}, view), 1e-9));
  EXPECT_TRUE(segment->second.isApprox(*project({1, 0, 6}, view), 1e-9));
}

TEST(ProjectSegmentTest, IsNoneOutsideTheDepthRange) {
  const auto view = makeView(200, 100, 1.2, Pose::Identity());
  EXPECT_FALSE(projectSegment({1, 0, -4}, {1, 0, -1}, view));
  EXPECT_FALSE(projectSegment({1, 0, -1}, {2, 0, -1}, view));
  EXPECT_FALSE(projectSegment({1, 0, 400}, {2, 0, 500}, view));
}

}  // namespace
}  // namespace headway::render
