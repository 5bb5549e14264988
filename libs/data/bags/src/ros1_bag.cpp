// SPDX-License-Identifier: BSD-3-Clause
// Bags of ROS 1, format 2.0. Read by hand, because librosbag_storage trusts what a file says: see
// openRos1Bag().
#include <headway/core/error.h>

#include <algorithm>

#include "bag_file.h"
#include "bag_formats.h"

namespace headway::bags {
namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMaxHeaderBytes = 1 << 20;  // of a record; real ones have some hundred
/// Operations of records.
enum RecordKind : std::uint8_t {
  kMessageData = 0x02,
  kFileHeader = 0x03,
  kChunkRecord = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07
};

/// Fields of a record's header: "name=value".
class Fields {
 public:
  explicit Fields(std::string_view bytes) {
    ByteCursor cursor(bytes);
    while (!cursor.atEnd()) {
      const std::string_view field = cursor.block();
      const auto equals = field.find('=');
      if (equals == std::string_view::npos) throw BrokenData("a header field has no name");
      values_[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    }
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? "" : found->second;
  }
  template <typename Number>
  [[nodiscard]] Number number(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end() || found->second.size() != sizeof(Number)) {
      throw BrokenData("a header lacks " + name);
    }
    return ByteCursor(found->second).number<Number>();
  }
  [[nodiscard]] std::uint8_t operation() const { return number<std::uint8_t>("op"); }

 private:
  std::map<std::string, std::string> values_;
};

class Ros1Bag : public BagReader {
 public:
  explicit Ros1Bag(const std::string& path) : file_(path) {
    if (file_.read(kVersion.size()) != kVersion) {
      throw InputError(path + ": is a ROS bag of another version than 2.0; `rosbag fix` renews it");
    }
    readFileHeader();
    if (!readIndex()) countMessages();
    requireTopics(path, "messages");
    start();
  }

  double progress() const override {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
  }

  std::optional<BagMessage> next() override {
    while (true) {
      if (auto message = nextInChunk()) return message;
      if (!openNextChunk()) return std::nullopt;
    }
  }

 private:
  void start() {
    file_.goTo(kVersion.size());
    records_.reset();
    truncation_.reset();
    skipped_.clear();
  }

  /// Reads the header of the next record in the file; nullopt at the end. The length of the
  /// record's data, which are not read, is in data_bytes_.
  std::optional<Fields> readHeader() {
    const std::uint64_t begin = file_.position();
    if (file_.left() == 0) return std::nullopt;
    const std::string_view length = file_.read(sizeof(std::uint32_t));
    const auto bytes = length.empty() ? 0 : ByteCursor(length).number<std::uint32_t>();
    try {
      if (bytes == 0 || bytes > kMaxHeaderBytes) throw BrokenData("no record begins here");
      const std::string_view header = file_.read(bytes);
      if (header.empty()) throw BrokenData("a record ends early");
      Fields fields(header);
      const std::string_view data_length = file_.read(sizeof(std::uint32_t));
      if (data_length.empty()) throw BrokenData("a record ends early");
      data_bytes_ = ByteCursor(data_length).number<std::uint32_t>();
      return fields;
    } catch (const BrokenData& error) {
      truncation_ =
          "is damaged or truncated at byte " + std::to_string(begin) + ": " + error.what();
      file_.goTo(file_.size());
      return std::nullopt;
    }
  }

  void readFileHeader() {
    const auto header = readHeader();
    if (!header) throw InputError(file_.path() + ": " + truncation_.value_or("is empty"));
    try {
      if (header->operation() != kFileHeader) throw BrokenData("it has no file header");
      index_position_ = header->number<std::uint64_t>("index_pos");
    } catch (const BrokenData& error) {
      throw InputError(file_.path() + ": is damaged at its beginning: " + error.what());
    }
    const std::string encryptor = header->text("encryptor");
    if (!encryptor.empty() && encryptor != "rosbag/NoEncryptor") {
      throw InputError(file_.path() + ": is encrypted; `rosbag encrypt` or `rosbag decrypt` first");
    }
  }

