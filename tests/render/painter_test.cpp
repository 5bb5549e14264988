// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/render/painter.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <random>

namespace headway::render {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr Backdrop kBackdrop{{0, 0, 90}, {60, 60, 60}, {0, 40, 0}};
constexpr Colour kRed{200, 0, 0}, kBlue{0, 0, 200};

/// From the map's origin along +x; 1 m at 10 m is 16 px.
PinholeView forwardView() {
  PinholeView view;
  view.width = kWidth;
  view.height = kHeight;
  view.fx = view.fy = 160.0;
  view.cx = 0.5 * (kWidth - 1);
  view.cy = 0.5 * (kHeight - 1);
  view.T_map_camera = lookAt({0, 0, 0}, {1, 0, 0});
  return view;
}

class PainterTest : public ::testing::Test {
 protected:
  PainterTest() { painter.clear(forwardView(), kBackdrop); }

  void paint(const std::vector<PaintedPoint>& points, const PointStyle& style) {
    painter.paint(points.data(), points.size(), style);
  }
  [[nodiscard]] int count(Colour colour) {
    cv::Mat equal;
    const cv::Scalar bgr(colour.blue, colour.green, colour.red);
    cv::inRange(painter.picture(), bgr, bgr, equal);
    return cv::countNonZero(equal);
  }
  [[nodiscard]] cv::Vec3b at(double x, double y, double z) {
    const auto pixel = project({x, y, z}, forwardView());
    return painter.picture().at<cv::Vec3b>(cvRound(pixel->y()), cvRound(pixel->x()));
  }

  Painter painter{kWidth, kHeight};
};

/// A wall across the view, as two triangles with a common edge.
std::vector<PaintedTriangle> wall(float x, Colour colour, float opacity) {
  const Eigen::Vector3f a(x, -2, -2), b(x, 2, -2), c(x, 2, 2), d(x, -2, 2);
  const std::array<float, 3> same{opacity, opacity, opacity};
  return {{{a, b, c}, colour, same}, {{a, c, d}, colour, same}};
}

PointStyle wide(float width_m) {
  PointStyle style;
  style.width_m = width_m;
  return style;
}

PointStyle dot(float side_px) {
  PointStyle style;
  style.min_px = style.max_px = side_px;
  return style;
}

TEST_F(PainterTest, HasSkyAboveTheHorizonAndGroundBelow) {
  const auto& picture = painter.picture();
  EXPECT_GT(picture.at<cv::Vec3b>(0, 10)[0], 70) << "towards the zenith";
  EXPECT_EQ(picture.at<cv::Vec3b>(kHeight - 1, 10), cv::Vec3b(0, 40, 0));
  EXPECT_NEAR(picture.at<cv::Vec3b>(kHeight / 2, 10)[2], 60, 8) << "of the horizon";
}

TEST_F(PainterTest, PointsAreDiscsOfTheirSizeInTheWorld) {
  paint({{{10, 0, 0}, kRed}}, wide(1.F));
  EXPECT_NEAR(count(kRed), 0.25 * M_PI * 24 * 24, 12) << "1 m is 16 px, and half of it overlaps";
  EXPECT_EQ(at(10, 0, 0), cv::Vec3b(0, 0, 200));
}

TEST_F(PainterTest, DotsHaveTheSameSizeAtAnyDistance) {
  paint({{{10, 3, 0}, kRed}, {{80, -3, 0}, kRed}}, dot(3.F));
  EXPECT_EQ(count(kRed), 2 * 9);
}

TEST_F(PainterTest, DistantDiscsAreOnePixel) {
  paint({{{200, 0, 0}, kRed}}, wide(0.1F));
  EXPECT_EQ(count(kRed), 1);
}

TEST_F(PainterTest, NearerPointsHideOthersInAnyOrder) {
  paint({{{10, 0, 0}, kRed}, {{20, 0, 0}, kBlue}}, wide(1.F));
  EXPECT_EQ(count(kBlue), 0);
  paint({{{5, 0, 0}, kBlue}}, wide(1.F));
  EXPECT_EQ(count(kRed), 0);
}

TEST_F(PainterTest, PointsOutsideTheViewAreNotDrawn) {
  paint({{{-10, 0, 0}, kRed}, {{10, 50, 0}, kRed}, {{0.1F, 0, 0}, kRed}, {{1e4F, 0, 0}, kRed}},
        wide(1.F));
  EXPECT_EQ(count(kRed), 0);
  auto style = wide(1.F);
  style.near_m = 12.F;
  paint({{{10, 0, 0}, kRed}}, style);
  EXPECT_EQ(count(kRed), 0) << "nearer than the style allows";
}

TEST_F(PainterTest, ShadingDarkensOnlyWhatIsBehindAnEdge) {
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      paint({{{20, 0.25F * float(i), 0.25F * float(j)}, kBlue}}, wide(0.25F));
    }
  }
  paint({{{10, 0, 0}, kRed}}, wide(1.F));
  const cv::Vec3b sky = painter.picture().at<cv::Vec3b>(0, 10);
  painter.shade();
  EXPECT_EQ(at(10, 0, 0), cv::Vec3b(0, 0, 200)) << "in front";
  EXPECT_EQ(at(20, 5, 5), cv::Vec3b(200, 0, 0)) << "far from the edge";
  EXPECT_EQ(painter.picture().at<cv::Vec3b>(0, 10), sky);
  const int left = (kWidth - 20) / 2 - 1;  // of the red square
  EXPECT_LT(painter.picture().at<cv::Vec3b>(kHeight / 2, left)[0], 130);
}

