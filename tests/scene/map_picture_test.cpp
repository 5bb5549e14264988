// SPDX-License-Identifier: BSD-3-Clause
#include "map_picture.h"

#include <gtest/gtest.h>
#include <headway/plot/colours.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "canvas.h"
#include "example_street.h"
#include "view.h"

namespace headway::scene {
namespace {

/// Points on a floor, one in each square of 10 cm, as the dense map has them.
std::vector<render::PaintedPoint> floorPoints(float size_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> within(0.F, 0.1F);
  std::vector<render::PaintedPoint> points;
  for (float x = 0.F; x < size_m; x += 0.1F) {
    for (float y = -0.5F * size_m; y < 0.5F * size_m; y += 0.1F) {
      points.push_back(
          {{x + within(random), y + within(random), 0.1F * within(random)}, {250, 10, 10}});
    }
  }
  return points;
}

int reds(const cv::Mat& picture) {
  cv::Mat alike;
  cv::inRange(picture, cv::Scalar(0, 0, 90), cv::Scalar(30, 30, 255), alike);
  return cv::countNonZero(alike);
}

/// Pixels of a picture that show the floor, seen from a height.
int paintedAt(const PointCells& cells, double height, int width, float width_m) {
  const auto view = render::makeView(
      width, width, 1.0, render::lookAt({10, 0, height}, {10, 0, 0}, Eigen::Vector3d::UnitX()));
  render::Painter painter(width, width);
  painter.clear(view, {});
  render::PointStyle style;
  style.width_m = width_m;
  cells.paint(view, style, painter);
  return reds(painter.picture());
}

TEST(PointCellsTest, DiscsOfTheClosingWidthCloseSurfaces) {
  const PointCells cells(floorPoints(40.F), 10.0);
  const double disc = cells.closingWidth();
  EXPECT_GT(disc, 0.06);
  EXPECT_LT(disc, 0.18) << "a voxel of 0.1 m";
  const int all = 300 * 300;
  EXPECT_GT(paintedAt(cells, 15.0, 300, static_cast<float>(disc)), 0.97 * all);
}

TEST(PointCellsTest, ASampleOfDistantCellsStillClosesThem) {
  const PointCells cells(floorPoints(40.F), 10.0);
  // 40 m are about 100 of 400 px: 2.5 voxels a pixel.
  const int pixels = paintedAt(cells, 146.0, 400, 0.1F);
  EXPECT_GT(pixels, 0.6 * 100 * 100);
  EXPECT_LT(pixels, 1.1 * 100 * 100);
}

TEST(PointCellsTest, PaintsEveryVisibleDot) {
  const auto map = streetMap();
  const auto points = landmarkPoints(*map.staticMap(), 0.0, 1.0, kDarkPalette);
  const auto view =
      render::makeView(640, 360, 1.0, render::lookAt({0.0, 0.0, 2.0}, {30.0, 0.0, 1.0}));
  render::Painter at_once(640, 360), by_cells(640, 360);
  render::PointStyle dot;
  dot.min_px = dot.max_px = 2.F;
  for (auto* painter : {&at_once, &by_cells}) painter->clear(view, {});
  at_once.paint(points.data(), points.size(), dot);
  PointCells(points, 10.0).paint(view, dot, by_cells);
  EXPECT_EQ(cv::norm(at_once.picture(), by_cells.picture(), cv::NORM_INF), 0.0);
}

TEST(PointCellsTest, HasNoClosingWidthWithoutPoints) {
  EXPECT_EQ(PointCells().closingWidth(), 0.0);
  EXPECT_EQ(PointCells({{{1, 2, 3}, {}}}, 10.0).closingWidth(), 0.0);
}

TEST(MapPointsTest, AreTheLandmarksInBrightnessAndHeight) {
  const slam::MapView static_map{{{LandmarkId{1}, {1, 2, 0}, 4, 250},
                                  {LandmarkId{2}, {1, 2, 0}, 4, 20},
                                  {LandmarkId{3}, {1, 2, 9}, 4, 250}},
                                 {}};
  const auto points = landmarkPoints(static_map, 0.0, 1.0, kDarkPalette);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_GT(points[0].colour.blue, points[1].colour.blue);
  EXPECT_GT(points[0].colour.blue, points[0].colour.red);
  EXPECT_LT(points[2].colour.blue, points[2].colour.red);
  EXPECT_EQ(points[2].position, Eigen::Vector3f(1, 2, 9));
}

TEST(LandmarkWidthTest, IsVisibleInSmallPicturesAndGrowsInLargeOnes) {
  EXPECT_GE(landmarkWidth({320, 180}), 2.0);
  EXPECT_NEAR(landmarkWidth({3840, 2160}), 3.0 * landmarkWidth({1280, 720}), 1e-9);
}

TEST(OccupancyTest, IsDrawnWhereItsCellsAre) {
  mrpt::maps::COccupancyGridMap2D grid(-20.F, 20.F, -20.F, 20.F, 0.5F);
  grid.setPos(5.2F, 3.2F, 0.05F);   // occupied
  grid.setPos(8.2F, -4.2F, 0.95F);  // free
  const auto cells = occupancyAround(grid, {0, 0, 0}, 15.0, kDarkPalette);
  ASSERT_FALSE(cells.colours.empty());
  EXPECT_NEAR(cells.x_min, -15.0, 0.51);
  const auto view = render::makeView(640, 360, 1.0, render::lookAt({-6, 0, 8}, {8, 0, 0}));
  cv::Mat picture(360, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  drawOccupancy(cells, -0.5, view, picture);
  const auto at = [&](double x, double y) {
    const auto pixel = render::project({x, y, -0.5}, view);
    return picture.at<cv::Vec3b>(cvRound(pixel->y()), cvRound(pixel->x()));
  };
  EXPECT_GT(at(5.25, 3.25)[2], 100) << "an obstacle is red";
  EXPECT_GT(at(8.25, -4.25)[1], 30) << "free ground is green";
  EXPECT_EQ(at(6.25, 0.25), cv::Vec3b(0, 0, 0)) << "unknown ground is left out";
  EXPECT_TRUE(occupancyAround(grid, {500, 0, 0}, 15.0, kDarkPalette).colours.empty());
}

TEST(MapPictureTest, PicturesOfTwoSizesShowTheSame) {
  const auto map = streetMap();
  const auto input = streetInput(map);
  const auto draw = [&](int width, int height) {
    SnapshotOptions options{width, height};
    MapPicture picture(options);
    return picture.draw(input, externalView(options, input, 0.0), 0.0);
  };
  const cv::Mat small = draw(640, 360);
  cv::Mat reduced;
  cv::resize(draw(1280, 720), reduced, small.size(), 0.0, 0.0, cv::INTER_AREA);
  const double difference = cv::norm(small, reduced, cv::NORM_L1) / (3.0 * 640 * 360);
  EXPECT_LT(difference, 8.0) << "of 255, on average";
}

}  // namespace
}  // namespace headway::scene
