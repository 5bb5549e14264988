// SPDX-License-Identifier: BSD-3-Clause
// A recording as MRPT 3.0 writes it, which MRPT 2.5.8 can neither read nor write. The bytes follow
// the published source of MRPT 3, serializeTo() and its version history: CImage 10 (raw pixels,
// colour as red, green, blue), CObservation2DRangeScan 8 (duration of the sweep) and
// CObservationGPS 12 (covariance). The other classes have the versions of MRPT 2.5.8, which writes
// them here.
#include <gtest/gtest.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <mrpt/math/CMatrixD.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <zstd.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "object_bytes.h"

namespace headway::io {
namespace {

using test::bytesOf;
using test::mrptBytes;
using test::objectBytes;
using test::textBytes;

const std::string kInside = bytesOf(false);  // not in a file of its own

std::string greyImage(const cv::Mat& image) {
  const auto size = static_cast<std::uint32_t>(image.total());
  constexpr std::int32_t kBytesOfAPixel = 1;
  return objectBytes("mrpt::img::CImage", 10,
                     kInside + bytesOf(false, image.cols, image.rows, size, kBytesOfAPixel) +
                         std::string(image.ptr<char>(), size));
}

std::string colourImage(const cv::Mat& image) {
  cv::Mat rgb;
  cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  return objectBytes(
      "mrpt::img::CImage", 10,
      kInside + bytesOf(true, rgb.cols, rgb.rows) + std::string(rgb.ptr<char>(), 3 * rgb.total()));
}

std::string timeBytes(Time time) { return bytesOf(mrptTime(time).time_since_epoch().count()); }

std::string laserScan(Time time) {
  const std::string ranges = bytesOf(std::uint32_t{3}, 1.0F, 2.0F, 3.0F) + std::string(3, '\1');
  return objectBytes("mrpt::obs::CObservation2DRangeScan", 8,
                     bytesOf(3.0F, true, 10.0F) + mrptBytes(mrpt::poses::CPose3D()) + ranges +
                         bytesOf(0.01F) + timeBytes(time) + bytesOf(0.01F) + textBytes("laser") +
                         bytesOf(0.0, false) + bytesOf(0.025F));
}

/// A position with GGA of quality 1; the covariance may be missing.
std::string position(Time time, const std::optional<mrpt::math::CMatrixD>& covariance) {
  mrpt::obs::gnss::Message_NMEA_GGA gga;
  gga.fields.latitude_degrees = 48.5;
  gga.fields.longitude_degrees = 11.25;
  gga.fields.fix_quality = 1;
  const std::string content(reinterpret_cast<const char*>(&gga.fields), sizeof(gga.fields));
  return objectBytes(
      "mrpt::obs::CObservationGPS", 12,
      timeBytes(time) + timeBytes(time) + textBytes("gnss") + mrptBytes(mrpt::poses::CPose3D()) +
          bytesOf(true) + textBytes("std::optional") + textBytes("CMatrixFixed<double,3,3>") +
          bytesOf(covariance.has_value()) + (covariance ? mrptBytes(*covariance) : "") +
          bytesOf(std::uint32_t{1}, std::int32_t{mrpt::obs::gnss::Message_NMEA_GGA::msg_type}) +
          textBytes(content));
}

std::string imu(Time time) {
  mrpt::obs::CObservationIMU sample;
  sample.timestamp = mrptTime(time);
  sample.set(mrpt::obs::IMU_WX, 0.0);
  sample.set(mrpt::obs::IMU_WY, 0.0);
  sample.set(mrpt::obs::IMU_WZ, 0.25);
  return mrptBytes(sample);
}

std::string odometry(Time time, double x) {
  mrpt::obs::CObservationOdometry wheels;
  wheels.timestamp = mrptTime(time);
  wheels.odometry = mrpt::poses::CPose2D(x, 0.0, 0.0);
  return mrptBytes(wheels);
}

class Mrpt3RawlogTest : public ::testing::Test {
 protected:
  Mrpt3RawlogTest() { registerClasses(); }

