// SPDX-License-Identifier: BSD-3-Clause
// Several recordings that get one map.
#include <gmock/gmock.h>
#include <headway/io/detection_observation.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_file.h>
#include <headway_test/input_error.h>
#include <headway_test/limits.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "replay_run.h"

namespace headway {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using Trajectory = std::vector<Stamped<Pose>>;

const std::string kRawlogs = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/";

using Change = std::function<void(mrpt::obs::CObservationStereoImages&)>;

/// As of another place.
void mirror(mrpt::obs::CObservationStereoImages& stereo) {
  cv::Mat left, right;
  cv::flip(stereo.imageLeft.asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY), right, 1);
  cv::flip(stereo.imageRight.asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY), left, 1);
  stereo.imageLeft = mrpt::img::CImage(left, mrpt::img::DEEP_COPY);
  stereo.imageRight = mrpt::img::CImage(right, mrpt::img::DEEP_COPY);
}

void blacken(mrpt::obs::CObservationStereoImages& stereo) {
  for (auto* image : {&stereo.imageLeft, &stereo.imageRight}) image->asCvMatRef().setTo(0);
}

/// Copies the stereo pairs from `first` to before `end`, changed if wanted.
void cut(const std::string& from, const std::string& to, int first, int end,
         const Change& change = {}) {
  mrpt::io::CFileGZInputStream in(from);
  mrpt::io::CFileGZOutputStream out(to);
  auto source = mrpt::serialization::archiveFrom(in);
  auto target = mrpt::serialization::archiveFrom(out);
  for (int pair = 0; pair < end;) {
    const auto object = source.ReadObject();
    auto* stereo = dynamic_cast<mrpt::obs::CObservationStereoImages*>(object.get());
    if (stereo == nullptr || pair++ < first) continue;
    if (change) change(*stereo);
    target << *stereo;
  }
}

/// Parts of the bundled street, and another place.
class RecordingsTest : public ::testing::Test {
 protected:
  RecordingsTest() {
    mrpt::rtti::registerClass(CLASS_ID(headway::CObservationObjectDetections));
    cut(kRawlogs + "street.rawlog", folder_ / "begin.rawlog", 0, 30);
    cut(kRawlogs + "street.rawlog", folder_ / "end.rawlog", 15, 45);
  }

  test::ProcessResult replay(const std::vector<std::string>& names, const std::string& output,
                             const std::string& options = "") {
    std::string command = test::program("headway-replay") + " --snapshots 0 --detector none -o " +
                          at(output) + " " + options;
    for (const auto& name : names) command += " -i " + at(name + ".rawlog");
    return test::runProcess(command);
  }
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] Trajectory path(const std::string& folder) const {
    return io::readTum(at(folder + "/trajectory.tum"));
  }
  [[nodiscard]] Json record(const std::string& output) const {
    return Json::parse(test::contentsOf(at(output + "/recordings.json")));
  }
  /// RMSE of both parts as if they were one path, with one alignment [m].
  [[nodiscard]] double ateTogether(const std::string& output) const {
    Trajectory all = path(output + "/begin");
    const Trajectory later = path(output + "/end");
    all.insert(all.end(), later.begin(), later.end());
    return test::ateRmse(io::readTum(kRawlogs + "street.truth/trajectory.tum"), all);
  }
  /// Greatest distance between the poses of both parts at the same time [m].
  [[nodiscard]] double disagreement(const std::string& output) const {
    double worst = -1.0;
    for (const auto& a : path(output + "/begin")) {
      for (const auto& b : path(output + "/end")) {
        if (std::abs(a.time - b.time) > 1e-6) continue;
        worst = std::max(worst, (a.value.translation() - b.value.translation()).norm());
      }
    }
    return worst;
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordingsTest, OfOnePlaceGetOneMapInAnyOrderAndOfAnotherStayApart) {
  cut(kRawlogs + "street.rawlog", folder_ / "elsewhere.rawlog", 0, 15, mirror);
  const auto forward = replay({"begin", "elsewhere", "end"}, "forward", "-q");
  ASSERT_EQ(0, forward.status) << forward.output;
  EXPECT_THAT(forward.output, HasSubstr("elsewhere: shares no place with begin, end"));
  const Json maps = record("forward").at("maps");
  ASSERT_EQ(2U, maps.size());
  EXPECT_THAT(maps[0].at("recordings"), ElementsAre("begin", "end"));
  EXPECT_EQ("map-2", maps[1].at("folder"));
  for (const char* file : {"map.headway", "map_points.ply", "map.simplemap", "scene.3Dscene",
                           "begin/trajectory_kitti.txt", "begin/map.headway", "end/report.html",
                           "elsewhere/summary.json", "map-2/map.headway"}) {
    EXPECT_TRUE(std::filesystem::exists(at("forward/") + file)) << file;
  }
  test::expectWithin("ate_rmse_m", ateTogether("forward"), test::kStreetTwoDrivesAteM);
  test::expectWithin("disagreement_m", disagreement("forward"), test::kSharedFrameM);

  const auto backward = replay({"end", "begin"}, "backward", "-q");
  ASSERT_EQ(0, backward.status) << backward.output;
  EXPECT_EQ(1U, record("backward").at("maps").size());
  EXPECT_NEAR(ateTogether("backward"), ateTogether("forward"), 0.1 * ateTogether("forward"));
  EXPECT_TRUE(path("backward/end").front().value.isApprox(Pose::Identity(), 1e-3))
      << "the frame is that of the recording given first";

  const auto crop = test::runProcess(test::program("headway-export") + " map " + at("forward") +
                                     " -q --crop -1,6,-50,50 -o " + at("crop"));
  ASSERT_EQ(0, crop.status) << crop.output;
  const auto whole = map::loadMap(at("forward/map.headway"));
  const auto part = map::loadMap(at("crop/map.headway"));
  const auto& keyframes = part.map.staticMap()->keyframes;
  EXPECT_GT(keyframes.size(), 2U);
  EXPECT_LT(keyframes.size(), whole.map.staticMap()->keyframes.size());
  for (const auto& keyframe : keyframes) EXPECT_LE(keyframe.T_map_robot.translation().x(), 6.0);
  for (const auto& landmark : part.map.staticMap()->landmarks) {
    EXPECT_LE(landmark.position.x(), 6.0);
  }
}

