// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/folders.h>
#include <headway_test/limits.h>
#include <headway_test/stereo_sequence.h>

#include <algorithm>
#include <fstream>

namespace headway::pipeline {
namespace {

// Real streets, the camera's poses from the recording's own truth: detector and tracker as the
// pipeline runs them.

struct FoundObject {
  Eigen::Vector3d place;     ///< in the camera's first frame [m]
  Eigen::Vector3d velocity;  ///< along the axes of that [m/s]
  double lateral;            ///< of the camera, to the right [m]
};

std::vector<FoundObject> objectsOf(const std::filesystem::path& data, const std::string& name) {
  const auto sequence = test::kittiSequence(data / "kitti_odometry", name);
  std::ifstream poses(data / "kitti_odometry" / "poses" / (name + ".txt"));
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(sequence.camera, params);
  std::vector<FoundObject> all;
  for (std::size_t i = 0; i < sequence.times.size(); ++i) {
    Pose T_map_cam = Pose::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) poses >> T_map_cam(row, column);
    }
    RecordedFrame frame;
    frame.index = i;
    frame.stereo = sequence.frame(i);
    frame.time = frame.stereo->time;
    frame.T_map_robot = robotFromOptical() * T_map_cam * robotFromOptical().inverse();
    const auto found = perception.process(frame).detections;
    if (!found) continue;
    for (const auto& item : found->items) {
      all.push_back({T_map_cam * item.box3d->centre, T_map_cam.linear() * item.velocity->value,
                     item.box3d->centre.x()});
    }
  }
  return all;
}

TEST(RealStreetsTest, OnAStreetOfParkedCarsOnlyTheOncomingOnesMove) {
  HEADWAY_REQUIRE_DATA(data);
  // Beyond the green in the street's middle, cars come towards the camera near the clip's end. All
  // else stands: false detections are few, and not so many in one place as confirm a track.
  std::vector<Eigen::Vector3d> mistaken;
  for (const auto& object : objectsOf(data, "06")) {
    const bool comes = object.lateral < -10.0 && object.velocity.z() < -5.0;
    if (comes) continue;
    const auto near = std::count_if(mistaken.begin(), mistaken.end(), [&](const auto& place) {
      return (place - object.place).norm() < 2.0;
    });
    EXPECT_LE(near, 1);
    mistaken.push_back(object.place);
  }
  test::expectWithin("false_objects", static_cast<int>(mistaken.size()),
                     test::kKitti06FalseObjects);
}

TEST(RealStreetsTest, TheCarsOnAMotorwayAreDetected) {
  HEADWAY_REQUIRE_DATA(data);
  const auto objects = objectsOf(data, "01");
  int fast = 0;
  for (const auto& object : objects) fast += object.velocity.norm() > 10.0 ? 1 : 0;
  EXPECT_GE(fast, test::kKitti01Cars);
  RecordProperty("cars", fast);
  // Nothing but cars moves there.
  test::expectWithin("false_objects", static_cast<int>(objects.size()) - fast,
                     test::kKitti01FalseObjects);
}

}  // namespace
}  // namespace headway::pipeline
