// SPDX-License-Identifier: BSD-3-Clause
// How messages become frames and observations: images are paired, and all put in the order of their
// times.
#pragma once

#include <headway/bags/bag_import.h>
#include <headway/core/pose.h>
#include <headway/io/rawlog_sink.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>

#include "bag_rig.h"

namespace headway::bags {

/// An image and its time.
using StampedImage = Stamped<cv::Mat>;

/// Pairs the images of two cameras by their times.
class ImagePairing {
 public:
  explicit ImagePairing(double tolerance_s) : tolerance_s_(tolerance_s) {}

  using Pair = std::array<StampedImage, 2>;

  /// @param side  0: the first camera, 1: the second one
  /// @return      the pair that this image completes
  [[nodiscard]] std::optional<Pair> add(std::size_t side, StampedImage image) {
    auto& partners = waiting_[1 - side];
    const auto distance = [&](const StampedImage& other) {
      return std::abs(other.time - image.time);
    };
    const auto nearest = std::min_element(
        partners.begin(), partners.end(),
        [&](const StampedImage& a, const StampedImage& b) { return distance(a) < distance(b); });
    if (nearest != partners.end()) nearest_s_ = std::min(nearest_s_, distance(*nearest));
    if (nearest == partners.end() || distance(*nearest) > tolerance_s_) {
      waiting_[side].push_back(std::move(image));
      if (waiting_[side].size() > kMaxWaiting) drop(waiting_[side], 1);
      return std::nullopt;
    }
    Pair pair;
    pair[1 - side] = *nearest;
    pair[side] = std::move(image);
    const auto older = static_cast<std::size_t>(nearest - partners.begin());
    drop(partners, older);
    partners.pop_front();
    return pair;
  }

  /// Number of images without a partner; at the end, of those that wait for one.
  [[nodiscard]] std::size_t unpaired() const { return unpaired_; }
  [[nodiscard]] std::size_t waiting() const { return waiting_[0].size() + waiting_[1].size(); }
  /// Smallest distance of a left and a right image [s]; infinite if one camera has none.
  [[nodiscard]] double nearest() const { return nearest_s_; }

 private:
  static constexpr std::size_t kMaxWaiting = 8;  // images of one camera: a quarter of a second

  void drop(std::deque<StampedImage>& images, std::size_t count) {
    images.erase(images.begin(), images.begin() + static_cast<std::ptrdiff_t>(count));
    unpaired_ += count;
  }

  double tolerance_s_;
  double nearest_s_ = std::numeric_limits<double>::infinity();
  std::array<std::deque<StampedImage>, 2> waiting_;
  std::size_t unpaired_ = 0;
};

/// Puts observations in the order of their own times: images arrive later than samples of the same
/// moment, because they take time to expose and to send.
class TimeOrder {
 public:
  struct Event {
    Time time = 0.0;
    const char* kind = nullptr;  ///< of what is counted when written; null: a frame
    std::size_t bytes = 0;
    std::function<void(io::RawlogSink&)> write;
    std::map<std::string, std::size_t> dropped = {};  ///< when a frame was read, from the start on
  };

  void add(Event event) {
    bytes_ += event.bytes;
    newest_ = waiting_.empty() ? event.time : std::max(newest_, event.time);
    const Time time = event.time;
    waiting_.emplace(time, std::move(event));
  }

  /// The earliest event, if no earlier one is to be expected any more.
  [[nodiscard]] std::optional<Event> next(bool at_end) {
    if (waiting_.empty()) return std::nullopt;
    const bool is_due = at_end || newest_ - waiting_.begin()->first > kMaxDelay ||
                        bytes_ > kMaxBytes || waiting_.size() > kMaxEvents;
    if (!is_due) return std::nullopt;
    Event event = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    bytes_ -= event.bytes;
    return event;
  }

 private:
  static constexpr double kMaxDelay = 1.0;           // [s]
  static constexpr std::size_t kMaxBytes = 1 << 28;  // that wait, of images
  static constexpr std::size_t kMaxEvents = 100000;  // that wait

  std::multimap<Time, Event> waiting_;
  Time newest_ = 0.0;
  std::size_t bytes_ = 0;
};

/// Converts the messages of the selected topics to events in the order of time.
class MessageImport {
 public:
  MessageImport(const BagImportOptions& options, const BagRig& rig, BagImportSummary& summary);

  /// @throws InputError if an image has another size than its calibration
  void add(const BagTopic& topic, const BagMessage& message);
  /// The next event to write; nullopt until there are further messages, or at the end.
  [[nodiscard]] std::optional<TimeOrder::Event> next(bool at_end) { return order_.next(at_end); }
  /// Counts what remained unpaired. @throws InputError with the cause if there was no pair at all
  void finish();

 private:
  [[nodiscard]] std::map<std::string, std::size_t> dropped(std::size_t waiting) const;
  [[nodiscard]] Time timeOf(const MessageHeader& header, const BagMessage& message);
  void addImage(std::size_t side, const BagTopic& topic, const BagMessage& message);
  void addPair(const ImagePairing::Pair& pair);
  void addImu(const BagTopic& topic, const BagMessage& message);
  void addOdometry(const BagTopic& topic, const BagMessage& message);
  void addScan(const BagTopic& topic, const BagMessage& message);
  void addFix(const BagTopic& topic, const BagMessage& message);
  /// Where a topic's sensor is mounted; nullptr if it is unknown, which is counted.
  [[nodiscard]] const Pose* mountingOf(const std::string& topic);
  void requireSize(const cv::Mat& image, const std::string& topic, const io::RawCamera& lens) const;

  const BagImportOptions& options_;
  const BagRig& rig_;
  BagImportSummary& summary_;
  bool is_stereo_;
  bool is_imu_split_;  ///< into a topic each of gyroscope and accelerometer
  ImagePairing pairing_;
  TimeOrder order_;
  std::size_t pairs_ = 0;
};

}  // namespace headway::bags
