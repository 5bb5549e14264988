// SPDX-License-Identifier: BSD-3-Clause
// The ways in which others record: sensory frames, single images, colour, several cameras.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <cmath>

#include "foreign_recording.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using mrpt::serialization::CSerializable;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using Objects = std::vector<CSerializable::Ptr>;

class RawlogKindsTest : public ::testing::Test {
 protected:
  RawlogSource opened(const Objects& objects, const RawlogSourceOptions& options = {},
                      bool compressed = true) {
    test::writeObjects(path_, objects, compressed);
    return {path_, options};
  }
  std::string errorFor(const Objects& objects, const RawlogSourceOptions& options = {}) {
    return test::errorOf([&] { (void)opened(objects, options); });
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

Objects walls(int frames, const std::string& label = "stereo") {
  Objects objects;
  for (int i = 0; i < frames; ++i) {
    objects.push_back(test::wallObservation(i, test::frameTime(i), label));
  }
  return objects;
}

mrpt::obs::CActionCollection::Ptr movement(double forward) {
  mrpt::obs::CActionRobotMovement2D action;
  action.computeFromOdometry(mrpt::poses::CPose2D(forward, 0, 0),
                             mrpt::obs::CActionRobotMovement2D::TMotionModelOptions());
  auto actions = mrpt::obs::CActionCollection::Create();
  actions->insert(action);
  return actions;
}

mrpt::obs::CObservation2DRangeScan::Ptr laserScan(Time time, const std::string& label = "laser") {
  auto scan = mrpt::obs::CObservation2DRangeScan::Create();
  scan->timestamp = mrptTime(time);
  scan->sensorLabel = label;
  scan->sensorPose = mrpt::poses::CPose3D(0.1, 0.0, 0.2, M_PI / 2.0, 0.0, 0.0);
  scan->aperture = static_cast<float>(M_PI);
  scan->maxRange = 10.0F;
  scan->stdError = 0.01F;
  const std::vector<float> ranges = {1.0F, 2.0F, 3.0F, 10.0F, 4.0F};  // one at the limit
  scan->resizeScan(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    scan->setScanRange(i, ranges[i]);
    scan->setScanRangeValidity(i, i != 1);
  }
  return scan;
}

void expectLaserScan(const RecordedFrame& frame) {
  ASSERT_EQ(1u, frame.laser_scans.size());
  const LaserScan& scan = frame.laser_scans.front();
  EXPECT_EQ("laser", scan.label);
  EXPECT_NEAR(0.2, scan.T_robot_laser.translation().z(), 1e-6);
  ASSERT_EQ(3u, scan.ends.size());
  EXPECT_NEAR(0.0, (scan.ends[0] - Eigen::Vector2f(0.0F, -1.0F)).norm(), 1e-5) << "the right";
  EXPECT_NEAR(0.0, (scan.ends[1] - Eigen::Vector2f(3.0F, 0.0F)).norm(), 1e-5);
  EXPECT_NEAR(0.0, (scan.ends[2] - Eigen::Vector2f(0.0F, 4.0F)).norm(), 1e-5) << "the left";
}

TEST_F(RawlogKindsTest, ReadsLaserScansOfAllKindsOfRawlogs) {
  RawlogSourceOptions options;
  options.use_laser = true;
  Objects alone, sensory, with_actions;
  for (int i = 0; i < 3; ++i) {
    const auto image = test::wallObservation(i, test::frameTime(i), "stereo");
    const auto scan = laserScan(test::frameTime(i) + 0.02);
    alone.push_back(image);
    alone.push_back(scan);
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(image);
    frame->insert(scan);
    sensory.push_back(frame);
    with_actions.push_back(movement(0.1));
    with_actions.push_back(frame);
  }
  for (const auto& objects : {alone, sensory, with_actions}) {
    auto source = opened(objects, options);
    const auto frames = test::framesOf(source);
    ASSERT_EQ(3u, frames.size());
    for (const auto& frame : frames) expectLaserScan(frame);
    EXPECT_TRUE(source.skipped().empty());
  }
}

TEST_F(RawlogKindsTest, CountsLaserScansThatAreNotUsed) {
  RawlogSourceOptions options;
  options.use_laser = true;
  Objects objects = walls(2);
  auto no_ranges = laserScan(test::frameTime(0));
  for (std::size_t i = 0; i < 5; ++i) no_ranges->setScanRangeValidity(i, false);
  auto no_pose = laserScan(test::frameTime(0));
  no_pose->sensorPose = mrpt::poses::CPose3D(NAN, 0.0, 0.0, 0.0, 0.0, 0.0);
  objects.insert(objects.begin(), {no_ranges, no_pose, laserScan(test::frameTime(0) - 0.03),
                                   laserScan(test::frameTime(0) - 0.01)});
  auto source = opened(objects, options);
  EXPECT_EQ(1u, test::framesOf(source).at(0).laser_scans.size());
  EXPECT_THAT(source.skipped(),
              ElementsAre(Pair("laser_bad_pose", 1), Pair("laser_between_frames", 1),
                          Pair("laser_no_ranges", 1)));
  auto without = opened(objects);
  EXPECT_TRUE(test::framesOf(without).at(0).laser_scans.empty());
  EXPECT_EQ(4u, without.skipped().at("CObservation2DRangeScan"));
}

TEST_F(RawlogKindsTest, ReadsPlainLikeCompressedFiles) {
  auto source = opened(walls(3), {}, false);
  EXPECT_EQ(3u, test::framesOf(source).size());
  EXPECT_FALSE(source.truncation());
  EXPECT_EQ(1.0, source.progress());
}

TEST_F(RawlogKindsTest, SensoryFramesGiveTheirObservationsAndActionsTheOdometry) {
  Objects objects;
  for (int i = 0; i < 4; ++i) {
    objects.push_back(movement(0.5));
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(test::wallObservation(i, test::frameTime(i)));
    auto scan = mrpt::obs::CObservation2DRangeScan::Create();
    scan->timestamp = mrptTime(test::frameTime(i));
    frame->insert(scan);
    objects.push_back(frame);
  }
  auto source = opened(objects);
  const auto frames = test::framesOf(source);
  ASSERT_EQ(4u, frames.size());
  EXPECT_FALSE(source.truncation()) << *source.truncation();
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("CObservation2DRangeScan", 4u)));
  EXPECT_FALSE(frames[0].stereo->motion_prior.T_previous_current);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    ASSERT_TRUE(frames[i].stereo->motion_prior.T_previous_current) << i;
    EXPECT_TRUE(frames[i].stereo->motion_prior.T_previous_current->translation().isApprox(
        Eigen::Vector3d(0.5, 0, 0), 1e-9));
    EXPECT_TRUE(test::sameImage(test::wall(static_cast<int>(i)).left, frames[i].stereo->left));
  }
}

