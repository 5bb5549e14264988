// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_sink.h>
#include <headway_test/folders.h>
#include <mrpt/img/CImage.h>
#include <sys/stat.h>

#include <opencv2/core.hpp>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

StereoFrame onlyFrame(const std::string& path) {
  const auto frames = test::framesOf(path);
  if (frames.size() != 1 || !frames[0].stereo) throw std::runtime_error("not one stereo frame");
  return *frames[0].stereo;
}

void recordColour(const std::string& path, ImageStorage storage) {
  RawlogSink sink(path, storage, 90);
  const auto [left, right] = test::colourWall(1);
  sink.writeStereo(1.0, left, right, rawFrom(test::smallCamera()));
}

TEST(RawlogSinkTest, RawColourIsLosslessEmbeddedAndAsPng) {
  const headway::test::TemporaryFolder folder;
  for (const auto storage : {ImageStorage::kEmbeddedRaw, ImageStorage::kExternalPng}) {
    recordColour(folder / "x.rawlog", storage);
    EXPECT_TRUE(
        test::sameImage(test::colourWall(1).left, onlyFrame(folder / "x.rawlog").left_colour));
  }
  EXPECT_TRUE(fs::exists(folder / "x_Images/stereo_left_000000.png"));
  EXPECT_TRUE(fs::exists(folder / "x_Images/stereo_right_000000.png"));
}

TEST(RawlogSinkTest, JpegColourIsSmallAndNearlyTheSame) {
  const headway::test::TemporaryFolder folder;
  recordColour(folder / "raw.rawlog", ImageStorage::kEmbeddedRaw);
  recordColour(folder / "jpeg.rawlog", ImageStorage::kEmbedded);
  recordColour(folder / "beside.rawlog", ImageStorage::kExternalJpeg);
  const auto original = test::colourWall(1).left;
  const auto inside = onlyFrame(folder / "jpeg.rawlog").left_colour;
  const auto beside = onlyFrame(folder / "beside.rawlog").left_colour;
  EXPECT_FALSE(test::sameImage(original, inside));
  const double per_pixel = 1.0 / std::sqrt(3.0 * static_cast<double>(original.total()));
  EXPECT_LT(cv::norm(original, inside) * per_pixel, 30.0);
  EXPECT_LT(cv::norm(original, beside) * per_pixel, 30.0);
  EXPECT_TRUE(fs::exists(folder / "beside_Images/stereo_left_000000.jpg"));
}

TEST(RawlogSinkTest, IsPrivateUntilItIsComplete) {
  const headway::test::TemporaryFolder folder;
  const mode_t before = umask(0022);
  const auto othersRead = [](const fs::path& path) {
    return (fs::status(path).permissions() & fs::perms::others_read) != fs::perms::none;
  };
  {
    RawlogSink sink(folder / "x.rawlog", ImageStorage::kExternalPng);
    const auto [left, right] = test::colourWall(1);
    sink.writeStereo(1.0, left, right, rawFrom(test::smallCamera()));
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      EXPECT_EQ(fs::perms::none, entry.status().permissions() & ~fs::perms::owner_all) << entry;
      ++count;
    }
    EXPECT_EQ(2u, count) << "the rawlog and the folder of its images";
    sink.close();
  }
  umask(before);
  for (const char* name : {"x.rawlog", "x_Images", "x_Images/stereo_left_000000.png"}) {
    EXPECT_TRUE(othersRead(folder / name)) << name;
  }
}

TEST(RawlogSinkTest, RestoresMrptsGlobalImageSettings) {
  const headway::test::TemporaryFolder folder;
  const bool disabled = mrpt::img::CImage::DISABLE_JPEG_COMPRESSION();
  const int quality = mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY();
  const std::string base = mrpt::img::CImage::getImagesPathBase();
  recordColour(folder / "x.rawlog", ImageStorage::kEmbedded);
  recordColour(folder / "y.rawlog", ImageStorage::kExternalPng);
  (void)test::framesOf(folder / "y.rawlog");
  EXPECT_EQ(disabled, mrpt::img::CImage::DISABLE_JPEG_COMPRESSION());
  EXPECT_EQ(quality, mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY());
  EXPECT_EQ(base, mrpt::img::CImage::getImagesPathBase());
}

