// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/object_class.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "small_replay.h"

namespace headway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

int pixelsLike(const cv::Mat& picture, Colour colour) {
  const cv::Scalar bgr(colour.blue, colour.green, colour.red);
  cv::Mat alike;
  cv::inRange(picture, bgr - cv::Scalar::all(30), bgr + cv::Scalar::all(30), alike);
  return cv::countNonZero(alike);
}

class RenderProgramTest : public ::testing::Test {
 protected:
  RenderProgramTest() {
    test::writeReplayRawlog(rawlog);
    test::writeSmallReplay(replay, rawlog);
  }

  [[nodiscard]] test::ProcessResult render(const std::string& output,
                                           const std::string& options = "",
                                           const std::string& size = "480x270") const {
    return test::runProcess(test::program("headway-render") + " -i " + replay + " -o " +
                            path(output) + " --size " + size + " " + options);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder / name; }
  [[nodiscard]] cv::Mat picture(const std::string& name) const { return cv::imread(path(name)); }

  test::TemporaryFolder folder;
  std::string rawlog = folder / "in.rawlog";
  std::string replay = folder / "replay";
};

constexpr Colour kImageAt7{160, 60, 190};  ///< of the last frame's image

TEST_F(RenderProgramTest, DrawsEachViewOfAFinishedReplay) {
  for (const std::string view : {"follow", "top", "orbit", "camera"}) {
    const auto result = render(view + ".png", "--view " + view);
    ASSERT_EQ(result.status, 0) << result.output;
    EXPECT_EQ(result.output, "");
    const cv::Mat drawn = picture(view + ".png");
    ASSERT_EQ(drawn.size(), cv::Size(480, 270));
    EXPECT_GT(pixelsLike(drawn, colourOf(ObjectClass::kCyclist)), 20) << view;
    EXPECT_GT(pixelsLike(drawn, kPredictionColour), 5) << view;
    EXPECT_GT(pixelsLike(drawn, kImageAt7), 500) << view;
  }
}

TEST_F(RenderProgramTest, ShowsTheRequestedFrame) {
  ASSERT_EQ(render("five.png", "--view camera --frame 5").status, 0);
  EXPECT_GT(pixelsLike(picture("five.png"), {120, 60, 190}), 5000);
  EXPECT_LT(pixelsLike(picture("five.png"), kImageAt7), 5000);
}

TEST_F(RenderProgramTest, RefusesALostFrame) {
  const auto result = render("two.png", "--frame 2");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("--frame 2: is not one of the tracked frames, 0 to 7"));
  EXPECT_FALSE(std::filesystem::exists(path("two.png")));
}

TEST_F(RenderProgramTest, NotesAMissingRawlog) {
  std::filesystem::remove(rawlog);
  const auto result = render("gone.png", "--view camera");
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output,
              HasSubstr("in.rawlog does not exist: drawn without the camera's image"));
  EXPECT_EQ(pixelsLike(picture("gone.png"), kImageAt7), 0);
  EXPECT_GT(pixelsLike(picture("gone.png"), colourOf(ObjectClass::kCyclist)), 20);
}

TEST_F(RenderProgramTest, NotesAMalformedRawlog) {
  std::ofstream(rawlog) << "no rawlog at all";
  const auto result = render("broken.png");
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("drawn without the camera's image"));
}

TEST_F(RenderProgramTest, DrawsWithoutTracksPredictionsAndMap) {
  for (const char* name : {"tracks.csv", "map.headway"}) {
    std::filesystem::remove(std::filesystem::path(replay) / name);
  }
  const auto result = render("bare.png");
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no tracks.csv"));
  EXPECT_THAT(result.output, HasSubstr("no map.headway"));
  EXPECT_EQ(pixelsLike(picture("bare.png"), colourOf(ObjectClass::kCyclist)), 0);
}

TEST_F(RenderProgramTest, PrintsNoNotesWhenQuiet) {
  std::filesystem::remove(rawlog);
  EXPECT_EQ(render("quiet.png", "-q").output, "");
}

