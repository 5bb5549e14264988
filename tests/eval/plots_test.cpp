// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/eval/plots.h>
#include <headway/plot/colours.h>

#include <opencv2/core.hpp>

namespace headway::eval {
namespace {

TEST(TrajectoryPlotTest, DrawsMapAndErrorAtStandstill) {
  const std::vector<Pose> still(5, Pose::Identity());
  const auto error = trajectoryError(pairByIndex(still, still), {});
  const cv::Mat plot = trajectoryPlot(error, TopView::kXy, "still");
  EXPECT_EQ(cv::Size(1200, 760 + 340), plot.size());
}

TEST(TrackPlotTest, DrawsErrorsWithoutAnyTrack) {
  TrackErrors errors;
  errors.classes[ObjectClass::kCar];
  EXPECT_FALSE(trackPlot("street", errors).empty());
}

TEST(PredictionPlotTest, TheErrorStartsAtTheFirstHorizon) {
  PredictionError error;
  error.mean_error_m.fill(1.0);
  const cv::Mat plot = errorOverHorizonPlot("street", {{"kalman", error}});
  cv::Mat curve;
  const Colour colour = plot::categoryColour(0);
  const cv::Scalar bgr(colour.blue, colour.green, colour.red);
  cv::inRange(plot, bgr - cv::Scalar::all(12), bgr + cv::Scalar::all(12), curve);
  const cv::Mat lower = curve(cv::Rect(0, plot.rows / 2, plot.cols / 3, plot.rows / 2));
  EXPECT_GT(cv::countNonZero(curve), 100);
  EXPECT_EQ(0, cv::countNonZero(lower)) << "no line comes up from an error of 0";
}

TEST(GridPlotTest, DrawsCellsAboveTheLegend) {
  GridCells truth({0.0, 0.0}, 0.2, 200, 50);
  GridCells estimate = truth;
  truth.states[0] = CellState::kOccupied;
  estimate.states[0] = CellState::kFree;
  const cv::Mat plot = gridPlot(truth, estimate, std::vector<std::uint8_t>(200 * 50, 0));
  ASSERT_EQ(plot.cols, 1600);
  ASSERT_GT(plot.rows, 400);
  EXPECT_EQ(plot.at<cv::Vec3b>(399, 0), cv::Vec3b(220, 120, 20)) << "lower left: false free";
  EXPECT_EQ(plot.at<cv::Vec3b>(0, 1599), cv::Vec3b(176, 176, 176)) << "upper right: unobserved";
}

}  // namespace
}  // namespace headway::eval
