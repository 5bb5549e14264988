// SPDX-License-Identifier: BSD-3-Clause
// The files of a run: rows of each frame, trajectories and checkpoints.
#include "result_files.h"

#include <headway/core/detection.h>
#include <headway/core/output_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_export.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/program/files.h>

#include <array>
#include <cmath>
#include <exception>
#include <fstream>
#include <iomanip>
#include <set>
#include <sstream>
#include <string>
#include <utility>

namespace headway::replay {
namespace {

namespace fs = std::filesystem;

constexpr char kKittiTracks[] = "tracks_kitti.txt";

/// KITTI row of a track; the 2D box is -1 -1 -1 -1 if there is neither a detected box nor a camera.
io::KittiRow kittiRow(std::size_t frame, const Track& track, const Pose& T_sensor_map,
                      const StereoCamera* camera) {
  const Box3d box = opticalBox(track.position, track.size, track.yaw, T_sensor_map);
  io::KittiRow row;
  row.frame = frame;
  row.id = track.id.value;
  row.type = std::string(toString(track.object_class));
  row.truncation = -1;
  row.occlusion = -1;
  row.alpha = wrapAngle(box.yaw - std::atan2(box.centre.x(), box.centre.z()));
  row.height = box.height;
  row.width = box.width;
  row.length = box.length;
  row.bottom_centre = box.centre + Eigen::Vector3d(0, 0.5 * box.height, 0);
  row.rotation_y = box.yaw;
  row.score = track.score;
  auto box2d = track.box2d;
  if (!box2d && camera != nullptr) box2d = pipeline::projectedBox(box, *camera);
  row.box2d = box2d.value_or(Box2d{-1, -1, -1, -1});
  return row;
}

/// Track and place of the score in a row of a KITTI tracking result.
struct ScoredRow {
  explicit ScoredRow(const std::string& row) : score_at(row.rfind(' ') + 1) {
    std::istringstream fields(row);
    std::int64_t frame = 0;
    fields >> frame >> id;
  }
  std::int64_t id = -1;
  std::size_t score_at;
};

/// Replaces the score of every row of a KITTI tracking result by that of its track's last row,
/// because KITTI evaluates complete tracks; during the replay the file contains the current scores.
///
/// @throws InputError naming the file if it cannot be read or written
void rescoreKittiResults(const fs::path& file) {
  std::map<std::int64_t, std::string> scores;
  std::ifstream current(file);
  for (std::string row; std::getline(current, row);) {
    const ScoredRow scored(row);
    scores[scored.id] = row.substr(scored.score_at);
  }
  current.clear();
  current.seekg(0);
  OutputFile final_rows(file);
  for (std::string row; std::getline(current, row);) {
    const ScoredRow scored(row);
    final_rows.stream() << row.substr(0, scored.score_at) << scores[scored.id] << '\n';
  }
  final_rows.commit();
}

constexpr std::array<const char*, 6> kPoseAxes = {"x", "y", "z", "roll", "pitch", "yaw"};

/// The upper triangle of the covariance, row by row.
std::string covarianceHeader() {
  std::string header = "frame,time";
  for (std::size_t i = 0; i < kPoseAxes.size(); ++i) {
    for (std::size_t k = i; k < kPoseAxes.size(); ++k) {
      header += std::string(",") + kPoseAxes[i] + "_" + kPoseAxes[k];
    }
  }
  return header;
}

void writeCovariance(const pipeline::PerceptionUpdate& update, std::ostream& out) {
  std::ostringstream row;
  row << update.frame << ',' << std::fixed << std::setprecision(9) << update.time << std::scientific
      << std::setprecision(6);
  for (int i = 0; i < 6; ++i) {
    for (int k = i; k < 6; ++k) row << ',' << update.camera.covariance(i, k);
  }
  out << row.str() << '\n';
}

void moveTracks(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::trackCsvHeader() << '\n';
  io::visitTrackCsv(path, [&](TrackSample row) {
    // The file has no covariance of z, which must not become one of x and y.
    row.track.position_covariance.row(2).setZero();
    row.track.position_covariance.col(2).setZero();
    row.track = transformed(std::move(row.track), T_map_run);
    io::writeTrackCsv(file.stream(), row);
  });
  file.commit();
}

void moveMapOdom(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::mapOdomCsvHeader() << '\n';
  io::visitMapOdomCsv(path, [&](io::MapOdomRow row) {
    row.T_map_odom = normalized(Pose(T_map_run * row.T_map_odom));
    io::writeMapOdomCsv(file.stream(), row);
  });
  file.commit();
}

void movePredictions(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::predictionCsvHeader() << '\n';
  for (io::PredictionRow row : io::readPredictionCsv(path)) {
    Track track;
    track.predictions = {{row.mode, row.probability, {row.point}}};
    row.point = transformed(std::move(track), T_map_run).predictions.front().points.front();
    io::writePredictionCsv(file.stream(), row);
  }
  file.commit();
}

void writeContents(const fs::path& folder, CheckpointContents contents) {
  for (const auto& log : contents.logs) synchroniseFile(log);
  TrajectoryWriter writer(folder, contents.T_robot_cam);
  contents.trajectory([&](const slam::FrameEstimate& estimate) { writer.add(estimate); });
  writer.commit();
  map::writePly(folder / "map_points.ply", *contents.map.map.staticMap());
  map::saveMap(folder / "map.headway", std::move(contents.map));
  writeSummary(folder / "summary.json", contents.summary);
}

}  // namespace

FrameWriters::FrameWriters(const fs::path& folder)
    : folder_(folder),
      trajectory_(open("trajectory_online.tum")),
      odometry_(open("trajectory_odom.tum")),
      map_odom_(open("map_odom.csv", io::mapOdomCsvHeader())),
      covariance_(open("trajectory_covariance.csv", covarianceHeader())),
      detections_(open("detections.csv", io::detectionCsvHeader())),
      tracks_(open("tracks.csv", io::trackCsvHeader())),
      tracks_odom_(open("tracks_odom.csv", io::trackCsvHeader())),
      smoothed_(open("tracks_smoothed.csv", io::trackCsvHeader())),
      kitti_(open(kKittiTracks)),
      predictions_(open("predictions.csv", io::predictionCsvHeader())) {}

std::ostream& FrameWriters::open(const std::string& name, const std::string& header) {
  std::ostream& out = files_.try_emplace(name, folder_ / name).first->second.stream();
  if (!header.empty()) out << header << '\n';
  return out;
}

std::vector<fs::path> FrameWriters::paths() const {
  std::vector<fs::path> paths;
  for (const auto& [name, file] : files_) paths.push_back(folder_ / name);
  return paths;
}

void FrameWriters::write(const pipeline::PerceptionUpdate& update, const StereoCamera* camera) {
  const slam::SlamUpdate& pose = update.camera;
  if (slam::isTracked(pose.status)) {
    io::writeTumRow(trajectory_, {update.time, pose.T_map_robot});
    writeCovariance(update, covariance_);
  }
  io::writeTumRow(odometry_, {update.time, pose.T_odom_robot});
  io::writeMapOdomCsv(map_odom_, {update.frame, update.time, pose.T_map_odom, pose.revision.number,
                                  slam::toString(pose.revision.cause)});
  if (update.detections) {
    for (const auto& detection : update.detections->items) {
      if (!isFinite(detection)) continue;  // counted by the tracker as nan_box
      io::writeDetectionCsv(detections_, update.frame, detection);
    }
  }
  const Pose T_robot_sensor = update.detections   ? update.detections->T_robot_sensor
                              : camera != nullptr ? camera->T_robot_cam
                                                  : robotFromOptical();
  const Pose T_sensor_map = (pose.T_map_robot * T_robot_sensor).inverse();
  for (const auto& track : update.objects.tracks) {
    if (isShown(track)) writeTrack(update, track, T_sensor_map, camera);
  }
  for (const auto& track : update.tracks_odom) {
    if (isShown(track)) {
      io::writeTrackCsv(tracks_odom_, {update.frame, update.time, track});
    }
  }
  writeSmoothed(update.objects.finalised);
  for (auto& [name, file] : files_) file.endRows();
}

void FrameWriters::writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                              const Pose& T_sensor_map, const StereoCamera* camera) {
  io::writeTrackCsv(tracks_, {update.frame, update.time, track});
  io::writeKittiResult(kitti_, kittiRow(update.frame, track, T_sensor_map, camera));
  for (const auto& path : track.predictions) {
    for (const auto& point : path.points) {
      io::writePredictionCsv(predictions_, {update.frame, update.time, track.id, track.object_class,
                                            path.mode, path.probability, point});
    }
  }
}

