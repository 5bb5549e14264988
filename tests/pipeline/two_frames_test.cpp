// SPDX-License-Identifier: BSD-3-Clause
// Objects in the odometry frame and layers in the map, while loops and submaps change the map.
#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/textured_world.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace headway::pipeline {
namespace {

constexpr int kRound = 110;        ///< frames once round
constexpr int kRoundFrames = 125;  ///< a little more than once round

/// Once round a block of walls in a hall, looking ahead, and on over the beginning.
Pose roundTheHall(int i) {
  const double angle = 2.0 * M_PI * i / kRound;
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.0, angle});
  pose.translation() << 4.0 * std::sin(angle), 4.0 - 4.0 * std::cos(angle), 0.0;
  return pose;
}

/// A hall with a block of walls in its middle.
const test::TexturedWorld& hall() {
  static const test::TexturedWorld built = [] {
    test::TexturedWorld world(test::smallCamera(), 4);
    world.addRoom(16.0, 16.0, 4.0);
    using V = Eigen::Vector3d;
    const V low(-2.0, 2.0, -2.0);
    world.boards.push_back({low, V::UnitX(), V::UnitZ(), 4.0, 4.0, {1.1, 8.2}});
    world.boards.push_back({low + 4.0 * V::UnitY(), V::UnitX(), V::UnitZ(), 4.0, 4.0, {6.1, 5.2}});
    world.boards.push_back({low, V::UnitY(), V::UnitZ(), 4.0, 4.0, {2.1, 3.2}});
    world.boards.push_back({low + 4.0 * V::UnitX(), V::UnitY(), V::UnitZ(), 4.0, 4.0, {9.1, 7.2}});
    return world;
  }();
  return built;
}

/// The frames, rendered once for all tests.
const std::vector<StereoFrame>& framesRoundTheHall() {
  static const std::vector<StereoFrame> frames = [] {
    std::vector<StereoFrame> rendered;
    for (int i = 0; i < kRoundFrames; ++i) {
      rendered.push_back(hall().frame(static_cast<std::size_t>(i), 0.1 * i, roundTheHall(i)));
    }
    return rendered;
  }();
  return frames;
}

void addBox(ObjectClass object_class, const Eigen::Vector3d& centre, double yaw,
            const Eigen::Vector3d& size, int frame, Detections& detections) {
  const Pose T_cam_map =
      (roundTheHall(frame) * framesRoundTheHall().front().camera->T_robot_cam).inverse();
  Detection detection;
  detection.object_class = object_class;
  detection.score = 0.9;
  const Box3d box = opticalBox(centre, size, yaw, T_cam_map);
  if (box.centre.z() < 1.0 || std::abs(box.centre.x()) > 0.6 * box.centre.z()) return;
  detection.box3d = box;
  detections.items.push_back(detection);
}

/// A frame with the true boxes of a parked car and of a pedestrian.
RecordedFrame recorded(int i) {
  RecordedFrame frame;
  frame.index = static_cast<std::size_t>(i);
  frame.time = 0.1 * i;
  frame.stereo = framesRoundTheHall()[frame.index];
  Detections detections;
  detections.time = frame.time;
  detections.T_robot_sensor = frame.stereo->camera->T_robot_cam;
  addBox(ObjectClass::kCar, {6.5, 0.8, -1.2}, 0.3, {4.0, 1.7, 1.5}, i, detections);
  addBox(ObjectClass::kPedestrian, {5.5, -2.0 + 0.12 * (i - 95), -1.1}, M_PI / 2.0, {0.6, 0.6, 1.7},
         i, detections);
  frame.detections = detections;
  return frame;
}

PerceptionParams paramsRound() {
  PerceptionParams params;
  params.slam.features = 250;
  params.detection.detector = "none";
  params.grid.period_s = 0.0;
  params.dense.use = false;
  return params;
}

std::vector<PerceptionUpdate> drive(bool loop_closing) {
  PerceptionParams params = paramsRound();
  params.detection.detector = "recorded";
  params.slam.loop_closing = loop_closing;
  Perception perception(framesRoundTheHall().front().camera, params);
  std::vector<PerceptionUpdate> updates;
  for (int i = 0; i < kRoundFrames; ++i) updates.push_back(perception.process(recorded(i)));
  return updates;
}