TEST_F(RecordingsTest, OfDifferentCamerasAreRefusedBeforeAnyIsProcessed) {
  std::filesystem::copy(kRawlogs + "hall.rawlog", folder_ / "hall.rawlog");
  const auto run = replay({"begin", "hall"}, "out", "-q");
  EXPECT_EQ(1, run.status);
  EXPECT_EQ(1, std::count(run.output.begin(), run.output.end(), '\n')) << run.output;
  EXPECT_THAT(run.output, HasSubstr("hall.rawlog: is the recording of another camera"));
  EXPECT_THAT(run.output, HasSubstr("baseline"));
}

TEST_F(RecordingsTest, OptionsOfOneRecordingAreRefused) {
  for (const char* option : {"--from-index 3", "--to-index 5", "--load-map x", "--detections x"}) {
    EXPECT_EQ(2, replay({"begin", "end"}, "out", option).status) << option;
  }
  EXPECT_EQ(2, replay({"begin", "begin"}, "out").status) << "twice the same";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(RecordingsTest, ATruncatedOneIsSaidAndDoesNotHinderTheOthers) {
  std::filesystem::resize_file(folder_ / "end.rawlog",
                               std::filesystem::file_size(folder_ / "end.rawlog") / 3);
  const auto run = replay({"end", "begin"}, "out", "-q");
  EXPECT_EQ(1, run.status);
  EXPECT_THAT(run.output, HasSubstr("end.rawlog"));
  EXPECT_EQ(30U, path("out/begin").size());
  EXPECT_TRUE(std::filesystem::exists(at("out/map.headway")));
  EXPECT_EQ(1, replay({"end", "begin"}, "out", "-q").status) << "not without -w";
}

TEST_F(RecordingsTest, OneOfWhichNothingIsTrackedReplacesNoGoodResults) {
  ASSERT_EQ(0, replay({"begin", "end"}, "out", "-q").status);
  const auto before = test::contentsOf(at("out/begin/trajectory.tum"));
  cut(kRawlogs + "street.rawlog", folder_ / "begin.rawlog", 0, 30, blacken);
  const auto run = replay({"begin", "end"}, "out", "-q -w");
  EXPECT_EQ(1, run.status);
  EXPECT_THAT(run.output, HasSubstr("none of 30 frames was tracked"));
  EXPECT_THAT(run.output, HasSubstr("the old results in " + at("out") + " remain"));
  EXPECT_EQ(before, test::contentsOf(at("out/begin/trajectory.tum")));
  EXPECT_EQ(30U, path("out/unfinished/end").size()) << "what the others gave is not lost";
}

}  // namespace
}  // namespace headway
