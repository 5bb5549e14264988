// SPDX-License-Identifier: BSD-3-Clause
#include "moving_object_finder.h"

#include <gmock/gmock.h>

#include "grid.h"

namespace headway::detect {
namespace {

using ::testing::ElementsAre;

const Eigen::Vector3d kVelocityAcross(2.0, 0.0, 0.0);  // [m/s]

/// A frame of a standing camera, with fitted points.
struct Frame : test::Grid {
  CameraPath path{camera, 0.5};
  cv::Mat image = cv::Mat::zeros(disparity.values.size(), CV_8U);
  std::optional<stereo::GroundPlane> plane = ground;
  Eigen::Vector3d up = ground.up;
  std::vector<PointTrack> points;
  std::vector<PointClass> classes;
  std::vector<SegmentTrack> segments;
  MovingObjectFinder finder{camera, {}};

  Frame() { path.advance(0.0, Pose::Identity()); }

  /// A row of points 1 m above the ground.
  void addPoints(double x, double depth, int count, PointClass point_class,
                 const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero()) {
    for (int i = 0; i < count; ++i) {
      PointMotion motion;
      motion.point = motion.static_point =
          Eigen::Vector3d(x + 0.1 * i, ground.camera_height - 1.0, depth);
      motion.velocity = velocity;
      motion.velocity_covariance = 0.01 * Eigen::Matrix3d::Identity();
      motion.observations = 5;
      PointTrack track;
      track.observations.push_back({0, *project(motion.point, camera)});
      track.motion = motion;
      points.push_back(track);
      classes.push_back(point_class);
    }
  }

  std::vector<MovingObject> find() {
    return finder.find({path, image, disparity, plane, up, points, classes, 1.0}, segments);
  }
};

TEST(MovingObjectFinderTest, PointsThatMoveOnASurfaceAreAnObject) {
  Frame frame;
  frame.draw(0.0, 10.0, 1.6, 0.2, 1.5);
  frame.addPoints(-0.2, 10.0, 4, PointClass::kMoving, kVelocityAcross);
  const auto objects = frame.find();
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_TRUE(objects[0].evidence.motion);
  EXPECT_THAT(objects[0].members, ElementsAre(0u, 1u, 2u, 3u));
  EXPECT_LT((objects[0].velocity.value - kVelocityAcross).norm(), 1e-6);
  EXPECT_NEAR(objects[0].extent.surface.z(), 10.0, 0.5);
  EXPECT_EQ(frame.finder.takeImplausible(), 0u);
}

TEST(MovingObjectFinderTest, WithoutAGroundPlaneTheFloorIsAssumedBelowThePoints) {
  Frame frame;
  frame.plane.reset();
  frame.draw(0.0, 10.0, 1.6, 0.2, 1.5);
  frame.addPoints(-0.2, 10.0, 4, PointClass::kMoving, kVelocityAcross);
  EXPECT_EQ(frame.find().size(), 1u);
}

TEST(MovingObjectFinderTest, PointsWithoutASurfaceAreImplausibleAndCountedOnce) {
  Frame frame;
  frame.addPoints(-0.2, 10.0, 4, PointClass::kMoving, kVelocityAcross);
  EXPECT_TRUE(frame.find().empty());
  EXPECT_EQ(frame.finder.takeImplausible(), 1u);
  EXPECT_EQ(frame.finder.takeImplausible(), 0u);
}

TEST(MovingObjectFinderTest, SlowPointsAreStatic) {
  Frame frame;
  frame.draw(0.0, 10.0, 1.6, 0.2, 1.5);
  frame.addPoints(-0.2, 10.0, 4, PointClass::kMoving, {0.3, 0.0, 0.0});
  EXPECT_TRUE(frame.find().empty());
  EXPECT_EQ(frame.finder.takeImplausible(), 0u);
}

TEST(MovingObjectFinderTest, AMinorityOfMovingPointsOnASurfaceIsAMismatch) {
  Frame frame;
  frame.draw(0.0, 10.0, 1.6, 0.2, 1.5);
  frame.addPoints(-0.2, 10.0, 4, PointClass::kMoving, kVelocityAcross);
  frame.addPoints(-0.5, 10.0, 8, PointClass::kStatic);
  EXPECT_TRUE(frame.find().empty());
  EXPECT_EQ(frame.finder.takeImplausible(), 1u);
}

TEST(MovingObjectFinderTest, TooFewPointsAreNoObject) {
  Frame frame;
  frame.draw(0.0, 10.0, 1.6, 0.2, 1.5);
  frame.addPoints(-0.2, 10.0, 2, PointClass::kMoving, kVelocityAcross);
  EXPECT_TRUE(frame.find().empty());
}

}  // namespace
}  // namespace headway::detect
