#include <gmock/gmock.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>

#include <limits>
#include <opencv2/core.hpp>

namespace headway::plot {
namespace {

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.dataend, b.datastart);
}

/// Share of pixels that differ between two pictures.
double changed(const cv::Mat& a, const cv::Mat& b) {
  std::size_t count = 0;
  for (int row = 0; row < a.rows; ++row) {
    for (int col = 0; col < a.cols; ++col) {
      if (a.at<cv::Vec3b>(row, col) != b.at<cv::Vec3b>(row, col)) ++count;
    }
  }
  return static_cast<double>(count) / static_cast<double>(a.total());
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
