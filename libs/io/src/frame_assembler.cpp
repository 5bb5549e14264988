#include "frame_assembler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::io {
namespace {

constexpr const char* kUnmatchedLaser = "laser_between_frames";
constexpr double kMaxUnconfirmedGap = 10.0;       // between two frames [s]
constexpr double kHalfIntervalOfOneFrame = 0.05;  // without a second frame [s]

}  // namespace

void FrameAssembler::addFrame(PendingFrame frame) {
  frame.index = next_index_++;
  if (auto ahead = std::exchange(ahead_, std::nullopt)) {
    if (frame.time > ahead->time) {
      append(std::move(*ahead));
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
  } else {
    append(std::move(frame));
  }
}

void FrameAssembler::append(PendingFrame frame) {
  if (last_added_ && !(frame.time > *last_added_)) {
    ++skipped_["time_backwards"];
    return;
  }
  last_added_ = frame.time;
  frames_.push_back(std::move(frame));
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
  if (last_taken_) interval = std::min(interval, time - *last_taken_);
  if (!frames_.empty()) interval = std::min(interval, frames_.front().time - time);
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
