// SPDX-License-Identifier: BSD-3-Clause
// Objects as MRPT writes them are read as MRPT reads them.
#include <gtest/gtest.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/mrpt_time.h>
#include <headway_test/folders.h>
#include <mrpt/math/CMatrixD.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <zlib.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "foreign_recording.h"
#include "object_bytes.h"
#include "observation_stream.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;
using test::bytesOf;
using test::mrptBytes;
using test::objectBytes;
using test::textBytes;

class RecordedObjectsTest : public ::testing::Test {
 protected:
  RecordedObjectsTest() { registerClasses(); }

  /// The only observation in a rawlog of these bytes; null if it cannot be read.
  CObservation::Ptr readFrom(const std::string& bytes) {
    test::writeContent(path_, bytes);
    test::keepAsSeed(bytes);
    std::map<std::string, std::size_t> skipped;
    ObservationStream stream(path_, skipped);
    auto result = stream.next();
    EXPECT_EQ(nullptr, stream.next());
    EXPECT_TRUE(skipped.empty()) << skipped.begin()->first;
    EXPECT_FALSE(stream.truncation());
    return result;
  }

  /// Expects that an object is read as MRPT reads it. In old versions MRPT takes the present for a
  /// time that is not stored, and forgets the distortion model.
  void expectAsMrpt(const std::string& bytes) {
    const auto own = readFrom(bytes);
    ASSERT_NE(nullptr, own);
    const auto theirs = std::dynamic_pointer_cast<CObservation>(test::mrptRead(bytes));
    if (own->timestamp == INVALID_TIMESTAMP) theirs->timestamp = INVALID_TIMESTAMP;
    if (auto* image = dynamic_cast<mrpt::obs::CObservationImage*>(theirs.get());
        image != nullptr && image->cameraParams.dist[1] == 0.5) {
      image->cameraParams.distortion = mrpt::img::DistortionModel::plumb_bob;
    }
    EXPECT_TRUE(mrptBytes(*theirs) == mrptBytes(*own))
        << "version " << static_cast<int>(bytes[1 + (bytes[0] & 0x7F)]) << ", " << bytes.size();
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

const mrpt::poses::CPose3D kPose(1.5, -2.25, 0.1, 0.3, -0.7, 1.1);
const std::string kTime = bytesOf(mrptTime(1234.5).time_since_epoch().count());

cv::Mat colourImage() {
  cv::Mat image;
  cv::GaussianBlur(test::colourWall(5).left, image, {5, 5}, 1.5);
  return image(cv::Rect(0, 0, 147, 111)).clone();  // sizes that are no multiples of 8
}

TEST_F(RecordedObjectsTest, ImuOfAllVersions) {
  mrpt::obs::CObservationIMU imu;
  imu.timestamp = mrptTime(3.25);
  imu.sensorLabel = "imu";
  imu.sensorPose = kPose;
  imu.set(mrpt::obs::IMU_WX, 0.25);
  imu.set(mrpt::obs::IMU_Z_ACC, 9.81);
  expectAsMrpt(mrptBytes(imu));
  const std::string present = bytesOf(std::uint32_t{15}) + std::string(15, '\1');
  std::string doubles = bytesOf(std::uint32_t{15}), floats = doubles;
  for (int i = 0; i < 15; ++i) {
    doubles += bytesOf(0.5 * i);
    floats += bytesOf(0.5F * static_cast<float>(i));
  }
  for (const int version : {0, 1, 2, 3}) {
    expectAsMrpt(objectBytes(
        "mrpt::obs::CObservationIMU", version,
        mrptBytes(kPose) + present + kTime + (version == 0 ? floats : doubles) + textBytes("imu")));
  }
}

TEST_F(RecordedObjectsTest, OdometryOfAllVersions) {
  mrpt::obs::CObservationOdometry odometry;
  odometry.timestamp = mrptTime(3.25);
  odometry.sensorLabel = "odometry";
  odometry.odometry = mrpt::poses::CPose2D(1.0, 2.0, 0.5);
  expectAsMrpt(mrptBytes(odometry));
  odometry.hasEncodersInfo = odometry.hasVelocities = true;
  odometry.encoderLeftTicks = 17;
  odometry.velocityLocal = {1.0, 0.5, 0.25};
  expectAsMrpt(mrptBytes(odometry));
  const std::string pose =
      objectBytes("mrpt::poses::CPose2D", 0, bytesOf(1.0F, 2.0F, 0.5F)) + textBytes("wheels");
  const std::string name = "mrpt::obs::CObservationOdometry";
  expectAsMrpt(objectBytes(name, 0, pose + kTime));
  expectAsMrpt(objectBytes(name, 1, pose + kTime + bytesOf(true, 3, 4, true, 0.5F, 0.25F)));
}

TEST_F(RecordedObjectsTest, LaserScansOfAllVersions) {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.timestamp = mrptTime(3.25);
  scan.sensorLabel = "laser";
  scan.sensorPose = kPose;
  scan.resizeScan(3);
  for (std::size_t i = 0; i < 3; ++i) {
    scan.setScanRange(i, static_cast<float>(i));
    scan.setScanRangeValidity(i, i > 0);
  }
  expectAsMrpt(mrptBytes(scan));
  scan.setScanHasIntensity(true);
  for (std::size_t i = 0; i < 3; ++i) scan.setScanIntensity(i, 7);
  expectAsMrpt(mrptBytes(scan));
  const std::string start = bytesOf(3.0F, true, 10.0F) + mrptBytes(kPose);
  const std::string covariance = mrptBytes(mrpt::math::CMatrixF(6, 6));
  const std::string ranges = bytesOf(std::uint32_t{2}, 1.0F, 11.0F);
  const std::string valid("\1\0", 2);
  const std::string label = textBytes("laser") + bytesOf(0.5);
  const std::string name = "mrpt::obs::CObservation2DRangeScan";
  expectAsMrpt(objectBytes(name, 0, start + covariance + ranges));
  expectAsMrpt(objectBytes(name, 1, start + covariance + ranges + valid));
  expectAsMrpt(objectBytes(name, 2, start + covariance + ranges + valid + bytesOf(0.1F)));
  const std::string timed = ranges + valid + bytesOf(0.1F) + kTime;
  expectAsMrpt(objectBytes(name, 3, start + covariance + timed));
  expectAsMrpt(objectBytes(name, 4, start + covariance + timed + bytesOf(0.2F)));
  expectAsMrpt(objectBytes(name, 5, start + covariance + timed + bytesOf(0.2F) + label));
  expectAsMrpt(objectBytes(name, 6, start + timed + bytesOf(0.2F) + label));
  const std::string intensities = bytesOf(true, 5, 6);
  const std::string version_7 = start + timed + bytesOf(0.2F) + label + intensities;
  expectAsMrpt(objectBytes(name, 7, version_7));
  // MRPT 3 adds the duration of the sweep, which MRPT 2.5.8 cannot read.
  const auto version_8 = readFrom(objectBytes(name, 8, version_7 + bytesOf(0.025F)));
  ASSERT_NE(nullptr, version_8);
  EXPECT_TRUE(mrptBytes(*version_8) == mrptBytes(*readFrom(objectBytes(name, 7, version_7))));
}

TEST_F(RecordedObjectsTest, SatellitePositionsKeepTheirGga) {
  mrpt::obs::CObservationGPS gnss;
  gnss.timestamp = mrptTime(3.25);
  gnss.originalReceivedTimestamp = mrptTime(3.5);
  gnss.sensorLabel = "gnss";
  gnss.sensorPose = mrpt::poses::CPose3D(0.1, 0.2, 1.5);
  mrpt::obs::gnss::Message_NMEA_GGA gga;
  gga.fields.UTCTime.hour = 11;
  gga.fields.latitude_degrees = 48.5;
  gga.fields.longitude_degrees = -11.25;
  gga.fields.altitude_meters = 500.0;
  gga.fields.geoidal_distance = 47.0;
  gga.fields.fix_quality = 2;
  gga.fields.satellitesUsed = 9;
  gga.fields.thereis_HDOP = true;
  gga.fields.HDOP = 2.0F;
  gnss.setMsg(gga);
  expectAsMrpt(mrptBytes(gnss));
  gnss.setMsg(mrpt::obs::gnss::Message_NMEA_RMC());  // passed over
  const auto read =
      std::dynamic_pointer_cast<mrpt::obs::CObservationGPS>(readFrom(mrptBytes(gnss)));
  ASSERT_NE(nullptr, read);
  std::map<std::string, std::size_t> skipped;
  const auto fix = fixFrom(*read, skipped);
  ASSERT_TRUE(fix);
  EXPECT_EQ(3.25, fix->time);
  EXPECT_EQ(48.5, fix->latitude_deg);
  EXPECT_EQ(-11.25, fix->longitude_deg);
  EXPECT_EQ(547.0, fix->altitude_m);  // above the ellipsoid
  EXPECT_EQ(Eigen::Vector3d(0.1, 0.2, 1.5), fix->antenna);
  EXPECT_NEAR(2.0 / std::sqrt(2.0), fix->sigma_m, 1e-9);  // differential: 1 m at a dilution of 1
  gga.fields.fix_quality = 0;
  gnss.setMsg(gga);
  EXPECT_FALSE(fixFrom(gnss, skipped));
  gga.fields.fix_quality = 1;
  gga.fields.latitude_degrees = std::nan("");
  gnss.setMsg(gga);
  EXPECT_FALSE(fixFrom(gnss, skipped));
  gga.fields.latitude_degrees = 48.5;
  gga.fields.HDOP = 150.0F;  // not "unknown": hundreds of metres
  gnss.setMsg(gga);
  EXPECT_FALSE(fixFrom(gnss, skipped));
  gga.fields.HDOP = 2.0F;
  gnss.setMsg(gga);
  gnss.sensorPose = mrpt::poses::CPose3D(0.1, std::nan(""), 1.5);
  EXPECT_FALSE(fixFrom(gnss, skipped));
  EXPECT_EQ((std::map<std::string, std::size_t>{
                {"gnss_bad_pose", 1}, {"gnss_no_position", 1}, {"gnss_without_fix", 2}}),
            skipped);
}

TEST_F(RecordedObjectsTest, UnknownVersionsAreCountedByClassAndVersion) {
  mrpt::obs::CObservationOdometry odometry;
  odometry.sensorLabel = "odometry";
  const std::string later = objectBytes("mrpt::obs::CObservationIMU", 9, mrptBytes(kPose));
  const std::string image = objectBytes("mrpt::img::CImage", 12, std::string(40, '\1'));
  test::writeContent(path_,
                     later + test::stereoBytes(1, image, test::imageBytes()) + mrptBytes(odometry));
  std::map<std::string, std::size_t> skipped;
  ObservationStream stream(path_, skipped);
  const auto read = stream.next();
  ASSERT_NE(nullptr, read);
  EXPECT_EQ("odometry", read->sensorLabel);
  EXPECT_EQ(1u, skipped.count("unreadable_CObservationIMU_version_9"));
  EXPECT_EQ(1u, skipped.count("unreadable_CObservationStereoImages_CImage_version_12"));
}

TEST_F(RecordedObjectsTest, RobotPosesOfAllVersions) {
  mrpt::obs::CObservationRobotPose pose;
  pose.timestamp = mrptTime(3.25);
  pose.sensorLabel = "pose";
  pose.pose.mean = kPose;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) pose.pose.cov(i, j) = pose.pose.cov(j, i) = i + 0.1 * j;
  }
  pose.sensorPose = mrpt::poses::CPose3D(1, 2, 3, 0.1, 0.2, 0.3);
  expectAsMrpt(mrptBytes(pose));
  expectAsMrpt(objectBytes("mrpt::obs::CObservationRobotPose", 0,
                           mrptBytes(pose.pose) + textBytes("pose") + kTime));
}

