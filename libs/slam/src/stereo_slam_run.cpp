// SPDX-License-Identifier: BSD-3-Clause
// The parts of StereoSlam that correct the map from outside, and join it with others.
#include <headway/core/camera_difference.h>
#include <headway/core/error.h>
#include <headway/slam/joint_map.h>
#include <headway/stereo/right_turn.h>

#include <map>
#include <utility>

#include "joint_sparse_map.h"
#include "loop_correction.h"
#include "right_camera.h"
#include "stereo_slam_implementation.h"

namespace headway::slam {
namespace {

// After a change of what is assumed about the right camera:
constexpr int kReadjusted = 100;  ///< keyframes, so that none is fixed where the old scale put it
constexpr int kReadjustIterations = 20;

}  // namespace

void StereoSlam::Implementation::turnRightCamera(const Eigen::Vector3d& angles, bool always_so) {
  if (!params_.mapping || angles == map_.rightTurn()) return;
  if (!always_so || !reference_) return map_.setRightTurn(angles);
  adjuster_.abandon();
  loops_.abandon();
  for (TrackedLandmark& seen : seen_before_) {
    stereo::StereoMeasurement& measured = seen.measurement;
    measured.disparity = stereo::turnedDisparity(measured.uv, measured.disparity, map_.rightTurn(),
                                                 angles, *camera_);
  }
  std::map<KeyframeId, Pose> before;
  for (const auto& [id, keyframe] : map_.keyframes()) before[id] = keyframe.T_map_cam;
  Pose T_reference_cam = before.at(*reference_).inverse(Eigen::Isometry) * motion_.last();
  slam::turnRightCamera(angles, *camera_, map_);
  const KeyframeId newest = map_.keyframes().rbegin()->first;
  adjustBundle(map_, map_.neighbourhood(newest, kReadjusted), *camera_, kReadjustIterations,
               params_.stop);
  const auto ratios = scaleChanges(before, map_);
  trajectory_.scale(ratios);
  const auto here = ratios.find(*reference_);
  if (here != ratios.end()) T_reference_cam.translation() *= here->second;
  motion_.correct(normalized(Pose(map_.keyframe(*reference_).T_map_cam * T_reference_cam)));
  local_landmarks_ = map_.seenBy(map_.neighbourhood(*reference_, params_.window));
}

void StereoSlam::Implementation::correct(const KeyframePoses& poses) {
  adjuster_.abandon();
  loops_.abandon();
  if (reference_) {
    const Pose T_reference_cam =
        map_.keyframe(*reference_).T_map_cam.inverse(Eigen::Isometry) * motion_.last();
    motion_.correct(normalized(Pose(poses.at(*reference_) * T_reference_cam)));
  }
  applyCorrection(poses, map_);
}

std::vector<JointMap> joinMaps(const std::vector<const StereoSlam*>& runs) {
  std::vector<const SparseMap*> maps;
  const auto& first = runs.front()->implementation_;
  for (const StereoSlam* run : runs) {
    if (const auto difference =
            differenceBetween(run->implementation_->camera(), first->camera())) {
      throw InputError("the runs have different cameras: " + *difference);
    }
    maps.push_back(&run->implementation_->sparseMap());
  }
  std::vector<JointMap> result;
  for (const auto& group : joinSparseMaps(maps, first->camera(), first->params())) {
    JointMap& joint = result.emplace_back();
    joint.links = group.links;
    for (std::size_t i = 0; i < group.members.size(); ++i) {
      JointMember& member = joint.members.emplace_back();
      member.run = group.members[i];
      member.keyframe_shift = group.shifts[i];
      for (const auto& [id, keyframe] : maps[member.run]->keyframes()) {
        const KeyframeId here{id.value + member.keyframe_shift};
        member.poses[id] = group.map.keyframe(here).T_map_cam;
      }
    }
    joint.saved = mapBytes(group.map, first->camera());
    joint.view = makeMapView(group.map, first->camera().T_robot_cam.inverse(Eigen::Isometry));
  }
  return result;
}

void StereoSlam::turnRightCamera(const Eigen::Vector3d& angles, bool always_so) {
  implementation_->turnRightCamera(angles, always_so);
}

const Eigen::Vector3d& StereoSlam::rightTurn() const {
  return implementation_->sparseMap().rightTurn();
}

std::optional<stereo::OffsetEstimate> StereoSlam::takeFreeOffset() {
  return implementation_->takeFreeOffset();
}

void StereoSlam::correct(const KeyframePoses& poses) { implementation_->correct(poses); }

}  // namespace headway::slam
