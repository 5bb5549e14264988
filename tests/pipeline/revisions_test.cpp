// SPDX-License-Identifier: BSD-3-Clause
// Each cause of a map revision, against a run in which that revision is withheld: odometry and
// tracks in it do not notice, and grid and dense map lie where they did in relation to the robot.
#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/textured_world.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "input_health.h"

namespace headway::pipeline {
namespace {

constexpr double kMaxStepError_m = 0.002;
constexpr double kMaxStepError_rad = 0.02 * kDegree;
constexpr double kMaxTrackError_m = 0.02;
constexpr double kMaxVelocityError_mps = 0.05;
constexpr int kSettled = 10;  ///< frames after which tracks of two runs have the same history
constexpr double kLength_m = 12.0, kWidth_m = 8.0, kHeight_m = 4.0;  // of the room

/// A robot that drives at 0.5 m/s through a room with a parked car and a pedestrian.
Pose onPath(double step) {
  Pose pose = Pose::Identity();
  pose.translation() << 0.05 * step, 0.3 * std::sin(0.05 * step), 0.0;
  pose.linear() = expSo3({0.0, 0.0, 0.2 * std::sin(0.04 * step)});
  return pose;
}

/// What a run says, with the layers of its end in the odometry frame.
struct Drive {
  std::vector<PerceptionUpdate> updates;
  std::shared_ptr<const StereoCamera> camera;  ///< at the end
  std::set<slam::MapChange> causes;
  double dense_error_m = 0.0;  ///< mean distance of the points from the room's surfaces
  std::size_t dense_points = 0;
  std::size_t occupied = 0, occupied_at_walls = 0;  ///< cells
  std::size_t free = 0, free_in_room = 0;
};

class RevisionTest : public testing::Test {
 protected:
  explicit RevisionTest(const StereoCamera& camera = test::smallCamera())
      : world_(camera), stated_(world_.camera()) {
    world_.addRoom(kLength_m, kWidth_m, kHeight_m);
    params_.slam.features = 250;
    params_.detection.detector = "recorded";
    params_.grid.period_s = 0.1;
    params_.dense.use = true;
  }

  /// The robot's true pose, which is turned round while the camera is covered, if it is.
  [[nodiscard]] Pose poseOf(int i) const {
    Pose pose = onPath(i);
    pose.translation().z() = origin_z_m_;
    if (is_turned_round_ && i >= kSeesAgain) {
      pose.linear() = pose.linear() * expSo3({0.0, 0.0, M_PI});
    }
    return pose;
  }

  [[nodiscard]] RecordedFrame frameAt(int i) const {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.1 * i;
    frame.stereo = world_.frame(frame.index, frame.time, poseOf(i));
    frame.stereo->camera = stated_;
    Detections detections;
    detections.time = frame.time;
    detections.T_robot_sensor = stated_->T_robot_cam;
    const Pose T_cam_odom = (poseOf(i) * world_.camera()->T_robot_cam).inverse();
    const double ahead = is_turned_round_ && i >= kSeesAgain ? -1.0 : 1.0;
    const auto add = [&](ObjectClass object_class, const Eigen::Vector3d& centre,
                         const Eigen::Vector3d& size, double yaw) {
      Detection detection;
      detection.object_class = object_class;
      detection.score = 0.9;
      detection.box3d = opticalBox(centre, size, yaw, T_cam_odom);
      detections.items.push_back(detection);
    };
    add(ObjectClass::kCar, {5.0 * ahead, 2.2, -1.2}, {4.0, 1.7, 1.5}, 0.3);
    add(ObjectClass::kPedestrian, {4.6 * ahead, 0.1 * i - 3.0, -1.1}, {0.6, 0.6, 1.7}, M_PI / 2.0);
    frame.detections = detections;
    return frame;
  }

  /// @param change  what the sensors deliver instead of a good frame
  [[nodiscard]] Drive drive(int first, int end,
                            const std::function<void(int, RecordedFrame&)>& change = {}) const {
    Perception perception(stated_, params_);
    Drive run;
    for (int i = first; i < end; ++i) {
      RecordedFrame frame = frameAt(i);
      if (change) change(i, frame);
      run.updates.push_back(perception.process(frame));
      run.causes.insert(run.updates.back().camera.revision.cause);
    }
    run.camera = perception.camera();
    perception.updateDenseMap();
    measureLayers(perception.map(),
                  poseOf(end - 1) * run.updates.back().camera.T_map_robot.inverse(), run);
    return run;
  }