void FrameWriters::writeSmoothed(const std::vector<TrackSample>& samples) {
  for (const auto& sample : samples) {
    if (isShown(sample.track)) io::writeTrackCsv(smoothed_, sample);
  }
}

void FrameWriters::finish() {
  std::exception_ptr failure;  // the first failure; the other files are ended nevertheless
  for (auto& [name, file] : files_) {
    try {
      file.close();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  rescoreKittiResults(folder_ / kKittiTracks);
}

TrajectoryWriter::TrajectoryWriter(const fs::path& folder, const Pose& T_robot_cam)
    : T_robot_cam_(T_robot_cam),
      tum_(folder / "trajectory.tum"),
      kitti_(folder / "trajectory_kitti.txt") {}

void TrajectoryWriter::add(const slam::FrameEstimate& estimate) {
  if (!first_frame_) first_frame_ = estimate.frame;
  if (estimate.tracked) {
    io::writeTumRow(tum_.stream(), {estimate.time, estimate.T_map_robot});
    if (!T_first_map_) T_first_map_ = (estimate.T_map_robot * T_robot_cam_).inverse();
  }
  if (!T_first_map_) return;
  for (; kitti_rows_ < estimate.frame - *first_frame_; ++kitti_rows_) {
    io::writeKittiPoseRow(kitti_.stream(), last_);
  }
  if (estimate.tracked) last_ = *T_first_map_ * estimate.T_map_robot * T_robot_cam_;
  io::writeKittiPoseRow(kitti_.stream(), last_);
  ++kitti_rows_;
}

void TrajectoryWriter::commit() {
  tum_.commit();
  kitti_.commit();
}

void moveOnlineResults(const fs::path& folder, const Pose& T_map_run) {
  auto path = io::readTum(folder / "trajectory_online.tum");
  for (auto& pose : path) pose.value = normalized(Pose(T_map_run * pose.value));
  io::writeTum(folder / "trajectory_online.tum", path);
  moveMapOdom(folder / "map_odom.csv", T_map_run);
  moveTracks(folder / "tracks.csv", T_map_run);
  moveTracks(folder / "tracks_smoothed.csv", T_map_run);
  movePredictions(folder / "predictions.csv", T_map_run);
}

void describeCheckpoints(double& interval_s, Params& params) {
  params.section("output").add(
      "checkpoint_s", interval_s, 0.0, 3600.0, "s",
      "Time between checkpoints of map and trajectory, which a killed run leaves; 0: none");
}

Checkpoint::Checkpoint(fs::path folder, double interval_s,
                       std::function<CheckpointContents()> collect,
                       std::function<void(const std::string&)> warn)
    : folder_(std::move(folder)),
      interval_(interval_s),
      collect_(std::move(collect)),
      warn_(std::move(warn)),
      last_(std::chrono::steady_clock::now()) {}

bool Checkpoint::isDue() const {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - last_;
  const bool is_early = elapsed < interval_ || elapsed < 50.0 * collecting_;
  if (interval_.count() <= 0.0 || is_early) return false;
  return !writing_.valid() || isReady(writing_);
}

void Checkpoint::onFrame(const run::FrameResult& /*result*/, pipeline::Perception& /*perception*/) {
  if (!isDue()) return;
  finish();
  const auto start = std::chrono::steady_clock::now();
  auto contents = collect_();
  last_ = std::chrono::steady_clock::now();
  collecting_ = last_ - start;
  writing_ = writer_.run([folder = folder_, what = std::move(contents)]() mutable {
    writeContents(folder, std::move(what));
  });
}

void Checkpoint::onEnd(const std::optional<std::string>& /*failure*/) { finish(); }

void Checkpoint::finish() {
  if (!writing_.valid()) return;
  try {
    writing_.get();
  } catch (const std::exception& error) {
    warn_(std::string("no checkpoint: ") + error.what());
  }
}

}  // namespace headway::replay
