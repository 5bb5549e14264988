// SPDX-License-Identifier: BSD-3-Clause
// Bags of ROS 2 in MCAP files. Read by hand, because Debian has no library for them.
#include <headway/core/compression.h>
#include <headway/core/error.h>

#include "bag_file.h"
#include "bag_formats.h"

namespace headway::bags {
namespace {

/// Operations of records.
enum Operation : std::uint8_t {
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kStatistics = 0x0B,
  kDataEnd = 0x0F
};
constexpr std::uint64_t kRecordHeaderBytes = 9;  // operation and length
constexpr std::uint64_t kFooterBytes = 20;       // positions of summary and offsets, checksum

class McapBag : public BagReader {
 public:
  explicit McapBag(const std::string& path) : file_(path) {
    if (!readSummary()) countMessages();
    requireTopics(path, "messages");
    start();
  }

  double progress() const override {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
  }

  std::optional<BagMessage> next() override {
    while (true) {
      if (auto message = nextInChunk()) return message;
      if (auto message = nextInFile()) return message;
      if (!records_) return std::nullopt;
    }
  }

 private:
  struct Record {
    std::uint8_t operation = 0;
    std::uint64_t bytes = 0;
  };

  void start() {
    file_.goTo(kMcapMagic.size());
    at_end_ = false;
    records_.reset();
    truncation_.reset();
    skipped_.clear();
  }

  /// Operation and length of the next record in the file; nullopt at the end of the messages.
  std::optional<Record> readRecordHeader() {
    const std::string at = std::to_string(file_.position());
    const std::string_view header = file_.read(kRecordHeaderBytes);
    if (header.empty()) {
      truncation_ = "is truncated at byte " + at;
      return std::nullopt;
    }
    ByteCursor cursor(header);
    Record record;
    record.operation = cursor.number<std::uint8_t>();
    record.bytes = cursor.number<std::uint64_t>();
    if (record.operation == 0 || record.bytes > file_.left()) {
      truncation_ = "is damaged or truncated in the record at byte " + at;
      return std::nullopt;
    }
    return record;
  }

  /// Topics and numbers of messages by the summary at the end; false if there is none.
  bool readSummary() {
    const std::uint64_t tail = kRecordHeaderBytes + kFooterBytes + kMcapMagic.size();
    if (file_.size() < tail + kMcapMagic.size()) return false;
    file_.goTo(file_.size() - tail);
    const auto footer = readRecordHeader();
    if (!footer || footer->operation != kFooter || footer->bytes != kFooterBytes) return false;
    const auto summary = ByteCursor(file_.read(kFooterBytes)).number<std::uint64_t>();
    if (summary < kMcapMagic.size() || summary >= file_.size()) return false;
    file_.goTo(summary);
    bool has_statistics = false;
    try {
      while (const auto record = readRecordHeader()) {
        if (record->operation == kFooter) break;
        const std::string_view content = file_.read(record->bytes);
        if (content.size() != record->bytes) return false;
        if (record->operation == kSchema) addSchema(content);
        if (record->operation == kChannel) addChannel(content);
        if (record->operation == kStatistics) readStatistics(content);
        has_statistics = has_statistics || record->operation == kStatistics;
      }
    } catch (const BrokenData&) {
      return false;
    }
    return has_statistics && !truncation_ && !topics_.empty();
  }

  void readStatistics(std::string_view content) {
    ByteCursor cursor(content);
    cursor.bytes(8 + 2 + 4 * 4 + 2 * 8);  // totals and times
    ByteCursor counts(cursor.block());
    while (!counts.atEnd()) {
      const auto channel = channels_.find(counts.number<std::uint16_t>());
      const auto messages = counts.number<std::uint64_t>();
      if (channel != channels_.end()) topics_[channel->second].messages += messages;
    }
  }

  void countMessages() {
    topics_.clear();
    channels_.clear();
    schemas_.clear();
    start();
    while (const auto message = next()) ++topics_[message->topic].messages;
  }