  static void measureLayers(const map::PerceptionMap& map, const Pose& T_room_map, Drive& run) {
    ASSERT_NE(map.dense(), nullptr);
    ASSERT_NE(map.staticGrid(), nullptr);
    const Eigen::Array3d half(kLength_m / 2, kWidth_m / 2, kHeight_m / 2);
    for (std::size_t k = 0; k < map.dense()->size(); ++k) {
      Eigen::Vector3f point;
      map.dense()->getPoint(k, point.x(), point.y(), point.z());
      const Eigen::Vector3d p = T_room_map * point.cast<double>();
      run.dense_error_m += (half - p.array().abs()).abs().minCoeff();
      ++run.dense_points;
    }
    run.dense_error_m /= static_cast<double>(std::max<std::size_t>(run.dense_points, 1));
    const auto& grid = *map.staticGrid();
    for (int y = 0; y < static_cast<int>(grid.getSizeY()); ++y) {
      for (int x = 0; x < static_cast<int>(grid.getSizeX()); ++x) {
        const float value = grid.getCell(x, y);
        if (std::abs(value - 0.5F) <= 0.1F) continue;
        // The cell's column where it meets the floor.
        const Eigen::Vector3d foot = T_room_map * Eigen::Vector3d(grid.idx2x(x), grid.idx2y(y), 0);
        const Eigen::Vector3d up = T_room_map.linear().col(2);
        const Eigen::Vector3d p = foot + (-half.z() - foot.z()) / up.z() * up;
        const double inside =
            std::min(half.x() - std::abs(p.x()), half.y() - std::abs(p.y()));  // to the next wall
        if (value < 0.5F) {
          ++run.occupied;
          run.occupied_at_walls += std::abs(inside) < 0.4 ? 1 : 0;
        } else {
          ++run.free;
          run.free_in_room += inside > -grid.getResolution() ? 1 : 0;
        }
      }
    }
  }

  /// From a frame on, steps of the odometry and tracks in it are the same.
  ///
  /// @param skipped         frames of `run` before the first of `withheld`
  /// @param max_rotation_rad  of a step; more where the images differ, whose noise is in both
  static void expectSameOdometry(const Drive& run, const Drive& withheld, std::size_t first,
                                 std::size_t skipped = 0,
                                 double max_rotation_rad = kMaxStepError_rad) {
    std::size_t tracks = 0;
    for (std::size_t i = std::max<std::size_t>(first, skipped + 1); i < run.updates.size(); ++i) {
      const PerceptionUpdate& a = run.updates[i];
      const PerceptionUpdate& b = withheld.updates.at(i - skipped);
      const Pose step = run.updates[i - 1].camera.T_odom_robot.inverse() * a.camera.T_odom_robot;
      const Pose other = withheld.updates.at(i - 1 - skipped).camera.T_odom_robot.inverse() *
                         b.camera.T_odom_robot;
      const Pose difference = step.inverse() * other;
      EXPECT_LT(difference.translation().norm(), kMaxStepError_m) << i;
      EXPECT_LT(logSo3(difference.linear()).norm(), max_rotation_rad) << i;
      for (const Track& track : a.tracks_odom) {
        for (const Track& same : b.tracks_odom) {
          if (track.object_class != same.object_class) continue;
          // In relation to the robot, because the frames may begin elsewhere.
          const Pose T_robot_a = a.camera.T_odom_robot.inverse();
          const Pose T_robot_b = b.camera.T_odom_robot.inverse();
          EXPECT_LT((T_robot_a * track.position - T_robot_b * same.position).norm(),
                    kMaxTrackError_m)
              << i;
          EXPECT_LT(
              (T_robot_a.linear() * track.velocity - T_robot_b.linear() * same.velocity).norm(),
              kMaxVelocityError_mps)
              << i;
          EXPECT_EQ(track.motion_state, same.motion_state) << i;
          ++tracks;
        }
      }
    }
    EXPECT_GT(tracks, 10U);
  }

