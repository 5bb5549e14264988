// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/ids.h>
#include <headway/core/record_log.h>

#include <unordered_map>

namespace headway::slam {

/// A keyframe that was removed: frames that were anchored to it belong to another one.
struct Reassignment {
  KeyframeId from, to;
  StoredPose T_to_from;
};

/// The keyframes that were removed in a run.
class Reassignments {
 public:
  void add(const Reassignment& one) { by_keyframe_[one.from] = one; }

  /// Expresses a pose in the keyframe to which the frames of a removed `reference` belong now.
  void follow(KeyframeId& reference, StoredPose& T_reference_cam) const;

 private:
  std::unordered_map<KeyframeId, Reassignment> by_keyframe_;  // ids are not used again
};

}  // namespace headway::slam
