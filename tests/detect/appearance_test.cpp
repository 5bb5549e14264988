#include "appearance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace headway::detect {
namespace {

const cv::Size kImage(200, 100);
const cv::Rect kThing(90, 30, 12, 40);

cv::Mat textured(cv::Size size, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat image(size, CV_8U);
  for (int i = 0; i < static_cast<int>(image.total()); ++i) {
    image.data[i] = static_cast<unsigned char>(random() % 200 + 20);
  }
  cv::GaussianBlur(image, image, {5, 5}, 0.0);
  return image;
}

/// A background with the thing at a place of it, larger by a factor.
cv::Mat imageWith(const cv::Point& corner, double scale = 1.0) {
  cv::Mat image = textured(kImage, 1);
  cv::Mat thing;
  cv::resize(textured(kThing.size(), 2), thing, {}, scale, scale, cv::INTER_LINEAR);
  const cv::Rect place = cv::Rect(corner, thing.size()) & cv::Rect({0, 0}, kImage);
  thing(cv::Rect(place.tl() - corner, place.size())).copyTo(image(place));
  return image;
}

std::vector<cv::Point> cellsIn(const cv::Rect& rectangle) {
  std::vector<cv::Point> cells;
  for (int row = rectangle.y; row < rectangle.br().y; ++row) {
    // Every other column: stereo leaves gaps.
    for (int column = rectangle.x; column < rectangle.br().x; column += 2) {
      cells.emplace_back(column, row);
    }
  }
  return cells;
}

Appearance looked() { return *appearanceOf(imageWith(kThing.tl()), cellsIn(kThing)); }

TEST(AppearanceTest, ShowsTheThingWithItsGapsClosed) {
  const auto appearance = looked();
  EXPECT_GE(appearance.patch.cols, kThing.width - 1);
  EXPECT_EQ(appearance.patch.rows, kThing.height);
  EXPECT_NEAR(cv::countNonZero(appearance.mask), kThing.area(), kThing.height + 20);
  EXPECT_NEAR(appearance.middle.x, kThing.x + 0.5 * kThing.width, 1.0);
  EXPECT_NEAR(appearance.middle.y, kThing.y + 0.5 * kThing.height, 1.0);
}

TEST(AppearanceTest, FlatOrTinyThingsHaveNone) {
  EXPECT_FALSE(appearanceOf(cv::Mat(kImage, CV_8U, cv::Scalar(90)), cellsIn(kThing)));
  EXPECT_FALSE(appearanceOf(imageWith(kThing.tl()), cellsIn({90, 30, 4, 4})));
}

TEST(AppearanceTest, IsFoundWhereItWent) {
  const auto appearance = looked();
  const auto off =
      seek(appearance, imageWith(kThing.tl() + cv::Point(5, -2)), appearance.middle, 1);
  ASSERT_TRUE(off);
  EXPECT_EQ(*off, cv::Point(5, -2));
}

TEST(AppearanceTest, IsFoundWhenItHasComeNearer) {
  const auto appearance = looked();
  const double scale = 1.25;
  const cv::Mat image = imageWith({90, 30}, scale);
  const cv::Point2d middle(90.0 + 0.5 * scale * kThing.width, 30.0 + 0.5 * scale * kThing.height);
  const auto off = seek(appearance, image, middle + cv::Point2d(3.0, 0.0), scale);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->x, -3, 1);
  EXPECT_NEAR(off->y, 0, 1);
}

TEST(AppearanceTest, IsNotSoughtMuchLargerOrSmaller) {
  const auto appearance = looked();
  for (const double scale : {1e-3, 0.3, 3.1, 1e3, std::nan("")}) {
    EXPECT_FALSE(seek(appearance, imageWith(kThing.tl()), appearance.middle, scale)) << scale;
  }
}

TEST(AppearanceTest, IsFoundAtTheEdgeByWhatIsLeftOfIt) {
  const auto appearance = looked();
  const cv::Point2d shift(-kThing.x - 6.0, 0.0);  // half of it has left the image
  const auto off = seek(appearance, imageWith({-6, 30}), appearance.middle + shift, 1.0);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->x, 0, 1);
  const cv::Point2d gone(-kThing.x - 20.0, 0.0);
  EXPECT_FALSE(seek(appearance, textured(kImage, 1), appearance.middle + gone, 1.0));
}

TEST(AppearanceTest, IsNotFoundWhereSomethingElseIs) {
  const auto appearance = looked();
  EXPECT_FALSE(seek(appearance, textured(kImage, 1), appearance.middle, 1.0));
  EXPECT_FALSE(seek(appearance, cv::Mat(kImage, CV_8U, cv::Scalar(0)), appearance.middle, 1.0));
}

}  // namespace
}  // namespace headway::detect