  static void expectLayersAsGoodAs(const Drive& withheld, const Drive& run) {
    EXPECT_GT(run.dense_points, 100U);
    EXPECT_LT(run.dense_error_m, 0.15) << "0.5 m is the noise of a depth of 8 m";
    EXPECT_LT(run.dense_error_m, withheld.dense_error_m + 0.02);
    EXPECT_GT(run.occupied, 10U);
    EXPECT_GT(run.free, 50U);
    const auto ratio = [](std::size_t some, std::size_t all) {
      return static_cast<double>(some) / static_cast<double>(std::max<std::size_t>(all, 1));
    };
    EXPECT_GE(ratio(run.occupied_at_walls, run.occupied),
              ratio(withheld.occupied_at_walls, withheld.occupied) - 0.05);
    EXPECT_GE(ratio(run.free_in_room, run.free), 0.99);
  }

  static constexpr int kCovered = 15;    ///< frame in which the camera is covered
  static constexpr int kSeesAgain = 25;  ///< and from which it is not

  test::TexturedWorld world_;
  std::shared_ptr<const StereoCamera> stated_;  ///< its calibration
  double origin_z_m_ = 0.0;                     ///< of the robot, in the room
  PerceptionParams params_;
  bool is_turned_round_ = false;
};

void coverInBetween(int i, RecordedFrame& frame, int first, int end) {
  if (i < first || i >= end) return;
  frame.stereo->left = frame.stereo->right =
      cv::Mat(frame.stereo->left.size(), CV_8U, cv::Scalar(9));
}

TEST_F(RevisionTest, Gravity) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.05, -0.1, 1.0).normalized();
  const auto motion = [&](bool with_accelerometer) {
    return [up, with_accelerometer](int i, RecordedFrame& frame) {
      const auto velocity = [](int k) {
        return Eigen::Vector3d(5.0 * (onPath(k + 1).translation() - onPath(k - 1).translation()));
      };
      const Pose T_previous_first = onPath(i - 1).inverse();
      MotionPrior& prior = frame.stereo->motion_prior;
      prior.specific_force = 9.80665 * up;
      prior.R_previous_current = (T_previous_first * onPath(i)).linear();
      const Eigen::Vector3d increment = velocity(i) - velocity(i - 1) + 0.1 * 9.80665 * up;
      if (with_accelerometer) prior.velocity_increment = T_previous_first.linear() * increment;
    };
  };
  const Drive run = drive(0, 35, motion(true));
  const Drive withheld = drive(0, 35, motion(false));
  EXPECT_EQ(run.causes.count(slam::MapChange::kGravity), 1U);
  EXPECT_EQ(withheld.causes.count(slam::MapChange::kGravity), 0U);
  EXPECT_GT(logSo3(run.updates.back().camera.T_map_odom.linear()).norm(), 0.08);
  expectSameOdometry(run, withheld, 1);
  expectLayersAsGoodAs(withheld, run);
}

TEST_F(RevisionTest, RightCamera) {
  const Drive withheld = drive(0, 70);
  world_.right_turn = Eigen::Vector3d(0.0, 0.4 * M_PI / 180.0, 0.0);
  const Drive run = drive(0, 70);
  EXPECT_EQ(run.causes.count(slam::MapChange::kRightCamera), 1U);
  EXPECT_EQ(withheld.causes.count(slam::MapChange::kRightCamera), 0U);
  std::size_t first = 0;
  while (first + 1 < run.updates.size() &&
         run.updates[first].camera.revision.cause != slam::MapChange::kRightCamera) {
    ++first;
  }
  expectSameOdometry(run, withheld, first + kSettled, 0, 0.05 * kDegree);
  expectLayersAsGoodAs(withheld, run);
}

TEST_F(RevisionTest, Relocalised) {
  const auto covered = [](int i, RecordedFrame& frame) {
    coverInBetween(i, frame, kCovered, kSeesAgain);
  };
  const Drive run = drive(0, 50, covered);
  const Drive withheld = drive(kSeesAgain, 50);
  EXPECT_EQ(run.causes.count(slam::MapChange::kRelocalised), 1U);
  EXPECT_EQ(withheld.causes.count(slam::MapChange::kRelocalised), 0U);
  expectSameOdometry(run, withheld, kSeesAgain + kSettled, kSeesAgain);
  expectLayersAsGoodAs(withheld, run);
}

