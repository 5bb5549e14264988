// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/ids.h>

#include <algorithm>

namespace headway::slam {

/// Age of the submap that was initialised last, at a predicted pose.
///
/// There is none before the first initialisation, or after relocalisation in an older submap.
class ActiveSubmap {
 public:
  void initialise(KeyframeId first) {
    first_ = first;
    frames_ = 0;
  }
  /// A frame was tracked.
  void countTrackedFrame() { ++frames_; }
  /// The camera was relocalised at a keyframe, which may belong to an older submap.
  void relocaliseAt(KeyframeId recognised) {
    if (recognised < first_) first_ = KeyframeId{};
  }

  /// First keyframe; invalid if there is no active submap.
  [[nodiscard]] KeyframeId first() const { return first_; }

  /// Whether its static landmarks may still be reassigned.
  [[nodiscard]] bool isNew() const { return first_.valid() && frames_ < kNewFrames; }

  /// Lost frames after which a new submap is initialised: at most as many as were tracked in this
  /// one, since a submap lost right after its initialisation may be wrong.
  ///
  /// @param restart_after  of a map that is not new
  [[nodiscard]] int maxLostFrames(int restart_after) const {
    return first_.valid() ? std::min(restart_after, 1 + frames_) : restart_after;
  }

 private:
  static constexpr int kNewFrames = 8;  ///< tracked frames

  KeyframeId first_;
  int frames_ = 0;  ///< tracked ones
};

}  // namespace headway::slam
