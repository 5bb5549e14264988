// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/worker_thread.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>

#include <cmath>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class RawlogSourceTest : public ::testing::Test {
 protected:
  void writeWall(RawlogSink& sink, std::size_t i, std::optional<Time> time = {}) {
    const auto [left, right] = test::wall(static_cast<int>(i));
    sink.writeStereo(time.value_or(test::frameTime(i)), left, right, rawFrom(test::smallCamera()));
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

Detections boxesAt(Time time, ObjectClass object_class = ObjectClass::kCar) {
  Detections detections;
  detections.time = time;
  Detection detection;
  detection.object_class = object_class;
  detection.box2d = Box2d{10, 20, 30, 40};
  detection.box3d = Box3d{{1, 2, 30}, 4, 2, 1.5, 0.5};
  detections.items.push_back(detection);
  return detections;
}

Pose poseAtX(double x) { return Pose(Eigen::Translation3d(x, 0, 0)); }

TEST_F(RawlogSourceTest, ReturnsRecordedPixels) {
  test::recordWalls(path_, 5);
  RawlogSource source(path_, {});
  const StereoCamera expected = test::smallCamera();
  ASSERT_NE(nullptr, source.camera());
  EXPECT_EQ(expected.fx, source.camera()->fx);
  EXPECT_EQ(expected.cy, source.camera()->cy);
  EXPECT_EQ(expected.baseline_m, source.camera()->baseline_m);
  EXPECT_TRUE(expected.T_robot_cam.isApprox(source.camera()->T_robot_cam, 1e-12));
  const auto frames = test::framesOf(source);
  ASSERT_EQ(5u, frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(i, frames[i].index);
    EXPECT_NEAR(test::frameTime(i), frames[i].time, 1e-7);
    ASSERT_TRUE(frames[i].stereo);
    const auto [left, right] = test::wall(static_cast<int>(i));
    EXPECT_TRUE(test::sameImage(left, frames[i].stereo->left));
    EXPECT_TRUE(test::sameImage(right, frames[i].stereo->right));
    EXPECT_TRUE(frames[i].stereo->left_colour.empty());
    EXPECT_EQ(source.camera(), frames[i].stereo->camera);
    EXPECT_FALSE(frames[i].detections);
    EXPECT_FALSE(frames[i].T_map_robot);
  }
  EXPECT_FALSE(source.truncation());
  EXPECT_TRUE(source.skipped().empty());
  EXPECT_EQ(1.0, source.progress());
}

TEST_F(RawlogSourceTest, ReadsAFrameAtTimeZero) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    writeWall(sink, 0, 0.0);
    writeWall(sink, 1, 0.1);
  }
  const auto frames = test::framesOf(path_);
  ASSERT_EQ(2u, frames.size());
  EXPECT_EQ(0.0, frames[0].time);
}

TEST_F(RawlogSourceTest, MeasuresTheCalibrationOnTheFirstPair) {
  test::recordWalls(path_, 2);
  const RawlogSource source(path_, {});
  ASSERT_TRUE(source.calibration());
  EXPECT_EQ(0.2, source.calibration()->baseline_m);
  EXPECT_EQ(100.0, source.calibration()->focal_px);
  EXPECT_GT(source.calibration()->matches, 20u);
  EXPECT_NEAR(8.0, source.calibration()->median_disparity_px, 0.1);
  EXPECT_LT(source.calibration()->vertical_disparity_px, 0.1);
  EXPECT_FALSE(source.calibration()->rectified_here);
}

TEST_F(RawlogSourceTest, ARangeKeepsTheFrameIndices) {
  test::recordWalls(path_, 6);
  RawlogSourceOptions options;
  options.from_index = 2;
  options.to_index = 4;
  const auto frames = test::framesOf(path_, options);
  ASSERT_EQ(3u, frames.size());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(i + 2, frames[i].index);
    EXPECT_TRUE(test::sameImage(test::wall(static_cast<int>(i) + 2).left, frames[i].stereo->left));
  }
}

TEST_F(RawlogSourceTest, AStopRequestEndsTheSkippingToTheFirstFrame) {
  test::recordWalls(path_, 40);
  RawlogSourceOptions options;
  options.from_index = 35;
  RawlogSource source(path_, options);
  requestStop(1);
  EXPECT_FALSE(source.next());
  requestStop(0);
}

