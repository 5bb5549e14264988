// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/report/report.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class ReportTest : public ::testing::Test {
 protected:
  ReportTest() {
    summary = {{"frames", 20},
               {"frames_tracked", 18},
               {"frames_lost", 2},
               {"lost_frames", {7, 8}},
               {"keyframes", 5},
               {"landmarks", 12345},
               {"loops", 1},
               {"frame_ms_median", 12.34},
               {"stages_ms", {{"slam_track", {{"median", 8.0}, {"p95", 11.0}}}}},
               {"detections_used", 33},
               {"detections_dropped", {{"nan_box", 2}, {"strange_reason", 1}}},
               {"observations_skipped", {{"CObservation2DRangeScan", 40}}},
               {"calibration", {{"baseline_m", 0.5}, {"vertical_disparity_px", 3.5}}},
               {"version", "9.8.7"},
               {"ended_early", nullptr}};
    record = {{"input", {{"rawlog", "/data/<street> & co.rawlog"}}},
              {"configuration", {{"slam", {{"mapping", "true"}}}}}};
  }

  void writeFolder() const {
    std::ofstream(folder / "summary.json") << summary;
    std::ofstream(folder / "replay.json") << record;
    std::ofstream trajectory(folder / "trajectory.tum");
    std::ofstream tracks(folder / "tracks.csv");
    tracks
        << "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,"
           "var_y,cov_xy\n";
    for (int i = 0; i < 20; ++i) {
      trajectory << 10.0 + 0.1 * i << ' ' << i << " 0 0 0 0 0 1\n";
      tracks << i << ',' << 10.0 + 0.1 * i << ",4,Tram,confirmed,1," << 2 * i
             << ",3,1,0,9,2.5,3,20,0,0,0.1,0.1,0\n";
    }
    std::filesystem::create_directories(folder / "snapshots");
    for (const char* name : {"000000.png", "000009.png", "000019.png"}) {
      cv::imwrite((folder / "snapshots") / name, cv::Mat(40, 60, CV_8UC3, cv::Scalar(9, 9, 9)));
    }
  }

  [[nodiscard]] std::string page(const ReportOptions& options = {}) const {
    writeFolder();
    return test::contentsOf(writeReport(folder.path(), options));
  }

  test::TemporaryFolder folder;
  Json summary;
  Json record;
};

TEST_F(ReportTest, ShowsAllPartsOfAFinishedReplay) {
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("&lt;street&gt; &amp; co.rawlog"));
  EXPECT_THAT(html, HasSubstr("18<i> of 20</i>"));
  EXPECT_THAT(html, HasSubstr("12\u202f345<i> landmarks</i>"));
  EXPECT_THAT(html, HasSubstr("19.0<i> m</i>"));
  EXPECT_THAT(html, HasSubstr("12.3<i> ms</i>"));
  EXPECT_THAT(html, HasSubstr("Camera lost in 2 frames: 7, 8"));
  EXPECT_THAT(html, HasSubstr("<svg class=\"map\""));
  EXPECT_THAT(html, HasSubstr("frame 9</figcaption>"));
  EXPECT_THAT(html, HasSubstr("frame 0</figcaption>"));
  EXPECT_THAT(html, HasSubstr("Tram 4"));
  EXPECT_THAT(html, HasSubstr("8.0 / 11.0 ms"));
  EXPECT_THAT(html, HasSubstr("bad: check the calibration"));
  EXPECT_THAT(html, HasSubstr("box with values that are not finite"));
  EXPECT_THAT(html, HasSubstr("strange_reason"));
  EXPECT_THAT(html, HasSubstr("CObservation2DRangeScan"));
  EXPECT_THAT(html, HasSubstr("[slam] 1 parameter<"));
  EXPECT_THAT(html, HasSubstr("headway 9.8.7"));
}

TEST_F(ReportTest, IsSelfContained) {
  const std::string html = page();
  for (const char* reference : {"http:", "https:", "<script", "<link", "url(", "@import"}) {
    EXPECT_THAT(html, Not(HasSubstr(reference)));
  }
  EXPECT_THAT(html, HasSubstr("src=\"data:image/jpeg;base64,"));
}

TEST_F(ReportTest, IsDeterministic) { EXPECT_EQ(page(), page()); }

TEST_F(ReportTest, ClosesEveryTag) {
  const std::string html = page();
  for (const std::string tag : {"section", "div", "table", "tr", "svg", "figure", "p", "b",
                                "details", "main", "body", "html"}) {
    const auto count = [&](const std::string& start) {
      std::size_t n = 0;
      for (auto at = html.find(start); at != std::string::npos; at = html.find(start, at + 1)) {
        const char after = html[at + start.size()];
        if (after == '>' || after == ' ') ++n;
      }
      return n;
    };
    EXPECT_EQ(count("<" + tag), count("</" + tag)) << tag;
  }
}

