// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace headway::plot {
namespace {

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.dataend, b.datastart);
}

/// Ratio of pixels that differ between two pictures.
double changed(const cv::Mat& a, const cv::Mat& b) {
  std::size_t count = 0;
  for (int row = 0; row < a.rows; ++row) {
    for (int col = 0; col < a.cols; ++col) {
      if (a.at<cv::Vec3b>(row, col) != b.at<cv::Vec3b>(row, col)) ++count;
    }
  }
  return static_cast<double>(count) / static_cast<double>(a.total());
}

/// Area inside the axes of a chart of the default size [px].
const cv::Rect kAxes(84, 46, 1200 - 84 - 24, 760 - 46 - 62);

/// Mask of the pixels that differ between two pictures.
cv::Mat differenceOf(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat mask(a.size(), CV_8U, cv::Scalar(0));
  for (int row = 0; row < a.rows; ++row) {
    for (int col = 0; col < a.cols; ++col) {
      if (a.at<cv::Vec3b>(row, col) != b.at<cv::Vec3b>(row, col))
        mask.at<std::uint8_t>(row, col) = 1;
    }
  }
  return mask;
}

/// Smallest rectangle around the pixels that differ.
cv::Rect boundsOf(const cv::Mat& mask) {
  cv::Point low(mask.cols, mask.rows), high(-1, -1);
  for (int row = 0; row < mask.rows; ++row) {
    for (int col = 0; col < mask.cols; ++col) {
      if (mask.at<std::uint8_t>(row, col) == 0) continue;
      low = {std::min(low.x, col), std::min(low.y, row)};
      high = {std::max(high.x, col), std::max(high.y, row)};
    }
  }
  return high.x < 0 ? cv::Rect() : cv::Rect(low, high + cv::Point(1, 1));
}

/// What one drawing call changes.
template <typename Draw>
cv::Mat changedBy(const ChartFrame& frame, const Draw& draw) {
  Chart chart(frame);
  const cv::Mat before = chart.picture();
  draw(chart);
  return differenceOf(before, chart.picture());
}

ChartFrame someFrame() { return {"Title", "x [m]", "y [m]", {0.0, 10.0}, {-1.0, 1.0}}; }

TEST(ChartTest, DrawsAtTheGivenPosition) {
  Chart chart(someFrame());
  const cv::Mat before = chart.picture();
  chart.dot({5.0, 0.0}, {255, 0, 0}, 10.0);
  const cv::Mat after = chart.picture();
  EXPECT_EQ(before.size(), cv::Size(1200, 760));
  EXPECT_GT(changed(before, after), 0.0);
  EXPECT_LT(changed(before, after), 0.001);
  // Middle of the axes: red.
  const cv::Vec3b middle = after.at<cv::Vec3b>(46 + (760 - 46 - 62) / 2, 84 + (1200 - 84 - 24) / 2);
  EXPECT_EQ(cv::Vec3b(0, 0, 255), middle);
}

TEST(ChartTest, IsDeterministic) {
  const auto draw = [] {
    Chart chart(someFrame());
    chart.line({{0, 0}, {3, 1}, {10, -1}}, categoryColour(1), 2.0, LineStyle::kDashed);
    chart.legend("line", categoryColour(1));
    chart.ramp("error", 0.37);
    return chart.picture();
  };
  EXPECT_TRUE(sameBytes(draw(), draw()));
}

TEST(ChartTest, IgnoresPointsThatAreNotFiniteAndClipsFarOnes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Chart chart(someFrame());
  const cv::Mat before = chart.picture();
  chart.dot({nan, 0.0}, {});
  chart.line({{nan, 0.0}, {1.0, 0.0}}, {});
  EXPECT_TRUE(sameBytes(before, chart.picture()));
  chart.line({{-1e12, 0.0}, {1e12, 0.0}}, {});
  EXPECT_FALSE(sameBytes(before, chart.picture()));
}

TEST(ChartTest, AcceptsEmptyRanges) {
  ChartFrame frame = someFrame();
  frame.x = frame.y = {3.0, 3.0};
  EXPECT_EQ(cv::Size(1200, 760), Chart(frame).picture().size());
  EXPECT_EQ(0.0, rangeOf({}, 0).min);
  EXPECT_EQ(1.0, rangeOf({}, 0).max);
}

