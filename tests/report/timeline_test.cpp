// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "sections.h"

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Stamped<Pose> poseAt(Time time, double x, double y) {
  return {time, Pose(Eigen::Translation3d(x, y, 0.0))};
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Confirmed and moving at 0, 0.1, ... 1.9 s, but coasting from 1.0 s on.
TrackHistory exampleTrack(std::int64_t id, double start = 0.0) {
  TrackHistory track{id, ObjectClass::kCyclist, {}};
  for (int i = 0; i < 20; ++i) track.points.push_back({start + 0.1 * i, 0, 0, i < 10, true});
  return track;
}

TEST(TimelineTest, SplitsABarWhereStatusOrMotionChanges) {
  ReplayFolder folder;
  folder.tracks = {exampleTrack(3)};
  const std::string html = timeline(folder);
  EXPECT_THAT(html, HasSubstr("Cyclist 3"));
  EXPECT_EQ(countOf(html, "<rect"), 2u);
  EXPECT_EQ(countOf(html, "opacity"), 1u);
}

TEST(TimelineTest, LeavesAGapWhereATrackIsMissing) {
  ReplayFolder folder;
  folder.tracks = {exampleTrack(3)};
  folder.tracks[0].points.erase(folder.tracks[0].points.begin() + 3,
                                folder.tracks[0].points.begin() + 8);
  EXPECT_EQ(countOf(timeline(folder), "<rect"), 3u);
}

TEST(TimelineTest, StatesTheNumberOfOmittedTracks) {
  ReplayFolder folder;
  for (int i = 0; i < 75; ++i) folder.tracks.push_back(exampleTrack(i, 0.01 * i));
  const std::string html = timeline(folder);
  EXPECT_EQ(countOf(html, "Cyclist "), 60u);
  EXPECT_THAT(html, HasSubstr("15 shorter tracks"));
}

TEST(TimelineTest, IsEmptyWithoutTracks) {
  EXPECT_EQ(timeline(ReplayFolder()), "");
  EXPECT_EQ(activityPlots(ReplayFolder()), "");
  EXPECT_EQ(timingBars(ReplayFolder()), "");
}

TEST(ActivityPlotsTest, ShowTheHighestSpeedAndNumberOfTracks) {
  ReplayFolder folder;
  for (int i = 0; i < 40; ++i) folder.trajectory.push_back(poseAt(0.1 * i, 0.5 * i, 0.0));
  folder.tracks = {exampleTrack(1), exampleTrack(2)};
  const std::string html = activityPlots(folder);
  EXPECT_THAT(html, HasSubstr("mean over the last second"));
  EXPECT_THAT(html, HasSubstr("max. 5.0\u202fm/s"));
  EXPECT_THAT(html, HasSubstr("max. 2 tracks"));
  folder.tracks.pop_back();
  EXPECT_THAT(activityPlots(folder), HasSubstr("max. 1 track<"));
}

TEST(ActivityPlotsTest, HaveAxesOfRoundValuesFromZeroAndOfTime) {
  ReplayFolder folder;
  for (int i = 0; i < 41; ++i) folder.trajectory.push_back(poseAt(0.1 * i, 0.055 * i, 0.0));
  const std::string html = activityPlots(folder);
  EXPECT_THAT(html, HasSubstr("<span>0.6</span><span>0.4</span><span>0.2</span><span>0.0</span>"));
  EXPECT_THAT(html, HasSubstr("<span>0 s</span><span>2.0 s</span><span>4.0 s</span>"));
}

TEST(TimingBarsTest, ShowEachStageWithItsFigures) {
  ReplayFolder folder;
  folder.summary = nlohmann::ordered_json::parse(
      R"({"stages_ms": {"slam_track": {"median": 10, "p95": 40}, "objects": {"median": 1, "p95": 2}}})");
  const std::string html = timingBars(folder);
  EXPECT_THAT(html, HasSubstr("slam_track"));
  EXPECT_THAT(html, HasSubstr("10.0 / 40.0 ms"));
  EXPECT_THAT(html, HasSubstr("<span>0 ms</span><span>20.0 ms</span><span>40.0 ms</span>"));
  EXPECT_THAT(html, HasSubstr("width=\"1000.0\""));
  EXPECT_THAT(html, HasSubstr("width=\"250.0\""));
}

}  // namespace
}  // namespace headway::report
