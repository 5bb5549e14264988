// SPDX-License-Identifier: BSD-3-Clause
#include "sections.h"

#include <gmock/gmock.h>
#include <headway_test/folders.h>

#include <opencv2/imgcodecs.hpp>

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using OrderedJson = nlohmann::ordered_json;

TEST(TitleBlockTest, NamesRawlogAndDetectionsEscaped) {
  ReplayFolder folder;
  folder.record = {{"input", {{"rawlog", "/data/a<b>.rawlog"}, {"detections", "boxes & co.csv"}}}};
  const std::string html = titleBlock(folder);
  EXPECT_THAT(html, HasSubstr("<h1>a&lt;b&gt;.rawlog</h1>"));
  EXPECT_THAT(html, HasSubstr("detections: boxes &amp; co.csv"));
  EXPECT_THAT(html, Not(HasSubstr("warning")));
}

TEST(TitleBlockTest, SaysWhatTheRigCanSee) {
  ReplayFolder folder;
  folder.summary["rig"] = {{"text", "rig: baseline 0.12 m; people's motion to 6.5 m"}};
  EXPECT_THAT(titleBlock(folder), HasSubstr("rig: baseline 0.12 m; people's motion to 6.5 m"));
}

TEST(CalibrationSectionTest, SaysHowWellTheImagesAreRectified) {
  ReplayFolder folder;
  folder.summary["rectification"] = "rectification off by 0.31 +- 0.02 px";
  folder.summary["calibration"] = {{"vertical_disparity_px", 0.1}};
  EXPECT_THAT(titleBlock(folder), Not(HasSubstr("rectification")));
  EXPECT_THAT(calibrationSection(folder), HasSubstr("rectification off by 0.31 +- 0.02 px"));
}

TEST(TitleBlockTest, OneIsNotSeveral) {
  ReplayFolder folder;
  folder.summary["frames_lost"] = 1;
  folder.summary["lost_frames"] = {7};
  folder.summary["warnings"] = {{"gap", {{"count", 1}, {"first_frame", 3}, {"text", "a gap"}}}};
  const std::string html = titleBlock(folder);
  EXPECT_THAT(html, HasSubstr("Camera lost in 1 frame: 7<"));
  EXPECT_THAT(html, HasSubstr("From frame 3, 1 time: a gap"));
}

TEST(TitleBlockTest, UsesTheFolderNameWithoutARecord) {
  ReplayFolder folder;
  folder.path = "/results/run7";
  EXPECT_THAT(titleBlock(folder), HasSubstr("<h1>run7</h1>"));
}

TEST(TitleBlockTest, AbbreviatesALongListOfLostFrames) {
  ReplayFolder folder;
  folder.summary["frames_lost"] = 500;
  for (int i = 0; i < 500; ++i) folder.summary["lost_frames"].push_back(1000 + i);
  const std::string html = titleBlock(folder);
  EXPECT_THAT(html, HasSubstr("500 frames: 1000, 1001"));
  EXPECT_THAT(html, HasSubstr("…"));
  EXPECT_LT(html.size(), 400u);
}

TEST(TitleBlockTest, NamesUnreliableFrames) {
  ReplayFolder folder;
  folder.summary["frames_unreliable"] = 2;
  folder.summary["unreliable_frames"] = {7, 8};
  EXPECT_THAT(titleBlock(folder), HasSubstr("pose unreliable in 2 frames: 7, 8<"));
}

TEST(TitleBlockTest, ShowsTheImageInWhichTheCameraWasLost) {
  const test::TemporaryFolder results;
  ReplayFolder folder;
  folder.path = results.path();
  folder.summary["frames_lost"] = 3;
  EXPECT_THAT(titleBlock(folder), Not(HasSubstr("<img")));
  cv::imwrite(results / "lost.jpg", cv::Mat(40, 60, CV_8U, cv::Scalar(3)));
  EXPECT_THAT(titleBlock(folder),
              HasSubstr("<img alt=\"The first image in which the camera was lost\""));
  EXPECT_THAT(titleBlock(folder), HasSubstr("src=\"data:image/jpeg;base64,"));
}

TEST(SummaryTilesTest, ShowsMissingFiguresAsDashes) {
  const std::string html = summaryTiles(ReplayFolder());
  EXPECT_THAT(html, HasSubstr("0<i> of 0</i>"));
  EXPECT_THAT(html, HasSubstr("–<i> ms</i>"));
}