TEST_F(PainterTest, TrianglesBlendByTheirOpacityOnceOnCommonEdges) {
  painter.picture().setTo(cv::Scalar(100, 100, 100));
  painter.paint(wall(10, kRed, 0.5F), 0.1);
  EXPECT_EQ(count({150, 50, 50}), 64 * 64) << "4 m are 64 px";
  EXPECT_EQ(count({175, 25, 25}), 0) << "blended twice";
}

TEST_F(PainterTest, TrianglesFadeBetweenTheirCorners) {
  painter.picture().setTo(cv::Scalar(0, 0, 0));
  painter.paint({{{{{10, 4, -4}, {10, 4, 4}, {10, -4, 0}}}, {200, 200, 200}, {1.F, 1.F, 0.F}}},
                0.1);
  EXPECT_GT(at(10, 3.5, 0)[0], 170);
  EXPECT_NEAR(at(10, 0, 0)[0], 100, 5);
  EXPECT_LT(at(10, -3.5, 0)[0], 30);
}

TEST_F(PainterTest, HiddenTrianglesAreFaint) {
  paint({{{10, 0, 0}, {100, 100, 100}}}, wide(6.F));
  painter.paint(wall(10.2F, kRed, 1.F), 0.5);
  EXPECT_EQ(at(10, 0, 0), cv::Vec3b(0, 0, 200)) << "within the margin";
  painter.paint(wall(12, {0, 200, 0}, 1.F), 0.5);
  const auto faint = at(10, 0, 0);
  EXPECT_NEAR(faint[1], 50, 2);
  EXPECT_NEAR(faint[2], 150, 2);
}

TEST_F(PainterTest, ClipsTrianglesAtTheCamera) {
  // The ground from behind the camera to far ahead.
  painter.paint({{{{{-20, -5, -1}, {50, -5, -1}, {50, 5, -1}}}, kRed, {1.F, 1.F, 1.F}}}, 0.1);
  EXPECT_EQ(at(20, -2, -1), cv::Vec3b(0, 0, 200));
  EXPECT_NE(at(20, 2, 1), cv::Vec3b(0, 0, 200)) << "above the horizon";
  painter.paint({{{{{-20, -5, -1}, {-5, -5, -1}, {-5, 5, -1}}}, kBlue, {1.F, 1.F, 1.F}}}, 0.1);
  EXPECT_EQ(count(kBlue), 0);
}

TEST_F(PainterTest, HidesWhatIsBehindPoints) {
  paint({{{10, 0, 0}, kRed}}, wide(1.F));
  EXPECT_TRUE(painter.hides({20, 0, 0}, 0.5));
  EXPECT_FALSE(painter.hides({10.3, 0, 0}, 0.5)) << "within the margin";
  EXPECT_FALSE(painter.hides({5, 0, 0}, 0.5));
  EXPECT_FALSE(painter.hides({20, 8, 0}, 0.5)) << "beside it";
  EXPECT_FALSE(painter.hides({20, 500, 0}, 0.5)) << "outside the picture";
  EXPECT_FALSE(painter.hides({-20, 0, 0}, 0.5));
}

