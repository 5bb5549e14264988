// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/recorded_frame.h>

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stereo_pairing.h"

namespace headway::io {

/// A frame with undecoded images and its recorded boxes and pose.
struct PendingFrame {
  std::size_t index = 0;
  Time time = 0.0;
  double arrival_s = 0.0;            ///< when it was complete, by a live source's clock [s]
  std::optional<RecordedPair> pair;  ///< empty: the frame is a pose
  std::optional<Detections> detections;
  std::optional<Pose> T_map_robot;
  std::vector<LaserScan> laser_scans;
};

/// Assigns boxes, poses and laser scans to the nearest frame in time, at most half a frame interval
/// away.
///
/// Frames are numbered from 0 and returned in order, once `read_ahead` later frames are known, so
/// that boxes and poses recorded late, even after the next image, are assigned. Frames whose time
/// does not increase are dropped but keep their index, unless the third of them in succession shows
/// that the clock was set back; so is a frame whose time is more than 10 s
/// ahead, unless the next frame confirms it. Unassigned items are counted.
class FrameAssembler {
 public:
  /// @param read_ahead  number of later frames known before a frame is returned
  /// @param skipped     counts "time_backwards", "time_outlier", "unmatched_detections",
  ///                    "unmatched_pose", "laser_between_frames"
  FrameAssembler(std::size_t read_ahead, std::map<std::string, std::size_t>& skipped)
      : read_ahead_(read_ahead), skipped_(skipped) {}

  /// @param frame  without index and detections, and without pose if it has a pair
  /// @return       whether it shows that the clock was set back
  bool addFrame(PendingFrame frame);
  /// Index of the next frame that is added.
  [[nodiscard]] std::size_t nextIndex() const { return next_index_; }
  void addDetections(Detections detections) { detections_.push_back(std::move(detections)); }
  void addPose(Time time, const Pose& T_map_robot) { poses_.push_back({time, T_map_robot}); }

  /// @param scan  of each laser (label), the scan nearest to a frame is assigned to it
  void addLaserScan(LaserScan scan) { laser_scans_[scan.label].push_back(std::move(scan)); }

  /// Whether take() can return a frame before the end of the recording.
  [[nodiscard]] bool isReady() const { return ready() > 0; }
  /// Number of frames that take() can return before the end of the recording.
  [[nodiscard]] std::size_t ready() const {
    return frames_.size() > read_ahead_ ? frames_.size() - read_ahead_ : 0;
  }
  /// Number of frames stored, with those read ahead.
  [[nodiscard]] std::size_t frames() const { return frames_.size() + (ahead_ ? 1 : 0); }
  /// Number of boxes (by image), poses and laser scans stored.
  [[nodiscard]] std::size_t items() const;
  /// Removes and counts the oldest of the boxes, poses, and scans of a laser above this number.
  void limitItems(std::size_t max_count);

  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take();

  /// Counts the items that remain unassigned at the end.
  void finish();

 private:
  bool append(PendingFrame frame);
  [[nodiscard]] bool isSetBack(Time time);
  void removeItemsAfter(Time time);
  [[nodiscard]] double halfInterval(Time time) const;
  template <typename Item>
  std::optional<Item> takeNearest(std::deque<Item>& items, Time time, double half_interval,
                                  const char* unmatched);

  std::size_t read_ahead_;
  std::map<std::string, std::size_t>& skipped_;
  std::size_t next_index_ = 0;
  std::optional<Time> last_added_;
  std::optional<Time> last_taken_;
  std::optional<Time> last_backward_;  ///< of the newest frame, if its time did not increase
  int backward_frames_ = 0;            ///< that increased in succession, after the last one added
  std::deque<PendingFrame> frames_;
  std::optional<PendingFrame> ahead_;  ///< its time is not yet confirmed
  std::deque<Detections> detections_;
  std::deque<Stamped<Pose>> poses_;
  std::map<std::string, std::deque<LaserScan>> laser_scans_;  ///< by label
};

}  // namespace headway::io
