#include "anchored_trajectory.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace headway::slam {

void AnchoredTrajectory::add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
                             const std::optional<KeyframeId>& reference, const SparseMap& map) {
  AnchoredPose anchored{frame, time, {}, stored(T_map_cam), tracked};
  if (reference) {
    anchored.reference = *reference;
    anchored.T_reference_cam =
        stored(map.keyframe(*reference).T_map_cam.inverse(Eigen::Isometry) * T_map_cam);
  }
  frames_.append(anchored);
}

void AnchoredTrajectory::reassign(KeyframeId from, KeyframeId to, const SparseMap& map) {
  const Pose T_to_from =
      map.keyframe(to).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(from).T_map_cam;
  for (AnchoredPose& anchored : frames_.recent()) {
    if (anchored.reference != from) continue;
    anchored.reference = to;
    anchored.T_reference_cam = stored(T_to_from * poseFrom(anchored.T_reference_cam));
  }
  if (frames_.filed() > 0) moved_.append({from, to, stored(T_to_from)});
}

void AnchoredTrajectory::visitAnchored(
    std::size_t count, const SparseMap& map,
    const std::function<void(const AnchoredPose&)>& callback) const {
  std::unordered_map<KeyframeId, Reassignment> moved;  // ids of keyframes are not used again
  moved_.visit([&](const Reassignment& one) { moved[one.from] = one; });
  frames_.visitNewest(count, [&](AnchoredPose anchored) {
    if (!anchored.reference.valid()) return callback(anchored);
    auto one = moved.find(anchored.reference);
    if (one != moved.end()) {
      Pose T_reference_cam = poseFrom(anchored.T_reference_cam);
      for (; one != moved.end(); one = moved.find(anchored.reference)) {
        T_reference_cam = poseFrom(one->second.T_to_from) * T_reference_cam;
        anchored.reference = one->second.to;
      }
      anchored.T_reference_cam = stored(T_reference_cam);
    }
    // Without its keyframe, whose reassignment found no place on the disk, it is left out.
    if (map.keyframes().count(anchored.reference) > 0) callback(anchored);
  });
}

void AnchoredTrajectory::visit(const SparseMap& map, const Pose& T_cam_robot,
                               const std::function<void(const FrameEstimate&)>& callback) const {
  visitAnchored(std::numeric_limits<std::size_t>::max(), map, [&](const AnchoredPose& anchored) {
    Pose T_map_cam = poseFrom(anchored.T_reference_cam);
    if (anchored.reference.valid()) {
      T_map_cam = map.keyframe(anchored.reference).T_map_cam * T_map_cam;
    }
    callback(
        {anchored.frame, anchored.time, anchored.tracked, normalized(T_map_cam * T_cam_robot)});
  });
}

std::optional<AnchoredTrajectory::Anchored> AnchoredTrajectory::find(std::size_t frame,
                                                                     const SparseMap& map) const {
  const auto& recent = frames_.recent();
  const auto found = std::lower_bound(
      recent.begin(), recent.end(), frame,
      [](const AnchoredPose& anchored, std::size_t index) { return anchored.frame < index; });
  if (found == recent.end() || found->frame != frame) return std::nullopt;
  Anchored result{found->time, poseFrom(found->T_reference_cam), found->reference, found->tracked};
  if (result.reference.valid()) {
    result.T_map_cam = map.keyframe(result.reference).T_map_cam * result.T_map_cam;
  }
  return result;
}

std::optional<std::size_t> AnchoredTrajectory::lastFrame() const {
  if (frames_.empty()) return std::nullopt;
  return frames_.back().frame;
}

void AnchoredTrajectory::write(std::size_t count, const SparseMap& map, ByteWriter& out) const {
  ByteWriter frames;
  std::size_t written = 0;
  visitAnchored(count, map, [&](const AnchoredPose& anchored) {
    frames.value<std::uint64_t>(anchored.frame);
    frames.value(anchored.time);
    frames.value(anchored.reference.value);
    frames.values(anchored.T_reference_cam.values);
    frames.value<std::uint8_t>(anchored.tracked ? 1 : 0);
    ++written;
  });
  out.count(written);
  out.bytes += frames.bytes;
}

void AnchoredTrajectory::read(const SparseMap& map, ByteReader& in) {
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
    AnchoredPose anchored{};
    anchored.frame = in.value<std::uint64_t>();
    anchored.time = in.finiteValue<double>();
    anchored.reference.value = in.value<std::int64_t>();
    in.values(anchored.T_reference_cam.values);
    anchored.tracked = in.value<std::uint8_t>() != 0;
    const bool is_in_order = frames_.empty() || frames_.back().frame < anchored.frame;
    const bool is_anchored =
        !anchored.reference.valid() || map.keyframes().count(anchored.reference) > 0;
    const auto& values = anchored.T_reference_cam.values;
    const bool is_finite =
        std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
    if (!is_in_order || !is_anchored || !is_finite) {
      throw InputError("damaged: a frame of the trajectory is not in order, or has no keyframe");
    }
    frames_.append(anchored);
  }
}

}  // namespace headway::slam
