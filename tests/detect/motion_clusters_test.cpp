// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "drive.h"
#include "moving_object_finder.h"

namespace headway::detect {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kUp;

/// Points in front of a camera that stands, each with its fitted motion and class.
struct Points {
  StereoCamera camera = test::testCamera();
  CameraPath path{camera, 0.5};
  std::vector<PointTrack> tracks;
  std::vector<PointClass> classes;

  Points() { path.advance(0.0, Pose::Identity()); }

  void add(const Eigen::Vector3d& place, const Eigen::Vector3d& velocity,
           PointClass point_class = PointClass::kMoving, double sigma = 0.1) {
    PointTrack track;
    track.id = static_cast<std::int64_t>(tracks.size());
    track.observations.push_back({0, *project(place, camera)});
    PointMotion motion;
    motion.point = motion.static_point = place;
    motion.velocity = velocity;
    motion.velocity_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    motion.observations = 5;
    track.motion = motion;
    tracks.push_back(track);
    classes.push_back(point_class);
  }

  /// A group of points that move alike.
  void addObject(double x, double depth, const Eigen::Vector3d& velocity, int count = 4) {
    for (int i = 0; i < count; ++i) add({x + 0.2 * i, 0.5 - 0.3 * i, depth}, velocity);
  }

  [[nodiscard]] std::vector<MotionCluster> clusters() const {
    return clusterMotion(tracks, classes, path, kUp, {});
  }
  [[nodiscard]] double ratioIn(const Box2d& outline, double nearest, double farthest) const {
    return movingRatio(tracks, classes, path, outline, nearest, farthest);
  }
};

TEST(ClusterMotionTest, PointsThatAreNearAndMoveAlikeAreOneCluster) {
  Points points;
  points.addObject(0.0, 10.0, {1.5, 0.0, 0.0});
  const auto clusters = points.clusters();
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_THAT(clusters[0].members, ElementsAre(0u, 1u, 2u, 3u));
  EXPECT_LT((clusters[0].velocity - Eigen::Vector3d(1.5, 0.0, 0.0)).norm(), 1e-6);
}

TEST(ClusterMotionTest, PointsFarApartAreTwo) {
  Points points;
  points.addObject(0.0, 10.0, {1.5, 0.0, 0.0});
  points.addObject(4.0, 10.0, {1.5, 0.0, 0.0});
  EXPECT_EQ(points.clusters().size(), 2u);
}

TEST(ClusterMotionTest, OppositeVelocitiesAreTwo) {
  Points points;
  points.addObject(0.0, 10.0, {1.5, 0.0, 0.0});
  points.addObject(0.1, 10.0, {-1.5, 0.0, 0.0});
  EXPECT_EQ(points.clusters().size(), 2u);
}

TEST(ClusterMotionTest, AChainOfNeighboursIsOne) {
  Points points;
  for (int i = 0; i < 6; ++i) points.add({0.9 * i, 0.5, 10.0}, {5.0, 0.0, 0.0});
  ASSERT_EQ(points.clusters().size(), 1u);
  EXPECT_EQ(points.clusters()[0].members.size(), 6u);
}

TEST(ClusterMotionTest, TooFewPointsAreNone) {
  Points points;
  points.addObject(0.0, 10.0, {1.5, 0.0, 0.0}, 2);
  EXPECT_THAT(points.clusters(), IsEmpty());
  EXPECT_THAT(Points().clusters(), IsEmpty());
}

TEST(ClusterMotionTest, OnlyMovingPointsAreClustered) {
  Points points;
  points.addObject(0.0, 10.0, {1.5, 0.0, 0.0});
  points.add({0.1, 0.5, 10.0}, {1.5, 0.0, 0.0}, PointClass::kUnknown);
  points.add({0.1, 0.4, 10.0}, {1.5, 0.0, 0.0}, PointClass::kStatic);
  ASSERT_EQ(points.clusters().size(), 1u);
  EXPECT_EQ(points.clusters()[0].members.size(), 4u);
}

TEST(ClusterMotionTest, BetterMeasuredPointsWeighMoreAndHeightDoesNotCount) {
  Points points;
  points.add({0.0, 0.5, 10.0}, {1.0, 0.4, 0.0}, PointClass::kMoving, 0.05);
  points.add({0.2, 0.5, 10.0}, {1.0, 0.4, 0.0}, PointClass::kMoving, 0.05);
  points.add({0.4, 0.5, 10.0}, {2.0, 0.4, 0.0}, PointClass::kMoving, 2.0);
  const auto clusters = points.clusters();
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_NEAR(clusters[0].velocity.x(), 1.0, 0.05);
  EXPECT_NEAR(clusters[0].velocity.y(), 0.0, 1e-9) << "over the ground";
  EXPECT_LT(clusters[0].velocity_covariance(0, 0), 0.05);
}

TEST(MovingRatioTest, CountsClassifiedPointsInsideTheOutlineAtItsDepth) {
  Points points;
  const Box2d everywhere{0.0, 0.0, 1240.0, 376.0};
  EXPECT_EQ(points.ratioIn(everywhere, 9.0, 11.0), 1.0) << "no point was classified";
  points.add({0.0, 0.5, 10.0}, {1.5, 0.0, 0.0});
  points.add({0.1, 0.5, 10.0}, {0.0, 0.0, 0.0}, PointClass::kStatic);
  points.add({0.2, 0.5, 10.0}, {0.0, 0.0, 0.0}, PointClass::kUnknown);
  EXPECT_EQ(points.ratioIn(everywhere, 9.5, 10.5), 0.5);
  points.add({0.1, 0.5, 20.0}, {0.0, 0.0, 0.0}, PointClass::kStatic);
  EXPECT_EQ(points.ratioIn(everywhere, 9.5, 10.5), 0.5) << "background";
  points.add({-5.0, 0.5, 10.0}, {0.0, 0.0, 0.0}, PointClass::kStatic);
  EXPECT_EQ(points.ratioIn({500.0, 0.0, 740.0, 376.0}, 9.5, 10.5), 0.5) << "beside the outline";
  EXPECT_NEAR(points.ratioIn(everywhere, 9.5, 10.5), 1.0 / 3.0, 1e-9);
}

}  // namespace
}  // namespace headway::detect
