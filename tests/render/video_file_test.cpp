// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/render/video_file.h>
#include <headway_test/folders.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace headway::render {
namespace {

constexpr int kPictures = 12;
const cv::Size kSize(160, 90);

cv::Scalar colourOf(int picture) { return {200.0 - 10.0 * picture, 60.0, 20.0 + 15.0 * picture}; }

void writeTo(const std::string& path, int pictures = kPictures) {
  VideoFile video(path, 12.5, kSize);
  for (int i = 0; i < pictures; ++i) video.add(cv::Mat(kSize, CV_8UC3, colourOf(i % kPictures)));
  video.finish();
}

TEST(VideoFileTest, KeepsNumberRateSizeAndColours) {
  const test::TemporaryFolder folder;
  writeTo(folder / "drive.mp4");
  cv::VideoCapture video((folder / "drive.mp4").string());
  ASSERT_TRUE(video.isOpened());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 12.5, 0.01);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_WIDTH), kSize.width);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_HEIGHT), kSize.height);
  cv::Mat picture;
  int count = 0;
  for (; video.read(picture); ++count) {
    const cv::Scalar mean = cv::mean(picture);
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(mean[channel], colourOf(count)[channel], 12.0) << "picture " << count;
    }
  }
  EXPECT_EQ(count, kPictures);
}

TEST(VideoFileTest, AcceptsAPartOfALargerPicture) {
  const test::TemporaryFolder folder;
  cv::Mat whole(2 * kSize.height, 2 * kSize.width, CV_8UC3, cv::Scalar(0, 0, 255));
  whole(cv::Rect({0, 0}, kSize)).setTo(cv::Scalar(0, 255, 0));
  VideoFile video(folder / "part.mp4", 10.0, kSize);
  video.add(whole(cv::Rect({0, 0}, kSize)));
  video.finish();
  cv::Mat picture;
  ASSERT_TRUE(cv::VideoCapture((folder / "part.mp4").string()).read(picture));
  EXPECT_GT(cv::mean(picture)[1], 230.0);
  EXPECT_LT(cv::mean(picture)[2], 25.0);
}

TEST(VideoFileTest, APictureMayBeOverwrittenAtOnce) {
  const test::TemporaryFolder folder;
  writeTo(folder / "new.mp4");
  VideoFile video(folder / "reused.mp4", 12.5, kSize);
  cv::Mat picture(kSize, CV_8UC3);
  for (int i = 0; i < kPictures; ++i) {
    picture.setTo(colourOf(i));
    video.add(picture);
    picture.setTo(cv::Scalar(0, 0, 0));
  }
  video.finish();
  cv::VideoCapture expected((folder / "new.mp4").string());
  cv::VideoCapture reused((folder / "reused.mp4").string());
  cv::Mat other;
  for (int i = 0; i < kPictures; ++i) {
    ASSERT_TRUE(expected.read(picture) && reused.read(other));
    EXPECT_EQ(cv::norm(picture, other, cv::NORM_INF), 0.0) << "picture " << i;
  }
}

TEST(VideoFileTest, RefusesAMissingFolder) {
  const test::TemporaryFolder folder;
  try {
    writeTo(folder / "missing" / "drive.mp4");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("missing/drive.mp4"));
    EXPECT_THAT(error.what(), testing::HasSubstr("No such file"));
  }
}

TEST(VideoFileTest, ReportsAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  try {
    writeTo("/dev/full", 400);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("No space left"));
  }
}

}  // namespace
}  // namespace headway::render
