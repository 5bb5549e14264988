// SPDX-License-Identifier: BSD-3-Clause
// Images that are larger than the limits are refused by their headers, before they take memory.
#include <gmock/gmock.h>
#include <headway/io/dataset.h>
#include <headway/io/image_file.h>
#include <headway_test/black_png.h>
#include <headway_test/folders.h>
#include <headway_test/peak_memory.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>

#include "foreign_recording.h"
#include "object_bytes.h"

namespace headway::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// A PNG whose first chunk is of a kind that decoders skip, and looks like the header of a small
/// one.
std::string behindAnotherChunk(std::string png) {
  std::string chunk("prVt\0\0\0\x10\0\0\0\x10\x08\0\0\0\0", 17);
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), 17);
  for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(sum >> shift);
  return png.insert(8, std::string("\0\0\0\x0D", 4) + chunk);
}

class HugeImageTest : public ::testing::Test {
 protected:
  ~HugeImageTest() override { EXPECT_LT(memory_.growthMb(), 50); }

  void write(const std::string& name, const std::string& content) {
    test::writeContent(folder_ / name, content);
  }

  headway::test::TemporaryFolder folder_;
  const std::string huge_ = test::blackPng(30000, 30000);

 private:
  const headway::test::PeakMemory memory_;
};

TEST_F(HugeImageTest, IsBrokenInEachFormat) {
  const std::string small_png = test::blackPng(300, 20);
  EXPECT_EQ(cv::Size(300, 20), decodeImage(small_png).size());
  EXPECT_EQ(cv::Size(300, 20), decodeImage(behindAnotherChunk(small_png)).size());
  EXPECT_TRUE(decodeImage(huge_).empty());
  EXPECT_TRUE(decodeImage(behindAnotherChunk(huge_)).empty());
  for (const char* ending : {".png", ".bmp", ".pgm", ".tif"}) {
    std::vector<unsigned char> small;
    cv::imencode(ending, test::wall(1).right, small);
    EXPECT_FALSE(decodeImage({reinterpret_cast<char*>(small.data()), small.size()}).empty())
        << ending;
  }
  EXPECT_TRUE(decodeImage("P5 30000 30000 255\n").empty());
  EXPECT_TRUE(decodeImage("P5\n# text").empty());
  EXPECT_TRUE(decodeImage(std::string("II*\0\x08\0\0\0", 8)).empty());
}

TEST_F(HugeImageTest, PngsAreDecodedWithoutLossAndBrokenOnesWithoutAWord) {
  cv::RNG random(3);
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    cv::Mat pixels(20, 30, type);
    random.fill(pixels, cv::RNG::UNIFORM, 0, type == CV_16UC1 ? 65536 : 256);
    std::vector<unsigned char> bytes;
    cv::imencode(".png", pixels, bytes);
    std::string text(bytes.begin(), bytes.end());
    const auto decoded = [&] {
      return type == CV_16UC1 ? decodeDepthImage(text) : decodeImage(text);
    };
    ASSERT_EQ(type, decoded().type());
    EXPECT_EQ(0.0, cv::norm(pixels, decoded(), cv::NORM_INF));
    testing::internal::CaptureStderr();
    int broken = 0;
    for (char& byte : text) {
      byte = static_cast<char>(byte ^ 0x55);
      broken += decoded().empty() ? 1 : 0;
      byte = static_cast<char>(byte ^ 0x55);
    }
    EXPECT_EQ("", testing::internal::GetCapturedStderr()) << "by libpng";
    EXPECT_GT(broken, static_cast<int>(text.size()) / 2);
  }
}

// OpenCV releases the pixels that it could not decode but keeps their type, which has transparency
// here.
TEST_F(HugeImageTest, IsWholeOrEmptyWhateverByteOfTransparentPixelsIsBroken) {
  for (const char* ending : {".png", ".tif"}) {
    std::vector<unsigned char> whole;
    cv::imencode(ending, cv::Mat(8, 6, CV_8UC4, cv::Scalar(1, 2, 3, 4)), whole);
    for (std::size_t size = 1; size < whole.size(); ++size) {
      const cv::Mat image = decodeImage({reinterpret_cast<char*>(whole.data()), size});
      EXPECT_TRUE(image.empty() || image.type() == CV_8UC3) << ending << " of " << size << " bytes";
    }
    for (std::size_t i = 8; i < whole.size(); ++i) {
      std::vector<unsigned char> changed = whole;
      changed[i] ^= 0x0F;
      const cv::Mat image = decodeImage({reinterpret_cast<char*>(changed.data()), changed.size()});
      EXPECT_TRUE(image.empty() || image.depth() == CV_8U) << ending << ", byte " << i;
    }
  }
}

TEST_F(HugeImageTest, CostsItsFrameOfARawlog) {
  const auto external = [](const std::string& name) {
    return test::objectBytes("mrpt::img::CImage", 9, '\1' + test::textBytes(name));
  };
  write("x_Images/good.png", "");
  cv::imwrite(folder_ / "x_Images/good.png", test::wall(0).left);
  write("x_Images/huge.png", huge_);
  const std::string good = external("good.png");
  write("x.rawlog", test::stereoBytes(0, good, good) +
                        test::stereoBytes(1, good, external("huge.png")) +
                        test::stereoBytes(2, good, good));
  RawlogSource source(folder_ / "x.rawlog", {});
  EXPECT_EQ(2u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ElementsAre(Pair("broken_image", 1u)));
}

TEST_F(HugeImageTest, IsRefusedByNameAtImport) {
  const std::string folder = folder_.path();
  for (const char* image : {"image_0/000000.png", "image_1/000000.png"}) {
    write(std::string("sequences/07/") + image, huge_);
  }
  write("sequences/07/calib.txt",
        "P0: 100 0 80 0 0 100 60 0 0 0 1 0\nP1: 100 0 80 -50 0 100 60 0 0 0 1 0\n");
  const auto kitti = test::errorOf([&] { (void)openKittiOdometry(folder, "07"); });
  EXPECT_THAT(kitti, HasSubstr("/000000.png: missing, broken"));
  for (const auto& [camera, y] : {std::pair("mav0/cam0", "0.0"), std::pair("mav0/cam1", "0.1")}) {
    write(std::string(camera) + "/sensor.yaml",
          std::string("T_BS: {data: [0, -1, 0, 0, 1, 0, 0, ") + y +
              ", 0, 0, 1, 0, 0, 0, 0, 1]}\n"
              "resolution: [30000, 30000]\ncamera_model: pinhole\nintrinsics: [9, 9, 8, 6]\n"
              "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
    write(std::string(camera) + "/data.csv", "12,a.png\n");
    write(std::string(camera) + "/data/a.png", huge_);
  }
  const auto euroc = test::errorOf([&] { (void)openEuroc(folder)->frame(0); });
  EXPECT_THAT(euroc, HasSubstr("cam0/data/a.png: missing, broken"));
}

}  // namespace
}  // namespace headway::io