  /// Topics and numbers of messages by the index at the end of the file; false if it is damaged.
  bool readIndex() {
    if (index_position_ == 0 || index_position_ >= file_.size()) return false;
    file_.goTo(index_position_);
    try {
      while (const auto header = readHeader()) {
        const std::string_view data = file_.read(data_bytes_);
        if (data.size() != data_bytes_) return false;
        if (header->operation() == kConnection) addConnection(*header, data);
        if (header->operation() == kChunkInfo) countChunk(*header, data);
      }
    } catch (const BrokenData&) {
      return false;
    }
    return !truncation_ && !topics_.empty();
  }

  void countChunk(const Fields& header, std::string_view data) {
    ByteCursor cursor(data);
    for (auto i = header.number<std::uint32_t>("count"); i > 0; --i) {
      const auto connection = connections_.find(cursor.number<std::uint32_t>());
      const auto messages = cursor.number<std::uint32_t>();
      if (connection != connections_.end()) topics_[connection->second].messages += messages;
    }
  }

  void countMessages() {
    topics_.clear();
    connections_.clear();
    start();
    while (const auto message = next()) ++topics_[message->topic].messages;
  }

  void addConnection(const Fields& header, std::string_view data) {
    const auto id = header.number<std::uint32_t>("conn");
    if (connections_.count(id) > 0) return;
    BagTopic topic;
    topic.name = header.text("topic");
    topic.type = Fields(data).text("type");
    topic.encoding = Encoding::kRos1;
    connections_[id] = indexOf(topic);
  }

  /// Reads on to the next chunk; false at the end.
  bool openNextChunk() {
    while (const auto header = readHeader()) {
      const std::uint64_t end = file_.position() + data_bytes_;
      if (end > file_.size()) {
        truncation_ = "is truncated in the record at byte " + std::to_string(file_.position());
      }
      try {
        if (header->operation() == kChunkRecord) {
          openChunk(*header);
          return true;
        }
      } catch (const BrokenData&) {
        ++skipped_["broken_chunk"];
      }
      file_.goTo(end);
    }
    return false;
  }

  /// The chunk whose header was read; of a truncated one what there is.
  void openChunk(const Fields& header) {
    const auto bytes = file_.read(std::min(data_bytes_, file_.left()));
    if (bytes.empty()) throw BrokenData("a chunk is empty or too large");
    records_ = ByteCursor(decompress(header.text("compression"), bytes,
                                     header.number<std::uint32_t>("size"), chunk_));
  }

  std::optional<BagMessage> nextInChunk() {
    if (!records_) return std::nullopt;
    try {
      while (!records_->atEnd()) {
        const Fields header(records_->block());
        const std::string_view data = records_->block();
        const auto operation = header.operation();
        if (operation == kConnection) addConnection(header, data);
        if (operation != kMessageData) continue;
        const auto connection = connections_.find(header.number<std::uint32_t>("conn"));
        if (connection == connections_.end()) throw BrokenData("a message has no connection");
        const auto time = header.number<std::uint64_t>("time");  // seconds, nanoseconds
        return BagMessage{connection->second,
                          static_cast<std::int64_t>(time & 0xFFFFFFFF) * 1000000000 +
                              static_cast<std::int64_t>(time >> 32),
                          data};
      }
    } catch (const BrokenData&) {
      if (!truncation_) ++skipped_["broken_chunk"];
    }
    records_.reset();
    return std::nullopt;
  }

  BagFile file_;
  std::uint64_t index_position_ = 0;
  std::map<std::uint32_t, std::size_t> connections_;  ///< to topics
  std::uint64_t data_bytes_ = 0;                      ///< of the record whose header was read
  std::string chunk_;                                 ///< decompressed
  std::optional<ByteCursor> records_;                 ///< of the chunk
};

}  // namespace

std::unique_ptr<BagReader> openRos1Bag(const std::string& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace headway::bags
