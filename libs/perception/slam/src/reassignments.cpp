// SPDX-License-Identifier: BSD-3-Clause
#include "reassignments.h"

namespace headway::slam {

void Reassignments::follow(KeyframeId& reference, StoredPose& T_reference_cam) const {
  auto one = reference.valid() ? by_keyframe_.find(reference) : by_keyframe_.end();
  if (one == by_keyframe_.end()) return;
  Pose pose = poseFrom(T_reference_cam);
  for (; one != by_keyframe_.end(); one = by_keyframe_.find(reference)) {
    pose = poseFrom(one->second.T_to_from) * pose;
    reference = one->second.to;
  }
  T_reference_cam = stored(pose);
}

}  // namespace headway::slam
