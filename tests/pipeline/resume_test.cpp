// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/map/map_query.h>
#include <headway/pipeline/perception.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <headway_test/repeats.h>
#include <headway_test/textured_world.h>

namespace headway::pipeline {
namespace {

using ::testing::HasSubstr;

/// A small robot in a hall, which it maps, leaves, and comes back to.
class ResumeTest : public ::testing::Test {
 protected:
  ResumeTest() : hall_(test::smallCamera()) {
    hall_.addRoom(12.0, 8.0, 4.0);
    params_.slam.features = 250;
  }

  static Pose onPath(double step) {
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * step, 0.3 * std::sin(0.05 * step), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.4 * std::sin(0.1 * step)});
    return pose;
  }

  [[nodiscard]] RecordedFrame frameAt(std::size_t index, double step) const {
    RecordedFrame frame;
    frame.index = index;
    frame.time = 0.1 * static_cast<double>(index);
    frame.stereo = hall_.frame(index, frame.time, onPath(step));
    return frame;
  }

  /// Drives along steps of the path and returns the largest error of a tracked pose [m].
  double drive(Perception& perception, int from, int to) const {
    double worst = 0.0;
    for (int step = from; step < to; ++step) {
      const auto update = perception.process(frameAt(static_cast<std::size_t>(step - from), step));
      EXPECT_EQ(slam::TrackingStatus::kTracked, update.camera.status) << step;
      const Eigen::Vector3d truth = onPath(step).translation();
      worst = std::max(worst, (update.camera.T_map_robot.translation() - truth).norm());
    }
    return worst;
  }

  [[nodiscard]] std::string mapOfDrive(int from, int to) const {
    Perception perception(hall_.camera(), params_);
    EXPECT_LT(drive(perception, from, to), 0.05);
    map::saveMap(path_, perception.stored());
    return test::contentsOf(path_);
  }

  void writeMap(const std::string& bytes) const {
    std::filesystem::remove(path_);
    std::ofstream(path_, std::ios::binary) << bytes;
  }

