// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/replay_frames.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::report {
namespace {

using ::testing::ElementsAre;

constexpr std::size_t kFrameCount = 40;
constexpr std::size_t kLost = 5;  ///< has no pose

Time timeOfFrame(std::size_t frame) { return 50.0 + 0.1 * static_cast<double>(frame); }

/// A replay whose final map is 1 m to the left of the online map. Every third frame has a track.
class ReplayFramesTest : public ::testing::Test {
 protected:
  ReplayFramesTest() {
    std::vector<Stamped<Pose>> final_path, online_path;
    std::ofstream tracks(folder_ / "tracks.csv"), predictions(folder_ / "predictions.csv");
    tracks << io::trackCsvHeader() << '\n';
    predictions << io::predictionCsvHeader() << '\n';
    for (std::size_t frame = 0; frame < kFrameCount; ++frame) {
      if (frame == kLost) continue;
      const double x = static_cast<double>(frame);
      final_path.push_back({timeOfFrame(frame), Pose(Eigen::Translation3d(x, 1.0, 0.0))});
      online_path.push_back({timeOfFrame(frame), Pose(Eigen::Translation3d(x, 0.0, 0.0))});
      if (frame % 3 != 0) continue;
      Track track;
      track.id = TrackId{2};
      track.object_class = ObjectClass::kCar;
      track.status = TrackStatus::kConfirmed;
      track.position << x, 5.0, 0.5;
      io::writeTrackCsv(tracks, {frame, timeOfFrame(frame), track});
      for (int i = 1; i <= 30; ++i) {
        io::PredictionRow row{frame, timeOfFrame(frame), track.id, track.object_class, 0, 1.0, {}};
        row.point.horizon_s = 0.1 * i;
        row.point.position = track.position;
        io::writePredictionCsv(predictions, row);
      }
    }
    io::writeTum(folder_ / "trajectory.tum", final_path);
    io::writeTum(folder_ / "trajectory_online.tum", online_path);
    std::ofstream(folder_ / "summary.json") << R"({"lost_frames":[5]})";
  }

  [[nodiscard]] std::vector<ReplayFrame> read(const ReplayFrameOptions& options) const {
    return readReplayFrames(folder_.path(), options, [](const std::string&) {});
  }

  test::TemporaryFolder folder_;
};

TEST_F(ReplayFramesTest, AreInTheFinalMapAndKeepTheirIndices) {
  const auto frames = read({});
  ASSERT_EQ(kFrameCount - 1, frames.size());
  EXPECT_EQ(4u, frames[4].frame);
  EXPECT_EQ(6u, frames[5].frame);
  ASSERT_EQ(1u, frames[5].tracks.size());
  const Track& track = frames[5].tracks[0];
  EXPECT_NEAR(6.0, track.position.y(), 1e-6) << "moved with the map";
  ASSERT_EQ(30u, track.predictions[0].points.size());
  EXPECT_NEAR(6.0, track.predictions[0].points[29].position.y(), 1e-6);
  ASSERT_EQ(2u, track.recent_path.size()) << "of frames 0 and 3";
  EXPECT_EQ(3u, track.recent_path[1].frame);
}

TEST_F(ReplayFramesTest, OfALongReplayASampleIsReadWithItsIndices) {
  ReplayFrameOptions options;
  options.max_frames = 12;
  options.past_s = 0.0;
  options.horizon_step_s = 1.0;
  const auto frames = read(options);
  ASSERT_LE(frames.size(), 12u);
  ASSERT_GE(frames.size(), 6u);
  for (const auto& frame : frames) {
    EXPECT_NEAR(timeOfFrame(frame.frame), frame.time, 1e-6);
    EXPECT_EQ(frame.frame % 3 == 0 ? 1u : 0u, frame.tracks.size()) << frame.frame;
    for (const auto& track : frame.tracks) {
      EXPECT_EQ(3u, track.predictions[0].points.size());
      EXPECT_TRUE(track.recent_path.empty());
    }
  }
}

TEST_F(ReplayFramesTest, MissingFilesAreNotedAndAMissingTrajectoryIsAnError) {
  std::filesystem::remove(folder_ / "predictions.csv");
  std::vector<std::string> notes;
  const auto note = [&](const std::string& text) { notes.push_back(text); };
  EXPECT_FALSE(readReplayFrames(folder_.path(), {}, note).empty());
  EXPECT_THAT(notes, ElementsAre(::testing::HasSubstr("no predictions.csv")));
  std::filesystem::remove(folder_ / "trajectory.tum");
  EXPECT_THROW((void)read({}), InputError);
}

TEST_F(ReplayFramesTest, TheInputIsThatOfTheRecord) {
  EXPECT_TRUE(readReplayInput(folder_.path()).rawlog.empty());
  std::ofstream(folder_ / "replay.json")
      << R"({"input":{"rawlog":"/data/x.rawlog","sensor_label":"CAM"}})";
  EXPECT_EQ("/data/x.rawlog", readReplayInput(folder_.path()).rawlog);
  EXPECT_EQ("CAM", readReplayInput(folder_.path()).sensor_label);
}

}  // namespace
}  // namespace headway::report
