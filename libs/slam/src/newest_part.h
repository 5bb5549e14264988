#pragma once

#include <headway/core/ids.h>

#include <algorithm>

namespace headway::slam {

/// How far the newest part of the map has come, since it was begun at a guessed pose.
///
/// There is none until one is begun here, nor once the camera is back in an older part.
class NewestPart {
 public:
  void begin(KeyframeId first) {
    first_ = first;
    frames_ = 0;
  }
  /// A frame was tracked.
  void addTracked() { ++frames_; }
  /// A lost camera was recognised by a keyframe, maybe in an older part, where all is settled.
  void returnTo(KeyframeId recognised) {
    if (recognised < first_) first_ = KeyframeId{};
  }

  /// First keyframe; invalid if there is no such part.
  [[nodiscard]] KeyframeId first() const { return first_; }

  /// Whether what stands still in it may still be chosen otherwise.
  [[nodiscard]] bool isYoung() const { return first_.valid() && frames_ < kYoung; }

  /// Lost frames after which the map is begun anew: no more than this part took to make, for what
  /// was lost right after its beginning may never have been right.
  ///
  /// @param restart_after  of a map that has lasted
  [[nodiscard]] int patience(int restart_after) const {
    return first_.valid() ? std::min(restart_after, 1 + frames_) : restart_after;
  }

 private:
  static constexpr int kYoung = 8;  ///< tracked frames

  KeyframeId first_;
  int frames_ = 0;  ///< tracked ones
};

}  // namespace headway::slam
