#include "stored_values.h"

#include <stdexcept>

namespace headway::map {
namespace {

using mrpt::serialization::CArchive;

template <typename Derived>
void writeMatrix(CArchive& out, const Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) out << matrix(row, column);
  }
}

template <typename Matrix>
Matrix readMatrix(CArchive& in) {
  Matrix matrix;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) in >> matrix(row, column);
  }
  return matrix;
}

void writeCount(CArchive& out, std::size_t count) { out << static_cast<std::uint64_t>(count); }

/// Lists are read one by one and not reserved, so that a wrong count ends at the archive's end.
template <typename Item, typename Read>
std::vector<Item> readList(CArchive& in, const Read& read) {
  const auto count = in.ReadAs<std::uint64_t>();
  std::vector<Item> items;
  for (std::uint64_t i = 0; i < count; ++i) items.push_back(read(in));
  return items;
}

template <typename Enum>
Enum readEnum(CArchive& in, int count) {
  const auto value = in.ReadAs<std::uint8_t>();
  if (value >= count) throw std::runtime_error("value of an enumeration that does not exist");
  return static_cast<Enum>(value);
}

void write(CArchive& out, const std::optional<Box2d>& box) {
  out << box.has_value();
  if (box) out << box->left << box->top << box->right << box->bottom;
}

std::optional<Box2d> readBox2d(CArchive& in) {
  if (!in.ReadAs<bool>()) return std::nullopt;
  Box2d box;
  in >> box.left >> box.top >> box.right >> box.bottom;
  return box;
}

void write(CArchive& out, const TrajectoryPoint& point) {
  writeCount(out, point.frame);
  out << point.time;
  writeMatrix(out, point.position);
  out << point.yaw;
}

TrajectoryPoint readTrajectoryPoint(CArchive& in) {
  TrajectoryPoint point;
  point.frame = in.ReadAs<std::uint64_t>();
  in >> point.time;
  point.position = readMatrix<Eigen::Vector3d>(in);
  in >> point.yaw;
  return point;
}

void write(CArchive& out, const PredictedPath& path) {
  out << static_cast<std::int32_t>(path.mode) << path.probability;
  writeCount(out, path.points.size());
  for (const auto& point : path.points) {
    out << point.horizon_s;
    writeMatrix(out, point.position);
    writeMatrix(out, point.covariance);
  }
}

PredictedPoint readPredictedPoint(CArchive& in) {
  PredictedPoint point;
  in >> point.horizon_s;
  point.position = readMatrix<Eigen::Vector3d>(in);
  point.covariance = readMatrix<Eigen::Matrix2d>(in);
  return point;
}

PredictedPath readPredictedPath(CArchive& in) {
  PredictedPath path;
  path.mode = in.ReadAs<std::int32_t>();
  in >> path.probability;
  path.points = readList<PredictedPoint>(in, readPredictedPoint);
  return path;
}

void write(CArchive& out, const slam::LandmarkView& landmark) {
  out << landmark.id.value;
  writeMatrix(out, landmark.position);
  out << static_cast<std::int32_t>(landmark.observations) << landmark.intensity;
}

slam::LandmarkView readLandmark(CArchive& in) {
  slam::LandmarkView landmark;
  in >> landmark.id.value;
  landmark.position = readMatrix<Eigen::Vector3d>(in);
  landmark.observations = in.ReadAs<std::int32_t>();
  in >> landmark.intensity;
  return landmark;
}

void write(CArchive& out, const slam::KeyframeView& keyframe) {
  out << keyframe.id.value;
  writeCount(out, keyframe.frame);
  out << keyframe.time;
  map::write(out, keyframe.T_map_robot);
  writeMatrix(out, keyframe.covariance);
  writeCount(out, keyframe.landmarks.size());
  for (const auto id : keyframe.landmarks) out << id.value;
}

slam::KeyframeView readKeyframe(CArchive& in) {
  slam::KeyframeView keyframe;
  in >> keyframe.id.value;
  keyframe.frame = in.ReadAs<std::uint64_t>();
  in >> keyframe.time;
  keyframe.T_map_robot = readPose(in);
  keyframe.covariance = readMatrix<PoseCovariance>(in);
  keyframe.landmarks = readList<LandmarkId>(
      in, [](CArchive& archive) { return LandmarkId{archive.ReadAs<std::int64_t>()}; });
  return keyframe;
}

void write(CArchive& out, const Eigen::Vector3f& place) { writeMatrix(out, place); }

