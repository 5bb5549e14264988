// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of the moving objects of a replay's folder.
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/moving_object_error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/track_geometry.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "evaluation_inputs.h"

namespace headway::eval {
namespace {

namespace fs = std::filesystem;

constexpr double kNearestDepth_m = 0.1;  // corners of boxes nearer than this are not projected

/// Image box of a track's 3D box; nullopt if its centre is behind the camera.
std::optional<Box2d> imageBox(const Track& track, const Pose& T_cam_map, const StereoCamera& lens) {
  if ((T_cam_map * track.position).z() < kNearestDepth_m) return std::nullopt;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& corner : map::boxCorners(track)) {
    const Eigen::Vector3d point = T_cam_map * corner;
    if (point.z() >= kNearestDepth_m) box.extend(project(point, lens)->head<2>());
  }
  return Box2d{box.min().x(), box.min().y(), box.max().x(), box.max().y()};
}

/// Adds the rows of a tracks file, and the camera poses of their frames.
void readRows(const fs::path& replay, const std::string& file, MovingObjectInput& input) {
  const auto calibration = io::readCalibration((replay / "calibration.yaml").string());
  const std::string online = (replay / "trajectory_online.tum").string();
  const auto trajectory = io::readTum(online);
  input.image_width = calibration.width;
  input.image_height = calibration.height;
  for (const auto& sample : io::readTrackCsv((replay / file).string())) {
    const auto& track = sample.track;
    const Pose* T_map_robot = poseAt(trajectory, sample.time);
    if (T_map_robot == nullptr) {
      throw InputError(online + ": contains no pose of time " + std::to_string(sample.time) +
                       ", at which there are tracks");
    }
    const Pose T_map_cam = *T_map_robot * calibration.T_robot_cam;
    input.T_map_cam[sample.frame] = T_map_cam;
    TrackRow row;
    row.frame = sample.frame;
    row.id = track.id.value;
    row.object_class = track.object_class;
    row.moving = isMoving(track);
    row.coasting = track.status == TrackStatus::kCoasting;
    row.centre = T_map_cam.inverse() * track.position;
    row.box2d = imageBox(track, T_map_cam.inverse(), calibration);
    row.T_map_object.linear() =
        Eigen::AngleAxisd(track.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    row.T_map_object.translation() = track.position;
    row.velocity = track.velocity;
    input.rows.push_back(row);
  }
}

/// Times of frames whose poses have none: those of the replay, if it tracked every frame.
void setTimes(const fs::path& replay, MovingObjectInput& input) {
  const auto trajectory = io::readTum((replay / "trajectory_online.tum").string());
  const std::size_t frames = input.end_frame - input.first_frame;
  if (trajectory.size() != frames || frames == 0) return;
  for (std::size_t k = 0; k < input.T_world_cam.size(); ++k) {
    const auto offset = static_cast<double>(k) - static_cast<double>(input.first_frame);
    if (k >= input.first_frame && k < input.end_frame) {
      input.T_world_cam[k].time = trajectory[k - input.first_frame].time;
    } else if (k < input.first_frame) {
      input.T_world_cam[k].time = trajectory.front().time + kNominalFrameInterval_s * offset;
    } else {
      input.T_world_cam[k].time =
          trajectory.back().time +
          kNominalFrameInterval_s * (offset - static_cast<double>(frames) + 1.0);
    }
  }
}

void readTruePoses(const std::string& path, const fs::path& replay, const Pose& T_robot_cam,
                   MovingObjectInput& input) {
  if (io::hasRawlogName(path)) {
    input.T_world_cam = io::readTruth(path).poses;
    for (auto& pose : input.T_world_cam) pose.value = pose.value * T_robot_cam;
    if (input.T_world_cam.empty()) throw InputError(path + ": contains no true poses");
    return;
  }
  input.T_world_cam = readCameraPoses(path, T_robot_cam);
  if (poseFormatOf(path) == PoseFormat::kKitti) setTimes(replay, input);
}

/// Reads labels, true poses and the output folder of a replay.
///
/// The evaluated frames are those of the replay. True poses are a rawlog's `truth_pose`, or one row
/// per frame: KITTI (camera) or TUM (robot).
///
/// @throws InputError naming the file that cannot be read or does not match the others
MovingObjectInput readMoversInput(const std::string& labels, const std::string& poses,
                                  const std::string& replay) {
  MovingObjectInput input;
  const fs::path folder = replay;
  input.labels = readLabels(labels);
  input.first_frame = firstFrame(replayRecord(folder));
  input.end_frame =
      input.first_frame + io::readKittiPoses((folder / "trajectory_kitti.txt").string()).size();
  const auto calibration = io::readCalibration((folder / "calibration.yaml").string());
  readTruePoses(poses, folder, calibration.T_robot_cam, input);
  readRows(folder, "tracks.csv", input);
  return input;
}

/// The input's rows replaced by those of `tracks_smoothed.csv`.
///
/// @throws InputError if the file cannot be read
MovingObjectInput withSmoothedRows(const MovingObjectInput& input, const std::string& replay) {
  auto smoothed = input;
  smoothed.rows.clear();
  readRows(replay, "tracks_smoothed.csv", smoothed);
  return smoothed;
}

}  // namespace

MoverEvaluation evaluateMovers(const std::string& labels, const std::string& poses,
                               const std::string& replay) {
  MoverEvaluation evaluation;
  evaluation.input = readMoversInput(labels, poses, replay);
  const auto& input = evaluation.input;
  MovingObjectParams params;
  evaluation.error = movingObjectError(input, params);
  evaluation.labelled = labelledObjectError(input, params);
  params.with_coasting = true;
  evaluation.with_coasting = movingObjectError(input, params);
  const auto& matches = evaluation.error.matches;
  evaluation.motion = objectMotionErrors(input, matches, ObjectMotion::kPoses);
  evaluation.motion_velocity = objectMotionErrors(input, matches, ObjectMotion::kVelocity);
  evaluation.motion_smoothed =
      objectMotionErrors(withSmoothedRows(input, replay), matches, ObjectMotion::kPoses);
  return evaluation;
}

nlohmann::ordered_json toJson(const MoverEvaluation& evaluation) {
  auto json = toJson(evaluation.error);
  json["with_coasting"] = toJson(evaluation.with_coasting);
  json["labelled"] = toJson(evaluation.labelled);
  json["motion"] = toJson(evaluation.motion);
  json["motion_velocity"] = toJson(evaluation.motion_velocity);
  json["motion_smoothed"] = toJson(evaluation.motion_smoothed);
  return json;
}

}  // namespace headway::eval
