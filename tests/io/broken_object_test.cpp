// SPDX-License-Identifier: BSD-3-Clause
// A broken object in a rawlog costs itself only, and is counted by reason.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <headway_test/peak_memory.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "foreign_recording.h"
#include "object_bytes.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using test::bytesOf;
using test::objectBytes;
using test::textBytes;
using ::testing::ElementsAre;
using ::testing::Pair;

using Skipped = std::map<std::string, std::size_t>;

struct ReadResult {
  std::vector<std::size_t> indices;
  Skipped skipped;
};

class BrokenObjectTest : public ::testing::Test {
 protected:
  ReadResult readFrom(const std::string& bytes) {
    test::writeContent(path_, bytes);
    test::keepAsSeed(bytes);
    RawlogSource source(path_, {});
    ReadResult result;
    for (const auto& frame : test::framesOf(source)) result.indices.push_back(frame.index);
    result.skipped = source.skipped();
    EXPECT_FALSE(source.truncation()) << *source.truncation();
    return result;
  }

  static std::string good(int frame) {
    return test::mrptBytes(*test::wallObservation(frame, test::frameTime(frame)));
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

/// A JPEG of a wall, between frames with good ones.
std::string jpegBytes() {
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", test::colourWall(1).left, jpeg);
  return {jpeg.begin(), jpeg.end()};
}

std::string withJpeg(int frame, const std::string& jpeg) {
  const std::string image =
      objectBytes("mrpt::img::CImage", 9, bytesOf(false, true, 160, 120) + textBytes(jpeg));
  return test::stereoBytes(frame, image, test::jpegImageBytes(test::colourWall(1).right));
}

TEST_F(BrokenObjectTest, ABrokenJpegCostsItsFrameOnly) {
  const std::string jpeg = jpegBytes();
  const auto tables = jpeg.find("\xFF\xDB");
  std::string no_tables = jpeg, huge = jpeg, zeros = jpeg;
  no_tables.replace(tables, 2, "\xFF\xFE");  // a comment
  const auto frame_header = jpeg.find("\xFF\xC0");
  huge.replace(frame_header + 5, 4, "\xFF\xFF\xFF\xFF");  // 65535 x 65535 pixels
  std::fill(zeros.begin() + static_cast<long>(zeros.size() / 2), zeros.end(), '\0');
  for (const auto& broken : {no_tables, huge, zeros, jpeg.substr(0, jpeg.size() / 2),
                             std::string("no JPEG"), std::string()}) {
    const auto result = readFrom(withJpeg(0, jpeg) + withJpeg(1, broken) + withJpeg(2, jpeg));
    EXPECT_THAT(result.indices, ElementsAre(0, 2));
    EXPECT_THAT(result.skipped, ElementsAre(Pair("broken_image", 1)));
  }
}

TEST_F(BrokenObjectTest, JpegsWithWarningsAreBroken) {
  // One flipped bit in the coefficients: libjpeg ends with the right number of bits after most of
  // them, and notices the others.
  const std::string jpeg = jpegBytes();
  const std::size_t start = jpeg.find("\xFF\xDA") + 14;
  std::mt19937 random(5);
  std::size_t broken = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::string flipped = jpeg;
    flipped[start + random() % (jpeg.size() - start)] ^= static_cast<char>(1 << (random() % 8));
    const auto result = readFrom(withJpeg(0, jpeg) + withJpeg(1, flipped));
    broken += result.skipped.count("broken_image");
    EXPECT_EQ(result.skipped.empty() ? 2u : 1u, result.indices.size());
  }
  EXPECT_GT(broken, 3u);
}

TEST_F(BrokenObjectTest, AFlippedBitCostsItsObjectOnly) {
  const std::string object = good(1);
  // The header, calibration and lengths; most bytes after them are pixels, and harmless.
  for (std::size_t bit = 0; bit < 8 * 700; bit += 27) {
    std::string flipped = object;
    flipped[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    const auto result = readFrom(good(0) + flipped + good(2) + good(3));
    ASSERT_GE(result.indices.size(), 3u) << bit;
    if (result.indices.size() < 4) {
      EXPECT_FALSE(result.skipped.empty()) << bit;
    }
  }
}

TEST_F(BrokenObjectTest, AFlippedBitInTheFirstHeaderCostsTheFirstObjectOnly) {
  std::string flipped = good(0);
  flipped[0] ^= 0x40;
  const auto result = readFrom(flipped + good(1) + good(2));
  EXPECT_EQ(2u, result.indices.size());
  EXPECT_THAT(result.skipped, ElementsAre(Pair("broken_header", 1)));
}

TEST_F(BrokenObjectTest, LengthsBeyondTheFileAllocateNothing) {
  const std::uint32_t huge = 0xFFFFFFF0;
  const std::string pose = test::mrptBytes(mrpt::poses::CPose3D());
  const std::string name = "mrpt::img::CImage";
  const std::vector<std::string> broken = {
      objectBytes("mrpt::obs::CObservationOdometry", 2,
                  test::mrptBytes(mrpt::poses::CPose2D()) + bytesOf(huge)),
      objectBytes("mrpt::obs::CObservation2DRangeScan", 7,
                  bytesOf(1.0F, true, 1.0F) + pose + bytesOf(huge)),
      objectBytes("mrpt::obs::CObservationIMU", 3, pose + bytesOf(huge)),
      objectBytes("headway::CObservationObjectDetections", 0, bytesOf(huge)),
      test::stereoBytes(1, objectBytes(name, 9, bytesOf(false, true, 640, 480, huge)), ""),
      test::stereoBytes(1, objectBytes(name, 9, bytesOf(false, true, -30000, -30000)), ""),
      test::stereoBytes(1, objectBytes(name, 9, bytesOf(false, false, 30000, 30000, 0, huge)), ""),
      test::stereoBytes(1, objectBytes(name, 0, bytesOf(huge, huge, 3, '\1', huge)), "")};
  const headway::test::PeakMemory memory;
  for (const auto& object : broken) {
    const auto result = readFrom(good(0) + object + good(2));
    EXPECT_EQ(2u, result.indices.size());
    ASSERT_EQ(1u, result.skipped.size());
    EXPECT_EQ(0u, result.skipped.begin()->first.find("unreadable_"));
  }
  EXPECT_LT(memory.growthMb(), 50);
}

TEST_F(BrokenObjectTest, NestedObjectsNeedNoStack) {
  std::string sets, collections, ends;
  for (int i = 0; i < 20000; ++i) {
    sets += std::string("\x9b") + "mrpt::opengl::CSetOfObjects" + '\6' + bytesOf(1);
    collections += std::string("\x9c") + "mrpt::obs::CActionCollection" + '\0' + bytesOf(1);
    ends += '\x88';
  }
  EXPECT_EQ(2u, readFrom(good(0) + sets + ends + good(1)).indices.size());
  const auto result = readFrom(good(0) + collections + ends + good(1));
  EXPECT_EQ(2u, result.indices.size());
  EXPECT_TRUE(result.skipped.empty());
}

TEST_F(BrokenObjectTest, NamesInABrokenFileDoNotFillTheCounts) {
  std::string bytes = good(0);
  for (int i = 0; i < 2000; ++i) {
    bytes += objectBytes("acme::CThing" + std::to_string(i), 0, "") + good(1 + i % 2).substr(0, 37);
  }
  EXPECT_LT(readFrom(bytes + good(3)).skipped.size(), 250u);
}

TEST_F(BrokenObjectTest, ImageNamesCannotLeaveTheImageFolder) {
  fs::create_directory(folder_ / "x_Images");
  cv::imwrite(folder_ / "x_Images/in.png", test::wall(1).left);
  cv::imwrite(folder_ / "outside.png", test::wall(1).right);
  fs::create_symlink(folder_ / "outside.png", folder_ / "x_Images/link.png");
  const auto external = [](const std::string& name) {
    return objectBytes("mrpt::img::CImage", 9, '\1' + textBytes(name));
  };
  const std::string in = external("in.png");
  const std::string first = test::stereoBytes(0, in, external("./in.png"));
  for (const std::string& name : {std::string("../outside.png"), std::string("link.png"),
                                  (folder_ / "outside.png").string()}) {
    const auto result = readFrom(first + test::stereoBytes(1, in, external(name)));
    EXPECT_THAT(result.indices, ElementsAre(0)) << name;
    EXPECT_THAT(result.skipped, ElementsAre(Pair("image_outside_folder", 1))) << name;
  }
}

}  // namespace
}  // namespace headway::io
