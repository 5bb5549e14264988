// SPDX-License-Identifier: BSD-3-Clause
#include "canvas.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace headway::scene {
namespace {

constexpr Colour kRed{255, 0, 0};

cv::Mat black(int width, int height) {
  return cv::Mat(height, width, CV_8UC3, cv::Scalar(0, 0, 0));
}

/// Bounding rectangle of the pixels that are not black.
cv::Rect inkOf(const cv::Mat& picture) {
  cv::Mat grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  return cv::boundingRect(grey);
}

TEST(CanvasTest, PointsScaleWithTheHeightOfThePicture) {
  cv::Mat small = black(1280, 720), large = black(2560, 1440), tiny = black(20, 10);
  EXPECT_EQ(Canvas(small).px(10), 10);
  EXPECT_EQ(Canvas(large).px(10), 20);
  EXPECT_EQ(Canvas(tiny).px(10), 5) << "not below half size";
  EXPECT_EQ(Canvas(tiny).px(0.1), 1) << "never invisible";
}

TEST(CanvasTest, APartUsesThePointSizeOfTheWhole) {
  cv::Mat picture = black(1280, 720);
  const Canvas whole(picture);
  cv::Mat part = picture(cv::Rect(0, 0, 100, 100));
  EXPECT_EQ(Canvas(part, whole).px(10), 10);
  EXPECT_EQ(Canvas(part, whole, 0.5).px(10), 5);
}

TEST(CanvasTest, TextStartsAtItsBaselineWithTheHeightOfItsCapitals) {
  cv::Mat picture = black(1280, 720);
  Canvas canvas(picture);
  canvas.text("HEH", {100, 200}, 40, kRed, false);
  const cv::Rect ink = inkOf(picture);
  EXPECT_NEAR(ink.height, 40, 6) << "strokes are 2 px wide";
  EXPECT_NEAR(ink.br().y, 200, 3);
  EXPECT_NEAR(ink.x, 100, 6);
  EXPECT_NEAR(ink.width, canvas.textSize("HEH", 40).width, 14);
}

TEST(CanvasTest, PanelDarkensItsRectangleOnly) {
  cv::Mat picture(100, 100, CV_8UC3, cv::Scalar(200, 200, 200));
  Canvas(picture).panel({-20, 10, 40, 20}, 0.5);
  EXPECT_LT(picture.at<cv::Vec3b>(15, 5)[0], 120);
  EXPECT_EQ(picture.at<cv::Vec3b>(15, 21)[0], 200);
  EXPECT_EQ(picture.at<cv::Vec3b>(9, 5)[0], 200);
  Canvas(picture).panel({200, 200, 10, 10});
}

TEST(CanvasTest, DrawsLinesAndPolygonsWhereTheyAre) {
  cv::Mat picture = black(200, 100);
  Canvas canvas(picture);
  canvas.line({10.0, 50.0}, {190.0, 50.0}, 2.0, kRed);
  EXPECT_GT(picture.at<cv::Vec3b>(50, 100)[2], 200);
  EXPECT_EQ(picture.at<cv::Vec3b>(54, 100), cv::Vec3b(0, 0, 0));
  canvas.polygon({{20.0, 5.0}, {40.0, 5.0}, {40.0, 25.0}, {20.0, 25.0}}, {0, 255, 0});
  EXPECT_EQ(picture.at<cv::Vec3b>(15, 30), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(picture.at<cv::Vec3b>(15, 60), cv::Vec3b(0, 0, 0));
}

TEST(CanvasTest, ScalesGreyAndColourImagesIntoARectangle) {
  cv::Mat picture = black(200, 100);
  Canvas canvas(picture);
  canvas.image(cv::Mat(30, 30, CV_8UC1, cv::Scalar(90)), {10, 10, 60, 60});
  EXPECT_EQ(inkOf(picture), cv::Rect(10, 10, 60, 60));
  EXPECT_EQ(picture.at<cv::Vec3b>(40, 40), cv::Vec3b(90, 90, 90));
  canvas.image(cv::Mat(300, 300, CV_8UC3, cv::Scalar(1, 2, 3)), {100, 10, 30, 30});
  EXPECT_EQ(picture.at<cv::Vec3b>(20, 110), cv::Vec3b(1, 2, 3));
}

TEST(CanvasTest, IgnoresImagesThatExceedThePicture) {
  cv::Mat picture = black(200, 100);
  Canvas canvas(picture);
  canvas.image(cv::Mat(30, 30, CV_8UC1, cv::Scalar(90)), {190, 10, 60, 60});
  canvas.image(cv::Mat(), {10, 10, 60, 60});
  EXPECT_TRUE(inkOf(picture).empty());
}

}  // namespace
}  // namespace headway::scene