Eigen::Vector3f readPlace(CArchive& in) {
  const auto place = readMatrix<Eigen::Vector3f>(in);
  if (!place.allFinite()) throw std::runtime_error("a place that is not a number");
  return place;
}

}  // namespace

void write(CArchive& out, const Pose& pose) { writeMatrix(out, pose.matrix().topRows<3>()); }

Pose readPose(CArchive& in) {
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = readMatrix<Eigen::Matrix<double, 3, 4>>(in);
  return pose;
}

void write(CArchive& out, const Track& track) {
  out << track.id.value << static_cast<std::uint8_t>(track.object_class)
      << static_cast<std::uint8_t>(track.status) << isMoving(track) << track.score;
  writeMatrix(out, track.position);
  writeMatrix(out, track.velocity);
  out << track.yaw << track.yaw_rate;
  writeMatrix(out, track.size);
  writeMatrix(out, track.position_covariance);
  write(out, track.box2d);
  out << track.first_seen << track.last_seen;
  writeCount(out, track.recent_path.size());
  for (const auto& point : track.recent_path) write(out, point);
  writeCount(out, track.predictions.size());
  for (const auto& path : track.predictions) write(out, path);
}

Track readTrack(CArchive& in) {
  Track track;
  in >> track.id.value;
  track.object_class = readEnum<ObjectClass>(in, kObjectClassCount);
  track.status = readEnum<TrackStatus>(in, static_cast<int>(TrackStatus::kEnded) + 1);
  bool moving = false;
  in >> moving >> track.score;
  track.motion_state = moving ? MotionState::kMoving : MotionState::kUnknown;
  track.position = readMatrix<Eigen::Vector3d>(in);
  track.velocity = readMatrix<Eigen::Vector3d>(in);
  in >> track.yaw >> track.yaw_rate;
  track.size = readMatrix<Eigen::Vector3d>(in);
  track.position_covariance = readMatrix<Eigen::Matrix3d>(in);
  track.box2d = readBox2d(in);
  in >> track.first_seen >> track.last_seen;
  track.recent_path = readList<TrajectoryPoint>(in, readTrajectoryPoint);
  track.predictions = readList<PredictedPath>(in, readPredictedPath);
  return track;
}

void write(CArchive& out, const StereoCamera& camera) {
  out << static_cast<std::int32_t>(camera.width) << static_cast<std::int32_t>(camera.height)
      << camera.fx << camera.fy << camera.cx << camera.cy << camera.baseline_m;
  write(out, camera.T_robot_cam);
}

StereoCamera readCamera(CArchive& in) {
  StereoCamera camera;
  camera.width = in.ReadAs<std::int32_t>();
  camera.height = in.ReadAs<std::int32_t>();
  in >> camera.fx >> camera.fy >> camera.cx >> camera.cy >> camera.baseline_m;
  camera.T_robot_cam = readPose(in);
  return camera;
}

void write(CArchive& out, const slam::MapView& still_world) {
  writeCount(out, still_world.landmarks.size());
  for (const auto& landmark : still_world.landmarks) write(out, landmark);
  writeCount(out, still_world.keyframes.size());
  for (const auto& keyframe : still_world.keyframes) write(out, keyframe);
}

slam::MapView readMapView(CArchive& in) {
  slam::MapView still_world;
  still_world.landmarks = readList<slam::LandmarkView>(in, readLandmark);
  still_world.keyframes = readList<slam::KeyframeView>(in, readKeyframe);
  return still_world;
}

void write(CArchive& out, const GroundScan& scan) {
  writeCount(out, scan.free.size());
  for (const auto& piece : scan.free) {
    write(out, piece.from);
    write(out, piece.to);
  }
  writeCount(out, scan.obstacles.size());
  for (const auto& obstacle : scan.obstacles) {
    write(out, obstacle.foot);
    out << obstacle.sigma_m;
  }
}

GroundScan readGroundScan(CArchive& in) {
  GroundScan scan;
  scan.free = readList<GroundScan::Free>(in, [](CArchive& archive) {
    const Eigen::Vector3f from = readPlace(archive);
    return GroundScan::Free{from, readPlace(archive)};
  });
  scan.obstacles = readList<GroundScan::Obstacle>(in, [](CArchive& archive) {
    const Eigen::Vector3f foot = readPlace(archive);
    return GroundScan::Obstacle{foot, archive.ReadAs<float>()};
  });
  return scan;
}

}  // namespace headway::map
