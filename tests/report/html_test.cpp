// SPDX-License-Identifier: BSD-3-Clause
#include "html.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway_test/black_png.h>
#include <headway_test/folders.h>
#include <headway_test/peak_memory.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

namespace headway::report {
namespace {

std::string encoded(const std::string& text) { return base64({text.begin(), text.end()}); }

TEST(Base64Test, MatchesTheExamplesOfRfc4648) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64({0xff, 0xef, 0xbe}), "/+++");
}

TEST(PictureUriTest, ContainsAJpegScaledToTheMaximumWidth) {
  const test::TemporaryFolder folder;
  cv::imwrite(folder / "wide.png", cv::Mat(60, 400, CV_8UC3, cv::Scalar(10, 120, 200)));
  const std::string uri = pictureUri(folder / "wide.png", 100);
  EXPECT_THAT(uri, ::testing::StartsWith("data:image/jpeg;base64,/9j/"));
  EXPECT_LT(uri.size(), pictureUri(folder / "wide.png", 400).size());
}

TEST(PictureUriTest, RefusesAFileThatIsNoPicture) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "bad.png") << "no picture";
  EXPECT_THROW((void)pictureUri(folder / "bad.png", 100), InputError);
}

TEST(PictureUriTest, RefusesAHugePictureBeforeItTakesMemory) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "huge.png", std::ios::binary) << test::blackPng(30000, 30000);
  const test::PeakMemory memory;
  EXPECT_THROW((void)pictureUri(folder / "huge.png", 100), InputError);
  EXPECT_THROW((void)gridPicture(folder / "huge.png"), InputError);
  EXPECT_LT(memory.growthMb(), 50);
}

TEST(HtmlTest, EscapesSpecialCharacters) {
  EXPECT_EQ(escaped("<a b=\"c\"> & d"), "&lt;a b=&quot;c&quot;&gt; &amp; d");
}

TEST(HtmlTest, FormatsNumbers) {
  EXPECT_EQ(fixed(1.25, 1), "1.2");
  EXPECT_EQ(fixed(std::nan(""), 1), "–");
  EXPECT_EQ(grouped(7), "7");
  EXPECT_EQ(grouped(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(hex({255, 9, 16}), "#ff0910");
}

TEST(HtmlTest, EscapesOnlySpecialCharacters) {
  EXPECT_EQ(escaped(""), "");
  EXPECT_EQ(escaped("Fußgänger 5 'm/s'"), "Fußgänger 5 'm/s'");
  EXPECT_EQ(escaped("&amp;"), "&amp;amp;") << "an entity in the input is text";
  EXPECT_EQ(escaped("<script>"), "&lt;script&gt;");
}

TEST(HtmlTest, GroupsDigitsByThree) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1\u202f000");
}

TEST(HtmlTest, FormatsInfinityAsMissing) {
  EXPECT_EQ(fixed(INFINITY, 2), "–");
  EXPECT_EQ(fixed(-0.04, 1), "-0.0");
  EXPECT_EQ(fixed(1e6, 0), "1000000");
}

TEST(HtmlTest, SectionEscapesItsTitleAndOmitsAnEmptyIntroduction) {
  EXPECT_EQ(section("id", "A & B", "", "<p>x</p>"),
            "<section id=\"id\"><h2>A &amp; B</h2><p>x</p></section>\n");
  EXPECT_THAT(section("id", "A", "why", ""), ::testing::HasSubstr("<p class=\"lead\">why</p>"));
}

TEST(PictureUriTest, KeepsSmallPicturesAtTheirSize) {
  const test::TemporaryFolder folder;
  cv::imwrite(folder / "small.png", cv::Mat(6, 10, CV_8UC3, cv::Scalar(10, 120, 200)));
  EXPECT_EQ(pictureUri(folder / "small.png", 10), pictureUri(folder / "small.png", 1000));
  EXPECT_THROW((void)pictureUri(folder / "missing.png", 10), InputError);
}

}  // namespace
}  // namespace headway::report
