// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <thread>

#include "test_camera.h"

namespace headway::slam {
namespace {

struct World {
  SparseMap map;
  std::vector<Pose> poses;                       ///< true ones, by keyframe
  std::map<LandmarkId, Eigen::Vector3d> points;  ///< true ones
  std::vector<KeyframeId> keyframes;
};

Pose posed(int i) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.02 * i, 0.01 * i});
  pose.translation() << 0.1 * i, 0.02 * i, 0.8 * i;
  return pose;
}

/// Keyframes along a road that see random points; disparities are too great by an offset.
World makeWorld(int keyframes, double offset_px) {
  const StereoCamera camera = testCamera();
  World world;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> x(-15.0, 15.0), y(-4.0, 2.0), z(4.0, 60.0);
  for (int i = 0; i < keyframes; ++i) {
    world.poses.push_back(posed(i));
    world.keyframes.push_back(world.map.addKeyframe(i, 0.1 * i, posed(i)).id);
  }
  for (int n = 0; n < 400; ++n) {
    const Eigen::Vector3d point(x(random), y(random), z(random));
    LandmarkId id;
    for (int i = 0; i < keyframes; ++i) {
      const auto uvd = project(posed(i).inverse() * point, camera);
      if (!uvd || uvd->x() < 0 || uvd->x() > 640 || uvd->y() < 0 || uvd->y() > 480) continue;
      const stereo::StereoMeasurement measurement{
          uvd->head<2>() + 0.1 * Eigen::Vector2d(noise(random), noise(random)),
          uvd->z() + offset_px + 0.1 * noise(random), true, 0.1, 0.1};
      if (!id.valid()) {
        id = world.map.addLandmark(point, world.keyframes[static_cast<std::size_t>(i)], measurement)
                 .id;
      } else {
        world.map.observe(world.keyframes[static_cast<std::size_t>(i)], id, measurement);
      }
    }
    if (id.valid()) world.points[id] = point;
  }
  return world;
}

void disturb(World& world) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (std::size_t i = 1; i < world.keyframes.size(); ++i) {
    Eigen::Matrix<double, 6, 1> xi;
    for (double& value : xi) value = noise(random);
    xi.head<3>() *= 0.05;
    xi.tail<3>() *= 0.005;
    Keyframe& keyframe = world.map.keyframeToChange(world.keyframes[i]);
    keyframe.T_map_cam = stereo::retract(keyframe.T_map_cam, xi);
  }
  for (const auto& [id, point] : world.points) {
    world.map.findToChange(id)->position =
        point + 0.01 * point.z() * Eigen::Vector3d(noise(random), noise(random), noise(random));
  }
}

double worstPose(const World& world) {
  double worst = 0.0;
  for (std::size_t i = 0; i < world.keyframes.size(); ++i) {
    const Pose& pose = world.map.keyframe(world.keyframes[i]).T_map_cam;
    worst = std::max(worst, (pose.translation() - world.poses[i].translation()).norm());
  }
  return worst;
}

TEST(AdjustBundleTest, FindsPosesAndPointsAgain) {
  World world = makeWorld(6, 0.0);
  disturb(world);
  ASSERT_GT(worstPose(world), 0.05);
  const auto summary = adjustBundle(world.map, world.keyframes, testCamera(), 30);
  EXPECT_LT(summary.final_cost, 0.2 * summary.initial_cost);
  EXPECT_LT(worstPose(world), 0.01);
}

TEST(AdjustBundleTest, FindsTheOffsetOfTheDisparities) {
  World world = makeWorld(8, 0.3);
  for (int i = 0; i < 12; ++i) {
    static_cast<void>(adjustBundle(world.map, world.keyframes, testCamera(), 30));
  }
  EXPECT_NEAR(world.map.disparityOffset(), 0.3, 0.03);
  EXPECT_LT(worstPose(world), 0.03);
}

TEST(AdjustBundleTest, ObservationsTellTheOffsetWithoutWhatIsAssumedAboutIt) {
  for (const double offset_px : {-2.0, 0.0, 1.0, 3.0}) {
    World world = makeWorld(3, offset_px);
    const auto summary = adjustBundle(world.map, world.keyframes, testCamera(), 30);
    ASSERT_TRUE(summary.free_offset);
    const auto& [px, sigma_px] = *summary.free_offset;
    // Linearised where the assumptions keep the offset small: a few percent.
    EXPECT_NEAR(px, offset_px, 0.1 * std::abs(offset_px) + 4.0 * sigma_px) << offset_px;
    EXPECT_LT(std::abs(world.map.disparityOffset()), 0.9 * std::abs(offset_px) + 0.05);
  }
}

TEST(AdjustBundleTest, LeavesKeyframesOutsideWhereTheyAre) {
  World world = makeWorld(6, 0.0);
  const std::vector<KeyframeId> free(world.keyframes.begin() + 3, world.keyframes.end());
  disturb(world);
  const Pose before = world.map.keyframe(world.keyframes[1]).T_map_cam;
  static_cast<void>(adjustBundle(world.map, free, testCamera(), 10));
  EXPECT_EQ(world.map.keyframe(world.keyframes[1]).T_map_cam.matrix(), before.matrix());
}