TEST_F(RevisionTest, NewSubmap) {
  params_.slam.restart_after_s = 0.5;
  is_turned_round_ = true;
  const auto covered = [](int i, RecordedFrame& frame) {
    coverInBetween(i, frame, kCovered, kSeesAgain);
  };
  const Drive run = drive(0, 50, covered);
  const Drive withheld = drive(kSeesAgain, 50);
  EXPECT_EQ(run.causes.count(slam::MapChange::kNewSubmap), 1U);
  EXPECT_EQ(withheld.causes.count(slam::MapChange::kNewSubmap), 0U);
  EXPECT_EQ(run.updates.back().camera.status, slam::TrackingStatus::kTrackedInNewSubmap);
  expectSameOdometry(run, withheld, kSeesAgain + kSettled, kSeesAgain);
  expectLayersAsGoodAs(withheld, run);
}

/// A camera 1 m above the floor that looks down and is rolled.
StereoCamera mountedCamera() {
  StereoCamera camera = test::smallCamera();
  camera.T_robot_cam.linear() =
      expSo3({0.0, 0.3, 0.0}) * expSo3({0.1, 0.0, 0.0}) * camera.T_robot_cam.linear();
  camera.T_robot_cam.translation().z() = 1.0;
  return camera;
}

class MountingRevisionTest : public RevisionTest {
 protected:
  MountingRevisionTest() : RevisionTest(mountedCamera()) { origin_z_m_ = -kHeight_m / 2; }
};

TEST_F(MountingRevisionTest, AnAssumedMountingIsReplacedByThatOfTheFloor) {
  stated_ = std::make_shared<StereoCamera>(test::smallCamera());
  const Drive run = drive(0, 60);
  EXPECT_EQ(run.causes.count(slam::MapChange::kMounting), 1U);
  const Pose error = run.camera->T_robot_cam.inverse() * world_.camera()->T_robot_cam;
  constexpr double kMaxTilt = 3.0 * 0.6 * kDegree;  // 3 sigma, as the warning states it
  EXPECT_LT(error.translation().norm(), 0.1);
  EXPECT_LT(logSo3(error.linear()).norm(), kMaxTilt);
  // The room's floor, by the map: the robot's origin is on it.
  EXPECT_NEAR(0.0, run.updates.back().camera.T_map_robot.translation().z(),
              kMaxTilt * onPath(59).translation().norm());
  std::size_t first = 0, jumps = 0;
  for (std::size_t i = 1; i < run.updates.size(); ++i) {
    const bool is_revised = run.updates[i].camera.revision.cause == slam::MapChange::kMounting &&
                            run.updates[i - 1].camera.revision.cause != slam::MapChange::kMounting;
    if (!is_revised) continue;
    first = i;
    ++jumps;
  }
  EXPECT_EQ(jumps, 1U);
  stated_ = run.camera;
  const Drive withheld = drive(0, 60);
  EXPECT_EQ(withheld.causes.count(slam::MapChange::kMounting), 0U);
  expectSameOdometry(run, withheld, first + kSettled);
  expectLayersAsGoodAs(withheld, run);
}

TEST_F(RevisionTest, BundleAdjustment) {
  params_.slam.keyframe_flow_ratio = 0.02;  // many keyframes, so many adjustments
  const Drive run = drive(0, 40);
  params_.slam.stop = [] { return true; };
  const Drive withheld = drive(0, 40);
  expectSameOdometry(run, withheld, 1);
  expectLayersAsGoodAs(withheld, run);
}

bool warnsOfSpeed(const PreviousFrame& previous, const Pose& T_previous_robot) {
  RecordedFrame frame;
  frame.index = 1;
  frame.time = 0.1;
  const FrameRate rate;
  FrameState state(frame, previous, rate);
  state.camera.status = slam::TrackingStatus::kTracked;
  state.camera.revision = {previous.revision + 1, slam::MapChange::kLoop};
  state.camera.T_map_robot = Pose(Eigen::Translation3d(8.0, 0.0, 0.0));  // by the loop
  state.T_previous_robot = T_previous_robot;
  InputHealth health(nullptr, 70.0);
  const Findings findings = health.checkResults(state);
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.name == "speed"; });
}

TEST_F(RevisionTest, ALoopOf8mIsNoSpeedOfTheRobot) {
  PreviousFrame previous;
  previous.index = 0;
  previous.revision = 1;
  EXPECT_FALSE(warnsOfSpeed(previous, Pose(Eigen::Translation3d(0.1, 0.0, 0.0))));
  EXPECT_TRUE(warnsOfSpeed(previous, Pose(Eigen::Translation3d(8.0, 0.0, 0.0))));
}

}  // namespace
}  // namespace headway::pipeline