  /// Writes a rawlog by Zstandard, as MRPT 3 does.
  void write(const std::string& bytes) const {
    std::string compressed(ZSTD_compressBound(bytes.size()), '\0');
    compressed.resize(
        ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), 1));
    test::writeContent(path_, compressed);
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

TEST_F(Mrpt3RawlogTest, AllSensorsAreRead) {
  constexpr int kFrames = 4;
  mrpt::math::CMatrixD covariance(3, 3);
  covariance(0, 0) = 0.16;
  covariance(1, 1) = 0.34;
  covariance(2, 2) = 4.0;
  std::string bytes;
  for (int i = 0; i < kFrames; ++i) {
    const Time time = test::frameTime(static_cast<std::size_t>(i));
    const auto grey = test::wall(i), colour = test::colourWall(i);
    const std::string pair =
        i % 2 == 0 ? test::stereoBytes(i, greyImage(grey.left), greyImage(grey.right))
                   : test::stereoBytes(i, colourImage(colour.left), colourImage(colour.right));
    for (int k = 0; k < 10; ++k) bytes += imu(time - 0.1 + 0.01 * k);
    bytes += odometry(time, 0.5 * i) + pair + laserScan(time) +
             position(time, i == 1 ? std::nullopt : std::optional(covariance));
  }
  write(bytes);
  RawlogSourceOptions options;
  options.use_laser = true;
  RawlogSource source(path_, options);
  const auto frames = test::framesOf(source);
  EXPECT_TRUE(source.skipped().empty()) << source.skipped().begin()->first;
  ASSERT_EQ(kFrames, static_cast<int>(frames.size()));
  for (int i = 0; i < kFrames; ++i) {
    const RecordedFrame& frame = frames[static_cast<std::size_t>(i)];
    if (i % 2 == 0) {
      EXPECT_TRUE(test::sameImage(test::wall(i).right, frame.stereo->right));
    } else {
      EXPECT_TRUE(test::sameImage(test::colourWall(i).left, frame.stereo->left_colour));
    }
    ASSERT_EQ(1u, frame.laser_scans.size());
    EXPECT_EQ(3u, frame.laser_scans[0].ends.size());
    ASSERT_EQ(1u, frame.gnss.size());
    const double by_default = 3.0 * 1.5 / std::sqrt(2.0);
    EXPECT_NEAR(i == 1 ? by_default : 0.5, frame.gnss[0].sigma_m, 1e-6) << i;
    if (i == 0) continue;
    const auto& prior = frame.stereo->motion_prior;
    ASSERT_TRUE(prior.T_previous_current);
    EXPECT_NEAR(0.5, prior.T_previous_current->translation().x(), 1e-9);
  }
}

TEST_F(Mrpt3RawlogTest, DepthCamerasAreRead) {
  constexpr int kWidth = 160, kHeight = 120;
  std::string bytes;
  for (int i = 0; i < 3; ++i) {
    mrpt::obs::CObservation3DRangeScan scan;
    scan.timestamp = mrptTime(test::frameTime(static_cast<std::size_t>(i)));
    scan.maxRange = 8.0F;
    scan.hasRangeImage = scan.hasIntensityImage = true;
    scan.cameraParams.ncols = kWidth;
    scan.cameraParams.nrows = kHeight;
    scan.cameraParams.setIntrinsicParamsFromValues(100.0, 100.0, 79.5, 59.5);
    scan.cameraParamsIntensity = scan.cameraParams;
    scan.relativePoseIntensityWRTDepth = mrpt::poses::CPose3D(0, 0, 0, -M_PI / 2.0, 0, -M_PI / 2.0);
    scan.rangeImage_setSize(kHeight, kWidth);
    scan.rangeImage.fill(2000);
    const std::string as_mrpt_2 = mrptBytes(scan.intensityImage);
    std::string object = mrptBytes(scan);
    const auto at = object.find(as_mrpt_2);
    ASSERT_NE(std::string::npos, at);
    bytes += object.replace(at, as_mrpt_2.size(), colourImage(test::colourWall(i).left));
  }
  write(bytes);
  RawlogSource source(path_, {});
  const auto frames = test::framesOf(source);
  EXPECT_TRUE(source.skipped().empty()) << source.skipped().begin()->first;
  ASSERT_EQ(3u, frames.size());
  EXPECT_TRUE(test::sameImage(test::colourWall(2).left, frames[2].stereo->left_colour));
  const auto& camera = *source.camera();
  EXPECT_NEAR(2.0, camera.fx * camera.baseline_m / frames[2].stereo->disparity.at<float>(60, 80),
              1e-3);
}

}  // namespace
}  // namespace headway::io
