// SPDX-License-Identifier: BSD-3-Clause
// Depth scans as MRPT writes them, in all versions, are read as MRPT reads them.
#include <gtest/gtest.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway_test/folders.h>
#include <mrpt/math/CMatrixF.h>
#include <mrpt/obs/CObservation3DRangeScan.h>

#include <cmath>
#include <limits>

#include "object_bytes.h"
#include "observation_stream.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation3DRangeScan;
using test::bytesOf;
using test::mrptBytes;
using test::objectBytes;
using test::textBytes;

constexpr char kClass[] = "mrpt::obs::CObservation3DRangeScan";
const mrpt::poses::CPose3D kMounting(0.1, -0.2, 0.5, 0.3, -0.7, 1.1);
const std::string kScanTime = bytesOf(mrptTime(1234.5).time_since_epoch().count());

class RecordedDepthTest : public ::testing::Test {
 protected:
  RecordedDepthTest() { registerClasses(); }

  CObservation3DRangeScan::Ptr readFrom(const std::string& bytes) {
    test::writeContent(path_, bytes);
    test::keepAsSeed(bytes);
    skipped_.clear();
    ObservationStream stream(path_, skipped_);
    auto result = std::dynamic_pointer_cast<CObservation3DRangeScan>(stream.next());
    EXPECT_EQ(nullptr, stream.next());
    return result;
  }