TEST(ChartTest, RampRunsFromBlueToRedAndIsClamped) {
  EXPECT_GT(rampColour(0.0).blue, rampColour(0.0).red);
  EXPECT_GT(rampColour(1.0).red, rampColour(1.0).blue);
  EXPECT_EQ(rampColour(1.0).red, rampColour(7.0).red);
  EXPECT_EQ(rampColour(0.0).blue, rampColour(-7.0).blue);
}

TEST(ChartTest, LegendIsInTheEmptiestCorner) {
  Chart chart(someFrame());
  for (const auto& corner : {Eigen::Vector2d(9.0, 0.9), {1.0, 0.9}, {9.0, -0.9}}) {
    chart.dot(corner, {}, 30.0);
  }
  const cv::Mat before = chart.picture();
  chart.legend("line", categoryColour(1), LineStyle::kDotted);
  const cv::Mat after = chart.picture();
  const cv::Rect lower_left(84, 760 / 2, 1200 / 2, 760 / 2);
  EXPECT_GT(changed(before(lower_left), after(lower_left)), 0.0);
  EXPECT_EQ(
      changed(before, after) * static_cast<double>(before.total()),
      changed(before(lower_left), after(lower_left)) * static_cast<double>(lower_left.area()));
}

TEST(RangeTest, ExtendsToFiniteValuesOnly) {
  Range range{2.0, 3.0};
  range.include(std::numeric_limits<double>::infinity());
  range.include(std::numeric_limits<double>::quiet_NaN());
  EXPECT_DOUBLE_EQ(range.size(), 1.0);
  range.include(-1.0);
  range.include(2.5);
  EXPECT_DOUBLE_EQ(range.min, -1.0);
  EXPECT_DOUBLE_EQ(range.max, 3.0);
}

TEST(RangeTest, OfPointsIsThatOfOneCoordinate) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector2d> points = {{nan, 0.0}, {4.0, -7.0}, {-2.0, 9.0}};
  EXPECT_DOUBLE_EQ(rangeOf(points, 0).min, -2.0);
  EXPECT_DOUBLE_EQ(rangeOf(points, 0).max, 4.0);
  EXPECT_DOUBLE_EQ(rangeOf(points, 1).min, -7.0);
  EXPECT_DOUBLE_EQ(rangeOf(points, 1).max, 9.0);
}

TEST(ChartTest, LineConnectsItsPointsWithTheGivenWidth) {
  const auto mask = changedBy(someFrame(), [](Chart& chart) {
    chart.line({{2.0, 0.5}, {7.0, 0.5}}, {255, 0, 0}, 4.0);
  });
  const cv::Rect bounds = boundsOf(mask);
  // Ends are round, and antialiasing adds a pixel on each side.
  EXPECT_NEAR(bounds.x, kAxes.x + 0.2 * kAxes.width - 2.0, 2.0);
  EXPECT_NEAR(bounds.br().x, kAxes.x + 0.7 * kAxes.width + 2.0, 2.0);
  EXPECT_NEAR(bounds.height, 4.0 + 2.0, 1.0);
}

TEST(ChartTest, NonFinitePointInterruptsALine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto mask = changedBy(someFrame(), [nan](Chart& chart) {
    chart.line({{1.0, 0.0}, {4.0, 0.0}, {5.0, nan}, {6.0, 0.0}, {9.0, 0.0}}, {255, 0, 0});
  });
  const auto columnsOf = [&mask](double from, double to) {
    return cv::countNonZero(mask.colRange(kAxes.x + static_cast<int>(0.1 * from * kAxes.width),
                                          kAxes.x + static_cast<int>(0.1 * to * kAxes.width)));
  };
  EXPECT_GT(columnsOf(1.5, 3.5), 0);
  EXPECT_EQ(columnsOf(4.2, 5.8), 0);
  EXPECT_GT(columnsOf(6.5, 8.5), 0);
}

