#include "frame_writers.h"

#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/pipeline/moving_regions.h>

#include <array>
#include <cmath>
#include <exception>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

namespace headway::replay {
namespace {

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

/// Replaces the score of every row of a KITTI tracking result by the final score of its track,
/// because KITTI evaluates complete tracks; during the replay the file contains the current scores.
///
/// @param scores  track id -> score; rows of other tracks are not changed
/// @throws InputError naming the file if it cannot be read or written
void rescoreKittiResults(const std::filesystem::path& file,
                         const std::map<std::int64_t, double>& scores) {
  std::ifstream old_rows(file);
  OutputFile new_rows(file);
  new_rows.stream() << std::fixed << std::setprecision(6);
  for (std::string row; std::getline(old_rows, row);) {
    std::istringstream fields(row);
    std::int64_t frame = 0;
    std::int64_t id = 0;
    fields >> frame >> id;
    const auto score = scores.find(id);
    if (score == scores.end()) {
      new_rows.stream() << row << '\n';
    } else {
      new_rows.stream() << row.substr(0, row.rfind(' ') + 1) << score->second << '\n';
    }
  }
  new_rows.commit();
}

constexpr std::array<const char*, 6> kPoseAxes = {"x", "y", "z", "roll", "pitch", "yaw"};

/// The upper triangle of the covariance, row by row.
void writeCovarianceHeader(std::ostream& out) {
  out << "frame,time";
  for (std::size_t i = 0; i < kPoseAxes.size(); ++i) {
    for (std::size_t k = i; k < kPoseAxes.size(); ++k) {
      out << ',' << kPoseAxes[i] << '_' << kPoseAxes[k];
    }
  }
  out << '\n';
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

}  // namespace

FrameWriters::FrameWriters(const std::filesystem::path& folder,
                           std::shared_ptr<const StereoCamera> camera)
    : camera_(std::move(camera)),
      trajectory_(folder / "trajectory_online.tum"),
      covariance_(folder / "trajectory_covariance.csv"),
      detections_(folder / "detections.csv"),
      tracks_(folder / "tracks.csv"),
      smoothed_(folder / "tracks_smoothed.csv"),
      kitti_path_(folder / "tracks_kitti.txt"),
      kitti_(kitti_path_),
      predictions_(folder / "predictions.csv") {
  writeCovarianceHeader(covariance_.stream());
  detections_.stream() << io::detectionCsvHeader() << '\n';
  tracks_.stream() << io::trackCsvHeader() << '\n';
  smoothed_.stream() << io::trackCsvHeader() << '\n';
  predictions_.stream() << io::predictionCsvHeader() << '\n';
}

void FrameWriters::write(const pipeline::PerceptionUpdate& update) {
  if (update.camera.status == slam::TrackingStatus::kTracked) {
    io::writeTumRow(trajectory_.stream(), {update.time, update.camera.T_map_robot});
    writeCovariance(update, covariance_.stream());
  }
  if (update.detections) {
    for (const auto& detection : update.detections->items) {
      io::writeDetectionCsv(detections_.stream(), update.frame, detection);
    }
  }
  const Pose T_robot_sensor = update.detections    ? update.detections->T_robot_sensor
                              : camera_ != nullptr ? camera_->T_robot_cam
                                                   : robotFromOptical();
  const Pose T_sensor_map = (update.camera.T_map_robot * T_robot_sensor).inverse();
  for (const auto& track : update.objects.tracks) {
    if (isShown(track)) writeTrack(update, track, T_sensor_map);
  }
  writeSmoothed(update.objects.finalised);
  for (auto* file :
       {&trajectory_, &covariance_, &detections_, &tracks_, &smoothed_, &kitti_, &predictions_}) {
    file->endRows();
  }
}

void FrameWriters::writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                              const Pose& T_sensor_map) {
  io::writeTrackCsv(tracks_.stream(), {update.frame, update.time, track});
  io::writeKittiResult(kitti_.stream(), kittiRow(update.frame, track, T_sensor_map, camera_.get()));
  scores_[track.id.value] = track.score;
  for (const auto& path : track.predictions) {
    for (const auto& point : path.points) {
      io::writePredictionCsv(predictions_.stream(),
                             {update.frame, update.time, track.id, track.object_class, path.mode,
                              path.probability, point});
    }
  }
}

void FrameWriters::writeSmoothed(const std::vector<TrackSample>& samples) {
  for (const auto& sample : samples) {
    if (isShown(sample.track)) io::writeTrackCsv(smoothed_.stream(), sample);
  }
}

void FrameWriters::finish() {
  std::exception_ptr failure;  // the first failure; the other files are ended nevertheless
  for (auto* file :
       {&trajectory_, &covariance_, &detections_, &tracks_, &smoothed_, &kitti_, &predictions_}) {
    try {
      file->close();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  rescoreKittiResults(kitti_path_, scores_);
}

void writeTrajectories(const std::filesystem::path& folder,
                       const std::vector<slam::FrameEstimate>& trajectory,
                       const Pose& T_robot_cam) {
  std::vector<Stamped<Pose>> tracked;
  for (const auto& estimate : trajectory) {
    if (estimate.tracked) tracked.push_back({estimate.time, estimate.T_map_robot});
  }
  io::writeTum(folder / "trajectory.tum", tracked);

  std::vector<Pose> camera_poses;
  if (!tracked.empty()) {
    const Pose T_first_map = (tracked.front().value * T_robot_cam).inverse();
    Pose last = Pose::Identity();
    for (const auto& estimate : trajectory) {
      const std::size_t row = estimate.frame - trajectory.front().frame;
      while (camera_poses.size() < row) camera_poses.push_back(last);
      if (estimate.tracked) last = T_first_map * estimate.T_map_robot * T_robot_cam;
      camera_poses.push_back(last);
    }
  }
  io::writeKittiPoses(folder / "trajectory_kitti.txt", camera_poses);
}

}  // namespace headway::replay