TEST_F(RawlogSourceTest, AssignsBoxesAndPosesToTheNearestFrame) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    sink.writeDetections("detections", boxesAt(test::frameTime(0) - 0.02));  // before its image
    writeWall(sink, 0);
    writeWall(sink, 1);
    writeWall(sink, 2);
    sink.writePose("pose", test::frameTime(0), poseAtX(1));
    sink.writeDetections("detections", boxesAt(test::frameTime(1) + 0.03));  // after the next one
    sink.writePose("pose", test::frameTime(2) - 0.04, poseAtX(3));
    writeWall(sink, 3);
  }
  RawlogSource source(path_, {});
  const auto frames = test::framesOf(source);
  ASSERT_EQ(4u, frames.size());
  EXPECT_TRUE(frames[0].detections);
  EXPECT_FALSE(frames[0].T_map_robot);  // recorded when the frame was gone already
  EXPECT_FALSE(frames[1].T_map_robot);
  EXPECT_TRUE(frames[1].detections);
  EXPECT_FALSE(frames[2].detections);
  ASSERT_TRUE(frames[2].T_map_robot);
  EXPECT_EQ(3.0, frames[2].T_map_robot->translation().x());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("unmatched_pose", 1u)));
}

TEST_F(RawlogSourceTest, BoxesKeepTheirPixelsAndNumbersInRectifiedRecordings) {
  Detections broken = boxesAt(test::frameTime(0));
  broken.items[0].box3d->centre.x() = NAN;
  broken.items[0].box2d->left = NAN;
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    writeWall(sink, 0);
    sink.writeDetections("detections", broken);
    writeWall(sink, 1);
    sink.writeDetections("detections", boxesAt(test::frameTime(1)));
  }
  const auto frames = test::framesOf(path_);
  EXPECT_TRUE(std::isnan(frames.at(0).detections->items.at(0).box3d->centre.x()));
  EXPECT_TRUE(std::isnan(frames.at(0).detections->items.at(0).box2d->left));
  EXPECT_EQ(40.0, frames.at(1).detections->items.at(0).box2d->bottom);
}

TEST_F(RawlogSourceTest, CountsUnassignedBoxesAndPoses) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    sink.writeDetections("detections", boxesAt(5.0));
    writeWall(sink, 0);
    writeWall(sink, 1);
    sink.writeDetections("detections", boxesAt(test::frameTime(1)));
    sink.writeDetections("detections", boxesAt(test::frameTime(1) + 0.01));  // a second one
    sink.writeDetections("detections", boxesAt(500.0));
    sink.writePose("pose", 500.0, poseAtX(1));
  }
  RawlogSource source(path_, {});
  const auto frames = test::framesOf(source);
  EXPECT_NEAR(test::frameTime(1), frames.at(1).detections->time, 1e-6);
  EXPECT_THAT(source.skipped(),
              ElementsAre(Pair("unmatched_detections", 3u), Pair("unmatched_pose", 1u)));
}

TEST_F(RawlogSourceTest, ReturnsTruthOnlyFromReadTruth) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (std::size_t i = 0; i < 3; ++i) {
      writeWall(sink, i);
      sink.writePose("truth_pose", test::frameTime(i), poseAtX(static_cast<double>(i)));
      sink.writeDetections("truth_objects", boxesAt(test::frameTime(i)));
    }
  }
  RawlogSource source(path_, {});
  for (const auto& frame : test::framesOf(source)) {
    EXPECT_FALSE(frame.T_map_robot);
    EXPECT_FALSE(frame.detections);
  }
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("truth", 6u)));
  const auto truth = readTruth(path_);
  ASSERT_EQ(3u, truth.poses.size());
  EXPECT_EQ(2.0, truth.poses[2].value.translation().x());
  ASSERT_EQ(3u, truth.objects.size());
  EXPECT_EQ(ObjectClass::kCar, truth.objects[0].items[0].object_class);
}