TEST_F(RenderProgramTest, DrawsAMapFile) {
  const auto result = test::runProcess(test::program("headway-render") + " -i " + replay +
                                       "/map.headway -o " + path("map.png"));
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_EQ(picture("map.png").size(), cv::Size(1280, 720));
  EXPECT_GT(pixelsLike(picture("map.png"), colourOf(ObjectClass::kCyclist)), 20);
}

TEST_F(RenderProgramTest, DrawsAMapFilesObjectsAtTheTimeOfItsPose) {
  constexpr double kLaterS = 1.5;  // the objects' time after that of the last keyframe
  auto later = test::replayTrack(5);
  later.position += kLaterS * later.velocity;
  auto stored = test::replayMap();
  stored.map.update(test::replayTime(5) + kLaterS, {later});
  map::saveMap(path("later.headway"), stored);
  const auto draw = [&](const std::string& map, const std::string& output) {
    const auto result = test::runProcess(test::program("headway-render") + " -i " + map + " -o " +
                                         path(output) + " --size 480x270");
    EXPECT_EQ(result.status, 0) << result.output;
    return picture(output);
  };
  const cv::Mat same = draw(replay + "/map.headway", "same.png");
  cv::Mat difference;
  cv::absdiff(same, draw(path("later.headway"), "later.png"), difference);
  EXPECT_EQ(0, cv::countNonZero(difference.reshape(1) > 8));
}

TEST_F(RenderProgramTest, WritesTheReplaysPageWithImagesAndKeyframes) {
  const auto result = render("replay.html");
  ASSERT_EQ(result.status, 0) << result.output;
  const std::string page = test::contentsOf(path("replay.html"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy"));
  EXPECT_THAT(page, HasSubstr("\"keyframes\":[[4.0,"));
  EXPECT_THAT(page, HasSubstr("[7,\"/9j/")) << "the JPEG of the last frame";
}

TEST_F(RenderProgramTest, WritesASceneThatMrptReads) {
  const auto result = render("scene.3Dscene", "--frame 3");
  ASSERT_EQ(result.status, 0) << result.output;
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(path("scene.3Dscene")));
  EXPECT_NE(scene.getByName("landmarks"), nullptr);
}

TEST_F(RenderProgramTest, RequiresNoOpenGl) {
  setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
  EXPECT_EQ(render("scene.3Dscene").status, 0);
  const auto result = render("follow.png");
  unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
  EXPECT_EQ(result.status, 0) << result.output;
  EXPECT_GT(pixelsLike(picture("follow.png"), colourOf(ObjectClass::kCyclist)), 20);
}

TEST_F(RenderProgramTest, ShowsTheDenseMapUnlessItIsLeftOut) {
  auto stored = test::replayMap();
  auto dense = mrpt::maps::CColouredPointsMap::Create();
  for (float y = -6.F; y < 6.F; y += 0.1F) {
    for (float z = -1.5F; z < 3.F; z += 0.1F) dense->insertPointRGB(14.F, y, z, 0.9F, 0.1F, 0.1F);
  }
  stored.map.update(dense);
  map::saveMap(replay + "/map.headway", stored);
  const auto redPixels = [&](const std::string& name) {
    cv::Mat alike;
    cv::inRange(picture(name), cv::Scalar(0, 0, 100), cv::Scalar(80, 80, 255), alike);
    return cv::countNonZero(alike);
  };
  ASSERT_EQ(render("with.png").status, 0);
  ASSERT_EQ(render("without.png", "--no-dense").status, 0);
  EXPECT_GT(redPixels("with.png"), redPixels("without.png") + 2000);
  ASSERT_EQ(render("with.3Dscene").status, 0);
  ASSERT_EQ(render("without.3Dscene", "--no-dense").status, 0);
  mrpt::opengl::COpenGLScene with, without;
  ASSERT_TRUE(with.loadFromFile(path("with.3Dscene")));
  ASSERT_TRUE(without.loadFromFile(path("without.3Dscene")));
  EXPECT_NE(with.getByName("dense"), nullptr);
  EXPECT_EQ(without.getByName("dense"), nullptr);
}

TEST_F(RenderProgramTest, HasADarkAndALightTheme) {
  ASSERT_EQ(render("dark.png").status, 0);
  ASSERT_EQ(render("light.png", "--theme light").status, 0);
  EXPECT_LT(cv::mean(picture("dark.png"))[1], 80.0);
  EXPECT_GT(cv::mean(picture("light.png"))[1], 150.0);
}

TEST_F(RenderProgramTest, DrawsTheSameBytesTwice) {
  ASSERT_EQ(render("one.png").status, 0);
  ASSERT_EQ(render("two.png").status, 0);
  EXPECT_EQ(test::contentsOf(path("one.png")), test::contentsOf(path("two.png")));
}

TEST_F(RenderProgramTest, WritesAVideoOfTheTrackedFramesAtTheirRate) {
  const auto result = render("video.mp4", "--view top -q", "321x241");
  ASSERT_EQ(result.status, 0) << result.output;
  if (std::filesystem::exists(path("video_frames"))) GTEST_SKIP() << "no MP4 encoder here";
  cv::VideoCapture video(path("video.mp4"));
  ASSERT_TRUE(video.isOpened());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 10.0, 0.01);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_COUNT), test::kReplayFrames - 1);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_WIDTH), 322);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_HEIGHT), 242);
}

