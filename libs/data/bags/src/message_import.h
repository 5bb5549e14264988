// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_import.h>

#include <string>

#include "bag_rig.h"
#include "image_pairing.h"
#include "time_order.h"

namespace headway::bags {

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
  ImagePairing pairing_;
  TimeOrder order_;
  std::size_t pairs_ = 0;
};

}  // namespace headway::bags
