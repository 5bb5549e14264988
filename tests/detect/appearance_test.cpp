// SPDX-License-Identifier: BSD-3-Clause
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

constexpr int kReduce = 2;

AppearanceTemplate thing() { return *templateOf(imageWith(kThing.tl()), cellsIn(kThing), kReduce); }

cv::Point2d centreOf(const AppearanceTemplate& appearance) {
  return {appearance.mask.corner.x + 0.5 * appearance.mask.cells.cols,
          appearance.mask.corner.y + 0.5 * appearance.mask.cells.rows};
}

TEST(AppearanceTest, MaskCoversTheObjectWithItsGapsClosed) {
  const auto appearance = thing();
  EXPECT_GE(appearance.patch.cols, kThing.width - 1);
  EXPECT_EQ(appearance.patch.rows, kThing.height);
  EXPECT_NEAR(cv::countNonZero(appearance.mask.cells), kThing.area(), kThing.height + 20);
  EXPECT_NEAR(centreOf(appearance).x, kThing.x + 0.5 * kThing.width, 1.0);
  EXPECT_NEAR(centreOf(appearance).y, kThing.y + 0.5 * kThing.height, 1.0);
}

TEST(ObjectMaskTest, HoldsTheCellsInTheirBoundingBox) {
  const auto mask = maskOf({{7, 3}, {5, 4}}, kReduce);
  ASSERT_NE(mask, nullptr);
  EXPECT_EQ(mask->corner, cv::Point(5, 3));
  EXPECT_EQ(mask->cells.size(), cv::Size(3, 2));
  EXPECT_EQ(cv::countNonZero(mask->cells), 2);
  EXPECT_NE(mask->cells.at<unsigned char>(0, 2), 0);
  EXPECT_EQ(mask->reduce, kReduce);
  EXPECT_EQ(maskOf({}, kReduce), nullptr);
}

TEST(AppearanceTest, FlatOrTinyObjectsHaveNoTemplate) {
  EXPECT_FALSE(templateOf(cv::Mat(kImage, CV_8U, cv::Scalar(90)), cellsIn(kThing), kReduce));
  EXPECT_FALSE(templateOf(imageWith(kThing.tl()), cellsIn({90, 30, 4, 4}), kReduce));
}

TEST(AppearanceTest, IsFoundWhereTheObjectMoved) {
  const auto appearance = thing();
  const auto off =
      findTemplate(appearance, imageWith(kThing.tl() + cv::Point(5, -2)), centreOf(appearance), 1);
  ASSERT_TRUE(off);
  EXPECT_EQ(*off, cv::Point(5, -2));
}

TEST(AppearanceTest, IsFoundEnlarged) {
  const auto appearance = thing();
  const double scale = 1.25;
  const cv::Mat image = imageWith({90, 30}, scale);
  const cv::Point2d middle(90.0 + 0.5 * scale * kThing.width, 30.0 + 0.5 * scale * kThing.height);
  const auto off = findTemplate(appearance, image, middle + cv::Point2d(3.0, 0.0), scale);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->x, -3, 1);
  EXPECT_NEAR(off->y, 0, 1);
}

TEST(AppearanceTest, IsNotSearchedBeyondAFactorOfThreeInScale) {
  const auto appearance = thing();
  for (const double scale : {1e-3, 0.3, 3.1, 1e3, std::nan("")}) {
    EXPECT_FALSE(findTemplate(appearance, imageWith(kThing.tl()), centreOf(appearance), scale))
        << scale;
  }
}

TEST(AppearanceTest, IsFoundAtTheEdgeOfTheImageByItsVisiblePart) {
  const auto appearance = thing();
  const cv::Point2d shift(-kThing.x - 6.0, 0.0);  // half of it has left the image
  const auto off = findTemplate(appearance, imageWith({-6, 30}), centreOf(appearance) + shift, 1.0);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->x, 0, 1);
  const cv::Point2d gone(-kThing.x - 20.0, 0.0);
  EXPECT_FALSE(findTemplate(appearance, textured(kImage, 1), centreOf(appearance) + gone, 1.0));
}

TEST(AppearanceTest, IsNotFoundInOtherTexture) {
  const auto appearance = thing();
  EXPECT_FALSE(findTemplate(appearance, textured(kImage, 1), centreOf(appearance), 1.0));
  EXPECT_FALSE(
      findTemplate(appearance, cv::Mat(kImage, CV_8U, cv::Scalar(0)), centreOf(appearance), 1.0));
}

TEST(RepeatsAlongRowsTest, ACorrugatedSheetDoes) {
  cv::Mat image(kImage, CV_8U);
  for (int column = 0; column < image.cols; ++column) {
    image.col(column).setTo(128.0 + 80.0 * std::sin(0.6 * column));
  }
  EXPECT_TRUE(repeatsAlongRows(image, cellsIn(kThing)));
}

TEST(RepeatsAlongRowsTest, APersonDoesNot) {
  EXPECT_FALSE(repeatsAlongRows(imageWith(kThing.tl()), cellsIn(kThing)));
}

}  // namespace
}  // namespace headway::detect