  void addSchema(std::string_view content) {
    ByteCursor cursor(content);
    const auto id = cursor.number<std::uint16_t>();
    schemas_[id] = std::string(cursor.block());
  }

  void addChannel(std::string_view content) {
    ByteCursor cursor(content);
    const auto id = cursor.number<std::uint16_t>();
    if (channels_.count(id) > 0) return;
    const auto schema = schemas_.find(cursor.number<std::uint16_t>());
    BagTopic topic;
    topic.name = cursor.block();
    topic.type = schema == schemas_.end() ? "" : ros1TypeOf(schema->second);
    topic.encoding = encodingOf(std::string(cursor.block()));
    channels_[id] = indexOf(topic);
  }

  /// The message of a record; nullopt for other records, of which schemas and channels are kept.
  std::optional<BagMessage> use(std::uint8_t operation, std::string_view content) {
    if (operation == kSchema) addSchema(content);
    if (operation == kChannel) addChannel(content);
    if (operation != kMessage) return std::nullopt;
    ByteCursor cursor(content);
    const auto channel = channels_.find(cursor.number<std::uint16_t>());
    if (channel == channels_.end()) throw BrokenData("a message has no channel");
    (void)cursor.number<std::uint32_t>();  // its number
    const auto received = static_cast<std::int64_t>(cursor.number<std::uint64_t>());
    (void)cursor.number<std::uint64_t>();  // when it was published
    return BagMessage{channel->second, received, cursor.bytes(cursor.left())};
  }

  /// The next message outside chunks; nullopt at a chunk, which is opened, and at the end.
  std::optional<BagMessage> nextInFile() {
    while (!at_end_) {
      const auto record = readRecordHeader();
      at_end_ = !record || record->operation == kDataEnd || record->operation == kFooter;
      if (at_end_) break;
      const std::uint64_t end = file_.position() + record->bytes;
      const bool is_used = record->operation == kChunk || record->operation == kMessage ||
                           record->operation == kSchema || record->operation == kChannel;
      const std::string_view content = is_used ? file_.read(record->bytes) : std::string_view();
      try {
        if (is_used && content.empty()) throw BrokenData("a record is empty or too large");
        if (record->operation == kChunk) {
          openChunk(content);
          return std::nullopt;
        }
        if (auto message = use(record->operation, content)) return message;
      } catch (const BrokenData&) {
        ++skipped_[record->operation == kChunk ? "broken_chunk" : "broken_record"];
      }
      file_.goTo(end);
    }
    return std::nullopt;
  }

  void openChunk(std::string_view content) {
    ByteCursor cursor(content);
    cursor.bytes(2 * 8);  // times of its messages
    const auto size = cursor.number<std::uint64_t>();
    const auto crc = cursor.number<std::uint32_t>();
    const std::string compression(cursor.block());
    const std::string_view records =
        decompress(compression, cursor.block<std::uint64_t>(), size, chunk_);
    if (crc != 0 && crc != ~checksum(records, ~0U)) {
      throw BrokenData("a chunk has another checksum");
    }
    records_ = ByteCursor(records);
  }

  std::optional<BagMessage> nextInChunk() {
    if (!records_) return std::nullopt;
    try {
      while (!records_->atEnd()) {
        const auto operation = records_->number<std::uint8_t>();
        if (auto message = use(operation, records_->block<std::uint64_t>())) return message;
      }
    } catch (const BrokenData&) {
      ++skipped_["broken_chunk"];
    }
    records_.reset();
    return std::nullopt;
  }

  BagFile file_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  ///< to topics
  std::string chunk_;                              ///< decompressed
  std::optional<ByteCursor> records_;              ///< of the chunk
  bool at_end_ = false;
};

}  // namespace

std::unique_ptr<BagReader> openMcapBag(const std::string& path) {
  return std::make_unique<McapBag>(path);
}

}  // namespace headway::bags
