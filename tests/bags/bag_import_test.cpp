// SPDX-License-Identifier: BSD-3-Clause
// The same recording as a bag of each format, imported by the program as a user runs it.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <opencv2/core.hpp>

#include "imported_bag.h"

namespace headway::bags {
namespace {

using ::testing::HasSubstr;

class EveryBagFormat : public test::BagTest, public ::testing::WithParamInterface<test::BagFormat> {
 protected:
  [[nodiscard]] std::string bag() const { return at(std::string("b.") + GetParam().ending); }

  void expectImages() const {
    const auto pairs = observations<mrpt::obs::CObservationStereoImages>();
    ASSERT_EQ(test::kRecordedFrames, static_cast<int>(pairs.size()));
    for (int i = 0; i < test::kRecordedFrames; ++i) {
      EXPECT_NEAR(test::kRecordedStart + 0.1 * i, io::timeFrom(pairs[i]->timestamp), 1e-6);
      EXPECT_TRUE(test::sameImage(test::recordedPicture(i), pairs[i]->imageLeft.asCvMatRef()));
      EXPECT_TRUE(test::sameImage(test::recordedPicture(i, 11), pairs[i]->imageRight.asCvMatRef()));
    }
    const auto& lens = pairs[0]->rightCamera;
    EXPECT_EQ(50.0, lens.fx());
    EXPECT_EQ(31.5, lens.cx());
    EXPECT_EQ(23.5, lens.cy());
    EXPECT_EQ(-0.05, lens.k2());
    EXPECT_EQ(0.002, lens.p2());
    EXPECT_NEAR(0.12, pairs[0]->rightCameraPose.x(), 1e-9);
    Pose mounting = robotFromOptical();
    mounting.translation() << 0.3, 0.05, 0.5;
    EXPECT_TRUE(fromMrpt(pairs[0]->cameraPose).isApprox(mounting, 1e-6));
  }

  void expectMotionSensors() const {
    using namespace mrpt::obs;  // names of the IMU's fields
    const auto samples = observations<CObservationIMU>();
    ASSERT_EQ(120u, samples.size());
    EXPECT_NEAR(test::kRecordedStart + 0.01, io::timeFrom(samples[1]->timestamp), 1e-6);
    // The sensor is turned by 90 degrees about the robot's z axis.
    EXPECT_NEAR(-0.2, samples[0]->get(IMU_WX), 1e-9);
    EXPECT_NEAR(0.1, samples[0]->get(IMU_WY), 1e-9);
    EXPECT_NEAR(0.3, samples[0]->get(IMU_WZ), 1e-9);
    EXPECT_NEAR(-2.0, samples[0]->get(IMU_X_ACC), 1e-9);
    EXPECT_NEAR(9.8, samples[0]->get(IMU_Z_ACC), 1e-9);
    const auto odometry = observations<CObservationOdometry>();
    ASSERT_EQ(12u, odometry.size());
    EXPECT_NEAR(0.5, odometry[5]->odometry.x(), 1e-9);
    EXPECT_NEAR(0.1, odometry[5]->odometry.y(), 1e-9);
    EXPECT_NEAR(0.05, odometry[5]->odometry.phi(), 1e-9);
  }