TEST_F(RenderProgramTest, WritesARangeOfFramesAsVideo) {
  ASSERT_EQ(render("part.mp4", "--from-index 3 --to-index 5 -q").status, 0);
  if (std::filesystem::exists(path("part_frames"))) GTEST_SKIP() << "no MP4 encoder here";
  EXPECT_EQ(cv::VideoCapture(path("part.mp4")).get(cv::CAP_PROP_FRAME_COUNT), 3);
  const auto none = render("none.mp4", "--from-index 30");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("no tracked frame between 30"));
}

TEST_F(RenderProgramTest, ShowsTheTruthWithTheEstimate) {
  const std::filesystem::path truth(path("truth"));
  std::filesystem::create_directories(truth);
  std::vector<Stamped<Pose>> poses;
  std::ofstream objects(truth / "objects.csv");
  objects << io::trackCsvHeader() << ",visible\n";
  const Pose T_truth_map(Eigen::Translation3d(50.0, -20.0, 1.0));
  for (std::size_t frame = 0; frame < test::kReplayFrames; ++frame) {
    poses.push_back({test::replayTime(frame), T_truth_map * test::replayPose(frame)});
    Track object = test::replayTrack(frame);
    object.position = T_truth_map * Eigen::Vector3d(object.position + Eigen::Vector3d(3, -3, 0));
    std::ostringstream row;
    io::writeTrackCsv(row, {frame, test::replayTime(frame), object});
    std::string text = row.str();
    objects << text.substr(0, text.size() - 1) << ",1.0\n";
  }
  objects.close();
  io::writeTum(truth / "trajectory.tum", poses);
  std::filesystem::remove(rawlog);
  ASSERT_EQ(render("without.png", "-q --view top").status, 0);
  const auto result = render("with.png", "-q --view top --truth " + truth.string());
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_GT(pixelsLike(picture("with.png"), kTruthColour),
            pixelsLike(picture("without.png"), kTruthColour) + 50);
}

TEST_F(RenderProgramTest, RewritesTheReportWithErrors) {
  const std::filesystem::path truth(path("truth"));
  std::filesystem::create_directories(truth);
  std::vector<Stamped<Pose>> poses;
  for (std::size_t frame = 0; frame < test::kReplayFrames; ++frame) {
    poses.push_back({test::replayTime(frame), test::replayPose(frame)});
  }
  io::writeTum(truth / "trajectory.tum", poses);
  const auto result = render("page.html", "--truth " + truth.string());
  ASSERT_EQ(result.status, 0) << result.output;
  const std::string page = test::contentsOf(path("page.html"));
  EXPECT_THAT(page, HasSubstr("Absolute trajectory error"));
  EXPECT_THAT(page, HasSubstr("<td>0.000 m</td>"));
  EXPECT_EQ(render("plain.html").status, 0);
  EXPECT_THAT(test::contentsOf(path("plain.html")), Not(HasSubstr("Absolute trajectory error")));
}