TEST(AdjustBundleTest, RemovesObservationsThatDoNotFit) {
  World world = makeWorld(6, 0.0);
  LandmarkId wrong;
  for (const auto& [id, landmark] : world.map.landmarks()) {
    if (landmark.observations.size() == 6) wrong = id;
  }
  ASSERT_TRUE(wrong.valid());
  const stereo::StereoMeasurement far{{5000.0, 200.0}, 4.0, true, 0.1, 0.1};
  const KeyframeId extra = world.map.addKeyframe(6, 0.6, posed(5)).id;
  world.map.observe(extra, wrong, far);
  world.keyframes.push_back(extra);
  world.poses.push_back(posed(5));
  const auto summary = adjustBundle(world.map, world.keyframes, testCamera(), 20);
  EXPECT_GE(summary.outliers, 1);
  EXPECT_EQ(std::count(world.map.keyframe(extra).landmarks.begin(),
                       world.map.keyframe(extra).landmarks.end(), wrong),
            0);
}

TEST(AdjustBundleTest, DoesNothingWithoutSharedLandmarks) {
  World world = makeWorld(1, 0.0);
  const auto summary = adjustBundle(world.map, world.keyframes, testCamera(), 10);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_DOUBLE_EQ(worstPose(world), 0.0);
}

TEST(DetachedBundleTest, TakesAlongWhatCameMeanwhile) {
  World world = makeWorld(6, 0.0);
  disturb(world);
  DetachedBundle bundle(world.map, world.keyframes, testCamera());
  bundle.solve(30);
  const Pose T_last_new = posed(1);
  const Pose& last = world.map.keyframe(world.keyframes.back()).T_map_cam;
  const KeyframeId extra = world.map.addKeyframe(6, 0.6, last * T_last_new).id;
  const Eigen::Vector3d point_new(1.0, 2.0, 9.0);
  const LandmarkId landmark = world.map.addLandmark(last * T_last_new * point_new, extra, {}).id;
  static_cast<void>(bundle.writeBack(world.map));
  EXPECT_LT(worstPose(world), 0.01);
  const Pose moved = world.map.keyframe(world.keyframes.back()).T_map_cam * T_last_new;
  EXPECT_LT((world.map.keyframe(extra).T_map_cam.matrix() - moved.matrix()).norm(), 1e-9);
  EXPECT_LT((world.map.find(landmark)->position - moved * point_new).norm(), 1e-9);
}

TEST(DetachedBundleTest, WritesNothingBackThatWasStopped) {
  World world = makeWorld(6, 0.0);
  disturb(world);
  const Pose before = world.map.keyframe(world.keyframes[3]).T_map_cam;
  DetachedBundle bundle(world.map, world.keyframes, testCamera());
  bundle.stop();
  bundle.solve(30);
  static_cast<void>(bundle.writeBack(world.map));
  EXPECT_EQ(world.map.keyframe(world.keyframes[3]).T_map_cam.matrix(), before.matrix());
}

TEST(DetachedBundleTest, LetsWhatWasRemovedMeanwhileStayAway) {
  World world = makeWorld(6, 0.0);
  disturb(world);
  DetachedBundle bundle(world.map, world.keyframes, testCamera());
  bundle.solve(30);
  const LandmarkId landmark = world.map.landmarks().begin()->first;
  world.map.removeLandmark(landmark);
  world.map.removeKeyframe(world.keyframes.back());
  static_cast<void>(bundle.writeBack(world.map));
  EXPECT_EQ(world.map.find(landmark), nullptr);
  EXPECT_EQ(world.map.keyframes().size(), world.keyframes.size() - 1);
  world.keyframes.pop_back();
  EXPECT_LT(worstPose(world), 0.01);
}

/// Takes a background's result over as soon as it is there.
void poll(BundleAdjuster& adjuster, SparseMap& map) {
  while (!adjuster.applyFinished(map)) std::this_thread::yield();
}

/// Takes it over at the end, waiting for it.
void wait(BundleAdjuster& adjuster, SparseMap& map) { EXPECT_TRUE(adjuster.finish(map)); }

TEST(BundleAdjusterTest, TakesOverFromTheBackgroundWhatItWouldHaveDoneAtOnce) {
  World at_once = makeWorld(6, 0.0);
  disturb(at_once);
  BundleAdjuster(testCamera(), false).adjust(at_once.map, at_once.keyframes, 30);
  for (const auto take_over : {poll, wait}) {
    World beside = makeWorld(6, 0.0);
    disturb(beside);
    BundleAdjuster adjuster(testCamera(), true);
    EXPECT_FALSE(adjuster.applyFinished(beside.map));
    EXPECT_FALSE(adjuster.finish(beside.map));
    adjuster.adjust(beside.map, beside.keyframes, 30);
    take_over(adjuster, beside.map);
    for (const KeyframeId id : at_once.keyframes) {
      EXPECT_EQ(at_once.map.keyframe(id).T_map_cam.matrix(),
                beside.map.keyframe(id).T_map_cam.matrix());
    }
  }
}

TEST(BundleAdjusterTest, DiscardsAbandonedSolves) {
  World world = makeWorld(6, 0.0);
  disturb(world);
  const Pose before = world.map.keyframe(world.keyframes[3]).T_map_cam;
  BundleAdjuster adjuster(testCamera(), true);
  adjuster.adjust(world.map, world.keyframes, 30);
  adjuster.abandon();
  EXPECT_FALSE(adjuster.applyFinished(world.map));
  EXPECT_EQ(world.map.keyframe(world.keyframes[3]).T_map_cam.matrix(), before.matrix());
}

}  // namespace
}  // namespace headway::slam