TEST_F(RecordedObjectsTest, Detections) {
  CObservationObjectDetections detections;
  detections.sensorLabel = "detections";
  detections.timestamp = mrptTime(2.5);
  detections.sensor_pose = kPose;
  detections.image_width = 640;
  detections.items = {
      {"Car", 0.5, 7, Box2d{1, 2, 3, 4}, Box3d{{1, 2, 3}, 4, 5, 6, 7}, Eigen::Matrix3d::Identity()},
      {"Pedestrian", 1.0, -1, {}, {}, {}}};
  expectAsMrpt(mrptBytes(detections));
}

TEST_F(RecordedObjectsTest, StereoImagesOfAllKindsOfStorage) {
  auto stereo = test::wallObservation(2, 7.5);
  stereo->cameraPose = mrpt::poses::CPose3DQuat(kPose);
  stereo->leftCamera.setDistortionPlumbBob(0.1, 0.2, 0.3, 0.4, 0.5);
  stereo->leftCamera.cameraName = "left camera";
  expectAsMrpt(mrptBytes(*stereo));
  stereo->imageLeft = mrpt::img::CImage(colourImage(), mrpt::img::DEEP_COPY);
  expectAsMrpt(mrptBytes(*stereo));
  stereo->imageLeft.setExternalStorage("left_000001.png");
  expectAsMrpt(mrptBytes(*stereo));
  stereo->hasImageRight = false;
  expectAsMrpt(mrptBytes(*stereo));
}

