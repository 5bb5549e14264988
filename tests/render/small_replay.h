// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/calibration_file.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_file.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

namespace headway::test {

inline constexpr int kReplayFrames = 8;
inline constexpr std::size_t kLostFrame = 2;  ///< has no row in the trajectory

inline Time replayTime(std::size_t frame) { return 1000.0 + 0.1 * static_cast<double>(frame); }

inline StereoCamera replayCamera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 120;
  camera.fx = camera.fy = 180.0;
  camera.cx = 159.5;
  camera.cy = 59.5;
  camera.baseline_m = 0.4;
  return camera;
}

inline Pose replayPose(std::size_t frame) {
  return Pose(Eigen::Translation3d(0.8 * static_cast<double>(frame), 0.0, 0.0));
}

/// A cyclist ahead of the robot, who goes with it.
inline Track replayTrack(std::size_t frame) {
  Track track;
  track.id = TrackId{4};
  track.object_class = ObjectClass::kCyclist;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = MotionState::kMoving;
  track.position << 9.0 + 0.8 * static_cast<double>(frame), 1.0, -0.7;
  track.velocity << 8.0, 0.0, 0.0;
  track.size << 1.8, 0.6, 1.7;
  return track;
}

inline void writeReplayRawlog(const std::string& path) {
  io::RawlogSink sink(path, io::ImageStorage::kEmbeddedRaw);
  for (std::size_t frame = 0; frame < kReplayFrames; ++frame) {
    const cv::Mat image(120, 320, CV_8UC3, cv::Scalar(190, 60, 20 + 20 * double(frame)));
    sink.writeStereo(replayTime(frame), image, image, io::rawFrom(replayCamera()));
  }
  sink.close();
}

inline void writeReplayTracks(const std::filesystem::path& folder) {
  std::ofstream tracks(folder / "tracks.csv");
  std::ofstream predictions(folder / "predictions.csv");
  tracks << io::trackCsvHeader() << '\n';
  predictions << io::predictionCsvHeader() << '\n';
  for (std::size_t frame = 0; frame < kReplayFrames; ++frame) {
    const Track track = replayTrack(frame);
    io::writeTrackCsv(tracks, {frame, replayTime(frame), track});
    for (int i = 1; i <= 30; ++i) {
      io::PredictionRow row{frame, replayTime(frame), track.id, track.object_class, 0, 1.0, {}};
      row.point.horizon_s = 0.1 * i;
      row.point.position = track.position + row.point.horizon_s * track.velocity;
      row.point.covariance = 0.01 * i * Eigen::Matrix2d::Identity();
      io::writePredictionCsv(predictions, row);
    }
  }
}

inline map::StoredMap replayMap() {
  std::vector<slam::LandmarkView> landmarks;
  for (int i = 0; i < 400; ++i) {
    landmarks.push_back(
        {LandmarkId{i}, {0.2 * i, i % 2 == 0 ? 6.0 : -6.0, -1.5 + 0.01 * i}, 4, 200});
  }
  const slam::KeyframeView keyframe{KeyframeId{0},          5, replayTime(5), replayPose(5),
                                    PoseCovariance::Zero(), {}};
  map::StoredMap stored;
  stored.map.update(slam::MapView{landmarks, {keyframe}});
  stored.map.update(replayTime(5), {replayTrack(5)});
  stored.camera = replayCamera();
  return stored;
}

/// What headway-replay would leave of eight frames, one of them lost; the rawlog is beside it.
inline void writeSmallReplay(const std::filesystem::path& folder, const std::string& rawlog) {
  std::filesystem::create_directories(folder);
  std::vector<Stamped<Pose>> trajectory;
  for (std::size_t frame = 0; frame < kReplayFrames; ++frame) {
    if (frame != kLostFrame) trajectory.push_back({replayTime(frame), replayPose(frame)});
  }
  io::writeTum(folder / "trajectory.tum", trajectory);
  io::writeTum(folder / "trajectory_online.tum", trajectory);
  writeReplayTracks(folder);
  io::writeCalibration(folder / "calibration.yaml", replayCamera());
  map::saveMap(folder / "map.headway", replayMap());
  std::ofstream(folder / "summary.json") << nlohmann::json{{"lost_frames", {kLostFrame}}};
  std::ofstream(folder / "replay.json")
      << nlohmann::json{{"input", {{"rawlog", rawlog}, {"sensor_label", ""}}},
                        {"options", {{"from_index", nullptr}}}};
}

}  // namespace headway::test