TEST(SummaryTilesTest, SaysWhatEachCountIs) {
  ReplayFolder folder;
  folder.summary = {{"loops", 1}, {"landmarks", 1}, {"keyframes", 1}, {"tracks_confirmed", 1}};
  const std::string one = summaryTiles(folder);
  for (const char* text :
       {"1 loop closed", "1<i> landmark</i>", "1 keyframe<", "of 1 confirmed track<"}) {
    EXPECT_THAT(one, HasSubstr(text));
  }
  folder.summary = {{"loops", 2}, {"landmarks", 3}, {"keyframes", 0}, {"tracks_confirmed", 5}};
  const std::string several = summaryTiles(folder);
  for (const char* text :
       {"2 loops closed", "3<i> landmarks</i>", "0 keyframes<", "of 5 confirmed tracks<"}) {
    EXPECT_THAT(several, HasSubstr(text));
  }
}

TEST(ErrorsSectionTest, IsEmptyWithoutErrors) {
  EXPECT_EQ(errorsSection({}), "");
  const std::string html = errorsSection({{"ATE < RMSE", "0.1 m", "of the path"}});
  EXPECT_THAT(html, HasSubstr("<td>of the path</td>"));
  EXPECT_THAT(html, HasSubstr("ATE &lt; RMSE"));
  EXPECT_THAT(html, HasSubstr("0.1 m"));
}

TEST(SnapshotsSectionTest, IsEmptyWithoutPicturesOrWithALimitOfZero) {
  EXPECT_EQ(snapshotsSection(ReplayFolder(), 8), "");
  ReplayFolder folder;
  folder.snapshots = {"000001.png"};
  EXPECT_EQ(snapshotsSection(folder, 0), "");
}

TEST(CalibrationSectionTest, AssessesTheVerticalDisparity) {
  ReplayFolder folder;
  const auto with = [&](double vertical_disparity_px) {
    folder.summary["calibration"] = {{"vertical_disparity_px", vertical_disparity_px}};
    return calibrationSection(folder);
  };
  EXPECT_THAT(with(0.1), HasSubstr("good:"));
  EXPECT_THAT(with(1.0), HasSubstr("usable:"));
  EXPECT_THAT(with(2.0), HasSubstr("bad:"));
  folder.summary["calibration"] = nullptr;
  EXPECT_EQ(calibrationSection(folder), "");
}

TEST(DroppedSectionTest, ExplainsKnownReasonsAndShowsUnknownOnes) {
  ReplayFolder folder;
  folder.summary["detections_dropped"] = {{"too_far", 12}, {"<odd>", 1}, {"not a number", "x"}};
  const std::string html = droppedSection(folder);
  EXPECT_THAT(html, HasSubstr("<th>too_far</th><td>12</td><td>box beyond the maximum range</td>"));
  EXPECT_THAT(html, HasSubstr("<th>&lt;odd&gt;</th><td>1</td><td></td>"));
  EXPECT_THAT(html, Not(HasSubstr("not a number")));
  EXPECT_THAT(html, HasSubstr("<h3>Observations</h3><p>None.</p>"));
}

TEST(ConfigurationSectionTest, ListsParametersBySection) {
  ReplayFolder folder;
  EXPECT_EQ(configurationSection(folder), "");
  folder.record = {
      {"configuration",
       {{"slam", {{"mapping", "true"}, {"levels", 5}}}, {"ignored", "not an object"}}}};
  const std::string html = configurationSection(folder);
  EXPECT_THAT(html, HasSubstr("[slam] 2 parameters"));
  EXPECT_THAT(html, HasSubstr("<th>levels</th><td>5</td>"));
  EXPECT_THAT(html, Not(HasSubstr("ignored")));
}

TEST(ClassLegendTest, ListsEachClassOnceAndTheTruthIfShown) {
  ReplayFolder folder;
  folder.tracks = {{1, ObjectClass::kCar, {{}}}, {2, ObjectClass::kCar, {{}}}};
  const std::string html = classLegend(folder, false);
  EXPECT_EQ(html.find(">Car<", html.find("Car<") + 1), std::string::npos);
  EXPECT_THAT(html, HasSubstr("robot"));
  EXPECT_THAT(html, Not(HasSubstr("truth")));
  EXPECT_THAT(classLegend(folder, true), HasSubstr("truth"));
}

TEST(TimingBarsTest, ScaleToTheSlowestStage) {
  ReplayFolder folder;
  folder.summary["stages_ms"] = {{"a", {{"median", 5.0}, {"p95", 10.0}}},
                                 {"b", {{"median", 1.0}, {"p95", 2.0}}}};
  const std::string html = timingBars(folder);
  EXPECT_THAT(html, HasSubstr("width=\"1000.0\""));
  EXPECT_THAT(html, HasSubstr("width=\"100.0\""));
  EXPECT_THAT(html, HasSubstr("5.0 / 10.0 ms"));
}

}  // namespace
}  // namespace headway::report