TEST_F(ReportTest, StatesWhyAReplayEndedEarly) {
  summary["ended_early"] = "broken at byte 17 <of> it";
  EXPECT_THAT(page(), HasSubstr("The replay ended early: broken at byte 17 &lt;of&gt; it"));
}

TEST_F(ReportTest, OmitsSectionsWithoutData) {
  std::ofstream(folder / "summary.json") << Json{{"frames", 3}};
  const std::string html = test::contentsOf(writeReport(folder.path()));
  EXPECT_THAT(html, HasSubstr("0<i> of 3</i>"));
  for (const char* id : {"map", "snapshots", "timings", "calibration", "errors", "configuration"}) {
    EXPECT_THAT(html, Not(HasSubstr("id=\"" + std::string(id) + "\"")));
  }
}

TEST_F(ReportTest, LimitsTheNumberOfPictures) {
  ReportOptions options;
  options.max_pictures = 2;
  const std::string html = page(options);
  EXPECT_THAT(html, HasSubstr("frame 0</figcaption>"));
  EXPECT_THAT(html, HasSubstr("frame 19</figcaption>"));
  EXPECT_THAT(html, Not(HasSubstr("frame 9</figcaption>")));
}

TEST_F(ReportTest, ShowsTruthAndErrors) {
  const auto truth = folder / "truth";
  std::filesystem::create_directories(truth);
  std::ofstream trajectory(truth / "trajectory.tum");
  for (int i = 0; i < 20; ++i) trajectory << 10.0 + 0.1 * i << ' ' << i << " 0.1 0 0 0 0 1\n";
  trajectory.close();
  ReportOptions options;
  options.truth = truth;
  options.errors = {{"ATE RMSE", "0.043 m"}};
  const std::string html = page(options);
  EXPECT_THAT(html, HasSubstr("class=\"truth\""));
  EXPECT_THAT(html, HasSubstr("ATE RMSE"));
  EXPECT_THAT(html, HasSubstr("0.043 m"));
}

TEST_F(ReportTest, WritesToTheGivenFileOrFails) {
  writeFolder();
  ReportOptions options;
  options.output = folder / "elsewhere.html";
  EXPECT_EQ(writeReport(folder.path(), options), folder / "elsewhere.html");
  EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
  options.output = "/nonexistent/report.html";
  EXPECT_THROW(writeReport(folder.path(), options), InputError);
}

TEST_F(ReportTest, RefusesIncompleteAndMalformedFolders) {
  EXPECT_THROW(writeReport(folder.path()), InputError);
  EXPECT_THROW(writeReport(folder / "none"), InputError);
  std::ofstream(folder / "summary.json") << "{ broken";
  EXPECT_THROW(writeReport(folder.path()), InputError);
  writeFolder();
  std::ofstream(folder / "tracks.csv", std::ios::app) << "1,2,3\n";
  EXPECT_THROW(writeReport(folder.path()), InputError);
  ReportOptions options;
  options.truth = folder / "none";
  EXPECT_THROW(writeReport(folder.path(), options), InputError);
}

TEST_F(ReportTest, EntriesThatNoReplayWritesAreAnError) {
  const Json good = summary;
  const std::vector<std::pair<std::string, Json>> entries = {
      {"warnings", {{"speed", 3}}},
      {"stages_ms", {{"detect", "slow"}}},
      {"calibration", {{"matches", {1}}, {"rectified_here", 7}}}};
  for (const auto& [key, value] : entries) {
    summary = good;
    summary[key] = value;
    EXPECT_THROW((void)page(), InputError) << key;
  }
}

TEST_F(ReportTest, CountsThatNoMachineReachesAreLimited) {
  summary["landmarks"] = 1e300;
  summary["observations_skipped"] = {{"many", 1e300}, {"negative", -3}};
  EXPECT_THAT(page(), HasSubstr("1\u202f000\u202f000\u202f000\u202f000\u202f000<i> landmarks"));
}

TEST_F(ReportTest, PosesWhoseTimesGoBackHaveNoSpeed) {
  std::ofstream(folder / "summary.json") << summary;
  std::ofstream(folder / "trajectory.tum") << "5 0 0 0 0 0 0 1\n0.2 1e60 0 0 0 0 0 1\n";
  EXPECT_THAT(test::contentsOf(writeReport(folder.path())), HasSubstr("<b>max. 0.0\u202fm/s</b>"));
}

}  // namespace
}  // namespace headway::report