TEST_F(RecordedObjectsTest, EmbeddedJpegsGiveMrptsPixels) {
  for (const bool is_grey : {false, true}) {
    cv::Mat image = colourImage();
    if (is_grey) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    const std::string jpeg = test::jpegImageBytes(image);
    expectAsMrpt(test::stereoBytes(1, jpeg, jpeg));
  }
}

TEST_F(RecordedObjectsTest, StereoImagesOfOldVersions) {
  const std::string name = "mrpt::obs::CObservationStereoImages";
  mrpt::math::CMatrixF intrinsics(3, 3);
  for (int i = 0; i < 9; ++i) intrinsics(i / 3, i % 3) = static_cast<float>(i + 1);
  const std::string images = test::imageBytes() + test::imageBytes();
  const std::string start = mrptBytes(kPose) + mrptBytes(intrinsics) + images;
  const auto expectSame = [&](int version, const std::string& values) {
    const std::string bytes = objectBytes(name, version, values);
    const auto own =
        std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(readFrom(bytes));
    const auto theirs =
        std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(test::mrptRead(bytes));
    ASSERT_TRUE(own && theirs) << version;
    EXPECT_EQ(theirs->leftCamera.fx(), own->leftCamera.fx());
    EXPECT_EQ(theirs->rightCamera.cy(), own->rightCamera.cy());
    EXPECT_EQ(mrptBytes(theirs->cameraPose), mrptBytes(own->cameraPose));
    EXPECT_NEAR(theirs->rightCameraPose.x(), own->rightCameraPose.x(), 1e-8);
    EXPECT_EQ(theirs->sensorLabel, own->sensorLabel);
    EXPECT_EQ(theirs->timestamp, own->timestamp);
    EXPECT_TRUE(mrptBytes(theirs->imageRight) == mrptBytes(own->imageRight));
  };
  expectSame(0, start);
  expectSame(1, start + kTime);
  expectSame(2, start + kTime + mrptBytes(kPose));
  expectSame(3, start + kTime + mrptBytes(kPose) + bytesOf(0.004));
  expectSame(4, start + kTime + mrptBytes(kPose) + bytesOf(0.004) + textBytes("old"));
  const std::string camera = mrptBytes(mrpt::img::TCamera());
  const std::string quaternion = mrptBytes(mrpt::poses::CPose3DQuat(kPose));
  expectSame(5, quaternion + camera + camera + images + kTime + quaternion + textBytes("old"));
}

