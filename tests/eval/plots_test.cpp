#include <gtest/gtest.h>
#include <headway/eval/plots.h>

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
  EXPECT_FALSE(trackPlot(errors).empty());
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