TEST_F(RawlogKindsTest, PairsSingleImagesByTimeAndGeometry) {
  Objects objects;
  for (int i = 0; i < 4; ++i) {
    // The right camera comes first, has the name that sorts first, and is 2 ms late.
    objects.push_back(test::singleImage(1, i, test::frameTime(i) + 0.002, "cam_a"));
    objects.push_back(test::singleImage(0, i, test::frameTime(i), "cam_b"));
  }
  auto source = opened(objects);
  const auto frames = test::framesOf(source);
  ASSERT_EQ(4u, frames.size());
  EXPECT_NEAR(0.2, source.camera()->baseline_m, 1e-12);
  EXPECT_TRUE(source.camera()->T_robot_cam.isApprox(test::smallCamera().T_robot_cam, 1e-12));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(test::frameTime(i), frames[i].time, 1e-7);
    EXPECT_TRUE(test::sameImage(test::wall(static_cast<int>(i)).left, frames[i].stereo->left));
    EXPECT_TRUE(test::sameImage(test::wall(static_cast<int>(i)).right, frames[i].stereo->right));
  }
  EXPECT_TRUE(source.skipped().empty());
}

TEST_F(RawlogKindsTest, CountsUnpairedSingleImages) {
  Objects objects;
  for (int i = 0; i < 5; ++i) {
    objects.push_back(test::singleImage(0, i, test::frameTime(i), "left"));
    if (i != 2) objects.push_back(test::singleImage(1, i, test::frameTime(i), "right"));
  }
  objects.push_back(test::singleImage(1, 9, test::frameTime(9), "right"));
  auto source = opened(objects);
  EXPECT_EQ(4u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("unpaired_image", 2u)));
}

TEST_F(RawlogKindsTest, DoesNotPairImagesBeyondTheTolerance) {
  Objects objects;
  for (int i = 0; i < 4; ++i) {
    objects.push_back(test::singleImage(0, i, test::frameTime(i), "left"));
    objects.push_back(test::singleImage(1, i, test::frameTime(i) + 0.02, "right"));
  }
  EXPECT_THAT(errorFor(objects), HasSubstr("unpaired_image: 8"));
  RawlogSourceOptions lenient;
  lenient.pair_tolerance_s = 0.03;
  auto source = opened(objects, lenient);
  EXPECT_EQ(4u, test::framesOf(source).size());
}

