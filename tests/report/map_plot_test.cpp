#include "map_plot.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>

#include <cmath>

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ReplayFolder straightReplay() {
  ReplayFolder folder;
  for (int i = 0; i < 50; ++i) folder.trajectory.push_back({100.0 + 0.1 * i, 1.0 * i, 0.0});
  return folder;
}

TEST(MapPlotTest, ShowsThePathTheMapTracksAndAScale) {
  ReplayFolder folder = straightReplay();
  folder.landmarks = {{10.f, 3.f, 1.f}, {1e5f, 0.f, 0.f}};
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
      << "the landmark far outside is left out";
}

TEST(MapPlotTest, IsNothingWithoutATrajectory) { EXPECT_EQ(mapPlot(ReplayFolder(), {}), ""); }

TEST(MapPlotTest, HoldsOnlyFiniteNumbersForARobotThatStands) {
  ReplayFolder folder;
  folder.trajectory = {{1.0, 5.0, 5.0}};
  const std::string svg = mapPlot(folder, {});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("–")));
}

TEST(LayOntoTest, MovesTheTruthToTheEstimatesFirstPlaceAndHeading) {
  const ReplayFolder folder = straightReplay();
  TruthLayer truth;
  for (int i = -10; i < 50; ++i) truth.trajectory.push_back({100.0 + 0.1 * i, 7.0, 20.0 + i});
  truth.objects = {{1, ObjectClass::kCar, {{101.0, 5.0, 30.0, true, true}}}};
  layOnto(folder.trajectory, "truth.tum", truth);
  EXPECT_NEAR(truth.trajectory[10].x, 0.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[10].y, 0.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[30].x, 20.0, 1e-9);
  EXPECT_NEAR(truth.trajectory[30].y, 0.0, 1e-9);
  EXPECT_NEAR(truth.objects[0].points[0].x, 10.0, 1e-9);
  EXPECT_NEAR(truth.objects[0].points[0].y, 2.0, 1e-9);
}

TEST(LayOntoTest, RefusesATruthOfAnotherTime) {
  TruthLayer truth;
  truth.trajectory = {{5.0, 0.0, 0.0}};
  EXPECT_THROW(layOnto(straightReplay().trajectory, "truth.tum", truth), InputError);
}

}  // namespace
}  // namespace headway::report