TEST(ChartTest, StylesDifferInTheInkOfALine) {
  const auto inkOf = [](LineStyle style) {
    return cv::countNonZero(changedBy(someFrame(), [style](Chart& chart) {
      chart.line({{1.0, 0.0}, {9.0, 0.0}}, {255, 0, 0}, 2.0, style);
    }));
  };
  const int solid = inkOf(LineStyle::kSolid);
  const int dashed = inkOf(LineStyle::kDashed);
  EXPECT_LT(dashed, 0.85 * solid);
  EXPECT_LT(inkOf(LineStyle::kDotted), dashed);
  EXPECT_GT(inkOf(LineStyle::kDotted), 0.1 * solid);
}

TEST(ChartTest, RingHasAWhiteCentre) {
  Chart chart(someFrame());
  chart.ring({5.0, 0.02}, {200, 0, 0}, 12.0);
  const cv::Mat picture = chart.picture();
  const cv::Point centre(kAxes.x + kAxes.width / 2,
                         kAxes.y + static_cast<int>((0.5 - 0.01 / 1.08) * kAxes.height));
  EXPECT_EQ(picture.at<cv::Vec3b>(centre), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(centre + cv::Point(9, 0)), cv::Vec3b(0, 0, 200));
}

TEST(ChartTest, BarReachesFromZeroToItsValue) {
  const auto mask = changedBy(someFrame(), [](Chart& chart) {
    chart.bar(2.0, 4.0, 0.5, {0, 90, 0});
  });
  const cv::Rect bounds = boundsOf(mask);
  const double unit = kAxes.height / 2.16;  // the range of 2 is widened by 4 % at both ends
  EXPECT_NEAR(bounds.x, kAxes.x + 0.2 * kAxes.width, 3.0);
  EXPECT_NEAR(bounds.width, 0.2 * kAxes.width, 4.0);
  EXPECT_NEAR(bounds.height, 0.5 * unit, 4.0);
  EXPECT_NEAR(bounds.br().y, kAxes.y + 0.5 * kAxes.height, 3.0);
}

TEST(ChartTest, TextIsRightOfItsPoint) {
  const auto mask = changedBy(someFrame(), [](Chart& chart) {
    chart.text({5.0, 0.0}, "keyframe");
  });
  const cv::Rect bounds = boundsOf(mask);
  EXPECT_GT(bounds.x, kAxes.x + kAxes.width / 2);
  EXPECT_GT(bounds.width, 2 * bounds.height);
}

TEST(ChartTest, SameScaleDrawsACircleRound) {
  ChartFrame frame = someFrame();
  frame.same_scale = true;
  std::vector<Eigen::Vector2d> circle;
  for (int i = 0; i <= 60; ++i) {
    circle.emplace_back(5.0 + std::cos(i * M_PI / 30.0), std::sin(i * M_PI / 30.0));
  }
  const auto draw = [&circle](Chart& chart) { chart.line(circle, {255, 0, 0}, 1.0); };
  const cv::Rect round = boundsOf(changedBy(frame, draw));
  EXPECT_NEAR(round.width, round.height, 2.0);
  const cv::Rect stretched = boundsOf(changedBy(someFrame(), draw));
  EXPECT_GT(std::abs(stretched.width - stretched.height), 50);
}

TEST(ChartTest, CategoryNamesReplaceTheNumbersOfTheXAxis) {
  ChartFrame frame = someFrame();
  const cv::Mat numbered = Chart(frame).picture();
  frame.x_names = {"car", "van"};
  frame.x = {0.0, 2.0};
  const cv::Mat named = Chart(frame).picture();
  const cv::Rect below(0, kAxes.br().y + 4, 1200, 26);
  EXPECT_GT(changed(numbered(below).clone(), named(below).clone()), 0.0);
  frame.x_names = {"car", "bus"};
  const auto difference = boundsOf(differenceOf(named, Chart(frame).picture()));
  EXPECT_GT(difference.x, kAxes.x + kAxes.width / 2) << "only the second name differs";
}

