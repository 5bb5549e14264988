// SPDX-License-Identifier: BSD-3-Clause
// Serialisation of poses, tracks, scans and views of the map in map files.
#include "stored_values.h"

#include <cstring>

namespace headway::map {
namespace {

constexpr double kMaxReachM = 300.0;  // of scans, which decides on the memory that maps take

void write(ByteWriter& out, const std::optional<Box2d>& box) {
  out.value(box.has_value());
  if (!box) return;
  for (const double edge : {box->left, box->top, box->right, box->bottom}) out.value(edge);
}

std::optional<Box2d> readBox2d(ByteReader& in) {
  if (in.value<std::uint8_t>() == 0) return std::nullopt;
  Box2d box;
  box.left = in.value<double>();
  box.top = in.value<double>();
  box.right = in.value<double>();
  box.bottom = in.value<double>();
  return box;
}

void write(ByteWriter& out, const TrajectoryPoint& point) {
  out.count(point.frame);
  out.value(point.time);
  out.matrix(point.position);
  out.value(point.yaw);
}

TrajectoryPoint readTrajectoryPoint(ByteReader& in) {
  TrajectoryPoint point;
  point.frame = in.value<std::uint64_t>();
  point.time = in.value<double>();
  point.position = in.matrix<Eigen::Vector3d>();
  point.yaw = in.value<double>();
  return point;
}

void write(ByteWriter& out, const PredictedPath& path) {
  out.value(static_cast<std::int32_t>(path.mode));
  out.value(path.probability);
  out.count(path.points.size());
  for (const auto& point : path.points) {
    out.value(point.horizon_s);
    out.matrix(point.position);
    out.matrix(point.covariance);
  }
}

PredictedPoint readPredictedPoint(ByteReader& in) {
  PredictedPoint point;
  point.horizon_s = in.value<double>();
  point.position = in.matrix<Eigen::Vector3d>();
  point.covariance = in.matrix<Eigen::Matrix2d>();
  return point;
}

PredictedPath readPredictedPath(ByteReader& in) {
  PredictedPath path;
  path.mode = in.value<std::int32_t>();
  path.probability = in.value<double>();
  path.points = in.list<PredictedPoint>(readPredictedPoint);
  return path;
}

void write(ByteWriter& out, const slam::LandmarkView& landmark) {
  out.value(landmark.id.value);
  out.matrix(landmark.position);
  out.value(static_cast<std::int32_t>(landmark.observations));
  out.value(landmark.intensity);
}

slam::LandmarkView readLandmark(ByteReader& in) {
  slam::LandmarkView landmark;
  landmark.id.value = in.value<std::int64_t>();
  landmark.position = in.matrix<Eigen::Vector3d>();
  landmark.observations = in.value<std::int32_t>();
  landmark.intensity = in.value<std::uint8_t>();
  return landmark;
}

void write(ByteWriter& out, const slam::KeyframeView& keyframe) {
  out.value(keyframe.id.value);
  out.count(keyframe.frame);
  out.value(keyframe.time);
  map::write(out, keyframe.T_map_robot);
  out.matrix(keyframe.covariance);
  out.count(keyframe.landmarks.size());
  for (const auto id : keyframe.landmarks) out.value(id.value);
}

slam::KeyframeView readKeyframe(ByteReader& in) {
  slam::KeyframeView keyframe;
  keyframe.id.value = in.value<std::int64_t>();
  keyframe.frame = in.value<std::uint64_t>();
  keyframe.time = in.value<double>();
  keyframe.T_map_robot = readPose(in);
  keyframe.covariance = in.matrix<PoseCovariance>();
  keyframe.landmarks = in.list<LandmarkId>(
      [](ByteReader& archive) { return LandmarkId{archive.value<std::int64_t>()}; });
  return keyframe;
}

void write(ByteWriter& out, const Eigen::Vector3f& place) { out.matrix(place); }

/// Of a ground scan.
Eigen::Vector3f readPlace(ByteReader& in) {
  const auto place = in.finiteMatrix<Eigen::Vector3f>();
  if (place.cwiseAbs().maxCoeff() > kMaxReachM) {
    throw InputError("damaged: a ground scan reaches farther than any sensor");
  }
  return place;
}

}  // namespace

void write(ByteWriter& out, const Pose& pose) { out.matrix(pose.matrix().topRows<3>()); }

Pose readPose(ByteReader& in) {
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = in.matrix<Eigen::Matrix<double, 3, 4>>();
  return pose;
}

void write(ByteWriter& out, const Track& track) {
  out.value(track.id.value);
  out.value(static_cast<std::uint8_t>(track.object_class));
  out.value(static_cast<std::uint8_t>(track.status));
  out.value(static_cast<std::uint8_t>(track.motion_state));
  out.value(track.score);
  out.matrix(track.position);
  out.matrix(track.velocity);
  out.value(track.yaw);
  out.value(track.yaw_rate);
  out.matrix(track.size);
  out.matrix(track.position_covariance);
  write(out, track.box2d);
  out.value(track.first_seen);
  out.value(track.last_seen);
  out.count(track.recent_path.size());
  for (const auto& point : track.recent_path) write(out, point);
  out.count(track.predictions.size());
  for (const auto& path : track.predictions) write(out, path);
}

Track readTrack(ByteReader& in) {
  Track track;
  track.id.value = in.value<std::int64_t>();
  track.object_class = in.enumerator<ObjectClass>(kObjectClassCount);
  track.status = in.enumerator<TrackStatus>(static_cast<int>(TrackStatus::kEnded) + 1);
  track.motion_state = in.enumerator<MotionState>(static_cast<int>(MotionState::kStatic) + 1);
  track.score = in.value<double>();
  track.position = in.matrix<Eigen::Vector3d>();
  track.velocity = in.matrix<Eigen::Vector3d>();
  track.yaw = in.value<double>();
  track.yaw_rate = in.value<double>();
  track.size = in.matrix<Eigen::Vector3d>();
  track.position_covariance = in.matrix<Eigen::Matrix3d>();
  track.box2d = readBox2d(in);
  track.first_seen = in.value<double>();
  track.last_seen = in.value<double>();
  track.recent_path = in.list<TrajectoryPoint>(readTrajectoryPoint);
  track.predictions = in.list<PredictedPath>(readPredictedPath);
  return track;
}

void write(ByteWriter& out, const StereoCamera& camera) {
  out.value(static_cast<std::int32_t>(camera.width));
  out.value(static_cast<std::int32_t>(camera.height));
  out.value(camera.fx);
  out.value(camera.fy);
  out.value(camera.cx);
  out.value(camera.cy);
  out.value(camera.baseline_m);
  write(out, camera.T_robot_cam);
}

StereoCamera readCamera(ByteReader& in) {
  StereoCamera camera;
  camera.width = in.value<std::int32_t>();
  camera.height = in.value<std::int32_t>();
  camera.fx = in.value<double>();
  camera.fy = in.value<double>();
  camera.cx = in.value<double>();
  camera.cy = in.value<double>();
  camera.baseline_m = in.value<double>();
  camera.T_robot_cam = readPose(in);
  return camera;
}

void write(ByteWriter& out, const slam::MapView& static_map) {
  out.count(static_map.landmarks.size());
  for (const auto& landmark : static_map.landmarks) write(out, landmark);
  out.count(static_map.keyframes.size());
  for (const auto& keyframe : static_map.keyframes) write(out, keyframe);
}

slam::MapView readMapView(ByteReader& in) {
  slam::MapView static_map;
  static_map.landmarks = in.list<slam::LandmarkView>(readLandmark);
  static_map.keyframes = in.list<slam::KeyframeView>(readKeyframe);
  return static_map;
}

namespace {

void write(ByteWriter& out, const std::vector<GroundScan::Free>& pieces) {
  out.count(pieces.size());
  for (const auto& piece : pieces) {
    write(out, piece.from);
    write(out, piece.to);
  }
}

void write(ByteWriter& out, const std::vector<GroundScan::Obstacle>& obstacles) {
  out.count(obstacles.size());
  for (const auto& obstacle : obstacles) {
    write(out, obstacle.foot);
    out.value(obstacle.sigma_m);
  }
}

std::vector<GroundScan::Free> readSegments(ByteReader& in) {
  return in.list<GroundScan::Free>([](ByteReader& archive) {
    const Eigen::Vector3f from = readPlace(archive);
    return GroundScan::Free{from, readPlace(archive)};
  });
}

std::vector<GroundScan::Obstacle> readObstacles(ByteReader& in) {
  return in.list<GroundScan::Obstacle>([](ByteReader& archive) {
    const Eigen::Vector3f foot = readPlace(archive);
    const auto sigma_m = archive.finiteValue<float>();
    if (!(sigma_m > 0.0F)) throw InputError("damaged: an obstacle has no positive sigma");
    return GroundScan::Obstacle{foot, sigma_m};
  });
}

}  // namespace

void write(ByteWriter& out, const GroundScan& scan, bool with_laser) {
  write(out, scan.free);
  write(out, scan.obstacles);
  if (!with_laser) return;
  write(out, scan.laser_obstacles);
  write(out, scan.laser_passed);
}

GroundScan readGroundScan(ByteReader& in, bool with_laser) {
  GroundScan scan;
  scan.free = readSegments(in);
  scan.obstacles = readObstacles(in);
  if (!with_laser) return scan;
  scan.laser_obstacles = readObstacles(in);
  scan.laser_passed = readSegments(in);
  return scan;
}

namespace {

template <typename Item>
void writeItems(ByteWriter& out, const std::vector<Item>& items) {
  out.bytes.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
}

template <typename Item>
std::vector<Item> readItems(ByteReader& in, std::size_t count) {
  const auto bytes = in.take(count * sizeof(Item));
  std::vector<Item> items(count);
  if (count > 0) std::memcpy(items.data(), bytes.data(), bytes.size());
  return items;
}

void write(ByteWriter& out, const DepthScanGrid& grid) {
  out.value(grid.columns);
  out.value(grid.rows);
  for (const double value : {grid.u0, grid.v0, grid.step_u, grid.step_v, grid.fx, grid.fy, grid.cx,
                             grid.cy, grid.focal_baseline, grid.sigma_disparity_px}) {
    out.value(value);
  }
  map::write(out, grid.T_robot_cam);
}

DepthScanGrid readGrid(ByteReader& in) {
  DepthScanGrid grid;
  grid.columns = in.value<std::int32_t>();
  grid.rows = in.value<std::int32_t>();
  for (double* value : {&grid.u0, &grid.v0, &grid.step_u, &grid.step_v, &grid.fx, &grid.fy,
                        &grid.cx, &grid.cy, &grid.focal_baseline, &grid.sigma_disparity_px}) {
    *value = in.finiteValue<double>();
  }
  grid.T_robot_cam = readPose(in);
  constexpr std::int32_t kMaxSide = 1 << 14;  // so that its cells can be counted
  const bool has_size =
      grid.columns > 0 && grid.rows > 0 && grid.columns <= kMaxSide && grid.rows <= kMaxSide;
  const bool has_camera = grid.step_u > 0.0 && grid.step_v > 0.0 && grid.fx > 0.0 &&
                          grid.fy > 0.0 && grid.focal_baseline > 0.0 &&
                          grid.sigma_disparity_px > 0.0 && grid.T_robot_cam.matrix().allFinite();
  if (!has_size || !has_camera) throw InputError("damaged: a depth scan has no camera");
  return grid;
}

std::size_t countKnown(const DepthScan& scan) {
  std::size_t known = 0;
  for (std::size_t cell = 0; cell < scan.grid.cells(); ++cell) known += scan.isKnown(cell) ? 1 : 0;
  return known;
}

/// Refuses what would take any amount of memory: its points lie farther away than a camera sees.
void requireWithinReach(const DepthScan& scan) {
  for (const auto disparity : scan.disparity) {
    const double depth = scan.grid.focal_baseline * DepthScan::kUnitsPerPx / disparity;
    if (disparity == 0 || !(depth < kMaxReachM)) {
      throw InputError("damaged: a depth scan reaches farther than any camera");
    }
  }
}

}  // namespace

void write(ByteWriter& out, const DepthScan& scan) {
  write(out, scan.grid);
  out.value(static_cast<std::uint8_t>(scan.hasColour() ? 3 : 1));
  writeItems(out, scan.known);
  writeItems(out, scan.disparity);
  writeItems(out, scan.colour);
}

DepthScan readDepthScan(ByteReader& in) {
  DepthScan scan;
  scan.grid = readGrid(in);
  const std::size_t channels = in.value<std::uint8_t>();
  if (channels != 1 && channels != 3) throw InputError("damaged: a depth scan has no colours");
  scan.known = readItems<std::uint8_t>(in, (scan.grid.cells() + 7) / 8);
  const std::size_t count = countKnown(scan);
  if (count == 0) throw InputError("damaged: a depth scan has no depths");
  scan.disparity = readItems<std::uint16_t>(in, count);
  scan.colour = readItems<std::uint8_t>(in, channels * count);
  requireWithinReach(scan);
  return scan;
}

}  // namespace headway::map