TEST_F(RawlogKindsTest, OneCameraMayStartLongBeforeTheOther) {
  Objects objects;
  for (int i = 0; i < 40; ++i) {
    objects.push_back(test::singleImage(0, i, test::frameTime(i), "left"));
    if (i >= 30) objects.push_back(test::singleImage(1, i, test::frameTime(i), "right"));
  }
  auto source = opened(objects);
  EXPECT_EQ(10u, test::framesOf(source).size());
  std::size_t left_out = 0;
  for (const auto& [reason, count] : source.skipped()) left_out += count;
  EXPECT_EQ(30u, left_out);
}

TEST_F(RawlogKindsTest, RequiresTheSelectionOfOneOfSeveralCameras) {
  Objects objects;
  for (int i = 0; i < 3; ++i) {
    objects.push_back(test::wallObservation(i, test::frameTime(i), "front"));
    objects.push_back(test::wallObservation(10 + i, test::frameTime(i), "rear"));
  }
  EXPECT_THAT(errorFor(objects), HasSubstr("several stereo cameras; select one by its sensor "
                                           "label: 'front', 'rear'"));
  RawlogSourceOptions options;
  options.sensor_label = "side";
  EXPECT_THAT(errorFor(objects, options), HasSubstr("stereo 'front', 'rear'"));
  options.sensor_label = "rear";
  auto source = opened(objects, options);
  const auto frames = test::framesOf(source);
  ASSERT_EQ(3u, frames.size());
  EXPECT_TRUE(test::sameImage(test::wall(10).left, frames[0].stereo->left));
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("CObservationStereoImages", 3u)));
}

TEST_F(RawlogKindsTest, RequiresTheSelectionOfTwoOfSeveralSingleCameras) {
  Objects objects;
  for (int i = 0; i < 3; ++i) {
    objects.push_back(test::singleImage(0, i, test::frameTime(i), "left"));
    objects.push_back(test::singleImage(1, i, test::frameTime(i), "right"));
    objects.push_back(test::singleImage(1, i, test::frameTime(i), "third"));
  }
  EXPECT_THAT(errorFor(objects), HasSubstr("'left', 'right', 'third'"));
  RawlogSourceOptions options;
  options.sensor_label = "left,right";
  auto source = opened(objects, options);
  EXPECT_EQ(3u, test::framesOf(source).size());
  options.sensor_label = "right,left";
  EXPECT_THAT(errorFor(objects, options), HasSubstr("swapped"));
}

TEST_F(RawlogKindsTest, PrefersStereoObservationsToSingleImages) {
  Objects objects = walls(3);
  objects.push_back(test::singleImage(0, 1, 100.0, "webcam"));
  auto source = opened(objects);
  EXPECT_EQ(3u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("CObservationImage", 1u)));
}

TEST_F(RawlogKindsTest, StereoWithoutRightImageIsCounted) {
  Objects objects = walls(4);
  std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(objects[1])->hasImageRight = false;
  auto source = opened(objects);
  const auto frames = test::framesOf(source);
  EXPECT_EQ(3u, frames.size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("no_right_image", 1u)));
}

TEST_F(RawlogKindsTest, KeepsColourWithTheGreyImage) {
  {
    RawlogSink sink(path_, ImageStorage::kEmbeddedRaw);
    const auto [left, right] = test::colourWall(3);
    sink.writeStereo(1.0, left, right, rawFrom(test::smallCamera()));
  }
  RawlogSource source(path_, {});
  const auto frame = source.next();
  ASSERT_TRUE(frame && frame->stereo);
  EXPECT_EQ(CV_8UC1, frame->stereo->left.type());
  EXPECT_EQ(CV_8UC1, frame->stereo->right.type());
  EXPECT_TRUE(test::sameImage(test::colourWall(3).left, frame->stereo->left_colour));
  EXPECT_TRUE(test::sameImage(test::colourWall(3).right, source.rightColour()));
}

TEST_F(RawlogKindsTest, ObservationsWithoutTimeAreCounted) {
  Objects objects = walls(3);
  std::dynamic_pointer_cast<mrpt::obs::CObservation>(objects[1])->timestamp = INVALID_TIMESTAMP;
  auto source = opened(objects);
  EXPECT_EQ(2u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("no_time", 1u)));
}

}  // namespace
}  // namespace headway::io
