// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "sections.h"

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Stamped<Pose> at(Time time, double x, double y) {
  return {time, Pose(Eigen::Translation3d(x, y, 0.0))};
}

ReplayFolder straightReplay() {
  ReplayFolder folder;
  for (int i = 0; i < 50; ++i) folder.trajectory.push_back(at(100.0 + 0.1 * i, 1.0 * i, 0.0));
  return folder;
}

TEST(MapPlotTest, DrawsTheGridInPlace) {
  headway::test::TemporaryFolder folder;
  cv::Mat grid(20, 40, CV_8U, cv::Scalar(205));
  ASSERT_TRUE(cv::imwrite((folder / "map_grid.png").string(), grid));
  ReplayFolder replay = straightReplay();
  GridFile file{(folder / "map_grid.png").string(), 0.5, {0.0, -5.0}};
  replay.grid = file;
  const std::string svg = mapPlot(replay, {});
  EXPECT_THAT(svg, HasSubstr("width=\"40\" height=\"20\" transform=\"matrix("));
  EXPECT_THAT(svg, HasSubstr("data:image/png;base64,"));
  EXPECT_LT(svg.find("class=\"grid\""), svg.find("class=\"robot\"")) << "below the path";
}

TEST(MapPlotTest, DrawsPathLandmarksTracksAndScaleBar) {
  ReplayFolder folder = straightReplay();
  folder.landmarks = {{{10.f, 3.f, 1.f}, {}}, {{1e5f, 0.f, 0.f}, {}}};
  folder.tracks = {{4, ObjectClass::kCar, {{100, 5, 2, true, true}, {101, 9, 2, true, true}}},
                   {5, ObjectClass::kTruck, {{100, 5, -4, true, false}}}};
  const std::string svg = mapPlot(folder, {});
  EXPECT_THAT(svg, HasSubstr("class=\"robot\""));
  EXPECT_THAT(svg, HasSubstr("<title>Car 4</title>"));
  EXPECT_THAT(svg, HasSubstr("<circle r=\"4\""));
  EXPECT_THAT(svg, HasSubstr("<title>Truck 5</title>"));
  EXPECT_THAT(svg, HasSubstr(" m</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("class=\"truth\"")));
  const auto dots = svg.substr(svg.find("class=\"dots\""));
  EXPECT_EQ(std::count(dots.begin(), dots.begin() + long(dots.find("/>")), 'M'), 1)
      << "the landmark far outside is omitted";
}

TEST(MapPlotTest, IsEmptyWithoutATrajectory) { EXPECT_EQ(mapPlot(ReplayFolder(), {}), ""); }

TEST(MapPlotTest, ContainsOnlyFiniteNumbersForAStaticRobot) {
  ReplayFolder folder;
  folder.trajectory = {at(1.0, 5.0, 5.0)};
  const std::string svg = mapPlot(folder, {});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("–")));
}

TEST(MapPlotTest, DrawsTheTruthDashed) {
  TruthLayer truth;
  truth.trajectory = straightReplay().trajectory;
  truth.objects = {{1, ObjectClass::kCar, {{100, 5, 2, true, true}, {101, 9, 2, true, true}}},
                   {2, ObjectClass::kCar, {{100, 7, 2, true, false}}}};
  const std::string svg = mapPlot(straightReplay(), truth);
  EXPECT_THAT(svg, HasSubstr("class=\"truth\""));
  const auto first = svg.find("class=\"truthtrack\"");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(svg.find("class=\"truthtrack\"", first + 1), std::string::npos)
      << "static objects have no path";
}

TEST(MapPlotTest, TurnsAnAreaThatIsHigherThanWide) {
  ReplayFolder folder;
  for (int i = 0; i < 50; ++i) folder.trajectory.push_back(at(0.1 * i, 0.0, 4.0 * i));
  const std::string svg = mapPlot(folder, {});
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 1000 420\"")) << "wide after turning";
}

TEST(MapPlotTest, IsNotExtendedByFarTracks) {
  ReplayFolder folder = straightReplay();
  const auto height = [&] {
    const std::string svg = mapPlot(folder, {});
    return svg.substr(0, svg.find("role"));
  };
  const auto without = height();
  folder.tracks = {{4, ObjectClass::kCar, {{100, 5, 900, true, true}}}};
  EXPECT_EQ(height(), without);
}

TEST(AlignToEstimateTest, MovesTheTruthToTheEstimatedPositionAndHeading) {
  const ReplayFolder folder = straightReplay();
  TruthLayer truth;
  for (int i = -10; i < 50; ++i) truth.trajectory.push_back(at(100.0 + 0.1 * i, 7.0, 20.0 + i));
  truth.objects = {{1, ObjectClass::kCar, {{101.0, 5.0, 30.0, true, true}}}};
  alignToEstimate(folder.trajectory, "truth.tum", truth);
  EXPECT_NEAR(truth.trajectory[10].value.translation().x(), 0.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[10].value.translation().y(), 0.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[30].value.translation().x(), 20.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[30].value.translation().y(), 0.0, 1e-9);
  EXPECT_NEAR(truth.objects[0].points[0].x, 10.0, 1e-9);
  EXPECT_NEAR(truth.objects[0].points[0].y, 2.0, 1e-9);
}

TEST(AlignToEstimateTest, RefusesATruthWithOtherTimes) {
  TruthLayer truth;
  truth.trajectory = {at(5.0, 0.0, 0.0)};
  EXPECT_THROW(alignToEstimate(straightReplay().trajectory, "truth.tum", truth), InputError);
}

}  // namespace
}  // namespace headway::report