TEST_F(RawlogSourceTest, PosesWithoutImagesAreFrames) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (std::size_t i = 0; i < 4; ++i) {
      sink.writePose("pose", test::frameTime(i), poseAtX(static_cast<double>(i)));
      sink.writeDetections("detections", boxesAt(test::frameTime(i)));
    }
  }
  RawlogSource source(path_, {});
  EXPECT_EQ(nullptr, source.camera());
  EXPECT_FALSE(source.calibration());
  const auto frames = test::framesOf(source);
  ASSERT_EQ(4u, frames.size());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(i, frames[i].index);
    EXPECT_FALSE(frames[i].stereo);
    EXPECT_EQ(static_cast<double>(i), frames[i].T_map_robot->translation().x());
    EXPECT_TRUE(frames[i].detections);
  }
  EXPECT_TRUE(source.rightColour().empty());
}

TEST_F(RawlogSourceTest, TimeRunningBackwardsIsCountedAndKeepsTheIndex) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    writeWall(sink, 0);
    writeWall(sink, 1);
    writeWall(sink, 2, test::frameTime(0) - 5.0);
    writeWall(sink, 3, test::frameTime(1));  // stands still
    writeWall(sink, 4);
  }
  RawlogSource source(path_, {});
  const auto frames = test::framesOf(source);
  ASSERT_EQ(3u, frames.size());
  EXPECT_EQ(4u, frames[2].index);
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("time_backwards", 2u)));
}

TEST_F(RawlogSourceTest, MissingAndBrokenImagesAreCountedAndKeepTheIndex) {
  test::recordWalls(path_, 5, ImageStorage::kExternalPng);
  const auto images = folder_ / "x_Images";
  std::filesystem::remove(images / "stereo_right_000001.png");
  test::writeContent(images / "stereo_left_000003.png", "not a picture");
  RawlogSource source(path_, {});
  const auto frames = test::framesOf(source);
  ASSERT_EQ(3u, frames.size());
  EXPECT_EQ(0u, frames[0].index);
  EXPECT_EQ(2u, frames[1].index);
  EXPECT_EQ(4u, frames[2].index);
  EXPECT_TRUE(test::sameImage(test::wall(4).left, frames[2].stereo->left));
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("broken_image", 1u), Pair("missing_image", 1u)));
}

TEST_F(RawlogSourceTest, TheFirstImageMayBeMissingButNotAll) {
  test::recordWalls(path_, 3, ImageStorage::kExternalPng);
  std::filesystem::remove(folder_ / "x_Images/stereo_left_000000.png");
  {
    RawlogSource source(path_, {});
    EXPECT_EQ(1u, test::framesOf(source).front().index);
  }
  std::filesystem::remove_all(folder_ / "x_Images");
  EXPECT_THAT(test::errorOf([&] { RawlogSource source(path_, {}); }),
              ::testing::AllOf(HasSubstr("missing_image: 3"), HasSubstr("x_Images")));
}

TEST_F(RawlogSourceTest, ALaterImageOfAnotherSizeIsCounted) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    writeWall(sink, 0);
    const auto [left, right] = test::wall(1, 8, {320, 240});
    sink.writeStereo(test::frameTime(1), left, right, rawFrom(test::smallCamera()));
    writeWall(sink, 2);
  }
  RawlogSource source(path_, {});
  EXPECT_EQ(2u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("image_size", 1u)));
}

TEST_F(RawlogSourceTest, OdometryIsInterpolatedAtTheFrames) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (int i = 0; i < 40; ++i) {  // 1 m/s, 25 ms apart, off the frames' times
      const double time = test::frameTime(0) - 0.09 + 0.025 * i;
      sink.writeOdometry(time, time - 100.0, 0.0, 0.0);
      if (i % 4 == 3) writeWall(sink, static_cast<std::size_t>(i / 4));
    }
  }
  const auto frames = test::framesOf(path_);
  EXPECT_FALSE(frames.at(0).stereo->motion_prior.T_previous_current);
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    const auto& prior = frames[i].stereo->motion_prior.T_previous_current;
    ASSERT_TRUE(prior) << i;
    EXPECT_NEAR(0.1, prior->translation().x(), 1e-6);
  }
  RawlogSourceOptions options;
  options.use_odometry = false;
  RawlogSource without(path_, options);
  EXPECT_FALSE(test::framesOf(without).at(2).stereo->motion_prior.T_previous_current);
  EXPECT_EQ(40u, without.skipped().at("CObservationOdometry"));
}