TEST_F(RenderProgramTest, NamesATruthOfAnotherRecording) {
  const std::filesystem::path truth(path("truth"));
  std::filesystem::create_directories(truth);
  EXPECT_THAT(render("a.png", "--truth " + truth.string()).output, HasSubstr("trajectory.tum"));
  io::writeTum(truth / "trajectory.tum", {{5.0, Pose::Identity()}});
  const auto result = render("a.png", "--truth " + truth.string());
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("no time agrees with a time of the replay"));
}

TEST_F(RenderProgramTest, DoesNotOverwriteWithoutTheOption) {
  ASSERT_EQ(render("a.png").status, 0);
  const auto refused = render("a.png");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.output, HasSubstr("a.png"));
  EXPECT_EQ(render("a.png", "-w").status, 0);
}

TEST_F(RenderProgramTest, ReportsUsageErrors) {
  const auto usage = [&](const std::string& output, const std::string& options) {
    const auto result = test::runProcess(test::program("headway-render") + " -i " + replay +
                                         " -o " + path(output) + " " + options);
    EXPECT_EQ(result.status, 2) << output << ' ' << options;
    return result.output;
  };
  for (const char* size :
       {"640", "640x", "x480", "axb", "640x480x3", "-640x480", "0x480", "99999x480", "640X480"}) {
    EXPECT_THAT(usage("a.png", std::string("--size ") + size), HasSubstr("--size")) << size;
  }
  EXPECT_THAT(usage("a.png", "--view side"), HasSubstr("'side'"));
  EXPECT_THAT(usage("a.png", "--theme grey"), HasSubstr("'grey'"));
  EXPECT_THAT(usage("a.gif", ""), HasSubstr(".png, .jpg, .mp4, .3Dscene or .html"));
  EXPECT_THAT(usage("a.mp4", "--frame 3"), HasSubstr("--frame"));
  EXPECT_THAT(usage("a.png", "--from-index 3"), HasSubstr("--from-index"));
  EXPECT_THAT(usage("a.mp4", "--from-index 3 --to-index 2"), HasSubstr("--to-index"));
}

TEST_F(RenderProgramTest, ReportsInputErrors) {
  const auto failure = [&](const std::string& input) {
    const auto result =
        test::runProcess(test::program("headway-render") + " -i " + input + " -o " + path("a.png"));
    EXPECT_EQ(result.status, 1) << input;
    EXPECT_THAT(result.output, Not(HasSubstr("\n\n")));
    return result.output;
  };
  EXPECT_THAT(failure(path("nothing")), HasSubstr("no such folder or map file"));
  EXPECT_THAT(failure(folder.path()), HasSubstr("neither trajectory.tum nor map.headway"));
  EXPECT_THAT(failure(rawlog), HasSubstr("not a headway map"));
  std::ofstream(std::filesystem::path(replay) / "tracks.csv", std::ios::app) << "rubbish\n";
  EXPECT_THAT(failure(replay), HasSubstr("tracks.csv"));
  std::ofstream(std::filesystem::path(replay) / "trajectory.tum") << "# nothing\n";
  EXPECT_THAT(failure(replay), HasSubstr("contains no pose"));
}

TEST_F(RenderProgramTest, ReportsAnUnwritableOutput) {
  const auto result = test::runProcess(test::program("headway-render") + " -i " + replay +
                                       " -o /nonexistent/a.png");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("/nonexistent/a.png: cannot be written"));
}

}  // namespace
}  // namespace headway
