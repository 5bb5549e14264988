// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "actor_mesh.h"
#include "frame_finisher.h"
#include "mesh_projection.h"

namespace headway::sim {
namespace {

StereoCamera testCamera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 160;
  camera.fx = camera.fy = 200.0;
  camera.cx = 159.5;
  camera.cy = 79.5;
  camera.baseline_m = 0.5;
  camera.T_robot_cam.translation() = Eigen::Vector3d(0, 0, 1.5);
  return camera;
}

Actor carAt(double x, double y) {
  Actor car;
  car.id = 7;
  car.size = {4.2, 1.8, 1.5};
  car.position = {x, y, 0.0};
  return car;
}

/// Depth picture of the actors' rear faces.
cv::Mat depthOf(const std::vector<Actor>& actors) {
  cv::Mat depth(160, 320, CV_32F, cv::Scalar(0)), instances;
  for (const Actor& actor : actors) {
    const double near = actor.position.x() - 0.5 * actor.size.x();
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        const double y = -(u - 159.5) / 200.0 * near, z = 1.5 - (v - 79.5) / 200.0 * near;
        if (std::abs(y - actor.position.y()) < 0.5 * actor.size.y() && z > 0 &&
            z < actor.size.z()) {
          depth.at<float>(v, u) = static_cast<float>(near);
        }
      }
    }
  }
  return depth;
}

std::vector<Observation> observationsOf(const std::vector<Actor>& actors, const cv::Mat& depth,
                                        cv::Mat& instances) {
  const auto meshes = actorMeshes(actors, Eigen::Vector3d::Zero());
  return observeActors(Pose::Identity(), testCamera(), actors, meshes, depth, instances);
}

TEST(VisibilityTest, BoxSurroundsTheProjectedTruthBox) {
  cv::Mat instances;
  const std::vector<Actor> actors{carAt(20.0, 1.0)};
  const auto observations = observationsOf(actors, depthOf(actors), instances);
  ASSERT_EQ(observations.size(), 1U);
  // The rear face, 17.9 m away, spans y in [0.1, 1.9] and z in [0, 1.5].
  const Box2d& box = observations[0].box;
  EXPECT_NEAR(box.left, 159.5 - 200.0 * 1.9 / 17.9, 1.0);
  EXPECT_NEAR(box.right, 159.5 - 200.0 * 0.1 / 22.1, 1.0);
  EXPECT_NEAR(box.bottom, 79.5 + 200.0 * 1.5 / 17.9, 1.5);
  EXPECT_NEAR(observations[0].box3d.centre.z(), 20.0, 1e-9);
  EXPECT_NEAR(observations[0].box3d.yaw, -M_PI / 2, 1e-9);
  EXPECT_DOUBLE_EQ(observations[0].truncation, 0.0);
}

TEST(VisibilityTest, AWallInFrontHidesAnActor) {
  cv::Mat instances;
  const std::vector<Actor> actors{carAt(20.0, 1.0)};
  const cv::Mat wall(160, 320, CV_32F, cv::Scalar(5.0));
  const auto observations = observationsOf(actors, wall, instances);
  ASSERT_EQ(observations.size(), 1U);
  EXPECT_DOUBLE_EQ(observations[0].visible, 0.0);
  EXPECT_EQ(cv::countNonZero(instances), 0);
}

TEST(VisibilityTest, WhatIsBehindTheCameraOrBesideTheImageIsNotSeen) {
  cv::Mat instances;
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(0));
  EXPECT_TRUE(observationsOf({carAt(-10, 0), carAt(10, 40)}, depth, instances).empty());
}

TEST(VisibilityTest, AnActorAtTheEdgeIsTruncated) {
  cv::Mat instances;
  const std::vector<Actor> actors{carAt(10.0, 7.0)};
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(0));
  const auto observations = observationsOf(actors, depth, instances);
  ASSERT_EQ(observations.size(), 1U);
  EXPECT_GT(observations[0].truncation, 0.1);
  EXPECT_GE(observations[0].box.left, 0.0);
}

DetectorParams withoutMistakes() {
  DetectorParams params;
  params.position_sigma_m = params.depth_sigma_m = params.size_sigma = params.yaw_sigma_rad = 0.0;
  params.box_sigma_px = params.miss_near = params.miss_far = params.miss_occluded = 0.0;
  params.duplicate_probability = params.false_per_frame = params.flip_probability = 0.0;
  params.id_switch_probability = 0.0;
  return params;
}

Observation seenAt(double z, double visible) {
  Observation observation;
  observation.box = {100, 50, 150, 110};
  observation.visible = visible;
  observation.visible_pixels = visible > 0 ? 500 : 0;
  observation.box3d.centre = {0.0, 0.5, z};
  observation.box3d.length = 4.2;
  observation.box3d.width = 1.8;
  observation.box3d.height = 1.5;
  return observation;
}

