#include "data_uri.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "html.h"

namespace headway::report {
namespace {

std::string encoded(const std::string& text) { return base64({text.begin(), text.end()}); }

TEST(Base64Test, AgreesWithTheExamplesOfItsStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64({0xff, 0xef, 0xbe}), "/+++");
}

TEST(PictureUriTest, HoldsAJpegNoWiderThanAsked) {
  const test::TemporaryFolder folder;
  cv::imwrite(folder / "wide.png", cv::Mat(60, 400, CV_8UC3, cv::Scalar(10, 120, 200)));
  const std::string uri = pictureUri(folder / "wide.png", 100);
  EXPECT_THAT(uri, ::testing::StartsWith("data:image/jpeg;base64,/9j/"));
  EXPECT_LT(uri.size(), pictureUri(folder / "wide.png", 400).size());
}

TEST(PictureUriTest, NamesWhatIsNoPicture) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "bad.png") << "no picture";
  EXPECT_THROW((void)pictureUri(folder / "bad.png", 100), InputError);
}

TEST(HtmlTest, EscapesWhatMeansSomething) {
  EXPECT_EQ(escaped("<a b=\"c\"> & d"), "&lt;a b=&quot;c&quot;&gt; &amp; d");
}

TEST(HtmlTest, WritesNumbersForReaders) {
  EXPECT_EQ(fixed(1.25, 1), "1.2");
  EXPECT_EQ(fixed(std::nan(""), 1), "–");
  EXPECT_EQ(grouped(7), "7");
  EXPECT_EQ(grouped(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(hex({255, 9, 16}), "#ff0910");
}

}  // namespace
}  // namespace headway::report