TEST(RawlogSinkTest, AcceptsLabelsThatAreInvalidFileNames) {
  const headway::test::TemporaryFolder folder;
  {
    RawlogSink sink(folder / "x.rawlog", ImageStorage::kExternalPng);
    const auto [left, right] = test::wall(0);
    sink.writeStereo(1.0, left, right, rawFrom(test::smallCamera()), "/front cam");
  }
  EXPECT_TRUE(fs::exists(folder / "x_Images/_front_cam_left_000000.png"));
  EXPECT_TRUE(test::sameImage(test::wall(0).left, onlyFrame(folder / "x.rawlog").left));
}

TEST(RawlogSinkTest, TheFileHasATemporaryNameUntilItIsComplete) {
  const headway::test::TemporaryFolder folder;
  RawlogSink sink(folder / "x.rawlog", ImageStorage::kEmbedded);
  sink.writePose("pose", 1.0, Pose::Identity());
  EXPECT_FALSE(fs::exists(folder / "x.rawlog"));
  sink.close();
  EXPECT_TRUE(fs::exists(folder / "x.rawlog"));
  EXPECT_EQ(1, std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
  EXPECT_NO_THROW(sink.close());
}

TEST(RawlogSinkTest, AfterAnExceptionTheOldRawlogRemains) {
  const headway::test::TemporaryFolder folder;
  test::recordWalls(folder / "x.rawlog", 3);
  const std::string before = test::contentOf(folder / "x.rawlog");
  const auto failing = [&] {
    RawlogSink sink(folder / "x.rawlog", ImageStorage::kExternalPng);
    const auto [left, right] = test::wall(0);
    sink.writeStereo(1.0, left, right, rawFrom(test::smallCamera()));
    throw std::runtime_error("the dataset is broken");
  };
  EXPECT_THROW(failing(), std::runtime_error);
  EXPECT_EQ(before, test::contentOf(folder / "x.rawlog"));
  EXPECT_EQ(1, std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

TEST(RawlogSinkTest, ThrowsForUnwritablePaths) {
  const headway::test::TemporaryFolder folder;
  test::writeContent(folder / "file", "x");
  const auto open = [&](const std::string& path, ImageStorage storage) {
    return test::errorOf([&] { RawlogSink sink(path, storage); });
  };
  EXPECT_THAT(open(folder / "file/x.rawlog", ImageStorage::kEmbedded), HasSubstr("file/x.rawlog"));
  EXPECT_THAT(open(folder / "nowhere/x.rawlog", ImageStorage::kEmbedded),
              HasSubstr("cannot be written"));
  test::writeContent(folder / "y_Images", "a file in the way");
  EXPECT_THAT(open(folder / "y.rawlog", ImageStorage::kExternalPng), HasSubstr("y_Images"));
}

TEST(RawlogSinkTest, ThrowsOnAFullDiskWhenWritingAndClosing) {
  const auto [left, right] = test::wall(1, 8, {640, 480});
  auto camera = rawFrom(test::smallCamera());
  RawlogSink sink("/dev/full", ImageStorage::kEmbedded);
  EXPECT_THAT(test::errorOf([&, left_image = left, right_image = right] {
                for (int i = 0; i < 100; ++i) {
                  sink.writeStereo(i, left_image, right_image, camera);
                }
              }),
              HasSubstr("/dev/full: write error"));
  RawlogSink small("/dev/full", ImageStorage::kEmbedded);
  small.writePose("pose", 1.0, Pose::Identity());
  EXPECT_THAT(test::errorOf([&] { small.close(); }), HasSubstr("/dev/full"));
}

TEST(RawlogSinkTest, IsDeterministic) {
  const headway::test::TemporaryFolder folder;
  test::recordWalls(folder / "a.rawlog", 3);
  test::recordWalls(folder / "b.rawlog", 3);
  EXPECT_EQ(test::contentOf(folder / "a.rawlog"), test::contentOf(folder / "b.rawlog"));
}

}  // namespace
}  // namespace headway::io
