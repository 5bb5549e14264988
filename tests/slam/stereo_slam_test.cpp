// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/input_error.h>
#include <headway_test/textured_world.h>

#include <Eigen/Eigenvalues>
#include <opencv2/core/utility.hpp>

namespace headway::slam {
namespace {

test::TexturedWorld room() {
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(12.0, 8.0, 4.0);
  return world;
}

/// A gentle curve through the room.
Pose onSlamPath(int i) {
  Pose pose = Pose::Identity();
  pose.translation() << 0.05 * i, 0.6 * std::sin(0.05 * i), 0.1 * std::sin(0.11 * i);
  pose.linear() = expSo3({0.0, 0.01 * std::sin(0.2 * i), 0.3 * std::sin(0.04 * i)});
  return pose;
}

/// The path begins at the origin, so that the map frame is the world frame.
double errorAt(const SlamUpdate& update, int i) {
  return (update.T_map_robot.translation() - onSlamPath(i).translation()).norm();
}

bool isFinite(const SlamUpdate& update) {
  return update.T_map_robot.matrix().allFinite() && update.covariance.allFinite();
}

StereoFrame blank(int i) {
  StereoFrame frame;
  frame.index = static_cast<std::size_t>(i);
  frame.time = 0.1 * i;
  frame.camera = std::make_shared<StereoCamera>(test::smallCamera());
  frame.left = cv::Mat(240, 320, CV_8U, cv::Scalar(0));
  frame.right = frame.left.clone();
  return frame;
}

TEST(StereoSlamTest, FollowsAPathThroughARoom) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 40; ++i) {
    const auto update = slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT(errorAt(update, i), 0.02) << i;
    EXPECT_GE(update.inliers, 20);
    Eigen::SelfAdjointEigenSolver<PoseCovariance> eigen(update.covariance);
    EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-12);
  }
  const auto path = slam.trajectory();
  ASSERT_EQ(path.size(), 40U);
  EXPECT_LT((path.back().T_map_robot.translation() - onSlamPath(39).translation()).norm(), 0.02);
}

TEST(StereoSlamTest, FollowsAPathWhileBundlesAreAdjustedBeside) {
  const auto world = room();
  SlamParams params;
  params.adjust_in_background = true;
  params.keyframe_flow_ratio = 0.02;  // many keyframes, so many adjustments
  StereoSlam slam(world.camera(), params);
  for (int i = 0; i < 40; ++i) {
    const auto update = slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT(errorAt(update, i), 0.03) << i;
  }
  EXPECT_GT(slam.map().keyframes.size(), 8U);
}

TEST(StereoSlamTest, MapsLandmarksOntoTheWalls) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 20; ++i)
    static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
  const MapView map = slam.map();
  ASSERT_GT(map.landmarks.size(), 100U);
  int on_wall = 0;
  for (const LandmarkView& landmark : map.landmarks) {
    const Eigen::Vector3d beyond = landmark.position.cwiseAbs() - Eigen::Vector3d(6.0, 4.0, 2.0);
    on_wall += std::abs(beyond.maxCoeff()) < 0.15 ? 1 : 0;
  }
  EXPECT_GT(on_wall, 0.9 * static_cast<double>(map.landmarks.size()));
}

TEST(StereoSlamTest, SaysLostWithoutImagesAndFindsItsMapAgain) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 15; ++i)
    static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
  for (int i = 15; i < 20; ++i) {
    const auto update = slam.process(blank(i), {});
    EXPECT_EQ(update.status, TrackingStatus::kLost);
    EXPECT_TRUE(isFinite(update));
  }
  for (int i = 20; i < 24; ++i) {
    const auto update = slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {});
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT(errorAt(update, i), 0.03) << i;
  }
  const auto path = slam.trajectory();
  EXPECT_TRUE(path[14].tracked);
  EXPECT_FALSE(path[17].tracked);
}

TEST(StereoSlamTest, FindsItselfAfterAJump) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 15; ++i)
    static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
  Pose turned = onSlamPath(15);
  turned.linear() = turned.linear() * expSo3({0.0, 0.05, 0.2});
  const auto update = slam.process(world.frame(15, 9.0, turned), {});
  EXPECT_EQ(update.status, TrackingStatus::kTracked);
  EXPECT_LT(errorAt(update, 15), 0.03);
}

