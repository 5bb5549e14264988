// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "grid.h"
#include "moving_object_finder.h"

namespace headway::detect {
namespace {

const Eigen::Vector3d kForward(0.0, 0.0, 8.0);  // [m/s]

/// Objects that are seen from behind by a standing camera.
struct Pieces : test::Grid {
  CameraPath path{camera, 0.5};
  cv::Mat image = cv::Mat::zeros(disparity.values.size(), CV_8U);
  std::optional<stereo::GroundPlane> plane = ground;
  Eigen::Vector3d up = ground.up;
  std::vector<PointTrack> points;
  std::vector<PointClass> classes;
  std::vector<MovingObject> objects;

  Pieces() { path.advance(0.0, Pose::Identity()); }

  void add(double x, double width, double bottom, double top,
           const Eigen::Vector3d& velocity = kForward) {
    constexpr double kPieceDepth = 14.0;
    MovingObject object;
    object.velocity = {velocity, 0.04 * Eigen::Matrix3d::Identity()};
    object.evidence.motion = true;
    object.points = 5;
    object.members = {objects.size()};
    const auto cells = inSpace(draw(x, kPieceDepth, width, bottom, top));
    object.extent = *extentOf(cells, object.velocity, disparity, camera, ground);
    objects.push_back(std::move(object));
  }

  void join() {
    joinPieces({path, image, disparity, plane, up, points, classes, 1.0}, camera, objects);
  }
};

TEST(ObjectPiecesTest, ATruckFoundInThreePiecesIsOneTruck) {
  Pieces scene;
  scene.add(-0.5, 1.5, 0.3, 1.0);                    // lower left
  scene.add(0.9, 1.0, 0.3, 1.0, {0.2, 0.0, 8.2});    // lower right
  scene.add(0.1, 2.3, 1.05, 3.4, {-0.1, 0.0, 7.9});  // the box above
  scene.join();
  ASSERT_EQ(scene.objects.size(), 1u);
  const MovingObject& truck = scene.objects[0];
  EXPECT_EQ(truck.extent.object_class, ObjectClass::kTruck);
  EXPECT_NEAR(truck.extent.box.height, 3.4, 0.2);
  EXPECT_NEAR(truck.extent.box.width, 2.6, 0.2);
  EXPECT_EQ(truck.members.size(), 3u);
  EXPECT_EQ(truck.points, 15);
  EXPECT_LT((truck.velocity.value - kForward).norm(), 0.3);
  EXPECT_LT(truck.velocity.covariance(0, 0), 0.04);
}

TEST(ObjectPiecesTest, VehiclesAtDifferentSpeedsAreTwo) {
  Pieces scene;
  scene.add(-0.8, 1.7, 0.3, 1.5);
  scene.add(0.9, 1.6, 0.3, 1.5, {0.0, 0.0, 10.5});
  scene.join();
  EXPECT_EQ(scene.objects.size(), 2u);
}

TEST(ObjectPiecesTest, VehiclesWithAGapAreTwo) {
  Pieces scene;
  scene.add(-1.0, 1.7, 0.3, 1.5);
  scene.add(1.6, 1.7, 0.3, 1.5);
  scene.join();
  EXPECT_EQ(scene.objects.size(), 2u);
}

TEST(ObjectPiecesTest, WhatIsWiderThanAVehicleIsTwo) {
  Pieces scene;
  scene.add(-1.4, 2.0, 0.3, 1.5);
  scene.add(0.8, 2.0, 0.3, 1.5);
  scene.join();
  EXPECT_EQ(scene.objects.size(), 2u);
}

TEST(ObjectPiecesTest, PeopleBesideEachOtherStayTwo) {
  Pieces scene;
  const Eigen::Vector3d walk(0.0, 0.0, 1.4);
  scene.add(0.0, 1.5, 0.2, 1.7, walk);  // two of them, found as one
  scene.add(1.1, 0.5, 0.2, 1.7, walk);
  scene.join();
  EXPECT_EQ(scene.objects.size(), 2u);
}

TEST(ObjectPiecesTest, OnlyWhatWasFoundByItsMotionIsJoined) {
  Pieces scene;
  scene.add(-0.5, 1.5, 0.3, 1.6);
  scene.add(0.9, 1.0, 0.3, 1.8);
  scene.objects[1].evidence = {};
  scene.join();
  EXPECT_EQ(scene.objects.size(), 2u);
}

}  // namespace
}  // namespace headway::detect
