// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/rectification.h>

#include <random>

#include "bundle_adjustment.h"
#include "sparse_map.h"
#include "test_camera.h"

namespace headway::slam {
namespace {

constexpr double kTurnDegree = M_PI / 180.0;

/// A camera that moves ahead by 0.8 m a keyframe, whose right camera is turned while the map takes
/// it for exact.
struct TurnedWorld {
  SparseMap map;
  std::vector<KeyframeId> keyframes;
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;  ///< true ones

  explicit TurnedWorld(const Eigen::Vector3d& turn) {
    const StereoCamera camera = testCamera();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> x(-15.0, 15.0), y(-4.0, 2.0), z(5.0, 60.0);
    std::normal_distribution<double> noise(0.0, 0.05);
    for (int i = 0; i < 8; ++i) keyframes.push_back(map.addKeyframe(i, 0.1 * i, pose(i)).id);
    for (int n = 0; n < 400; ++n) {
      const Eigen::Vector3d point(x(random), y(random), z(random));
      LandmarkId id;
      for (std::size_t i = 0; i < keyframes.size(); ++i) {
        const auto uvd = project(pose(static_cast<int>(i)).inverse() * point, camera);
        if (!uvd || uvd->x() < 0 || uvd->x() > 640 || uvd->y() < 0 || uvd->y() > 480) continue;
        const Eigen::Vector2d right =
            stereo::turnedPixel({uvd->x() - uvd->z(), uvd->y()}, turn, camera);
        const double disparity = uvd->x() - right.x() + noise(random);
        if (disparity < 0.5) continue;
        const stereo::StereoMeasurement seen{uvd->head<2>(), disparity, true, 0.5, 0.3};
        if (id.valid()) {
          map.observe(keyframes[i], id, seen);
        } else {
          const auto in_cam = triangulate({uvd->x(), uvd->y(), disparity}, camera).value();
          id = map.addLandmark(pose(static_cast<int>(i)) * in_cam, keyframes[i], seen).id;
        }
      }
      if (id.valid()) points.emplace_back(id, point);
    }
  }

  static Pose pose(int i) {
    Pose pose = Pose::Identity();
    pose.translation().z() = 0.8 * i;
    return pose;
  }

  /// Median error of the landmarks by their depth.
  [[nodiscard]] double error() const {
    std::vector<double> errors;
    for (const auto& [id, point] : points) {
      errors.push_back((map.find(id)->position - point).norm() / point.z());
    }
    std::nth_element(errors.begin(), errors.begin() + 200, errors.end());
    return errors[200];
  }
};

TEST(TurnRightCameraTest, PutsLandmarksWhereTheTurnedCameraSawThem) {
  const Eigen::Vector3d turn(0.0, 0.3 * kTurnDegree, 0.1 * kTurnDegree);
  TurnedWorld world(turn);
  world.map.setDisparityOffset(0.4);
  const double before = world.error();
  turnRightCamera(turn, testCamera(), world.map);
  EXPECT_GT(before, 0.1);
  EXPECT_LT(world.error(), 0.01);
  EXPECT_EQ(world.map.rightTurn(), turn);
  EXPECT_EQ(world.map.disparityOffset(), 0.0) << "it was a part of the yaw";
}

TEST(TurnRightCameraTest, IsUndoneByTheTurnBack) {
  TurnedWorld world({0.0, 0.2 * kTurnDegree, 0.0});
  std::vector<Eigen::Vector3d> positions;
  for (const auto& [id, landmark] : world.map.landmarks()) positions.push_back(landmark.position);
  turnRightCamera({0.001, 0.002, -0.001}, testCamera(), world.map);
  turnRightCamera(Eigen::Vector3d::Zero(), testCamera(), world.map);
  std::size_t i = 0;
  for (const auto& [id, landmark] : world.map.landmarks()) {
    EXPECT_LT((landmark.position - positions[i]).norm(), 1e-3 * positions[i].norm());
    ++i;
  }
}

TEST(TurnRightCameraTest, TheScaleOfEachWayFollowsTheAdjustment) {
  SparseMap map;
  std::map<KeyframeId, Pose> before;
  const double now[] = {0.0, 1.0, 3.0, 3.6};
  for (int i = 0; i < 4; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = now[i];
    const KeyframeId id = map.addKeyframe(static_cast<std::size_t>(i), 0.1 * i, pose).id;
    pose.translation().x() = 0.8 * i;
    before[id] = pose;
  }
  const auto ratios = scaleChanges(before, map);
  ASSERT_EQ(ratios.size(), 4U);
  EXPECT_DOUBLE_EQ(ratios.at(KeyframeId{0}), 1.0 / 0.8);
  EXPECT_DOUBLE_EQ(ratios.at(KeyframeId{1}), 2.0) << "bounded";
  EXPECT_NEAR(ratios.at(KeyframeId{2}), 0.6 / 0.8, 1e-12);
  EXPECT_EQ(ratios.at(KeyframeId{3}), ratios.at(KeyframeId{2})) << "no next one";
}

TEST(TurnRightCameraTest, PitchAndRollKeepTheOffset) {
  TurnedWorld world(Eigen::Vector3d::Zero());
  world.map.setDisparityOffset(0.25);
  turnRightCamera({0.001, 0.0, 0.002}, testCamera(), world.map);
  EXPECT_EQ(world.map.disparityOffset(), 0.25);
}

}  // namespace
}  // namespace headway::slam