TEST_F(RecordedObjectsTest, SingleImagesPosesAndCamerasOfOldVersions) {
  const std::string name = "mrpt::obs::CObservationImage";
  mrpt::math::CMatrixF distortion(1, 5), intrinsics(3, 3), matrix(4, 4);
  for (int i = 0; i < 9; ++i) intrinsics(i / 3, i % 3) = static_cast<float>(i + 1);
  mrpt::math::CMatrixD doubles(3, 3);
  for (int i = 0; i < 9; ++i) doubles(i / 3, i % 3) = i + 1.5;
  distortion(0, 1) = 0.5F;
  matrix.setIdentity();
  matrix(0, 3) = 2.5F;
  const std::string old_pose = objectBytes("mrpt::poses::CPose3D", 0, mrptBytes(matrix));
  const std::string quaternion_pose =
      objectBytes("mrpt::poses::CPose3D", 2, bytesOf(1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0));
  const std::string lens = mrptBytes(distortion) + mrptBytes(intrinsics);
  const std::string image = test::imageBytes();
  for (const auto& pose : {old_pose, quaternion_pose, mrptBytes(kPose)}) {
    expectAsMrpt(objectBytes(name, 1, pose + lens + image + kTime));
    expectAsMrpt(objectBytes(name, 2, pose + lens + image + kTime + bytesOf(0.004)));
    expectAsMrpt(
        objectBytes(name, 3, pose + lens + image + kTime + bytesOf(0.004) + textBytes("old")));
    std::string values = bytesOf(0.004, 1.0, 2.0, 3.0, 4.0, 5.0);
    const std::string size = bytesOf(std::uint32_t{120}, std::uint32_t{160});
    const auto camera = [&](int version, const std::string& content) {
      return pose + objectBytes("mrpt::img::TCamera", version, content) + image + kTime +
             textBytes("camera");
    };
    const std::string old = values + mrptBytes(doubles);
    expectAsMrpt(objectBytes(name, 4, camera(1, old)));
    expectAsMrpt(objectBytes(name, 4, camera(2, old + size)));
    values += bytesOf(0.0, 0.0, 0.0, 100.0, 101.0, 80.0, 60.0) + size;
    expectAsMrpt(objectBytes(name, 4, camera(4, values)));
    expectAsMrpt(objectBytes(name, 4, camera(5, values + textBytes("name"))));
    expectAsMrpt(objectBytes(name, 4, camera(6, values + textBytes("name") + '\1')));
  }
}