TEST(TwoFramesTest, ALoopMovesTheMapAndNoObjectInOdometry) {
  const auto with_loop = drive(true);
  const auto without = drive(false);
  int loops = 0, tracks = 0, moving = 0, standing = 0;
  double jump_m = 0.0;
  std::map<TrackId, MotionState> states;
  for (std::size_t i = 1; i < with_loop.size(); ++i) {
    const PerceptionUpdate& a = with_loop[i];
    const PerceptionUpdate& b = without[i];
    if (a.camera.revision.number != with_loop[i - 1].camera.revision.number &&
        a.camera.revision.cause == slam::MapChange::kLoop) {
      ++loops;
      const Pose jump = with_loop[i - 1].camera.T_map_odom.inverse() * a.camera.T_map_odom;
      jump_m = std::max(
          jump_m, (jump * a.camera.T_odom_robot.translation() - a.camera.T_odom_robot.translation())
                      .norm());
    }
    ASSERT_EQ(a.tracks_odom.size(), b.tracks_odom.size()) << i;
    ASSERT_EQ(a.objects.tracks.size(), a.tracks_odom.size()) << i;
    for (std::size_t k = 0; k < a.tracks_odom.size(); ++k) {
      const Track& track = a.tracks_odom[k];
      ++tracks;
      EXPECT_EQ(track.id, b.tracks_odom[k].id);
      EXPECT_EQ(track.position, b.tracks_odom[k].position) << i;
      EXPECT_EQ(track.velocity, b.tracks_odom[k].velocity) << i;
      EXPECT_EQ(track.motion_state, b.tracks_odom[k].motion_state) << i;
      const Track published = transformed(track, a.camera.T_map_odom);
      EXPECT_EQ(a.objects.tracks[k].id, track.id);
      EXPECT_TRUE(a.objects.tracks[k].position.isApprox(published.position, 1e-9));
      EXPECT_TRUE(a.objects.tracks[k].velocity.isApprox(published.velocity, 1e-9));
      const auto known = states.find(track.id);
      if (loops > 0 && known != states.end() && track.motion_state != MotionState::kUnknown &&
          known->second != MotionState::kUnknown) {
        EXPECT_EQ(track.motion_state, known->second) << "frame " << i;
      }
      states[track.id] = track.motion_state;
      moving += loops > 0 && track.motion_state == MotionState::kMoving ? 1 : 0;
      standing += loops > 0 && track.motion_state == MotionState::kStatic ? 1 : 0;
    }
  }
  EXPECT_GE(loops, 1);
  EXPECT_GT(jump_m, 0.02) << "or the test shows nothing";
  EXPECT_GT(tracks, 20);
  EXPECT_GE(moving, 5) << "frames after the loop";
  EXPECT_GE(standing, 5);
}

/// Distance of a point from the nearest wall, floor or ceiling [m].
double distanceFromHall(const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::max();
  for (const test::Board& board : hall().boards) {
    const Eigen::Vector3d from = point - board.origin;
    const double x = std::clamp(from.dot(board.u), 0.0, board.width);
    const double y = std::clamp(from.dot(board.v), 0.0, board.height);
    nearest = std::min(nearest, (from - x * board.u - y * board.v).norm());
  }
  return nearest;
}

/// Mean distance of the dense points near the robot from the hall, and of obstacles in the grid
/// from its walls, when it is back at the beginning.
struct LayerErrors {
  double dense_m = 0.0, grid_m = 0.0;
  std::size_t points = 0, cells = 0, loops = 0;
};

LayerErrors layersAfterRound(bool loop_closing) {
  PerceptionParams params = paramsRound();
  params.grid.period_s = 0.1;
  params.dense.use = true;
  params.slam.loop_closing = loop_closing;
  Perception perception(framesRoundTheHall().front().camera, params);
  LayerErrors errors;
  Pose T_hall_map = Pose::Identity();
  for (int i = 0; i < kRoundFrames; ++i) {
    RecordedFrame frame = recorded(i);
    frame.detections.reset();
    const auto update = perception.process(frame);
    errors.loops += update.camera.revision.cause == slam::MapChange::kLoop ? 1 : 0;
    T_hall_map = roundTheHall(i) * update.camera.T_map_robot.inverse();
  }
  perception.updateDenseMap();
  const auto add = [&](const Eigen::Vector3d& place, double& sum, std::size_t& count) {
    sum += distanceFromHall(place);
    ++count;
  };
  const auto& dense = *perception.map().dense();
  for (std::size_t k = 0; k < dense.size(); ++k) {
    Eigen::Vector3f point;
    dense.getPoint(k, point.x(), point.y(), point.z());
    add(T_hall_map * point.cast<double>(), errors.dense_m, errors.points);
  }
  const auto& grid = *perception.map().staticGrid();
  for (int y = 0; y < static_cast<int>(grid.getSizeY()); ++y) {
    for (int x = 0; x < static_cast<int>(grid.getSizeX()); ++x) {
      if (grid.getCell(x, y) > 0.3F) continue;
      // At the height of the camera, because the floor is nearer than any wall.
      add(T_hall_map * Eigen::Vector3d(grid.idx2x(x), grid.idx2y(y), 0.0), errors.grid_m,
          errors.cells);
    }
  }
  errors.dense_m /= static_cast<double>(std::max<std::size_t>(errors.points, 1));
  errors.grid_m /= static_cast<double>(std::max<std::size_t>(errors.cells, 1));
  return errors;
}