  void expectScansAndPositions() const {
    const auto scans = observations<mrpt::obs::CObservation2DRangeScan>();
    ASSERT_EQ(12u, scans.size());
    const auto& scan = *scans[0];
    ASSERT_EQ(181u, scan.getScanSize());
    EXPECT_NEAR(1.8, scan.aperture, 1e-5);
    EXPECT_TRUE(scan.rightToLeft);
    EXPECT_NEAR(0.5 - 0.1, scan.sensorPose.yaw(), 1e-5);  // mounted at 0.5, its middle at -0.1
    EXPECT_NEAR(0.2, scan.sensorPose.x(), 1e-9);
    EXPECT_NEAR(1.8, scan.getScanRange(80), 1e-5);
    EXPECT_TRUE(scan.getScanRangeValidity(0));
    EXPECT_FALSE(scan.getScanRangeValidity(7));  // infinite
    EXPECT_FALSE(scan.getScanRangeValidity(9));  // nearer than the least range
    EXPECT_EQ("/scan", scan.sensorLabel);
    const auto positions = observations<mrpt::obs::CObservationGPS>();
    ASSERT_EQ(11u, positions.size());
    const auto& gga = positions[0]->getMsgByClass<mrpt::obs::gnss::Message_NMEA_GGA>().fields;
    // Values, because references to the packed fields are not aligned.
    EXPECT_EQ(52.5, double{gga.latitude_degrees});
    EXPECT_EQ(13.25, double{gga.longitude_degrees});
    EXPECT_EQ(80.0, double{gga.altitude_meters});
    EXPECT_EQ(4, int{gga.fix_quality});
    EXPECT_TRUE(gga.thereis_HDOP);
    EXPECT_NEAR(0.05 * std::sqrt(2.0) / 0.03, double{gga.HDOP}, 1e-5);  // 5 cm in the bag
  }
};

TEST_P(EveryBagFormat, AllSensorsAreImported) {
  HEADWAY_WRITE_BAG(GetParam(), "mono", bag());
  const auto result = import(bag() + " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("/stereo/left/image_raw  sensor_msgs/Image  12  -> left"));
  EXPECT_THAT(
      result.output,
      HasSubstr("12 frames, 120 inertial samples, 12 laser scans, 12 odometry, 11 satellite "
                "positions, skipped gnss_without_fix 1\n"));
  expectImages();
  expectMotionSensors();
  expectScansAndPositions();
  Time last = 0.0;
  for (const auto& observation : allObservations()) {
    EXPECT_GE(io::timeFrom(observation->timestamp), last) << "observations are in order of time";
    last = io::timeFrom(observation->timestamp);
  }
  io::RawlogSource source(at("x.rawlog"), {});
  int frames = 0;
  while (source.next()) ++frames;
  EXPECT_EQ(test::kRecordedFrames, frames);
  EXPECT_NEAR(0.12, source.camera()->baseline_m, 1e-9);
  EXPECT_TRUE(source.calibration()->rectified_here);
}

TEST_P(EveryBagFormat, DepthCamerasAreImported) {
  HEADWAY_WRITE_BAG(GetParam(), "rgbd", bag());
  const auto result = import(bag() + " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  const auto frames = observations<mrpt::obs::CObservation3DRangeScan>();
  ASSERT_EQ(test::kRecordedFrames, static_cast<int>(frames.size()));
  const auto& frame = *frames[3];
  EXPECT_NEAR(test::kRecordedStart + 0.3, io::timeFrom(frame.timestamp), 1e-6);
  EXPECT_TRUE(frame.hasRangeImage && frame.hasIntensityImage && frame.range_is_depth);
  const cv::Mat expected = test::recordedDepth(3);
  for (int v = 0; v < expected.rows; ++v) {
    for (int u = 0; u < expected.cols; ++u) {
      ASSERT_NEAR(1e-3 * expected.at<std::uint16_t>(v, u),
                  frame.rangeImage(v, u) * frame.rangeUnits, 1e-6);
    }
  }
  const cv::Mat picture = frame.intensityImage.asCvMatRef();
  ASSERT_EQ(CV_8UC3, picture.type());
  const int red = test::recordedPicture(3).at<std::uint8_t>(20, 30);
  EXPECT_EQ(cv::Vec3b(17, static_cast<std::uint8_t>(255 - red), static_cast<std::uint8_t>(red)),
            picture.at<cv::Vec3b>(20, 30));
  EXPECT_EQ(0.1, frame.cameraParamsIntensity.k1());
  EXPECT_EQ(0.0, frame.cameraParams.k1());
  // The depth camera is where tf has the right one, and its axes are x forward.
  EXPECT_NEAR(0.05 - 0.12, frame.sensorPose.y(), 1e-6);
  EXPECT_NEAR(0.0, frame.sensorPose.yaw(), 1e-6);
  EXPECT_NEAR(0.0, frame.sensorPose.roll(), 1e-6);
  EXPECT_NEAR(0.12, frame.relativePoseIntensityWRTDepth.y(), 1e-6);
  EXPECT_FALSE(frame.doDepthAndIntensityCamerasCoincide());
}

TEST_P(EveryBagFormat, TopicsAreListed) {
  HEADWAY_WRITE_BAG(GetParam(), "mono", bag());
  const auto result = import(bag() + " --list");
  EXPECT_EQ(0, result.status);
  for (const char* line :
       {"/imu/data  sensor_msgs/Imu  120  -> inertial samples\n",
        "/stereo/right/camera_info  sensor_msgs/CameraInfo  12  -> calibration\n",
        "/tf_static  tf2_msgs/TFMessage  1  -> mounting\n"}) {
    EXPECT_THAT(result.output, HasSubstr(line));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Bags, EveryBagFormat,
    ::testing::Values(test::BagFormat{"bag", "none"}, test::BagFormat{"bag", "lz4"},
                      test::BagFormat{"bag", "bz2"}, test::BagFormat{"mcap", "none"},
                      test::BagFormat{"mcap", "lz4"}, test::BagFormat{"mcap", "zstd"},
                      test::BagFormat{"db3", "none"}),
    [](const auto& format) {
      return std::string(format.param.ending) + "_" + format.param.compression;
    });

}  // namespace
}  // namespace headway::bags