  /// Error of loading the file and resuming in it; empty without an error.
  [[nodiscard]] std::string errorOfResuming(const StereoCamera& camera) const {
    try {
      const auto stored = map::loadMap(path_);
      Perception(std::make_shared<StereoCamera>(camera), params_).resume(stored);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::TexturedWorld hall_;
  PerceptionParams params_;
  test::TemporaryFolder folder_;
  std::string path_ = folder_ / "map.headway";
};

TEST_F(ResumeTest, ASecondDriveIsInTheFrameOfTheFirstAndMapsOn) {
  (void)mapOfDrive(0, 15);
  Perception second(hall_.camera(), params_);
  second.resume(map::loadMap(path_));
  const std::size_t keyframes = second.map().staticMap()->keyframes.size();
  EXPECT_GT(keyframes, 0u) << "the loaded map is shown before the first frame";
  EXPECT_LT(drive(second, 8, 30), 0.05);
  EXPECT_GT(second.map().staticMap()->keyframes.size(), keyframes);
}

TEST_F(ResumeTest, WithoutMappingTheMapStaysAsItIs) {
  (void)mapOfDrive(0, 25);
  params_.slam.mapping = false;
  Perception second(hall_.camera(), params_);
  const auto stored = map::loadMap(path_);
  second.resume(stored);
  EXPECT_LT(drive(second, 2, 24), 0.05);
  const auto& before = *stored.map.staticMap();
  const auto& after = *second.map().staticMap();
  ASSERT_EQ(before.landmarks.size(), after.landmarks.size());
  ASSERT_EQ(before.keyframes.size(), after.keyframes.size());
  for (std::size_t i = 0; i < after.landmarks.size(); ++i) {
    EXPECT_EQ(before.landmarks[i].position, after.landmarks[i].position);
  }
}

TEST_F(ResumeTest, AnEmptyGroundScanLeavesTheMapWithoutGrid) {
  params_.grid.scan.reach_m = 0.5;
  params_.robot = {0.0, 0.0};
  Perception perception(hall_.camera(), params_);
  EXPECT_LT(drive(perception, 0, 3), 0.05);
  EXPECT_EQ(1u, perception.times().summary().at("grid").count);
  EXPECT_EQ(nullptr, perception.map().staticGrid());
}

TEST_F(ResumeTest, TheGroundUnderTheRobotIsKnownFromTheFirstFrameOn) {
  params_.grid.scan.reach_m = 0.5;
  params_.robot = {4.5, 1.8};
  const map::FootprintShape footprint{4.5, 1.8, false};
  Perception perception(hall_.camera(), params_);
  for (std::size_t step = 0; step < 4; ++step) {
    const auto update = perception.process(frameAt(step, static_cast<double>(step)));
    const Pose& at = update.camera.T_map_robot;
    const auto collision =
        perception.map()
            .at(update.time)
            .timeToCollision(footprint, {{update.time, at.translation().head<2>(), yawOf(at)}});
    EXPECT_EQ(map::toString(collision.status), "known") << step;
    EXPECT_FALSE(collision.earliest_s) << step;
  }
}

TEST_F(ResumeTest, FreeAndOccupiedGroundIsPartOfTheMapAndIsTakenUpAgain) {
  params_.grid.scan.reach_m = 20.0;  // the wall at the end of the hall is beyond the rig's own
  const auto expectHall = [](const map::PerceptionMap& map) {
    const auto grid = map.staticGrid();
    ASSERT_NE(nullptr, grid);
    EXPECT_GT(grid->getPos(4.5f, 0.1f), 0.55f) << "the floor";
    EXPECT_LT(grid->getPos(6.05f, 0.0f), 0.4f) << "the wall at its end";
    EXPECT_NEAR(0.5f, grid->getPos(7.0f, 0.0f), 0.05f) << "what is behind that";
  };
  Perception first(hall_.camera(), params_);
  EXPECT_LT(drive(first, 0, 15), 0.05);
  expectHall(first.map());
  EXPECT_EQ(5u, first.times().summary().at("grid").count) << "every third frame";
  map::saveMap(path_, first.stored());

  Perception second(hall_.camera(), params_);
  second.resume(map::loadMap(path_));
  expectHall(second.map());
  EXPECT_LT(drive(second, 8, 20), 0.05);
  expectHall(second.map());

  params_.grid.period_s = 0.0;
  Perception without(hall_.camera(), params_);
  EXPECT_LT(drive(without, 0, 3), 0.05);
  EXPECT_EQ(nullptr, without.map().staticGrid());
}

TEST_F(ResumeTest, ADamagedGridIsReported) {
  (void)mapOfDrive(0, 1);
  auto stored = map::loadMap(path_);
  stored.attachments.at("grid").resize(20);
  map::saveMap(path_, stored);
  EXPECT_THAT(errorOfResuming(*hall_.camera()), HasSubstr("ground scans"));
}

TEST_F(ResumeTest, AMapThatWasTakenUpAndStoredAtOnceIsTheSame) {
  (void)mapOfDrive(0, 6);
  const auto stored = map::loadMap(path_);
  Perception second(hall_.camera(), params_);
  second.resume(stored);
  map::saveMap(path_, second.stored());
  EXPECT_EQ(stored.attachments, map::loadMap(path_).attachments);
}

TEST_F(ResumeTest, AMapIsTakenUpWithoutAFile) {
  Perception first(hall_.camera(), params_);
  EXPECT_LT(drive(first, 0, 6), 0.05);
  Perception second(hall_.camera(), params_);
  second.resume(first.stored());
  EXPECT_LT(drive(second, 3, 6), 0.05);
}

TEST_F(ResumeTest, AFileThatIsCutOffAtAnyByteIsAnError) {
  params_.slam.features = 50;
  params_.grid.period_s = 0.0;  // so that the file is short
  const std::string whole = mapOfDrive(0, 1);
  ASSERT_EQ("", errorOfResuming(*hall_.camera()));
  for (std::size_t length = whole.size(); length-- > 0;) {
    if (length % test::repeats(1, 97) != 0) continue;
    std::filesystem::resize_file(path_, length);
    ASSERT_NE("", errorOfResuming(*hall_.camera())) << length << " of " << whole.size();
  }
}

TEST_F(ResumeTest, AFileWithAWrongByteIsAnError) {
  params_.grid.period_s = 0.0;
  // Every byte of header and sections is tried elsewhere.
  constexpr std::size_t kStride = test::repeats(97, 997);
  std::string bytes = mapOfDrive(0, 1);
  for (std::size_t at = 0; at < bytes.size(); at += kStride) {
    bytes[at] = static_cast<char>(~bytes[at]);
    writeMap(bytes);
    EXPECT_NE("", errorOfResuming(*hall_.camera())) << at;
    bytes[at] = static_cast<char>(~bytes[at]);
  }
}

TEST_F(ResumeTest, AMapOfAnotherCameraIsAnErrorThatNamesBoth) {
  (void)mapOfDrive(0, 1);
  StereoCamera other = *hall_.camera();
  other.baseline_m *= 1.2;
  EXPECT_THAT(errorOfResuming(other), HasSubstr("another camera"));
  EXPECT_THAT(errorOfResuming(other), HasSubstr("baseline 0.2000 m"));
  EXPECT_THAT(errorOfResuming(other), HasSubstr("baseline 0.2400 m"));
}

TEST_F(ResumeTest, AMapOfAnotherVersionIsReported) {
  (void)mapOfDrive(0, 1);
  auto stored = map::loadMap(path_);
  stored.attachments.at("slam")[4] = 99;
  map::saveMap(path_, stored);
  EXPECT_THAT(errorOfResuming(*hall_.camera()), HasSubstr("version 99"));
}

TEST_F(ResumeTest, AMapWithoutLandmarksOfSlamIsAnError) {
  map::saveMap(path_, {});
  EXPECT_THAT(errorOfResuming(*hall_.camera()), HasSubstr("landmarks"));
}

TEST_F(ResumeTest, PosesAloneCannotTakeAMapUp) {
  (void)mapOfDrive(0, 1);
  Perception blind(nullptr, params_);
  EXPECT_THROW(blind.resume(map::loadMap(path_)), InputError);
}

TEST_F(ResumeTest, AGivenPoseInATakenUpMapIsAnError) {
  (void)mapOfDrive(0, 1);
  Perception second(hall_.camera(), params_);
  second.resume(map::loadMap(path_));
  auto frame = frameAt(0, 0.0);
  frame.T_map_robot = Pose::Identity();
  EXPECT_THROW((void)second.process(frame), InputError);
}

TEST_F(ResumeTest, AMountingThatIsNotStatedIsThatOfTheMap) {
  (void)mapOfDrive(0, 10);
  auto stored = map::loadMap(path_);
  stored.camera->T_robot_cam.translation().z() = 0.4;
  Perception perception(hall_.camera(), params_);
  perception.resume(stored);
  EXPECT_EQ(0.4, perception.camera()->T_robot_cam.translation().z());
  const auto update = perception.process(frameAt(0, 5.0));
  // The camera is where the map's keyframes are.
  const Pose T_map_cam = update.camera.T_map_robot * perception.camera()->T_robot_cam;
  EXPECT_LT((T_map_cam.translation() - onPath(5.0).translation()).norm(), 0.05);
}

}  // namespace
}  // namespace headway::pipeline
