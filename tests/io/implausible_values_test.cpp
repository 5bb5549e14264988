// SPDX-License-Identifier: BSD-3-Clause
// Values that no sensor measures: each costs itself only, and is counted by reason.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway_test/folders.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "foreign_recording.h"
#include "kitti_odometry.h"
#include "motion_prior.h"
#include "synthetic_recording.h"
#include "text_rows.h"

namespace headway::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;
using Objects = std::vector<mrpt::serialization::CSerializable::Ptr>;

class ImplausibleValuesTest : public ::testing::Test {
 protected:
  /// Indices of the frames in a rawlog of these objects; skipped_ are its counts.
  std::vector<std::size_t> indicesOf(const Objects& objects) {
    test::writeObjects(path_, objects, false);
    RawlogSource source(path_, {});
    std::vector<std::size_t> indices;
    for (const auto& frame : test::framesOf(source)) indices.push_back(frame.index);
    skipped_ = source.skipped();
    return indices;
  }

  static mrpt::obs::CObservationStereoImages::Ptr pairAt(int number, Time time) {
    return test::wallObservation(number, time);
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
  std::map<std::string, std::size_t> skipped_;
};

mrpt::obs::CObservationRobotPose::Ptr poseAt(Time time, double x) {
  auto pose = mrpt::obs::CObservationRobotPose::Create();
  pose->timestamp = mrptTime(time);
  pose->sensorLabel = "pose";
  pose->pose.mean = mrpt::poses::CPose3D(x, 0, 0, 0, 0, 0);
  return pose;
}

TEST_F(ImplausibleValuesTest, OneTimeFarAheadCostsItsFrame) {
  EXPECT_THAT(indicesOf({pairAt(0, 100.0), pairAt(1, 100.1), pairAt(2, 1e9), pairAt(3, 100.3),
                         pairAt(4, 100.4)}),
              ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(skipped_, ElementsAre(Pair("time_outlier", 1)));
  EXPECT_THAT(indicesOf({pairAt(0, 1e9), pairAt(1, 100.1), pairAt(2, 100.2), pairAt(3, 100.3)}),
              ElementsAre(1, 2, 3));
  EXPECT_THAT(skipped_, ElementsAre(Pair("time_outlier", 1)));
  EXPECT_THAT(indicesOf({pairAt(0, 100.0), pairAt(1, 100.1), pairAt(2, 1e9)}), ElementsAre(0, 1));
}

TEST_F(ImplausibleValuesTest, APauseIsConfirmedByTheNextFrame) {
  EXPECT_THAT(indicesOf({pairAt(0, 100.0), pairAt(1, 100.1), pairAt(2, 500.0), pairAt(3, 500.1)}),
              ElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(skipped_.empty());
}

TEST_F(ImplausibleValuesTest, ACalibrationThatIsNotFiniteCostsItsFrame) {
  auto broken = pairAt(0, 100.0);
  broken->leftCamera.fx(std::nan(""));
  EXPECT_THAT(indicesOf({broken, pairAt(1, 100.1), pairAt(2, 100.2)}), ElementsAre(1, 2));
  EXPECT_THAT(skipped_, ElementsAre(Pair("bad_calibration", 1)));
}

TEST_F(ImplausibleValuesTest, PosesOutsideAnyMapAreSkipped) {
  auto skewed = poseAt(100.3, 0.0);
  mrpt::math::CMatrixDouble44 matrix = mrpt::math::CMatrixDouble44::Identity();
  matrix(0, 1) = 0.5;
  skewed->pose.mean = mrpt::poses::CPose3D(matrix);
  EXPECT_THAT(indicesOf({poseAt(100.0, 5.0), poseAt(100.1, 1e10), poseAt(100.2, NAN), skewed,
                         poseAt(100.4, 1e300), poseAt(100.5, 5.1)}),
              ElementsAre(0, 1));
  EXPECT_THAT(skipped_, ElementsAre(Pair("bad_pose", 4)));
}

TEST_F(ImplausibleValuesTest, AJumpOfTheRecordedPoseIsConfirmedByTheNext) {
  EXPECT_EQ(2u, indicesOf({poseAt(100.0, 5.0), poseAt(100.1, 1e5), poseAt(100.2, 5.2)}).size());
  EXPECT_THAT(skipped_, ElementsAre(Pair("pose_jump", 1)));
  EXPECT_EQ(3u, indicesOf({poseAt(100.0, 5.0), poseAt(100.1, 1e5), poseAt(100.2, 1e5 + 1.0),
                           poseAt(100.3, 1e5 + 2.0)})
                    .size());
  EXPECT_THAT(skipped_, ElementsAre(Pair("pose_jump", 1)));
}

TEST_F(ImplausibleValuesTest, OdometryAndDetectionsWithoutAPossiblePoseAreSkipped) {
  auto odometry = mrpt::obs::CObservationOdometry::Create();
  odometry->timestamp = mrptTime(100.05);
  odometry->odometry = mrpt::poses::CPose2D(1e300, 0, 0);
  auto detections = CObservationObjectDetections::Create();
  detections->sensorLabel = "detections";
  detections->timestamp = mrptTime(100.1);
  detections->sensor_pose = mrpt::poses::CPose3D(0, 1e200, 0, 0, 0, 0);
  EXPECT_EQ(2u, indicesOf({pairAt(0, 100.0), odometry, detections, pairAt(1, 100.1)}).size());
  EXPECT_THAT(skipped_, ElementsAre(Pair("bad_detections_pose", 1), Pair("bad_odometry", 1)));
}

TEST_F(ImplausibleValuesTest, BoxesAndCovariancesThatCannotBeAreCounted) {
  CObservationObjectDetections observation;
  observation.items.resize(6);
  for (auto& item : observation.items) {
    item.class_name = "Car";
    item.box3d = Box3d{{0, 0, 10}, 4, 2, 1.5, 0};
  }
  observation.items[0].box3d->centre.x() = 1e300;
  observation.items[1].score = std::nan("");
  observation.items[2].centre_covariance = -Eigen::Matrix3d::Identity();
  observation.items[3].centre_covariance = 1e154 * Eigen::Matrix3d::Identity();
  observation.items[4].centre_covariance = Eigen::Matrix3d::Ones() + Eigen::Matrix3d::Identity();
  (*observation.items[4].centre_covariance)(0, 1) = 9.0;
  (*observation.items[4].centre_covariance)(1, 0) = 9.0;
  observation.items[5].centre_covariance = Eigen::Matrix3d::Identity();
  std::map<std::string, std::size_t> dropped;
  const auto detections = detectionsFrom(observation, dropped);
  ASSERT_EQ(4u, detections.items.size());
  EXPECT_THAT(dropped, ElementsAre(Pair("bad_covariance", 3), Pair("implausible_box", 2)));
  EXPECT_FALSE(detections.items[0].centre_covariance);
  EXPECT_TRUE(detections.items[3].centre_covariance);
}

TEST_F(ImplausibleValuesTest, OneOdometryTimeFarAheadDoesNotEndTheMotionPrior) {
  MotionPriorBuilder prior;
  for (int i = 0; i < 10; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.1 * i;
    prior.addOdometry(i == 4 ? 1e9 : 0.1 * i, pose);
  }
  const auto motion = prior.between(0.6, 0.8).T_previous_current;
  ASSERT_TRUE(motion);
  EXPECT_NEAR(0.2, motion->translation().x(), 1e-9);
}

TEST_F(ImplausibleValuesTest, LabelsDoNotReachTheTerminalWithEscapeSequences) {
  test::writeObjects(path_, {test::wallObservation(0, 1.0, "\x1b[31mred\x1b[0m"),
                             test::wallObservation(0, 1.0, "caf\xC3\xA9 \xC2\x9B 2J")});
  const std::string message = test::errorOf([&] { RawlogSource source(path_, {}); });
  EXPECT_THAT(message, HasSubstr("'?[31mred?[0m'"));
  EXPECT_THAT(message, HasSubstr("caf\xC3\xA9"));
  EXPECT_THAT(message, Not(HasSubstr("\x9B")));
}

TEST_F(ImplausibleValuesTest, YamlThatHangsOrCrashesItsReaderIsRefused) {
  const auto errorOfYaml = [&](const std::string& content) {
    test::writeContent(path_, content);
    return test::errorOf([&] { (void)readCalibration(path_); });
  };
  EXPECT_THAT(errorOfYaml("%\xFF\n"), HasSubstr("not ASCII"));
  EXPECT_THAT(errorOfYaml("a: 1\r%,2:\xACs\n"), HasSubstr("not ASCII"));
  EXPECT_THAT(errorOfYaml("a: \x01\n"), HasSubstr("control character"));
  EXPECT_THAT(errorOfYaml(std::string(20000, '[')), HasSubstr("nested"));
  EXPECT_THAT(errorOfYaml("a: " + std::string(20000, '{')), HasSubstr("nested"));
  std::string dashes;
  for (int i = 0; i < 20000; ++i) dashes += "- ";
  EXPECT_THAT(errorOfYaml(dashes), HasSubstr("nested"));
  EXPECT_THAT(errorOfYaml(std::string(3 << 20, 'a')), HasSubstr("1 MB"));
}

TEST_F(ImplausibleValuesTest, YamlWithAKeyThatIsNoStringIsRefused) {
  for (const char* key : {"NULL", "null", "~", "\"~\""}) {
    for (const char* rest : {"", ", a: 1"}) {
      const std::string map = std::string("{") + key + ": [1, 2]" + rest + "}";
      for (const std::string& content : {map, "M1: " + map + "\n", "D1: [[1, " + map + "]]\n"}) {
        test::writeContent(path_, content);
        EXPECT_THROW((void)readCalibration(path_), InputError) << content;
        EXPECT_THROW((void)readRawCalibration(path_), InputError) << content;
        EXPECT_THROW((void)readStereoCalibration(path_, {752, 480}), InputError) << content;
      }
    }
  }
  test::writeContent(path_, "M1: {NULL: [458, 0, 367]}\n");
  EXPECT_THAT(test::errorOf([&] { (void)readRawCalibration(path_); }), HasSubstr("not a string"));
}

TEST_F(ImplausibleValuesTest, LongRowsAreWhole) {
  EXPECT_EQ(2000u, formatted("%s", std::string(2000, 'x').c_str()).size());
  EXPECT_EQ(255u, formatted("%s", std::string(255, 'x').c_str()).size());
  EXPECT_EQ(256u, formatted("%s", std::string(256, 'x').c_str()).size());
  EXPECT_EQ("", formatted("%s", ""));
}

TEST_F(ImplausibleValuesTest, AFieldThatIsMissingOrNoNumberIsAnErrorInEachColumn) {
  const auto expectErrors = [&](const std::string& header, const std::string& row, auto read) {
    const auto fields = static_cast<int>(std::count(row.begin(), row.end(), ',')) + 1;
    for (int broken = -1; broken <= fields; ++broken) {  // the first row is good, the last short
      std::istringstream good(row);
      std::string text;
      for (int i = 0; i < fields - (broken == fields ? 1 : 0); ++i) {
        std::string field;
        std::getline(good, field, ',');
        text += (i > 0 ? "," : "") + (i == broken ? "x" : field);
      }
      test::writeContent(path_, header + "\n" + text + "\n");
      const std::string message = test::errorOf([&] { read(path_); });
      EXPECT_THAT(message, broken < 0 ? HasSubstr("no error") : HasSubstr(path_ + ":2: ")) << text;
    }
  };
  expectErrors(predictionCsvHeader(), "0,1,2,Car,0,1,0.5,1,2,3,1,0,1",
               [](const std::string& path) { (void)readPredictionCsv(path); });
  expectErrors(trackCsvHeader(), "0,1,2,Car,confirmed,1,1,2,3,0,4,2,1.5,1,0,0,1,1,0,1,1,0",
               [](const std::string& path) { (void)readTrackCsv(path); });
}

TEST_F(ImplausibleValuesTest, KittiCalibrationsMayHaveRowsWithoutAName) {
  for (const char* row : {",1,2", ":", ": 1 2", ",1,2,3,4,5,6,7,8,9,10,11,12"}) {
    test::writeContent(path_, std::string(row) + "\nP0: 1 2\n");
    EXPECT_EQ(1u, readKittiCalibration(path_).count("P0")) << row;
    EXPECT_THAT(test::errorOf([&] { (void)readKittiProjections(path_); }),
                HasSubstr("no line 'P0:'"))
        << row;
  }
}

}  // namespace
}  // namespace headway::io