/// Ratio of 4000 images in which a car is found.
double foundRatio(const DetectorParams& params, double z, double visible) {
  SimulatedDetector detector(params, testCamera(), 3);
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(20.0));
  int found = 0;
  for (int i = 0; i < 4000; ++i) {
    found += static_cast<int>(
        detector.detect(i, {carAt(z, 0)}, {seenAt(z, visible)}, depth).items.size());
  }
  return found / 4000.0;
}

TEST(SimulatedDetectorTest, WithoutMistakesItTellsTheTruth) {
  SimulatedDetector detector(withoutMistakes(), testCamera(), 1);
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(20.0));
  for (int i = 0; i < 50; ++i) {
    const auto detections = detector.detect(i, {carAt(20, 0)}, {seenAt(20, 1.0)}, depth);
    ASSERT_EQ(detections.items.size(), 1U);
    const Detection& detection = detections.items[0];
    EXPECT_LT((detection.box3d->centre - Eigen::Vector3d(0, 0.5, 20)).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(detection.box2d->left, 100.0);
    EXPECT_EQ(detection.detector_id, 1);
    EXPECT_EQ(detection.object_class, ObjectClass::kCar);
  }
}

TEST(SimulatedDetectorTest, MissesGrowWithDepthAndOcclusion) {
  DetectorParams params = withoutMistakes();
  params.miss_near = 0.05;
  params.miss_far = 0.5;
  params.miss_occluded = 1.0;
  params.max_range_m = 60.0;
  const double near = foundRatio(params, 8.0, 1.0), far = foundRatio(params, 55.0, 1.0);
  EXPECT_NEAR(near, 0.95, 0.03);
  EXPECT_NEAR(far, 0.55, 0.06);
  EXPECT_LT(foundRatio(params, 8.0, 0.2), near - 0.4);
  EXPECT_DOUBLE_EQ(foundRatio(params, 61.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(foundRatio(params, 8.0, 0.0), 0.0);
}

TEST(SimulatedDetectorTest, NoiseAlongTheRayGrowsWithDepth) {
  DetectorParams params = withoutMistakes();
  params.depth_sigma_m = 0.4;
  SimulatedDetector detector(params, testCamera(), 5);
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(20.0));
  for (const double z : {10.0, 60.0}) {
    double squares = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const auto detections = detector.detect(i, {carAt(z, 0)}, {seenAt(z, 1.0)}, depth);
      squares += std::pow(detections.items.at(0).box3d->centre.z() - z, 2);
    }
    EXPECT_NEAR(std::sqrt(squares / 2000), 0.4 * std::max(1.0, z / 20.0), 0.05 * z / 10.0);
  }
}

TEST(SimulatedDetectorTest, FlipsDoublesAndFalseBoxesComeAsOftenAsAsked) {
  DetectorParams params = withoutMistakes();
  params.flip_probability = 0.25;
  params.duplicate_probability = 0.4;
  params.false_per_frame = 1.5;
  params.id_switch_probability = 0.1;
  SimulatedDetector detector(params, testCamera(), 9);
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(20.0));
  int boxes = 0, flips = 0, switches = 0;
  std::int64_t last_id = -1;
  for (int i = 0; i < 4000; ++i) {
    const auto detections = detector.detect(i, {carAt(20, 0)}, {seenAt(20, 1.0)}, depth);
    boxes += static_cast<int>(detections.items.size());
    const Detection& first = detections.items.at(0);
    flips += std::abs(wrapAngle(first.box3d->yaw)) > 3.0 ? 1 : 0;
    switches += last_id >= 0 && first.detector_id != last_id ? 1 : 0;
    last_id = *first.detector_id;
    for (const Detection& detection : detections.items) {
      EXPECT_GE(detection.box2d->left, 0.0);
      EXPECT_LE(detection.box2d->right, 319.0);
      EXPECT_LT(detection.box2d->left, detection.box2d->right);
    }
  }
  EXPECT_NEAR(boxes / 4000.0, 1.0 + 0.4 + 1.5, 0.08);
  EXPECT_NEAR(flips / 4000.0, 0.25, 0.03);
  EXPECT_NEAR(switches / 4000.0, 0.1, 0.02);
}

TEST(SimulatedDetectorTest, CanGiveOneKindOfBoxAlone) {
  DetectorParams params = withoutMistakes();
  params.boxes_3d = false;
  SimulatedDetector detector(params, testCamera(), 1);
  const cv::Mat depth(160, 320, CV_32F, cv::Scalar(20.0));
  const auto detections = detector.detect(0, {carAt(20, 0)}, {seenAt(20, 1.0)}, depth);
  EXPECT_TRUE(detections.items.at(0).box2d);
  EXPECT_FALSE(detections.items.at(0).box3d);
}

}  // namespace
}  // namespace headway::sim
