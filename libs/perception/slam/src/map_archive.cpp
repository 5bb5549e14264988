// SPDX-License-Identifier: BSD-3-Clause
// The map as it leaves SLAM: as bytes, cropped, and as a view.
#include "map_archive.h"

#include <headway/core/byte_archive.h>
#include <headway/core/error.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/map_view.h>

#include <cstdio>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "motion_model.h"

namespace headway::slam {
namespace {

constexpr std::uint32_t kMagic = 0x4d535748;  ///< "HWSM"
enum Version : std::uint32_t {
  kVersionWithoutTurn = 2,  ///< of the right camera; nor with submaps
  kVersionWithoutSubmaps = 3,
  kVersion = 4,
};
constexpr std::int32_t kMaxSubmap = 1 << 20;

constexpr double kMaxRightTurn = 0.1;  ///< [rad]

void write(ByteWriter& out, const StereoCamera& camera) {
  out.value<std::int32_t>(camera.width);
  out.value<std::int32_t>(camera.height);
  for (const double x : {camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline_m}) {
    out.value(x);
  }
}

StereoCamera readCamera(ByteReader& in) {
  StereoCamera camera;
  camera.width = in.value<std::int32_t>();
  camera.height = in.value<std::int32_t>();
  for (double* x : {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &camera.baseline_m}) {
    *x = in.finiteValue<double>();
  }
  return camera;
}

void write(ByteWriter& out, const Keyframe& keyframe) {
  out.value(keyframe.id.value);
  out.value<std::uint64_t>(keyframe.frame);
  out.value(keyframe.time);
  out.matrix(keyframe.T_map_cam.matrix());
  out.matrix(keyframe.covariance);
  out.value<std::int32_t>(keyframe.submap);
}

Keyframe readKeyframe(ByteReader& in, std::uint32_t version) {
  Keyframe keyframe;
  keyframe.id.value = in.value<std::int64_t>();
  keyframe.frame = in.value<std::uint64_t>();
  keyframe.time = in.finiteValue<double>();
  keyframe.T_map_cam.matrix() = in.finiteMatrix<Eigen::Matrix4d>();
  keyframe.covariance = in.finiteMatrix<PoseCovariance>();
  if (version > kVersionWithoutSubmaps) keyframe.submap = in.value<std::int32_t>();
  if (keyframe.submap < 0 || keyframe.submap > kMaxSubmap) {
    throw InputError("damaged: a keyframe has no valid submap");
  }
  return keyframe;
}

void write(ByteWriter& out, const LandmarkObservation& observation) {
  const stereo::StereoMeasurement& measurement = observation.measurement;
  out.value(observation.keyframe.value);
  out.matrix(measurement.uv);
  out.value(measurement.disparity);
  out.value<std::uint8_t>(measurement.stereo ? 1 : 0);
  out.value(measurement.sigma_px);
  out.value(measurement.sigma_disparity_px);
}

LandmarkObservation readObservation(ByteReader& in) {
  LandmarkObservation observation;
  stereo::StereoMeasurement& measurement = observation.measurement;
  observation.keyframe.value = in.value<std::int64_t>();
  measurement.uv = in.finiteMatrix<Eigen::Vector2d>();
  measurement.disparity = in.finiteValue<double>();
  measurement.stereo = in.value<std::uint8_t>() != 0;
  measurement.sigma_px = in.finiteValue<double>();
  measurement.sigma_disparity_px = in.finiteValue<double>();
  if (!(measurement.sigma_px > 0.0) || !(measurement.sigma_disparity_px > 0.0)) {
    throw InputError("damaged: a measurement has no positive sigma");
  }
  return observation;
}

/// Bytes with gaps for the patches of landmarks.
struct PackedMap {
  struct Gap {
    std::size_t at = 0;  ///< in the bytes
    std::shared_ptr<const stereo::ReferencePatch> patch;
  };
  ByteWriter out;
  std::vector<Gap> gaps;  ///< in order

