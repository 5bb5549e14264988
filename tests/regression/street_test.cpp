// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_file.h>
#include <headway_test/limits.h>
#include <headway_test/paths.h>
#include <headway_test/waiting.h>

#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <thread>

#include "replay_run.h"

namespace headway {
namespace {

const std::string kStreet = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";
const std::string kTruth = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.truth";

/// One replay of the bundled street, shared by the tests that only read it.
const test::ReplayRun& streetRun() {
  static const test::TemporaryFolder folder;
  static const test::ReplayRun run = test::replay(kStreet, folder / "out", "--snapshots 2");
  return run;
}

TEST(StreetTest, EveryFrameIsTrackedAndClose) {
  const auto& run = streetRun();
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_GE(run.summary.at("frames"), 100);
  EXPECT_EQ(run.summary.at("frames"), run.summary.at("frames_tracked"));
  EXPECT_EQ(0, run.summary.at("frames_lost"));
  test::expectWithin("ate_rmse_m",
                     test::ateRmse(io::readTum(kTruth + "/trajectory.tum"),
                                   io::readTum(run.file("trajectory.tum"))),
                     test::kStreetAteM);
}

TEST(StreetTest, MovingObjectsAreTrackedAndPredicted) {
  const auto& run = streetRun();
  std::set<TrackId> moving;
  for (const auto& row : io::readTrackCsv(run.file("tracks.csv"))) {
    if (isMoving(row.track)) moving.insert(row.track.id);
  }
  std::set<TrackId> predicted;
  for (const auto& row : io::readPredictionCsv(run.file("predictions.csv"))) {
    if (moving.count(row.id) != 0 && row.point.horizon_s > 2.95) predicted.insert(row.id);
  }
  EXPECT_GE(predicted.size(), test::kStreetMovingObjects);
  EXPECT_EQ(run.summary.at("tracks_moving"), moving.size());
}

/// Objects are where they are in whole images, in pixels of those.
TEST(StreetTest, ImagesOfHalfTheSizeLoseNoFrame) {
  const test::TemporaryFolder folder;
  const auto half = test::replay(kStreet, folder / "out", "--snapshots 0 --set camera.scale=0.5");
  ASSERT_EQ(0, half.process.status) << half.process.output;
  EXPECT_EQ(0, half.summary.at("frames_lost"));
  EXPECT_LT(test::ateRmse(io::readTum(kTruth + "/trajectory.tum"),
                          io::readTum(half.file("trajectory.tum"))),
            0.06)
      << "measured: 0.038 m";
  EXPECT_EQ(test::contentsOf(streetRun().file("calibration.yaml")),
            test::contentsOf(half.file("calibration.yaml")));
  const auto farthestRight = [](const test::ReplayRun& run) {
    double right = 0.0;
    for (const auto& row : io::readKittiRows(run.file("tracks_kitti.txt"))) {
      right = std::max(right, row.box2d.right);
    }
    return right;
  };
  EXPECT_NEAR(farthestRight(streetRun()), farthestRight(half), 20.0);
}

TEST(StreetTest, EveryTrackHasOneScore) {
  std::map<std::int64_t, std::set<double>> scores;
  for (const auto& row : io::readKittiRows(streetRun().file("tracks_kitti.txt"))) {
    scores[row.id].insert(row.score);
  }
  EXPECT_GE(scores.size(), test::kStreetMovingObjects);
  for (const auto& [id, of_track] : scores) EXPECT_EQ(1u, of_track.size()) << "track " << id;
}

TEST(StreetTest, LeavesEveryFileOfTheContract) {
  const auto& run = streetRun();
  for (const char* name :
       {"trajectory.tum",      "trajectory_online.tum", "trajectory_kitti.txt", "tracks_kitti.txt",
        "tracks.csv",          "tracks_smoothed.csv",   "predictions.csv",      "calibration.yaml",
        "map.headway",         "map.simplemap",         "map_points.ply",       "map_dense.ply",
        "map_grid.gridmap.gz", "map_grid.png",          "map_grid.yaml",        "scene.3Dscene",
        "report.html",         "replay.html",           "replay.json",          "summary.json"}) {
    EXPECT_GT(test::contentsOf(run.file(name)).size(), 0u) << name;
  }
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(run.folder / "snapshots")) {
    pictures += entry.path().extension() == ".png" ? 1 : 0;
  }
  EXPECT_EQ(2u, pictures);
  const auto stored = map::loadMap(run.file("map.headway"));
  EXPECT_EQ(run.summary.at("landmarks"), stored.map.staticMap()->landmarks.size());
  EXPECT_EQ(run.summary.at("frames"), io::readKittiPoses(run.file("trajectory_kitti.txt")).size());
}

TEST(StreetTest, SummaryHasTheKeysThatScriptsRelyOn) {
  const auto& summary = streetRun().summary;
  for (const char* key : {"frames",          "frames_tracked",
                          "frames_lost",     "lost_frames",
                          "keyframes",       "landmarks",
                          "loops",           "start_up_s",
                          "frame_ms_median", "frame_ms_p95",
                          "frame_ms_max",    "cpu_ms_per_frame",
                          "stages_ms",       "peak_memory_mb",
                          "detections_used", "detections_dropped",
                          "calibration",     "observations_skipped",
                          "version",         "seed"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  for (const char* key :
       {"baseline_m", "focal_px", "vertical_disparity_px", "median_disparity_px"}) {
    EXPECT_TRUE(summary.at("calibration").contains(key)) << key;
  }
  EXPECT_TRUE(summary.at("stages_ms").at("slam_track").contains("median"));
  EXPECT_TRUE(summary.at("stages_ms").at("slam_track").contains("p95"));
  EXPECT_GT(summary.at("detections_used"), 100);
}

TEST(StreetTest, SaysWhereTheBoxesAreFrom) {
  EXPECT_NE(std::string::npos, streetRun().process.output.find(
                                   "; --detector stereo_motion finds objects from images alone"))
      << streetRun().process.output;
  EXPECT_NE(std::string::npos, streetRun().process.output.find(" recorded boxes"));
}

TEST(StreetTest, TwoRunsGiveTheSameBytes) {
  const test::TemporaryFolder folder;
  const auto again = test::replay(kStreet, folder / "out");
  ASSERT_EQ(0, again.process.status) << again.process.output;
  for (const char* name :
       {"trajectory.tum", "trajectory_online.tum", "tracks.csv", "tracks_smoothed.csv",
        "predictions.csv", "map_points.ply", "map_dense.ply"}) {
    EXPECT_TRUE(test::contentsOf(again.file(name)) == test::contentsOf(streetRun().file(name)))
        << name;
  }
}

TEST(StreetTest, APartOfTheRawlogKeepsItsIndices) {
  const test::TemporaryFolder folder;
  const auto part =
      test::replay(kStreet, folder / "out", "--snapshots 0 --from-index 20 --to-index 49");
  ASSERT_EQ(0, part.process.status) << part.process.output;
  EXPECT_EQ(30, part.summary.at("frames"));
  for (const auto& row : io::readTrackCsv(part.file("tracks.csv"))) {
    EXPECT_GE(row.frame, 20u);
    EXPECT_LE(row.frame, 49u);
  }
}

TEST(StreetTest, WithoutADetectorNothingIsTracked) {
  const test::TemporaryFolder folder;
  const auto run = test::replay(kStreet, folder / "out", "--snapshots 0 --detector none");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(0, run.summary.at("detections_used"));
  EXPECT_TRUE(io::readTrackCsv(run.file("tracks.csv")).empty());
}

TEST(StreetTest, TheImagesAloneGiveMovingTracksTwiceTheSame) {
  const test::TemporaryFolder folder;
  const std::string options = "--snapshots 0 --to-index 60 --detector stereo_motion";
  const auto run = test::replay(kStreet, folder / "out", options);
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_GE(run.summary.at("tracks_moving"), 2);
  EXPECT_TRUE(run.summary.at("stages_ms").contains("detect"));
  EXPECT_NE(std::string::npos, run.process.output.find(" detections by stereo_motion"));
  const auto again = test::replay(kStreet, folder / "again", options);
  for (const char* name : {"detections.csv", "tracks.csv", "trajectory.tum"}) {
    EXPECT_TRUE(test::contentsOf(again.file(name)) == test::contentsOf(run.file(name))) << name;
  }
}

TEST(StreetTest, DetectionsOfAReplayCanBeUsedAgain) {
  const test::TemporaryFolder folder;
  const auto run = test::replay(kStreet, folder / "out", "--snapshots 0 --to-index 40");
  const auto again =
      test::replay(kStreet, folder / "again",
                   "--snapshots 0 --to-index 40 --detections " + run.file("detections.csv"));
  ASSERT_EQ(0, again.process.status) << again.process.output;
  EXPECT_GT(run.summary.at("detections_used"), 0);
  EXPECT_EQ(run.summary.at("detections_used"), again.summary.at("detections_used"));
  EXPECT_EQ(run.summary.at("tracks_confirmed"), again.summary.at("tracks_confirmed"));
}

TEST(StreetTest, AtTheRecordedRateEveryFrameIsAccountedFor) {
  const test::TemporaryFolder folder;
  const auto run = test::replay(
      kStreet, folder / "out", "--snapshots 0 --realtime 4 --to-index 60 --detector stereo_motion");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(61u, run.summary.at("frames_tracked").get<std::size_t>() +
                     run.summary.at("frames_lost").get<std::size_t>() +
                     run.summary.at("late_frames").size());
  EXPECT_EQ(0, run.summary.at("frames_lost")) << "late frames are no lost ones";
  EXPECT_LE(run.summary.at("late_frames").size(), run.summary.at("frames_dropped_late"));
}

TEST(StreetTest, CtrlCLeavesFinishedReadableOutputs) {
  const test::TemporaryFolder folder;
  const auto out = folder / "out";
  const auto started =
      test::runProcess(test::program("headway-replay") + " -q -i " + kStreet + " -o " +
                       out.string() + " --realtime 1 --snapshots 0 > /dev/null & echo $!");
  const pid_t pid = std::stoi(started.output);
  const auto rows = [&] {
    const std::string text = test::contentsOf(out / "trajectory_online.tum");
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_TRUE(test::waitUntil([&] { return rows() > 5; }));
  ASSERT_EQ(0, kill(pid, SIGINT)) << "the replay ended before it was interrupted";
  while (kill(pid, 0) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));

  const auto summary = nlohmann::json::parse(test::contentsOf(out / "summary.json"));
  EXPECT_EQ("interrupted", summary.at("ended_early"));
  EXPECT_GT(summary.at("frames_tracked"), 3);
  EXPECT_LT(summary.at("frames"), 100);
  EXPECT_EQ(summary.at("frames_tracked").get<std::size_t>(),
            io::readTum(out / "trajectory.tum").size());
  EXPECT_NO_THROW((void)map::loadMap(out / "map.headway"));
  EXPECT_NO_THROW((void)io::readTrackCsv(out / "tracks.csv"));
}

TEST(StreetTest, ATrajectoryOfAnotherPlaceFailsTheLimit) {
  auto truth = io::readTum(kTruth + "/trajectory.tum");
  for (auto& pose : truth) pose.value.translation().y() += std::sin(pose.time);
  EXPECT_GT(test::ateRmse(truth, io::readTum(streetRun().file("trajectory.tum"))),
            test::kStreetAteM);
}

}  // namespace
}  // namespace headway