TEST(ChartTest, RampShowsItsColoursRightOfTheAxes) {
  ChartFrame frame = someFrame();
  frame.right_px = kRampWidth_px;
  Chart chart(frame);
  chart.ramp("error [m]", 0.4);
  const cv::Mat picture = chart.picture();
  const int column = 1200 - kRampWidth_px + 24 + 8;
  const auto expectColour = [&](int row, Colour colour) {
    const cv::Vec3b pixel = picture.at<cv::Vec3b>(row, column);
    EXPECT_NEAR(pixel[0], colour.blue, 3);
    EXPECT_NEAR(pixel[1], colour.green, 3);
    EXPECT_NEAR(pixel[2], colour.red, 3);
  };
  expectColour(kAxes.y + 2, rampColour(1.0));
  expectColour(kAxes.y + kAxes.height / 2, rampColour(0.5));
  expectColour(kAxes.br().y - 3, rampColour(0.0));
}

TEST(ChartTest, LegendBesideTheAxesCoversNothing) {
  ChartFrame frame = someFrame();
  frame.right_px = kLegendWidth_px;
  frame.legend_beside = true;
  const auto mask =
      changedBy(frame, [](Chart& chart) { chart.legend("landmarks", categoryColour(0)); });
  EXPECT_GT(cv::countNonZero(mask), 0);
  EXPECT_GT(boundsOf(mask).x, 1200 - kLegendWidth_px);
  EXPECT_LE(boundsOf(mask).br().x, 1200);
}

TEST(StackedTest, ConcatenatesInOrder) {
  const cv::Mat red(3, 4, CV_8UC3, cv::Scalar(0, 0, 255)),
      blue(2, 4, CV_8UC3, cv::Scalar(255, 0, 0));
  const cv::Mat both = stacked({red, blue});
  ASSERT_EQ(both.size(), cv::Size(4, 5));
  EXPECT_TRUE(sameBytes(both.rowRange(0, 3).clone(), red));
  EXPECT_TRUE(sameBytes(both.rowRange(3, 5).clone(), blue));
}

TEST(BarPlotTest, DrawsBarsByGroupAndLeavesGaps) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const BarChart plot{"Bars", "value [m]", {"one", "two"}, {{"a", {1.0, 2.0}}, {"b", {3.0, gap}}}};
  const cv::Mat whole = drawBars(plot);
  auto without = plot;
  without.series[0].values[1] = gap;  // the only bar of the right half
  const cv::Mat left_only = drawBars(without);
  ASSERT_EQ(whole.size(), left_only.size());
  const int right = 1200 - kLegendWidth_px;
  const int middle = (84 + right) / 2;
  const cv::Range all_rows(0, whole.rows);
  EXPECT_EQ(0.0, changed(whole(all_rows, {84, middle}).clone(),
                         left_only(all_rows, {84, middle}).clone()));
  EXPECT_GT(changed(whole(all_rows, {middle, right}).clone(),
                    left_only(all_rows, {middle, right}).clone()),
            0.1);
}

TEST(BarPlotTest, LegendCoversNoBar) {
  const std::vector<double> high(4, 1.0);
  BarChart plot{"Bars", "value [m]", {"a", "b", "c", "d"}, {}};
  plot.series.push_back({"constant_velocity", high});
  const cv::Mat picture = drawBars(plot);
  const auto colour = categoryColour(0);
  cv::Mat bars;
  cv::inRange(picture(cv::Rect(84, 0, 1200 - kLegendWidth_px - 84, picture.rows)),
              cv::Scalar(colour.blue, colour.green, colour.red),
              cv::Scalar(colour.blue, colour.green, colour.red), bars);
  const int of_each = bars.cols / 4;
  for (int group = 1; group < 4; ++group) {
    EXPECT_NEAR(cv::countNonZero(bars.colRange(0, of_each)),
                cv::countNonZero(bars.colRange(group * of_each, (group + 1) * of_each)),
                0.05 * cv::countNonZero(bars) / 4)
        << group;
  }
}

TEST(BarPlotTest, DrawsAnEmptyChart) { EXPECT_FALSE(drawBars({"Empty", "value", {}, {}}).empty()); }

}  // namespace
}  // namespace headway::plot
