// SPDX-License-Identifier: BSD-3-Clause
// How a drawn frame becomes a recorded one: truth, masks, detections.
#include "frame_finisher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "actor_mesh.h"
#include "mesh_projection.h"

namespace headway::sim {
namespace {

SimParams smallCamera() {
  SimParams params;
  params.camera.width = 320;
  params.camera.height = 160;
  params.camera.focal_px = 200.0;
  params.camera.noise_grey = params.camera.gain_difference = params.camera.vignetting = 0.0;
  params.detector.miss_near = params.detector.miss_far = 0.0;
  params.detector.false_per_frame = params.detector.duplicate_probability = 0.0;
  return params;
}

Actor carAt(double x, double y, std::int64_t id) {
  Actor car;
  car.id = id;
  car.size = {4.2, 1.8, 1.5};
  car.position = {x, y, 0.0};
  return car;
}

/// A frame in which each actor's mesh is drawn into the depth, over a wall 60 m away.
DrawnFrame drawn(const SimParams& params, const Pose& T_world_robot, std::vector<Actor> actors) {
  const Lens lens(params.camera);
  DrawnFrame frame;
  frame.actors = std::move(actors);
  frame.meshes = actorMeshes(frame.actors, T_world_robot.translation());
  frame.T_world_robot = T_world_robot;
  const cv::Size size(lens.drawn().width, lens.drawn().height);
  frame.left = cv::Mat(size, CV_8UC3, cv::Scalar(40, 80, 120));
  frame.right = frame.left.clone();
  frame.depth = cv::Mat(size, CV_32F, cv::Scalar(60.0));
  for (const Mesh& mesh : frame.meshes) {
    Pose T_origin_cam = T_world_robot * lens.drawn().T_robot_cam;
    T_origin_cam.translation() -= T_world_robot.translation();
    const auto triangles = projectMesh(mesh, T_origin_cam.inverse().cast<float>(), lens.drawn());
    MeshDepth alone(size);
    const cv::Mat body = alone.draw(triangles, cv::Rect({}, size));
    cv::min(frame.depth, body, frame.depth);
  }
  return frame;
}

TEST(OcclusionLevelTest, HasKittisFourLevels) {
  EXPECT_EQ(occlusionLevel(1.0), 0);
  EXPECT_EQ(occlusionLevel(0.8), 0);
  EXPECT_EQ(occlusionLevel(0.79), 1);
  EXPECT_EQ(occlusionLevel(0.4), 1);
  EXPECT_EQ(occlusionLevel(0.39), 2);
  EXPECT_EQ(occlusionLevel(0.1), 2);
  EXPECT_EQ(occlusionLevel(0.05), 3);
  EXPECT_EQ(occlusionLevel(0.0), 3);
}

TEST(DynamicMaskTest, MarksAllThatIsNotParked) {
  SimFrame frame;
  frame.objects.resize(2);
  frame.objects[0].parked = true;
  frame.instances = cv::Mat::zeros(4, 6, CV_16U);
  frame.instances.at<std::uint16_t>(1, 2) = 1;  // parked
  frame.instances.at<std::uint16_t>(2, 3) = 2;  // moving
  const cv::Mat mask = dynamicMask(frame);
  EXPECT_EQ(mask.type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(mask), 1);
  EXPECT_EQ(mask.at<std::uint8_t>(2, 3), 255);
}

TEST(FrameFinisherTest, TruthIsInTheFrameOfTheFirstPose) {
  const SimParams params = smallCamera();
  const Lens lens(params.camera);
  FrameFinisher finisher(params, lens, 1, 2);
  Pose first = Pose::Identity();
  first.translation() = Eigen::Vector3d(100.0, 50.0, 0.0);
  first.linear() = expSo3({0.0, 0.0, M_PI / 2});
  Actor car = carAt(100.0, 70.0, 7);  // 20 m ahead
  car.yaw = M_PI / 2;
  car.velocity = {0.0, 5.0};
  const SimFrame frame = finisher.finish(drawn(params, first, {car}));
  EXPECT_LT((frame.T_map_robot.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-9);
  ASSERT_EQ(frame.objects.size(), 1U);
  const TruthObject& object = frame.objects[0];
  EXPECT_EQ(object.id, 7);
  EXPECT_EQ(object.object_class, ObjectClass::kCar);
  EXPECT_LT((object.position - Eigen::Vector3d(20.0, 0.0, 0.75)).norm(), 1e-9);
  EXPECT_LT((object.velocity - Eigen::Vector3d(5.0, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_NEAR(object.yaw, 0.0, 1e-9);
  EXPECT_NEAR(object.visible, 1.0, 0.02);
  EXPECT_EQ(object.occlusion, 0);

  Pose second = first;
  second.translation().y() += 3.0;
  const SimFrame next = finisher.finish(drawn(params, second, {car}));
  EXPECT_LT((next.T_map_robot.translation() - Eigen::Vector3d(3.0, 0, 0)).norm(), 1e-9);
  EXPECT_LT((next.objects.at(0).position - object.position).norm(), 1e-9) << "it stands there";
  EXPECT_NEAR(next.objects[0].box3d.centre.z(), 17.0, 1e-9);
}

TEST(FrameFinisherTest, DropsAreTurnedIntoTheMap) {
  const SimParams params = smallCamera();
  const Lens lens(params.camera);
  FrameFinisher finisher(params, lens, 1, 2);
  Pose first = Pose::Identity();
  first.translation() = Eigen::Vector3d(10.0, 0.0, 0.0);
  first.linear() = expSo3({0.0, 0.0, M_PI});
  DrawnFrame frame = drawn(params, first, {});
  frame.frame.drops.push_back({{{12.0, 1.0}, {13.0, 1.0}, {13.0, 2.0}}, 1.5});
  const SimFrame finished = finisher.finish(std::move(frame));
  ASSERT_EQ(finished.drops.size(), 1U);
  EXPECT_LT((finished.drops[0].outline[0] - Eigen::Vector2d(-2.0, -1.0)).norm(), 1e-9);
  EXPECT_LT((finished.drops[0].outline[2] - Eigen::Vector2d(-3.0, -2.0)).norm(), 1e-9);
  EXPECT_EQ(finished.drops[0].depth_m, 1.5);
}

TEST(FrameFinisherTest, InstancesCountTheTruthsObjectsAndAgreeWithTheDepth) {
  const SimParams params = smallCamera();
  const Lens lens(params.camera);
  FrameFinisher finisher(params, lens, 1, 2);
  const std::vector<Actor> actors = {carAt(25.0, 6.0, 3), carAt(95.0, 0.0, 4),
                                     carAt(15.0, -2.0, 5)};
  const SimFrame frame = finisher.finish(drawn(params, Pose::Identity(), actors));
  ASSERT_EQ(frame.objects.size(), 2U) << "one is beyond the truth's range";
  double highest = 0.0;
  cv::minMaxLoc(frame.instances, nullptr, &highest);
  EXPECT_EQ(highest, 2.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const TruthObject& object = frame.objects[i];
    const cv::Mat pixels = frame.instances == static_cast<int>(i) + 1;
    const double area = cv::countNonZero(pixels);
    EXPECT_GT(area, 0.5 * object.box2d.width() * object.box2d.height());
    EXPECT_LT(area, 1.1 * object.box2d.width() * object.box2d.height());
    double nearest = 0.0, farthest = 0.0;
    cv::minMaxLoc(frame.depth, &nearest, &farthest, nullptr, nullptr, pixels);
    EXPECT_GT(nearest, object.box3d.centre.z() - 2.2);
    EXPECT_LT(farthest, object.box3d.centre.z() + 2.2);
  }
}

TEST(FrameFinisherTest, WhatHidesAnotherTakesItsPixels) {
  const SimParams params = smallCamera();
  const Lens lens(params.camera);
  FrameFinisher finisher(params, lens, 1, 2);
  // Of two cars one behind the other the farther is largely hidden.
  const SimFrame frame =
      finisher.finish(drawn(params, Pose::Identity(), {carAt(12.0, 0.0, 1), carAt(30.0, 0.0, 2)}));
  ASSERT_EQ(frame.objects.size(), 2U);
  EXPECT_NEAR(frame.objects[0].visible, 1.0, 0.02);
  EXPECT_LT(frame.objects[1].visible, 0.5);
  EXPECT_GE(frame.objects[1].occlusion, 1);
}

TEST(FrameFinisherTest, AParkedVehicleThatIsHiddenIsNoTruthButAMovingOneIs) {
  const SimParams params = smallCamera();
  const Lens lens(params.camera);
  FrameFinisher finisher(params, lens, 1, 2);
  for (const bool parked : {true, false}) {
    Actor hidden = carAt(30.0, 0.0, 2);
    hidden.parked = parked;
    DrawnFrame frame = drawn(params, Pose::Identity(), {hidden});
    frame.depth.setTo(5.0);  // a wall
    EXPECT_EQ(finisher.finish(std::move(frame)).objects.size(), parked ? 0U : 1U);
  }
}

TEST(FrameFinisherTest, WithADistortingLensBoxesFollowTheRecordedImage) {
  SimParams params = smallCamera();
  const Actor car = carAt(9.0, 4.5, 1);  // far from the image's middle
  const Lens straight(params.camera);
  FrameFinisher plain(params, straight, 1, 2);
  const Box2d undistorted =
      plain.finish(drawn(params, Pose::Identity(), {car})).objects.at(0).box2d;
  params.camera.k1 = -0.12;
  const Lens bent(params.camera);
  FrameFinisher finisher(params, bent, 1, 2);
  const SimFrame frame = finisher.finish(drawn(params, Pose::Identity(), {car}));
  EXPECT_EQ(frame.depth.size(), cv::Size(320, 160));
  EXPECT_EQ(frame.left.size(), cv::Size(320, 160));
  const Box2d& box = frame.objects.at(0).box2d;
  EXPECT_GT(box.left, undistorted.left + 1.0) << "barrel: towards the middle";
  std::vector<cv::Point> pixels;
  cv::findNonZero(frame.instances == 1, pixels);
  for (const cv::Point& pixel : pixels) {
    EXPECT_GT(pixel.x, box.left - 1.5);
    EXPECT_LT(pixel.x, box.right + 1.5);
    EXPECT_GT(pixel.y, box.top - 1.5);
    EXPECT_LT(pixel.y, box.bottom + 1.5);
  }
}

}  // namespace
}  // namespace headway::sim
