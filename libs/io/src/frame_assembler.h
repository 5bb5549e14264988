#pragma once

#include <headway/core/detection.h>

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "stereo_pairing.h"

namespace headway::io {

/// A frame before its images are decoded, with what was recorded for it.
struct PendingFrame {
  std::size_t index = 0;
  Time time = 0.0;
  std::optional<RecordedPair> pair;  ///< empty: the frame is a pose
  std::optional<Detections> detections;
  std::optional<Pose> T_map_robot;
};

/// Gives boxes and poses to the frame nearest in time, at most half a frame interval away.
///
/// Frames count from 0 in the order they come, and come out in that order once some of the next
/// are known (so that what is recorded late, even after the next image, finds its frame). Frames
/// whose time does not increase are left out but keep their index. What finds no frame is counted.
class FrameAssembler {
 public:
  /// @param read_ahead  frames to be known before one comes out
  /// @param skipped     counts "time_backwards", "unmatched_detections", "unmatched_pose"
  FrameAssembler(std::size_t read_ahead, std::map<std::string, std::size_t>& skipped)
      : read_ahead_(read_ahead), skipped_(skipped) {}

  /// `frame` holds all but its index, detections, and pose (if it has a pair).
  void addFrame(PendingFrame frame);
  void addDetections(Detections detections) { detections_.push_back(std::move(detections)); }
  void addPose(Time time, const Pose& T_map_robot) { poses_.push_back({time, T_map_robot}); }

  /// Whether a frame can come out without knowing more of the recording.
  [[nodiscard]] bool isReady() const { return frames_.size() > read_ahead_; }

  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take();

  /// Counts what waits for a frame: none will come.
  void finish();

 private:
  [[nodiscard]] double halfInterval(Time time) const;
  template <typename Item>
  std::optional<Item> takeNearest(std::deque<Item>& items, Time time, double half_interval,
                                  const char* unmatched);

  std::size_t read_ahead_;
  std::map<std::string, std::size_t>& skipped_;
  std::size_t next_index_ = 0;
  std::optional<Time> last_added_;
  std::optional<Time> last_taken_;
  std::deque<PendingFrame> frames_;
  std::deque<Detections> detections_;
  std::deque<Stamped<Pose>> poses_;
};

}  // namespace headway::io