  void writeTo(const ByteSink& sink) const {
    const std::string_view bytes = out.bytes;
    std::size_t written = 0;
    for (const auto& [at, patch] : gaps) {
      sink(bytes.substr(written, at - written));
      sink({reinterpret_cast<const char*>(patch->pixels.data()), patch->pixels.size()});
      written = at;
    }
    sink(bytes.substr(written));
  }
};

void write(PackedMap& packed, const Landmark& landmark) {
  ByteWriter& out = packed.out;
  out.value(landmark.id.value);
  out.matrix(landmark.position);
  out.value(landmark.reference.value);
  out.value<std::int32_t>(landmark.reference_level);
  out.matrix(landmark.T_reference_cut.matrix());
  packed.gaps.push_back({out.bytes.size(), landmark.patch});
  out.matrix(landmark.patch->centre);
  out.values(landmark.descriptor);
  for (const int count : {landmark.tried, landmark.found, landmark.agreed}) {
    out.value<std::int32_t>(count);
  }
  out.count(landmark.observations.size());
  for (const auto& observation : landmark.observations) write(out, observation);
}

Landmark readLandmark(ByteReader& in) {
  constexpr int kMaxLevel = 16;
  Landmark landmark;
  landmark.id.value = in.value<std::int64_t>();
  landmark.position = in.finiteMatrix<Eigen::Vector3d>();
  landmark.reference.value = in.value<std::int64_t>();
  landmark.reference_level = in.value<std::int32_t>();
  landmark.T_reference_cut.matrix() = in.finiteMatrix<Eigen::Matrix4f>();
  auto patch = std::make_shared<stereo::ReferencePatch>();
  in.values(patch->pixels);
  patch->centre = in.finiteMatrix<Eigen::Vector2f>();
  in.values(landmark.descriptor);
  landmark.tried = in.value<std::int32_t>();
  landmark.found = in.value<std::int32_t>();
  landmark.agreed = in.value<std::int32_t>();
  landmark.observations = in.list<LandmarkObservation>(readObservation);
  const float last = stereo::ReferencePatch::kSize - 1;
  if (landmark.reference_level < 0 || landmark.reference_level > kMaxLevel ||
      patch->centre.minCoeff() < 0.0F || patch->centre.maxCoeff() > last) {
    throw InputError("damaged: a landmark's patch lies outside its range");
  }
  landmark.patch = std::move(patch);
  return landmark;
}

/// At least the number of bytes without patches, so that a string of this capacity never grows.
std::size_t bytesInMemory(const SparseMap& map) {
  std::size_t bytes = 4096 + map.keyframes().size() * sizeof(Keyframe);
  for (const auto& [id, landmark] : map.landmarks()) {
    bytes += sizeof landmark + landmark.observations.size() * sizeof(LandmarkObservation);
  }
  return bytes;
}

}  // namespace

ByteSource mapBytes(const SparseMap& map, const StereoCamera& camera) {
  const auto packed = std::make_shared<PackedMap>();
  ByteWriter& out = packed->out;
  out.bytes.reserve(bytesInMemory(map));
  packed->gaps.reserve(map.landmarks().size());
  out.value(kMagic);
  out.value<std::uint32_t>(kVersion);
  write(out, camera);
  out.value(map.disparityOffset());
  out.matrix(map.rightTurn());
  out.count(map.keyframes().size());
  for (const auto& [id, keyframe] : map.keyframes()) write(out, keyframe);
  out.count(map.landmarks().size());
  for (const auto& [id, landmark] : map.landmarks()) write(*packed, landmark);
  return [packed](const ByteSink& sink) { packed->writeTo(sink); };
}

std::string packMap(const SparseMap& map, const StereoCamera& camera) {
  return collected(mapBytes(map, camera));
}

SparseMap unpackMap(const std::string& bytes, const std::optional<StereoCamera>& camera,
                    StereoCamera* made_by) {
  ByteReader in(bytes);
  if (in.value<std::uint32_t>() != kMagic)
    throw InputError("the static map in it is no map of headway's slam");
  const auto version = in.value<std::uint32_t>();
  if (version < kVersionWithoutTurn || version > kVersion) {
    throw InputError("the static map in it is of version " + std::to_string(version) +
                     ", this program reads versions " + std::to_string(kVersionWithoutTurn) +
                     " to " + std::to_string(kVersion));
  }
  const StereoCamera recorded = readCamera(in);
  if (camera) {
    if (const auto difference = differenceBetween(recorded, *camera)) {
      throw InputError("it was made with another camera (" + *difference +
                       "); use rawlogs of one camera");
    }
  }
  if (made_by != nullptr) *made_by = recorded;
  const double disparity_offset_px = in.finiteValue<double>();
  Eigen::Vector3d right_turn = Eigen::Vector3d::Zero();
  if (version != kVersionWithoutTurn) right_turn = in.finiteMatrix<Eigen::Vector3d>();
  if (!(right_turn.norm() < kMaxRightTurn)) {
    throw InputError("damaged: the right camera is turned too far");
  }
  const auto keyframes =
      in.list<Keyframe>([&](ByteReader& reader) { return readKeyframe(reader, version); });
  const auto landmarks = in.list<Landmark>(readLandmark);
  if (!in.atEnd()) throw InputError("damaged: there are data after the end of the static map");
  SparseMap map(keyframes, landmarks);
  map.setDisparityOffset(disparity_offset_px);
  map.setRightTurn(right_turn);
  return map;
}

std::string croppedMap(const std::string& saved, const Eigen::AlignedBox3d& box,
                       const Pose& T_robot_cam) {
  StereoCamera camera;
  SparseMap map = unpackMap(saved, {}, &camera);
  const Pose T_cam_robot = T_robot_cam.inverse(Eigen::Isometry);
  std::vector<KeyframeId> outside;
  for (const auto& [id, keyframe] : map.keyframes()) {
    const Pose T_map_robot = keyframe.T_map_cam * T_cam_robot;
    if (!box.contains(T_map_robot.translation())) outside.push_back(id);
  }
  for (const KeyframeId id : outside) map.removeKeyframe(id);
  std::vector<LandmarkId> outer_landmarks;
  for (const auto& [id, landmark] : map.landmarks()) {
    if (!box.contains(landmark.position)) outer_landmarks.push_back(id);
  }
  for (const LandmarkId id : outer_landmarks) map.removeLandmark(id);
  return packMap(map, camera);
}

namespace {

/// Grey value of a landmark where it was seen when its patch was cut.
std::uint8_t intensityOf(const stereo::ReferencePatch& patch) {
  const auto centre = patch.centre.array().round().cast<int>();
  return patch.pixels[centre.y() * stereo::ReferencePatch::kSize + centre.x()];
}

bool isIn(int submap, const Landmark& landmark, const SparseMap& map) {
  return map.submapOf(landmark.reference) == submap;
}

bool isIn(int submap, const Keyframe& keyframe, const SparseMap&) {
  return keyframe.submap == submap;
}

LandmarkView viewOf(const Landmark& landmark, const Pose& /*T_cam_robot*/) {
  return {landmark.id, landmark.position, static_cast<int>(landmark.observations.size()),
          intensityOf(*landmark.patch)};
}

KeyframeView viewOf(const Keyframe& keyframe, const Pose& T_cam_robot) {
  return {keyframe.id,
          keyframe.frame,
          keyframe.time,
          normalized(keyframe.T_map_cam * T_cam_robot),
          composedCovariance(keyframe.covariance, T_cam_robot, PoseCovariance::Zero()),
          keyframe.landmarks};
}

/// The groups that elements are in, ascending.
template <typename Id, typename Element>
std::vector<std::int64_t> groupsOf(const std::map<Id, Element>& elements) {
  IdGroups groups;
  for (const auto& [id, element] : elements) groups.add(id.value);
  return groups.take();
}

/// Makes the chunks of changed groups anew, and puts all chunks together.
template <typename Id, typename Element, typename View>
SharedChunks<View> updated(
    const std::map<Id, Element>& elements, const std::vector<std::int64_t>& changed,
    const Pose& T_cam_robot, int submap, const SparseMap& map,
    std::map<std::int64_t, std::shared_ptr<const std::vector<View>>>& groups) {
  for (const std::int64_t group : changed) {
    auto chunk = std::make_shared<std::vector<View>>();
    auto at = elements.lower_bound(Id{group * IdGroups::kSize});
    for (; at != elements.end() && at->first.value / IdGroups::kSize == group; ++at) {
      if (isIn(submap, at->second, map)) chunk->push_back(viewOf(at->second, T_cam_robot));
    }
    if (chunk->empty()) {
      groups.erase(group);
    } else {
      groups[group] = std::move(chunk);
    }
  }
  SharedChunks<View> all;
  for (const auto& [group, chunk] : groups) all.append(chunk);
  return all;
}

}  // namespace

MapView MapViewMaker::make(SparseMap& map, int submap) {
  auto landmarks = map.takeChangedLandmarks();
  auto keyframes = map.takeChangedKeyframes();
  if (submap != submap_) {
    reset();
    landmarks = groupsOf(map.landmarks());
    keyframes = groupsOf(map.keyframes());
    submap_ = submap;
  }
  return {updated(map.landmarks(), landmarks, T_cam_robot_, submap, map, landmarks_),
          updated(map.keyframes(), keyframes, T_cam_robot_, submap, map, keyframes_)};
}

MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot, int submap) {
  std::map<std::int64_t, std::shared_ptr<const std::vector<LandmarkView>>> landmarks;
  std::map<std::int64_t, std::shared_ptr<const std::vector<KeyframeView>>> keyframes;
  return {updated(map.landmarks(), groupsOf(map.landmarks()), T_cam_robot, submap, map, landmarks),
          updated(map.keyframes(), groupsOf(map.keyframes()), T_cam_robot, submap, map, keyframes)};
}

MapView savedMapView(const std::string& saved, const Pose& T_robot_cam) {
  return makeMapView(unpackMap(saved, {}), T_robot_cam.inverse(), 0);
}

}  // namespace headway::slam
