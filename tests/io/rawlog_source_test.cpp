#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::HasSubstr;

TEST(RawlogSourceTest, givesBackWhatWasRecordedPixelForPixel) {
  const headway::test::TemporaryFolder folder;
  const std::string path = folder / "x.rawlog";
  test::recordWalls(path, 5);
  RawlogSource source(path, {});
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

TEST(RawlogSourceTest, aFrameAtTimeZeroSurvives) {
  const headway::test::TemporaryFolder folder;
  const std::string path = folder / "x.rawlog";
  {
    RawlogSink sink(path, ImageStorage::kEmbedded);
    const auto [left, right] = test::wall(0);
    sink.writeStereo(0.0, left, right, rawFrom(test::smallCamera()));
    sink.writeStereo(0.1, left, right, rawFrom(test::smallCamera()));
  }
  const auto frames = test::framesOf(path);
  ASSERT_EQ(2u, frames.size());
  EXPECT_EQ(0.0, frames[0].time);
}

TEST(RawlogSourceTest, measuresTheCalibrationOnTheFirstPair) {
  const headway::test::TemporaryFolder folder;
  const std::string path = folder / "x.rawlog";
  test::recordWalls(path, 2);
  const RawlogSource source(path, {});
  ASSERT_TRUE(source.calibration());
  EXPECT_GT(source.calibration()->matches, 20u);
  EXPECT_NEAR(8.0, source.calibration()->median_disparity_px, 0.1);
  EXPECT_LT(source.calibration()->vertical_disparity_px, 0.1);
  EXPECT_FALSE(source.calibration()->rectified_here);
}

}  // namespace
}  // namespace headway::io