/// The pixels of an image of this version and content in an observation.
class RecordedImageTest : public RecordedObjectsTest {
 protected:
  cv::Mat pixels(int version, const std::string& content) {
    const std::string image = objectBytes("mrpt::img::CImage", version, content);
    const auto stereo = std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(
        readFrom(test::stereoBytes(1, image, test::imageBytes())));
    return stereo && !stereo->imageLeft.isEmpty() ? stereo->imageLeft.asCvMatRef() : cv::Mat();
  }
};

TEST_F(RecordedImageTest, GreyImagesOfAllVersions) {
  const cv::Mat image = test::wall(1).left;
  const auto size = static_cast<std::uint32_t>(image.total());
  const std::string raw(image.ptr<char>(), image.total());
  uLongf zipped_size = compressBound(size);
  std::string zipped(zipped_size, '\0');
  compress(reinterpret_cast<Bytef*>(zipped.data()), &zipped_size, image.data, size);
  zipped.resize(zipped_size);
  const std::string header = bytesOf(image.cols, image.rows, 0, size);
  const auto is_image = [&](const cv::Mat& read) { return test::sameImage(image, read); };
  EXPECT_TRUE(is_image(pixels(0, bytesOf(image.cols, image.rows, 1) + '\1' + bytesOf(size) + raw)));
  EXPECT_TRUE(is_image(pixels(2, '\0' + header + raw)));
  EXPECT_TRUE(is_image(pixels(3, '\0' + header + textBytes(zipped))));
  EXPECT_TRUE(is_image(pixels(4, '\0' + header + textBytes(zipped))));
  EXPECT_TRUE(is_image(pixels(5, '\0' + header + '\1' + textBytes(zipped))));
  EXPECT_TRUE(is_image(pixels(8, std::string(2, '\0') + header + '\0' + raw)));
  EXPECT_TRUE(is_image(pixels(9, std::string(2, '\0') + header + bytesOf(0) + '\0' + raw)));
  EXPECT_TRUE(
      is_image(pixels(10, std::string(2, '\0') + bytesOf(image.cols, image.rows, size, 1) + raw)));
}