TEST_F(PainterTest, TheSameInputGivesTheSameBytesWithAnyNumberOfThreads) {
  std::mt19937 random(7);
  std::vector<PaintedPoint> points;
  for (int i = 0; i < 2000; ++i) {
    const auto value = [&] { return 0.01F * static_cast<float>(random() % 2000) - 10.F; };
    points.push_back({{20.F + value(), value(), value()}, {std::uint8_t(i % 251), 90, 20}});
  }
  const auto draw = [&](int threads) {
    cv::setNumThreads(threads);
    Painter other(kWidth, kHeight);
    other.clear(forwardView(), kBackdrop);
    other.paint(points.data(), points.size(), wide(0.2F));
    other.shade();
    other.paint(wall(15, kBlue, 0.3F), 0.5);
    return other.picture().clone();
  };
  const int threads = cv::getNumThreads();
  const cv::Mat one = draw(1), four = draw(4);
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::norm(one, four, cv::NORM_INF), 0.0);
}

TEST_F(PainterTest, PaintsWholeDiscsInEveryRow) {
  for (int row = 20; row < kHeight - 20; ++row) {
    painter.clear(forwardView(), kBackdrop);
    const auto z = static_cast<float>(0.5 * (kHeight - 1) - row) / 16.F;
    paint({{{10, 0, z}, kRed}}, wide(1.F));
    EXPECT_NEAR(count(kRed), 0.25 * M_PI * 24 * 24, 12) << row;
  }
}

TEST_F(PainterTest, DiscsAreThePixelsWithinTheirRadiusAtBordersToo) {
  constexpr double kRadius = 0.75 * 16.0;  // of 1 m at 10 m, half of it overlaps
  for (const double y : {0.0, 3.71, 9.9, -9.9}) {
    painter.clear(forwardView(), kBackdrop);
    const Eigen::Vector3d place(10.0, y, 0.03);
    paint({{place.cast<float>(), kRed}}, wide(1.F));
    const auto centre = project(place, forwardView());
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const double distance = (*centre - Eigen::Vector2d(column, row)).norm();
        if (std::abs(distance - kRadius) < 0.01) continue;
        const bool is_red = painter.picture().at<cv::Vec3b>(row, column) == cv::Vec3b(0, 0, 200);
        ASSERT_EQ(is_red, distance < kRadius) << y << " m, pixel " << column << ' ' << row;
      }
    }
  }
}

TEST_F(PainterTest, ShadedPointsKeepTheirColourAwayFromEdges) {
  paint({{{10, 0, 0}, kRed}}, wide(6.F));
  const cv::Mat unshaded = painter.picture().clone();
  painter.shade();
  EXPECT_EQ(cv::norm(unshaded, painter.picture(), cv::NORM_INF), 0.0) << "nothing is behind";
  paint({{{8, 0, 0}, kBlue}}, wide(1.F));
  EXPECT_EQ(at(8, 0, 0), cv::Vec3b(200, 0, 0)) << "painted after shading";
}

TEST_F(PainterTest, ARunsRowsAreOnlyABound) {
  const std::vector<PaintedPoint> points{{{10, 0, 4}, kRed}, {{10, 0, -4}, kRed}};
  painter.paint({{points.data(), 1, 40, 80}, {points.data() + 1, 1, 160, 200}}, wide(1.F));
  const cv::Mat bounded = painter.picture().clone();
  painter.clear(forwardView(), kBackdrop);
  paint(points, wide(1.F));
  EXPECT_EQ(cv::norm(bounded, painter.picture(), cv::NORM_INF), 0.0);
}

TEST(EnlargedTest, KeepsWhereThingsAre) {
  const auto view = forwardView();
  const auto large = enlarged(view, 3);
  EXPECT_EQ(large.width, 3 * kWidth);
  const auto small_pixel = project({12, 3, 1}, view);
  const auto large_pixel = project({12, 3, 1}, large);
  ASSERT_TRUE(small_pixel && large_pixel);
  const Eigen::Vector2d centre(0.5, 0.5);
  EXPECT_TRUE((3.0 * (*small_pixel + centre)).isApprox(*large_pixel + centre, 1e-9));
}

}  // namespace
}  // namespace headway::render
