// SPDX-License-Identifier: BSD-3-Clause
// The protocol of the real-data figures: how many cases there are, and what two predictors of a
// few lines, written here, come to. Reference figures were found with another implementation.
#include <gmock/gmock.h>
#include <headway/eval/prediction_error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/folders.h>

#include <functional>

namespace headway::eval {
namespace {

using Velocity = std::function<Eigen::Vector3d(const std::vector<TrajectoryPoint>&)>;

std::vector<TrueObject> readObjects(const std::filesystem::path& training,
                                    const std::string& name) {
  std::vector<LabelledFrame> frames;
  for (const auto& row : io::readKittiRows(training / "label_02" / name)) {
    const auto detection = io::detectionFrom(row);
    if (!detection) continue;
    if (frames.size() <= row.frame) frames.resize(row.frame + 1);
    LabelledBox box;
    box.id = row.id;
    box.object_class = detection->object_class;
    box.box3d = detection->box3d;
    frames[row.frame].truth.push_back(box);
  }
  std::vector<Stamped<Pose>> T_map_cam;
  for (const auto& pose : io::readKittiPoses(training / "pose_orbslam3" / name)) {
    const double time = 0.1 * static_cast<double>(T_map_cam.size());
    T_map_cam.push_back({time, robotFromOptical() * pose});
  }
  return trueObjects(frames, T_map_cam);
}

PredictedPath straightOn(const Eigen::Vector3d& now, const Eigen::Vector3d& velocity) {
  PredictedPath path;
  for (std::size_t j = 0; j < kHorizons; ++j) {
    const double horizon_s = kHorizonStep_s * static_cast<double>(j + 1);
    path.points.push_back({horizon_s, now + horizon_s * velocity, Eigen::Matrix2d::Identity()});
  }
  return path;
}

PredictionErrors judge(const std::filesystem::path& training, const Velocity& velocity) {
  PredictionEvaluator all;
  for (const auto& file : std::filesystem::directory_iterator(training / "label_02")) {
    const auto objects = readObjects(training, file.path().filename());
    for (const auto& a_case : historyCases(objects, 0.1)) {
      all.add(objects[a_case.object].object_class,
              {straightOn(a_case.history.back().position, velocity(a_case.history))},
              a_case.future);
    }
  }
  return all.errors();
}

TEST(PredictionProtocolTest, StandingStill) {
  HEADWAY_REQUIRE_DATA(data);
  const auto errors =
      judge(data / "kitti_tracking/training", [](const auto&) { return Eigen::Vector3d::Zero(); });
  EXPECT_EQ(9849u, errors.all.cases);
  EXPECT_EQ(1u, errors.classes.at(ObjectClass::kTram).cases);
  EXPECT_NEAR(6.588, errors.all.ade_m.value(), 0.001);
  EXPECT_NEAR(12.792, errors.all.fde_m.value(), 0.001);
}

TEST(PredictionProtocolTest, ConstantVelocityOverHalfASecond) {
  HEADWAY_REQUIRE_DATA(data);
  const auto errors = judge(data / "kitti_tracking/training", [](const auto& history) {
    const Eigen::Vector3d moved = history.back().position - history[history.size() - 6].position;
    return Eigen::Vector3d(moved / 0.5);
  });
  EXPECT_NEAR(0.757, errors.all.ade_m.value(), 0.001);
  EXPECT_NEAR(1.849, errors.all.fde_m.value(), 0.001);
}

}  // namespace
}  // namespace headway::eval
