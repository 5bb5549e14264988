// SPDX-License-Identifier: BSD-3-Clause
// Recordings of ROS as topics and messages, whatever their format.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace headway::bags {

/// How the messages of a topic are serialised.
enum class Encoding {
  kRos1,   ///< ROS 1: little-endian, without alignment
  kCdr,    ///< ROS 2: OMG's Common Data Representation
  kOther,  ///< not read
};

/// A topic of a bag.
struct BagTopic {
  std::string name;
  std::string type;  ///< as in ROS 1, also of ROS 2 bags: "sensor_msgs/Image"
  Encoding encoding = Encoding::kOther;
  std::uint64_t messages = 0;
};

/// A recorded message.
struct BagMessage {
  std::size_t topic = 0;         ///< index in topics()
  std::int64_t received_ns = 0;  ///< when it was recorded, since the Unix epoch
  std::string_view content;      ///< valid until the next call of next()
};

/// A recording of ROS: its topics, then its messages in the order of their recording.
///
/// Each length in a file is checked before memory is allocated. What cannot be read is counted.
///
///     const auto bag = openBag("drive.mcap");
///     while (const auto message = bag->next()) count(bag->topics()[message->topic].name);
class BagReader {
 public:
  virtual ~BagReader() = default;
  [[nodiscard]] const std::vector<BagTopic>& topics() const { return topics_; }
  /// The next message; nullopt at the end.
  [[nodiscard]] virtual std::optional<BagMessage> next() = 0;
  /// Where and why the recording ended early; nullopt if it did not.
  [[nodiscard]] const std::optional<std::string>& truncation() const { return truncation_; }
  /// Number of unreadable parts by reason ("broken_chunk", ...).
  [[nodiscard]] const std::map<std::string, std::size_t>& skipped() const { return skipped_; }
  /// Ratio of the file read so far, 0 to 1.
  [[nodiscard]] virtual double progress() const = 0;

 protected:
  /// Index of the same topic, which is added without messages if it is new.
  std::size_t indexOf(const BagTopic& topic);
  /// @throws InputError if there is none of `what`, such as messages
  void requireTopics(const std::string& path, const char* what) const;

  std::vector<BagTopic> topics_;
  std::optional<std::string> truncation_;
  std::map<std::string, std::size_t> skipped_;
};

/// Opens a ROS 1 bag (`.bag`), a ROS 2 bag (`.mcap` or `.db3`), told apart by their first bytes, or
/// the folder of a ROS 2 bag, whose files are read in the order of their names.
///
/// @throws InputError if it is none of them or damaged from the start; or if this build lacks what
///         it needs, with the package to install
[[nodiscard]] std::unique_ptr<BagReader> openBag(const std::string& path);

}  // namespace headway::bags
