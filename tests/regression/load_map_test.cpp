// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/limits.h>

#include "plain_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

using ::testing::HasSubstr;
using Trajectory = std::vector<Stamped<Pose>>;

const std::string kStreetRawlog = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";
const std::string kStreetTruth = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.truth";

/// Replays of two overlapping parts of a recording, the second in the map of the first.
struct TwoDrives {
  test::ReplayRun first, second;

  [[nodiscard]] Trajectory path(const test::ReplayRun& run) const {
    return io::readTum(run.file("trajectory.tum"));
  }
  /// Both paths as if they were one, to be judged with one alignment.
  [[nodiscard]] Trajectory together() const {
    Trajectory all = path(first);
    const Trajectory later = path(second);
    all.insert(all.end(), later.begin(), later.end());
    return all;
  }
  /// Greatest distance between both paths' poses of the same time [m].
  [[nodiscard]] double disagreement() const {
    double worst = 0.0;
    std::size_t shared = 0;
    for (const auto& a : path(first)) {
      for (const auto& b : path(second)) {
        if (std::abs(a.time - b.time) > 1e-6) continue;
        worst = std::max(worst, (a.value.translation() - b.value.translation()).norm());
        ++shared;
      }
    }
    EXPECT_GT(shared, 0u);
    return worst;
  }
};

TwoDrives replayInTwo(const std::string& rawlog, const test::TemporaryFolder& folder,
                      int overlap_from, int overlap_to) {
  TwoDrives drives;
  const std::string common = "-q --snapshots 0 --detector none ";
  drives.first =
      test::replay(rawlog, folder / "first", common + "--to-index " + std::to_string(overlap_to));
  EXPECT_EQ(0, drives.first.process.status) << drives.first.process.output;
  drives.second = test::replay(rawlog, folder / "second",
                               common + "--from-index " + std::to_string(overlap_from) +
                                   " --load-map " + drives.first.file("map.headway"));
  EXPECT_EQ(0, drives.second.process.status) << drives.second.process.output;
  return drives;
}

TEST(LoadMapTest, TwoDrivesThroughTheStreetHaveOneFrameAndOneMap) {
  const test::TemporaryFolder folder;
  const auto drives = replayInTwo(kStreetRawlog, folder, 30, 60);
  EXPECT_EQ(0, drives.second.summary.at("frames_lost"));
  EXPECT_GT(drives.second.summary.at("keyframes"), drives.first.summary.at("keyframes"));
  const auto truth = io::readTum(kStreetTruth + "/trajectory.tum");
  test::expectWithin("ate_rmse_m", test::ateRmse(truth, drives.together()),
                     test::kStreetTwoDrivesAteM);
  test::expectWithin("disagreement_m", drives.disagreement(), test::kSharedFrameM);
}

TEST(LoadMapTest, WithoutMappingTheCameraIsLocalisedAndTheMapStays) {
  const test::TemporaryFolder folder;
  const auto first = test::replay(kStreetRawlog, folder / "first",
                                  "-q --snapshots 0 --detector none --to-index 60");
  const auto second = test::replay(
      kStreetRawlog, folder / "second",
      "-q --snapshots 0 --detector none --from-index 5 --to-index 55 --set slam.mapping=false "
      "--load-map " +
          first.file("map.headway"));
  ASSERT_EQ(0, second.process.status) << second.process.output;
  EXPECT_EQ(0, second.summary.at("frames_lost")) << second.summary.at("lost_frames");
  EXPECT_EQ(first.summary.at("keyframes"), second.summary.at("keyframes"));
  EXPECT_TRUE(test::contentsOf(first.file("map_points.ply")) ==
              test::contentsOf(second.file("map_points.ply")));
}

TEST(LoadMapTest, TwoPartsOfARealStreetHaveOneFrame) {
  HEADWAY_REQUIRE_DATA(data);
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "in.rawlog";
  const auto imported = test::runProcess(test::program("headway-import") + " kitti-odometry " +
                                         (data / "kitti_odometry").string() +
                                         " --sequence 06 -q -o " + rawlog.string());
  ASSERT_EQ(0, imported.status) << imported.output;
  const auto drives = replayInTwo(rawlog, folder, 20, 32);
  EXPECT_EQ(0, drives.second.summary.at("frames_lost")) << drives.second.summary.at("lost_frames");
  test::expectWithin("ate_rmse_m", test::ateRmse(io::readTruth(rawlog).poses, drives.together()),
                     test::kKitti06TwoDrivesAteM);
  test::expectWithin("disagreement_m", drives.disagreement(), test::kSharedFrameM);
}

/// Maps that cannot be used: one line, status 1, and the folder of results is not touched.
class UnusableMapTest : public ::testing::Test {
 protected:
  UnusableMapTest() {
    test::writePlainRawlog(rawlog_);
    const auto run = test::replay(rawlog_, folder_ / "first", "-q --snapshots 0");
    EXPECT_EQ(0, run.process.status) << run.process.output;
    std::filesystem::copy(run.file("map.headway"), map_);
  }

  /// The one line of a replay that must end with status 1.
  std::string errorLine(const std::string& rawlog) {
    const auto run = test::replay(rawlog, folder_ / "out", "-q --snapshots 0 --load-map " + map_);
    EXPECT_EQ(1, run.process.status) << run.process.output;
    EXPECT_EQ(1, std::count(run.process.output.begin(), run.process.output.end(), '\n'))
        << run.process.output;
    EXPECT_THAT(run.process.output, HasSubstr("map.headway"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    return run.process.output;
  }

  test::TemporaryFolder folder_;
  std::string rawlog_ = folder_ / "in.rawlog";
  std::string map_ = folder_ / "map.headway";
};

TEST_F(UnusableMapTest, Missing) {
  std::filesystem::remove(map_);
  EXPECT_THAT(errorLine(rawlog_), HasSubstr("no such file"));
}

TEST_F(UnusableMapTest, Truncated) {
  std::filesystem::resize_file(map_, std::filesystem::file_size(map_) / 2);
  EXPECT_THAT(errorLine(rawlog_), HasSubstr("truncated"));
}

TEST_F(UnusableMapTest, OfAnotherCamera) {
  EXPECT_THAT(errorLine(kStreetRawlog), HasSubstr("another camera"));
}

TEST_F(UnusableMapTest, OfAnotherPlaceLeavesEveryFrameLostWithAMessage) {
  const auto elsewhere = folder_ / "elsewhere.rawlog";
  {
    io::RawlogSink sink(elsewhere, io::ImageStorage::kEmbedded);
    for (int frame = 0; frame < 4; ++frame) {
      auto pair = test::plainPair(frame);
      cv::flip(pair.left, pair.left, 0);
      cv::flip(pair.right, pair.right, 0);
      sink.writeStereo(test::plainTime(frame), pair.left, pair.right,
                       io::rawFrom(test::plainCamera()));
    }
    sink.close();
  }
  const auto run = test::replay(elsewhere, folder_ / "out", "-q --snapshots 0 --load-map " + map_);
  EXPECT_EQ(1, run.process.status);
  EXPECT_EQ(4, run.summary.at("frames_lost"));
  EXPECT_THAT(run.process.output, HasSubstr("none was re-localised"));
}

}  // namespace
}  // namespace headway
