// SPDX-License-Identifier: BSD-3-Clause
// Each file of a replay on a full disk: /dev/full accepts no byte.
#include <gmock/gmock.h>
#include <headway/io/calibration_file.h>
#include <headway/map/map_export.h>
#include <headway/map/map_file.h>
#include <headway/program/picture_files.h>
#include <headway/report/report.h>
#include <headway/scene/snapshot.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>

#include "result_files.h"
#include "summary.h"

namespace headway::replay {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

StereoCamera someCamera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 260.0;
  camera.baseline_m = 0.2;
  return camera;
}

/// Writes all files of a replay into a folder.
void writeAll(const fs::path& folder) {
  const StereoCamera camera = someCamera();
  FrameWriters writers(folder);
  pipeline::PerceptionUpdate update;
  update.camera.status = slam::TrackingStatus::kTracked;
  update.detections.emplace();
  Track track;
  track.status = TrackStatus::kConfirmed;
  update.objects.tracks.push_back(track);
  writers.write(update, &camera);
  writers.writeSmoothed({{0, 0.0, track}});
  writers.finish();
  TrajectoryWriter trajectory(folder, Pose::Identity());
  trajectory.add({0, 0.0, true, Pose::Identity()});
  trajectory.commit();
  io::writeCalibration(folder / "calibration.yaml", camera);
  writeRunRecord(folder / "replay.json", {}, {}, {});
  writeSummary(folder / "summary.json", {});
  map::writeStaticGrid(folder / "map_grid", mrpt::maps::COccupancyGridMap2D());
  map::writeSimpleMap(folder / "map.simplemap", {});
  map::writePly(folder / "map_points.ply", slam::MapView());
  map::saveMap(folder / "map.headway", {});
  const map::PerceptionMap map;
  scene::saveScene(folder / "scene.3Dscene", {map, 0, 0.0, Pose::Identity(), {}, {}, {}, {}, {}});
  program::writePicture(folder / "picture.png", cv::Mat::zeros(9, 9, CV_8UC3));
  report::writeReport(folder, {});
}

TEST(FullDiskTest, EachFileOfAReplayIsAnErrorThatNamesIt) {
  const test::TemporaryFolder folder;
  const fs::path good = folder / "good";
  fs::create_directory(good);
  ASSERT_NO_THROW(writeAll(good));
  for (const auto& file : fs::directory_iterator(good)) {
    const fs::path full = folder / ("full " + file.path().filename().string());
    fs::create_directory(full);
    fs::create_symlink("/dev/full", full / file.path().filename());
    // Files without rows need no byte.
    if (fs::file_size(file.path()) == 0) continue;
    EXPECT_THAT(headway::test::inputErrorOf([&] { writeAll(full); }),
                testing::AnyOf(HasSubstr(file.path().filename().string()), HasSubstr("/dev/full")))
        << file.path();
  }
}

}  // namespace
}  // namespace headway::replay