TEST_F(RecordedImageTest, ColourImagesOfMrpt3AreRedGreenBlue) {
  const cv::Mat image = colourImage();
  cv::Mat rgb;
  cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  const std::string raw(rgb.ptr<char>(), 3 * rgb.total());
  EXPECT_TRUE(test::sameImage(
      image, pixels(10, std::string("\0\1", 2) + bytesOf(image.cols, image.rows) + raw)));
}

TEST_F(RecordedImageTest, ImagesOf16BitKeepTheirTypeToBeRefusedByName) {
  const std::string raw(2 * 160 * 120, '\5');
  EXPECT_EQ(
      CV_16UC1,
      pixels(9, std::string(2, '\0') + bytesOf(160, 120, 0, 2 * 160 * 120, 2) + '\0' + raw).type());
}

TEST_F(RecordedObjectsTest, MovementsGiveTheirIncrement) {
  mrpt::obs::CActionRobotMovement2D action;
  action.computeFromOdometry(mrpt::poses::CPose2D(0.5, 0.25, 0.125), {});
  action.hasVelocities = action.hasEncodersInfo = true;
  mrpt::obs::CActionCollection actions;
  actions.insert(action);
  const std::string pose = mrptBytes(mrpt::poses::CPose2D(0.5, 0.25, 0.125));
  const std::string name = "mrpt::obs::CActionRobotMovement2D";
  const std::string end = bytesOf(true, 1.0F, 2.0F, true, 3, 4);
  const std::string uninitialised = "\x5a" + bytesOf(0.0F, 0.0F) + "\x9c" + bytesOf(3, 4);
  const auto old = [&](int version, std::size_t model, const std::string& rest) {
    return objectBytes(
        "mrpt::obs::CActionCollection", 0,
        bytesOf(std::uint32_t{1}) +
            objectBytes(name, version, bytesOf(0) + pose + std::string(model, '\0') + rest));
  };
  for (const auto& bytes :
       {mrptBytes(actions), old(2, 44, end), old(3, 44, end), old(4, 48, end), old(5, 56, end),
        old(6, 56, end + kTime), old(6, 56, uninitialised + kTime)}) {
    test::writeContent(path_, bytes + mrptBytes(*test::wallObservation(0, 1.0)));
    std::map<std::string, std::size_t> skipped;
    ObservationStream stream(path_, skipped);
    const auto odometry = std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(stream.next());
    ASSERT_NE(nullptr, odometry);
    EXPECT_EQ(0.5, odometry->odometry.x());
    EXPECT_EQ(0.125, odometry->odometry.phi());
    EXPECT_NE(nullptr, stream.next());
    EXPECT_TRUE(skipped.empty());
  }
}

TEST_F(RecordedObjectsTest, MovementsOfMrptsOwnRecordingAreRead) {
  const std::string path = "/usr/share/mrpt/datasets/localization_demo.rawlog";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the package mrpt-common";
  std::map<std::string, std::size_t> skipped;
  ObservationStream stream(path, skipped);
  std::vector<mrpt::poses::CPose2D> odometry;
  while (const auto observation = stream.next()) {
    const auto* read = dynamic_cast<const mrpt::obs::CObservationOdometry*>(observation.get());
    if (read != nullptr) odometry.push_back(read->odometry);
  }
  EXPECT_TRUE(skipped.empty()) << skipped.begin()->first;
  ASSERT_GE(odometry.size(), 30u);
  EXPECT_NEAR(0.2478, odometry.front().x(), 1e-3);
  EXPECT_GT(odometry.back().norm(), 1.0);
}

}  // namespace
}  // namespace headway::io