  void expectAsMrpt(const std::string& bytes) {
    const auto own = readFrom(bytes);
    ASSERT_NE(nullptr, own);
    EXPECT_TRUE(skipped_.empty());
    const auto theirs = std::dynamic_pointer_cast<CObservation3DRangeScan>(test::mrptRead(bytes));
    ASSERT_EQ(theirs->rangeImage.rows(), own->rangeImage.rows());
    ASSERT_EQ(theirs->rangeImage.cols(), own->rangeImage.cols());
    EXPECT_TRUE(theirs->rangeImage == own->rangeImage);
    EXPECT_EQ(theirs->hasRangeImage, own->hasRangeImage);
    EXPECT_EQ(theirs->rangeUnits, own->rangeUnits);
    EXPECT_EQ(theirs->range_is_depth, own->range_is_depth);
    EXPECT_EQ(theirs->maxRange, own->maxRange);
    EXPECT_EQ(theirs->sensorPose, own->sensorPose);
    EXPECT_EQ(theirs->cameraParams.intrinsicParams, own->cameraParams.intrinsicParams);
    EXPECT_EQ(theirs->cameraParams.dist, own->cameraParams.dist);
    EXPECT_EQ(theirs->cameraParamsIntensity, own->cameraParamsIntensity);
    EXPECT_EQ(theirs->timestamp, own->timestamp);
    EXPECT_EQ(theirs->sensorLabel, own->sensorLabel);
    EXPECT_EQ(theirs->hasIntensityImage, own->hasIntensityImage);
    if (own->hasIntensityImage) {
      EXPECT_TRUE(
          test::sameImage(theirs->intensityImage.asCvMatRef(), own->intensityImage.asCvMatRef()));
    }
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
  std::map<std::string, std::size_t> skipped_;
};

CObservation3DRangeScan example() {
  CObservation3DRangeScan scan;
  scan.timestamp = mrptTime(3.25);
  scan.sensorLabel = "kinect";
  scan.sensorPose = kMounting;
  scan.maxRange = 7.5F;
  scan.hasRangeImage = scan.hasIntensityImage = true;
  scan.rangeUnits = 0.0005F;
  scan.range_is_depth = false;
  scan.cameraParams.ncols = 5;
  scan.cameraParams.nrows = 4;
  scan.cameraParams.setIntrinsicParamsFromValues(100.0, 101.0, 2.0, 1.5);
  scan.cameraParamsIntensity.setIntrinsicParamsFromValues(200.0, 202.0, 80.0, 60.0);
  scan.relativePoseIntensityWRTDepth.x(0.02);
  scan.rangeImage_setSize(4, 5);
  for (int i = 0; i < 20; ++i) scan.rangeImage(i / 5, i % 5) = static_cast<std::uint16_t>(1000 + i);
  scan.intensityImage = mrpt::img::CImage(test::wall(3, 8, {40, 30}).left, mrpt::img::DEEP_COPY);
  return scan;
}

TEST_F(RecordedDepthTest, ScansAsMrptWritesThemToday) {
  CObservation3DRangeScan scan = example();
  expectAsMrpt(mrptBytes(scan));
  const auto read = readFrom(mrptBytes(scan));
  EXPECT_LT((fromMrpt(read->relativePoseIntensityWRTDepth).matrix() -
             fromMrpt(scan.relativePoseIntensityWRTDepth).matrix())
                .norm(),
            1e-9);
  scan.hasPoints3D = true;
  scan.resizePoints3DVectors(7);
  scan.hasConfidenceImage = true;
  scan.confidenceImage = mrpt::img::CImage(test::wall(4, 8, {40, 30}).left, mrpt::img::DEEP_COPY);
  scan.rangeImageOtherLayers["second"] = scan.rangeImage;
  expectAsMrpt(mrptBytes(scan));
  scan.hasRangeImage = scan.hasIntensityImage = false;
  const auto without = readFrom(mrptBytes(scan));
  ASSERT_NE(nullptr, without);
  EXPECT_FALSE(without->hasRangeImage || without->hasIntensityImage);
}

TEST_F(RecordedDepthTest, ScansOfOldVersionsStoreMetresAsFloats) {
  mrpt::math::CMatrixF metres(3, 2);
  for (int i = 0; i < 6; ++i) metres(i / 2, i % 2) = 0.25F * static_cast<float>(i);
  mrpt::img::TCamera camera;
  camera.ncols = 2;
  camera.nrows = 3;
  camera.setIntrinsicParamsFromValues(10.0, 11.0, 1.0, 1.5);
  const std::string start = bytesOf(5.0F) + mrptBytes(kMounting);
  const std::string points = bytesOf(true, std::uint32_t{2}) + std::string(24, '\1');
  const std::string images =
      bytesOf(true) + mrptBytes(metres) + bytesOf(true) + test::imageBytes() + bytesOf(false);
  const std::string end = bytesOf(0.01F) + kScanTime + textBytes("tof");
  expectAsMrpt(objectBytes(kClass, 1, start + points + images + end));
  expectAsMrpt(objectBytes(kClass, 2, start + points + images + mrptBytes(camera) + end));
  const std::string storage = bytesOf(false) + textBytes("") + bytesOf(false) + textBytes("");
  expectAsMrpt(objectBytes(kClass, 3, start + points + images + mrptBytes(camera) + end + storage));
  const std::string cameras = mrptBytes(camera) + mrptBytes(camera) + mrptBytes(kMounting);
  const std::string version_4 = start + points + images + cameras + end + storage;
  expectAsMrpt(objectBytes(kClass, 4, version_4));
  expectAsMrpt(objectBytes(kClass, 5, version_4 + bytesOf(false)));
  expectAsMrpt(objectBytes(kClass, 6, version_4 + bytesOf(false, std::int8_t{1})));
  expectAsMrpt(objectBytes(kClass, 7, version_4 + bytesOf(true, std::int8_t{1}, false)));
  const std::string version_0 = start + bytesOf(std::uint32_t{2}) + std::string(26, '\1') + end;
  const auto oldest = readFrom(objectBytes(kClass, 0, version_0));
  ASSERT_NE(nullptr, oldest);
  EXPECT_FALSE(oldest->hasRangeImage);
  EXPECT_EQ("tof", oldest->sensorLabel);
}

TEST_F(RecordedDepthTest, RangesThatAreNoneAreHoles) {
  mrpt::math::CMatrixF metres(1, 5);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float values[] = {nan, -1.0F, 1e9F, std::numeric_limits<float>::infinity(), 1.0F};
  for (int i = 0; i < 5; ++i) metres(0, i) = values[i];
  const std::string start = bytesOf(5.0F) + mrptBytes(kMounting) + bytesOf(false);
  const std::string images =
      bytesOf(true) + mrptBytes(metres) + bytesOf(true) + test::imageBytes() + bytesOf(false);
  const auto read = readFrom(
      objectBytes(kClass, 1, start + images + bytesOf(0.01F) + kScanTime + textBytes("tof")));
  ASSERT_NE(nullptr, read);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(0, read->rangeImage(0, i)) << i;
  EXPECT_EQ(1000, read->rangeImage(0, 4));
}

TEST_F(RecordedDepthTest, BrokenScansCostThemselvesOnly) {
  const std::string whole = mrptBytes(example());
  const std::string start = bytesOf(5.0F) + mrptBytes(kMounting);
  const std::uint32_t huge = 0x7FFFFFFF;
  const std::vector<std::string> broken = {
      objectBytes(kClass, 11, start),
      objectBytes(kClass, 10, start + bytesOf(true, huge)),
      objectBytes(kClass, 10, start + bytesOf(false, true, 0.001F, huge, huge)),
      objectBytes(kClass, 10, start + bytesOf(false, true, 0.001F, std::uint32_t{4096}, 4096U)),
      objectBytes(kClass, 10, start + bytesOf(std::uint8_t{7})),
      objectBytes(kClass, 8, start + bytesOf(false, true) + mrptBytes(kMounting))};
  for (const auto& bytes : broken) {
    test::writeContent(path_, bytes + whole + whole);
    std::map<std::string, std::size_t> skipped;
    ObservationStream stream(path_, skipped);
    EXPECT_NE(nullptr, stream.next());
    EXPECT_NE(nullptr, stream.next());
    EXPECT_EQ(1u, skipped.size()) << skipped.begin()->first;
  }
  for (std::size_t length = 40; length < whole.size(); length += 97) {
    test::writeContent(path_, whole + whole.substr(0, length));
    std::map<std::string, std::size_t> skipped;
    ObservationStream stream(path_, skipped);
    EXPECT_NE(nullptr, stream.next());
    EXPECT_EQ(nullptr, stream.next());
    EXPECT_TRUE(stream.truncation() || !skipped.empty()) << length;
  }
}

}  // namespace
}  // namespace headway::io