TEST(StereoSlamTest, StaysLostInAnotherWorldUntilItBeginsAnew) {
  const auto world = room();
  test::TexturedWorld other(test::smallCamera(), 99);
  other.addRoom(9.0, 7.0, 3.0);
  SlamParams params;
  params.restart_after_s = 0.4;
  StereoSlam slam(world.camera(), params);
  for (int i = 0; i < 10; ++i)
    static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
  for (int i = 10; i < 14; ++i) {
    EXPECT_EQ(slam.process(other.frame(i, 0.1 * i, onSlamPath(i)), {}).status,
              TrackingStatus::kLost);
  }
  const auto update = slam.process(other.frame(14, 1.4, onSlamPath(14)), {});
  EXPECT_EQ(update.status, TrackingStatus::kTrackedInNewSubmap);
  EXPECT_TRUE(update.is_keyframe);
  EXPECT_EQ(slam.process(other.frame(15, 1.5, onSlamPath(15)), {}).status,
            TrackingStatus::kTrackedInNewSubmap);
}

TEST(StereoSlamTest, BeginsOnceThereIsSomethingToSee) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 3; ++i) {
    const auto update = slam.process(blank(i), {});
    EXPECT_EQ(update.status, TrackingStatus::kLost);
    EXPECT_TRUE(isFinite(update));
  }
  EXPECT_TRUE(slam.map().keyframes.empty());
  EXPECT_EQ(slam.process(world.frame(3, 0.3, onSlamPath(0)), {}).status, TrackingStatus::kTracked);
}

TEST(StereoSlamTest, SameInputSameBytesOnAnyNumberOfThreads) {
  const auto world = room();
  const auto run = [&](int threads) {
    cv::setNumThreads(threads);
    StereoSlam slam(world.camera(), SlamParams{});
    for (int i = 0; i < 12; ++i) {
      static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
    }
    return std::make_pair(slam.trajectory(), slam.map());
  };
  const auto [path_1, map_1] = run(1);
  const auto [path_2, map_2] = run(2);
  for (std::size_t i = 0; i < path_1.size(); ++i) {
    EXPECT_EQ(path_1[i].T_map_robot.matrix(), path_2[i].T_map_robot.matrix());
  }
  ASSERT_EQ(map_1.landmarks.size(), map_2.landmarks.size());
  for (std::size_t i = 0; i < map_1.landmarks.size(); ++i) {
    EXPECT_EQ(map_1.landmarks[i].position, map_2.landmarks[i].position);
  }
}

TEST(StereoSlamTest, TakesNothingFromMovingRegions) {
  const auto world = room();
  SlamParams params;
  params.dynamic_rejection = DynamicRejection::kBoxes;
  StereoSlam slam(world.camera(), params);
  MovingRegions moving;
  moving.boxes.push_back({100.0, 60.0, 220.0, 180.0});
  static_cast<void>(slam.process(world.frame(0, 0.0, onSlamPath(0)), moving));
  const Pose T_cam_map = world.camera()->T_robot_cam.inverse();
  for (const LandmarkView& landmark : slam.map().landmarks) {
    const auto uvd = project(T_cam_map * landmark.position, *world.camera()).value();
    EXPECT_FALSE(moving.boxes[0].contains(uvd.x(), uvd.y()));
  }
}

TEST(StereoSlamTest, IsLostWhereEverythingMoves) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 5; ++i)
    static_cast<void>(slam.process(world.frame(i, 0.1 * i, onSlamPath(i)), {}));
  MovingRegions all;
  all.mask = cv::Mat(240, 320, CV_8U, cv::Scalar(255));
  const auto update = slam.process(world.frame(5, 0.5, onSlamPath(5)), all);
  EXPECT_EQ(update.status, TrackingStatus::kLost);
  EXPECT_TRUE(isFinite(update));
  EXPECT_EQ(slam.process(world.frame(6, 0.6, onSlamPath(6)), {}).status, TrackingStatus::kTracked);
}