TEST_F(RawlogSourceTest, SkipsAndCountsOdometryThatIsNotFinite) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (std::size_t i = 0; i < 4; ++i) {
      sink.writeOdometry(test::frameTime(i), i == 1 ? NAN : 0.5 * static_cast<double>(i), 0, 0);
      writeWall(sink, i);
    }
  }
  RawlogSource source(path_, {});
  for (const auto& frame : test::framesOf(source)) {
    const auto& prior = frame.stereo->motion_prior.T_previous_current;
    if (!prior) continue;
    EXPECT_NEAR(0.5, prior->translation().x(), 1e-6) << frame.index;
  }
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("bad_odometry", 1u)));
}

TEST_F(RawlogSourceTest, CountsInertialSamplesThatAreNotFinite) {
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::nan(""));
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (int i = 0; i < 3; ++i) {
      sink.writeImu(test::frameTime(static_cast<std::size_t>(i)), nan, nan);
      writeWall(sink, static_cast<std::size_t>(i));
    }
  }
  RawlogSource source(path_, {});
  for (const auto& frame : test::framesOf(source)) {
    EXPECT_FALSE(frame.stereo->motion_prior.specific_force);
  }
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("bad_imu", 3u)));
}

TEST_F(RawlogSourceTest, InertialSamplesGiveRotationAndForce) {
  const Eigen::Vector3d omega(0.0, 0.0, 0.5);
  const Eigen::Vector3d gravity(0.0, 9.81 * std::sin(0.1), 9.81 * std::cos(0.1));
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (int i = 0; i < 100; ++i) {
      sink.writeImu(test::frameTime(0) - 0.1 + 0.01 * i, omega, gravity);
      if (i % 10 == 9) writeWall(sink, static_cast<std::size_t>(i / 10));
    }
  }
  const auto frames = test::framesOf(path_);
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const auto& prior = frames[i].stereo->motion_prior;
    ASSERT_TRUE(prior.specific_force) << i;
    EXPECT_TRUE(prior.specific_force->isApprox(gravity, 1e-6));
    if (i == 0) continue;
    ASSERT_TRUE(prior.R_previous_current) << i;
    EXPECT_TRUE(prior.R_previous_current->isApprox(expSo3(0.1 * omega), 1e-6));
  }
}

TEST_F(RawlogSourceTest, ASourceCanBeMoved) {
  test::recordWalls(path_, 3);
  RawlogSource first(path_, {});
  ASSERT_TRUE(first.next());
  RawlogSource second = std::move(first);
  EXPECT_EQ(1u, second.next()->index);
}

/// Progress after each frame.
std::vector<double> progressOf(const std::string& path, const RawlogSourceOptions& options) {
  RawlogSource source(path, options);
  std::vector<double> progress;
  while (source.next()) progress.push_back(source.progress());
  return progress;
}

TEST_F(RawlogSourceTest, ProgressIsEvenWithImagesOutside) {
  test::recordWalls(path_, 20, ImageStorage::kExternalPng);
  const auto progress = progressOf(path_, {});
  ASSERT_EQ(20u, progress.size());
  for (std::size_t i = 0; i < progress.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(i + 1) / 20.0, progress[i], 0.12) << i;
  }
}

TEST_F(RawlogSourceTest, ProgressIsThatOfTheChosenFrames) {
  test::recordWalls(path_, 20, ImageStorage::kExternalPng);
  RawlogSourceOptions options;
  options.from_index = 4;
  options.to_index = 11;
  const auto progress = progressOf(path_, options);
  ASSERT_EQ(8u, progress.size());
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(static_cast<double>(i + 1) / 8.0, progress[i], 1e-9);
  options.to_index.reset();
  const auto to_the_end = progressOf(path_, options);
  ASSERT_EQ(16u, to_the_end.size());
  EXPECT_LT(to_the_end[0], 0.2);
  EXPECT_NEAR(0.5, to_the_end[7], 0.12);
}

}  // namespace
}  // namespace headway::io
