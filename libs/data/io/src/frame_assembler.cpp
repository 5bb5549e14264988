// SPDX-License-Identifier: BSD-3-Clause
#include "frame_assembler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::io {
namespace {

constexpr const char* kUnmatchedLaser = "laser_between_frames";
constexpr double kMaxUnconfirmedGap = 10.0;       // between two frames [s]
constexpr double kMaxItemLead = 1.0;              // of an item before its frame [s]
constexpr int kSetBackFrames = 3;                 // that confirm that a clock was set back
constexpr double kHalfIntervalOfOneFrame = 0.05;  // without a second frame [s]

}  // namespace

bool FrameAssembler::addFrame(PendingFrame frame) {
  frame.index = next_index_++;
  if (auto ahead = std::exchange(ahead_, std::nullopt)) {
    if (frame.time > ahead->time) {
      (void)append(std::move(*ahead));
    } else {
      ++skipped_["time_outlier"];
    }
  }
  const bool is_first_ahead =
      frames_.size() == 1 && !last_taken_ && frames_[0].time - frame.time > kMaxUnconfirmedGap;
  if (is_first_ahead) {
    ++skipped_["time_outlier"];
    frames_.clear();
    last_added_.reset();
  }
  if (last_added_ && frame.time - *last_added_ > kMaxUnconfirmedGap) {
    ahead_ = std::move(frame);
    return false;
  }
  return append(std::move(frame));
}

bool FrameAssembler::append(PendingFrame frame) {
  const bool is_backward = last_added_ && !(frame.time > *last_added_);
  if (!is_backward) {
    last_backward_.reset();
  } else if (!isSetBack(frame.time)) {
    ++skipped_["time_backwards"];
    return false;
  } else {
    removeItemsAfter(frame.time);
  }
  last_added_ = frame.time;
  frames_.push_back(std::move(frame));
  return is_backward;
}

/// Whether frames with times before the last one continue each other.
bool FrameAssembler::isSetBack(Time time) {
  const bool continues =
      last_backward_ && time > *last_backward_ && time - *last_backward_ < kMaxUnconfirmedGap;
  backward_frames_ = continues ? backward_frames_ + 1 : 1;
  last_backward_ = time;
  if (backward_frames_ < kSetBackFrames) return false;
  last_backward_.reset();
  return true;
}

/// Removes boxes, poses and scans of the time before a clock was set back to this one.
void FrameAssembler::removeItemsAfter(Time time) {
  const auto remove = [&](auto& items, const char* unmatched) {
    const auto is_later = [&](const auto& item) { return item.time > time + kMaxItemLead; };
    const auto end = std::remove_if(items.begin(), items.end(), is_later);
    if (end != items.end()) skipped_[unmatched] += static_cast<std::size_t>(items.end() - end);
    items.erase(end, items.end());
  };
  remove(detections_, "unmatched_detections");
  remove(poses_, "unmatched_pose");
  for (auto& [label, scans] : laser_scans_) remove(scans, kUnmatchedLaser);
}

std::optional<PendingFrame> FrameAssembler::take() {
  if (frames_.empty()) return std::nullopt;
  PendingFrame frame = std::move(frames_.front());
  frames_.pop_front();
  const double half_interval = halfInterval(frame.time);
  frame.detections = takeNearest(detections_, frame.time, half_interval, "unmatched_detections");
  if (frame.pair) {
    const auto pose = takeNearest(poses_, frame.time, half_interval, "unmatched_pose");
    if (pose) frame.T_map_robot = pose->value;
  }
  for (auto& [label, scans] : laser_scans_) {
    auto scan = takeNearest(scans, frame.time, half_interval, kUnmatchedLaser);
    if (scan) frame.laser_scans.push_back(std::move(*scan));
  }
  last_taken_ = frame.time;
  return frame;
}

std::size_t FrameAssembler::items() const {
  std::size_t count = detections_.size() + poses_.size();
  for (const auto& [label, scans] : laser_scans_) count += scans.size();
  return count;
}

void FrameAssembler::limitItems(std::size_t max_count) {
  const auto limit = [&](auto& items, const char* unmatched) {
    while (items.size() > max_count) {
      items.pop_front();
      ++skipped_[unmatched];
    }
  };
  limit(detections_, "unmatched_detections");
  limit(poses_, "unmatched_pose");
  for (auto& [label, scans] : laser_scans_) limit(scans, kUnmatchedLaser);
}

void FrameAssembler::finish() {
  if (!frames_.empty()) return;
  if (std::exchange(ahead_, std::nullopt)) ++skipped_["time_outlier"];
  if (!detections_.empty()) skipped_["unmatched_detections"] += detections_.size();
  if (!poses_.empty()) skipped_["unmatched_pose"] += poses_.size();
  for (const auto& [label, scans] : laser_scans_) {
    if (!scans.empty()) skipped_[kUnmatchedLaser] += scans.size();
  }
  detections_.clear();
  poses_.clear();
  laser_scans_.clear();
}

/// Half of the shorter interval to the previous and the next frame, so that boxes and poses of lost
/// frames are not assigned across a gap.
double FrameAssembler::halfInterval(Time time) const {
  double interval = std::numeric_limits<double>::infinity();
  const auto include = [&interval](double seconds) {
    if (seconds > 0.0) interval = std::min(interval, seconds);  // else the clock was set back
  };
  if (last_taken_) include(time - *last_taken_);
  if (!frames_.empty()) include(frames_.front().time - time);
  return std::isfinite(interval) ? 0.5 * interval : kHalfIntervalOfOneFrame;
}

/// Removes the nearest item, and all items that are too old for later frames.
template <typename Item>
std::optional<Item> FrameAssembler::takeNearest(std::deque<Item>& items, Time time,
                                                double half_interval, const char* unmatched) {
  std::optional<Item> nearest;
  std::deque<Item> later;
  for (auto& item : items) {
    const double offset = item.time - time;
    if (offset > half_interval) {
      later.push_back(std::move(item));
    } else if (offset >= -half_interval &&
               (!nearest || std::abs(offset) < std::abs(nearest->time - time))) {
      if (nearest) ++skipped_[unmatched];
      nearest = std::move(item);
    } else {
      ++skipped_[unmatched];
    }
  }
  items = std::move(later);
  return nearest;
}

}  // namespace headway::io