TEST(StereoSlamTest, RefusesImagesThatAreNotTheCameras) {
  const auto world = room();
  StereoSlam slam(world.camera(), SlamParams{});
  StereoFrame frame = world.frame(0, 0.0, onSlamPath(0));
  frame.right = cv::Mat(100, 100, CV_8U, cv::Scalar(0));
  EXPECT_THROW(static_cast<void>(slam.process(frame, {})), InputError);
  frame.right = cv::Mat();
  EXPECT_THROW(static_cast<void>(slam.process(frame, {})), InputError);
}

TEST(StereoSlamTest, LevelsTheMapOnceGravityIsObservable) {
  const auto world = room();
  const Eigen::Vector3d up = Eigen::Vector3d(0.05, -0.1, 1.0).normalized();
  const auto tiltWith = [&](bool use_imu) {
    SlamParams params;
    params.use_imu = use_imu;
    StereoSlam slam(world.camera(), params);
    SlamUpdate update;
    const auto velocityAt = [&](int i) {
      return Eigen::Vector3d(5.0 *
                             (onSlamPath(i + 1).translation() - onSlamPath(i - 1).translation()));
    };
    for (int i = 0; i < 12; ++i) {
      StereoFrame frame = world.frame(i, 0.1 * i, onSlamPath(i));
      frame.motion_prior.specific_force = 9.80665 * up;
      const Pose T_previous_first = onSlamPath(i - 1).inverse();
      frame.motion_prior.R_previous_current = (T_previous_first * onSlamPath(i)).linear();
      const Eigen::Vector3d increment = velocityAt(i) - velocityAt(i - 1) + 0.1 * 9.80665 * up;
      frame.motion_prior.velocity_increment = T_previous_first.linear() * increment;
      update = slam.process(frame, {});
      if (i == 0) {
        EXPECT_TRUE(update.T_map_robot.isApprox(Pose::Identity(), 1e-9));
      }
    }
    const Pose first = slam.trajectory().front().T_map_robot;
    EXPECT_LT(first.translation().norm(), 1e-6);
    return std::acos((first.linear() * up).z());
  };
  EXPECT_GT(tiltWith(false), 0.1);
  EXPECT_LT(tiltWith(true), 0.02);
}

TEST(StereoSlamTest, WithoutMappingAnEmptyMapStaysEmpty) {
  const auto world = room();
  SlamParams params;
  params.mapping = false;
  StereoSlam slam(world.camera(), params);
  EXPECT_EQ(slam.process(world.frame(0, 0.0, onSlamPath(0)), {}).status, TrackingStatus::kLost);
  EXPECT_TRUE(slam.map().landmarks.empty());
}

TEST(StereoSlamTest, TracksInDarkImages) {
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(12.0, 8.0, 4.0);
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 12; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.05 * i;
    StereoFrame frame = world.frame(i, 0.1 * i, pose);
    for (cv::Mat* image : {&frame.left, &frame.right}) image->convertTo(*image, CV_8U, 0.1, 4.0);
    const auto update = slam.process(frame, {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT((update.T_map_robot.translation() - pose.translation()).norm(), 0.03) << i;
  }
}

TEST(StereoSlamTest, RefusesParametersOutOfRange) {
  const auto camera = std::make_shared<StereoCamera>(test::smallCamera());
  const auto errorOf = [&camera](auto change) {
    SlamParams params;
    change(params);
    return test::inputErrorOf([&] { StereoSlam slam(camera, params); });
  };
  EXPECT_EQ("", errorOf([](SlamParams&) {}));
  EXPECT_EQ("[slam] features: '20' is out of range [50 .. 3000]",
            errorOf([](SlamParams& params) { params.features = 20; }));
  EXPECT_EQ("[slam] sigma_px: '0' is out of range [px, 0.05 .. 5]",
            errorOf([](SlamParams& params) { params.sigma_px = 0.0; }));
  EXPECT_EQ("[slam] dynamic_rejection: the value is none of none, boxes, geometric, both",
            errorOf([](SlamParams& params) {
              params.dynamic_rejection = static_cast<DynamicRejection>(9);
            }));
}

}  // namespace
}  // namespace headway::slam