TEST(TwoFramesTest, ALoopMovesGridAndDenseMapWithIt) {
  const LayerErrors with_loop = layersAfterRound(true);
  const LayerErrors without = layersAfterRound(false);
  EXPECT_GE(with_loop.loops, 1U);
  EXPECT_EQ(without.loops, 0U);
  EXPECT_GT(with_loop.points, 500U);
  EXPECT_GT(with_loop.cells, 10U);
  EXPECT_LT(with_loop.dense_m, without.dense_m + 0.02);
  EXPECT_LT(with_loop.grid_m, without.grid_m + 0.05);
  EXPECT_LT(with_loop.dense_m, 0.2);
  EXPECT_LT(with_loop.grid_m, 0.4) << "cells of 0.2 m";
}

std::size_t knownCells(const map::PerceptionMap& map) {
  const auto grid = map.staticGrid();
  std::size_t known = 0;
  if (grid == nullptr) return known;
  for (int y = 0; y < static_cast<int>(grid->getSizeY()); ++y) {
    for (int x = 0; x < static_cast<int>(grid->getSizeX()); ++x) {
      known += std::abs(grid->getCell(x, y) - 0.5F) > 0.02F ? 1 : 0;
    }
  }
  return known;
}

/// Drives round with the camera covered in between, up to a frame.
class SubmapLayersTest : public testing::Test {
 protected:
  static constexpr int kCovered = 20;
  static constexpr int kSeesAgain = 60;

  SubmapLayersTest() {
    PerceptionParams params = paramsRound();
    params.slam.restart_after_s = 0.5;
    params.grid.period_s = 0.1;
    params.dense.use = true;
    perception_ = std::make_unique<Perception>(framesRoundTheHall().front().camera, params);
  }

  void driveTo(int end) {
    for (; next_ < end; ++next_) {
      RecordedFrame frame = recorded(next_);
      frame.detections.reset();
      if (next_ >= kCovered && next_ < kSeesAgain) {
        frame.stereo->left = frame.stereo->right =
            cv::Mat(frame.stereo->left.size(), CV_8U, cv::Scalar(0));
      }
      last_ = perception_->process(frame);
    }
  }

  std::unique_ptr<Perception> perception_;
  PerceptionUpdate last_;

 private:
  int next_ = 0;
};

TEST_F(SubmapLayersTest, AreNeverMixedAndBothThereAfterTheyAreJoined) {
  driveTo(kCovered);
  const std::size_t first = knownCells(perception_->map());
  ASSERT_GT(first, 50U);
  EXPECT_TRUE(perception_->otherSubmaps().empty());
  driveTo(kSeesAgain + 3);
  EXPECT_EQ(last_.camera.status, slam::TrackingStatus::kTrackedInNewSubmap);
  EXPECT_EQ(last_.camera.submap, 1);
  for (const auto& keyframe : perception_->map().staticMap()->keyframes) {
    EXPECT_GE(keyframe.frame, static_cast<std::size_t>(kSeesAgain));
  }
  const auto others = perception_->otherSubmaps();
  ASSERT_EQ(others.size(), 1U);
  EXPECT_EQ(others[0].number, 0);
  EXPECT_EQ(others[0].map.staticMap()->keyframes.front().frame, 0U);
  EXPECT_NEAR(static_cast<double>(knownCells(others[0].map)), static_cast<double>(first),
              0.1 * static_cast<double>(first))
      << "as it was left";
  std::size_t second = 0;
  for (int end = kSeesAgain + 4; end <= kRoundFrames && last_.camera.submap == 1; ++end) {
    second = knownCells(perception_->map());
    driveTo(end);
  }
  EXPECT_EQ(last_.camera.revision.cause, slam::MapChange::kSubmapJoined);
  EXPECT_EQ(last_.camera.submap, 0);
  EXPECT_TRUE(perception_->otherSubmaps().empty());
  EXPECT_EQ(perception_->map().staticMap()->keyframes.front().frame, 0U);
  EXPECT_GT(knownCells(perception_->map()), 1.1 * static_cast<double>(std::max(first, second)));
}

TEST_F(SubmapLayersTest, TheLargestIsCompleteAtTheEnd) {
  driveTo(kCovered);
  perception_->updateDenseMap();
  ASSERT_NE(perception_->map().dense(), nullptr);
  driveTo(kSeesAgain + 2);
  EXPECT_EQ(last_.camera.submap, 1);
  EXPECT_EQ(perception_->map().dense(), nullptr) << "of the other submap";
  perception_->finish();
  EXPECT_EQ(perception_->map().staticMap()->keyframes.front().frame, 0U);
  ASSERT_NE(perception_->map().dense(), nullptr);
  EXPECT_GT(perception_->map().dense()->size(), 100U);
  EXPECT_GT(knownCells(perception_->map()), 50U);
  ASSERT_EQ(perception_->otherSubmaps().size(), 1U);
}

}  // namespace
}  // namespace headway::pipeline
