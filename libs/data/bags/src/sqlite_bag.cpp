// SPDX-License-Identifier: BSD-3-Clause
// Bags of ROS 2 in SQLite databases, as rosbag2 writes them.
#include <headway/core/compression.h>
#include <headway/core/error.h>

#include <algorithm>

#include "bag_file.h"
#include "bag_formats.h"
#if HEADWAY_HAS_SQLITE
#include <sqlite3.h>
#endif

namespace headway::bags {

#if HEADWAY_HAS_SQLITE
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinaliseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinaliseStatement>;

/// A blob or a text of the current row; valid until the next step.
std::string_view bytesAt(sqlite3_stmt* row, int column) {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(row, column));
  const int count = sqlite3_column_bytes(row, column);
  return bytes == nullptr ? std::string_view()
                          : std::string_view(bytes, static_cast<std::size_t>(count));
}

class SqliteBag : public BagReader {
 public:
  explicit SqliteBag(const std::string& path) : path_(path) {
    open();
    const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics");
    while (step(topics)) addTopic(topics.get());
    const Statement counts = prepare("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
    while (step(counts)) addCount(counts.get());
    requireTopics(path, "topics");
    messages_ = prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp");
  }

  double progress() const override {
    return total_ == 0 ? 1.0 : static_cast<double>(read_) / static_cast<double>(total_);
  }

  std::optional<BagMessage> next() override {
    while (step(messages_)) {
      ++read_;
      const auto topic = topic_of_.find(sqlite3_column_int64(messages_.get(), 0));
      if (topic == topic_of_.end()) {
        ++skipped_["message_without_topic"];
        continue;
      }
      const auto content = plain(bytesAt(messages_.get(), 2));
      if (!content) continue;
      return BagMessage{topic->second, sqlite3_column_int64(messages_.get(), 1), *content};
    }
    return std::nullopt;
  }

 private:
  void open() {
    sqlite3* opened = nullptr;
    const int status = sqlite3_open_v2(path_.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(opened);
    if (status != SQLITE_OK) fail();
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxRecordBytes));
    // A file from elsewhere must not make SQLite run what is in its schema.
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_exec(opened, "PRAGMA cell_size_check=ON; PRAGMA mmap_size=0", nullptr, nullptr,
                 nullptr);
  }

  [[noreturn]] void fail() const {
    throw InputError(path_ + ": is no recording of rosbag2 that can be read: " +
                     (database_ ? sqlite3_errmsg(database_.get()) : "out of memory"));
  }

  [[nodiscard]] Statement prepare(const char* query) const {
    sqlite3_stmt* statement = nullptr;
    const int status = sqlite3_prepare_v2(database_.get(), query, -1, &statement, nullptr);
    Statement result(statement);
    if (status != SQLITE_OK) fail();
    return result;
  }

  /// Whether there is a further row; an error ends the recording.
  bool step(const Statement& statement) {
    const int status = sqlite3_step(statement.get());
    if (status == SQLITE_ROW) return true;
    if (status != SQLITE_DONE && !truncation_) {
      truncation_ = "is damaged after " + std::to_string(read_) +
                    " messages: " + sqlite3_errmsg(database_.get());
    }
    return false;
  }

  void addTopic(sqlite3_stmt* row) {
    BagTopic topic;
    topic.name = bytesAt(row, 1);
    topic.type = ros1TypeOf(std::string(bytesAt(row, 2)));
    topic.encoding = encodingOf(std::string(bytesAt(row, 3)));
    topic_of_[sqlite3_column_int64(row, 0)] = topics_.size();
    topics_.push_back(topic);
  }

  void addCount(sqlite3_stmt* row) {
    const auto topic = topic_of_.find(sqlite3_column_int64(row, 0));
    const auto count =
        static_cast<std::uint64_t>(std::max<sqlite3_int64>(0, sqlite3_column_int64(row, 1)));
    total_ += count;
    if (topic != topic_of_.end()) topics_[topic->second].messages = count;
  }

  /// The message, decompressed if rosbag2 compressed each by Zstandard; nullopt if it is broken.
  std::optional<std::string_view> plain(std::string_view content) {
    if (!isZstandard(content)) return content;
    try {
      const auto size = statedSize(content);
      if (!size) throw BrokenData("a compressed message does not state its size");
      return decompress("zstd", content, *size, decompressed_);
    } catch (const BrokenData&) {
      ++skipped_["broken_message"];
      return std::nullopt;
    }
  }

  std::string path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement messages_;  // after its database, so that it is finalised first
  std::map<std::int64_t, std::size_t> topic_of_;  ///< by id
  std::uint64_t total_ = 0;
  std::uint64_t read_ = 0;
  std::string decompressed_;
};

}  // namespace

std::unique_ptr<BagReader> openSqliteBag(const std::string& path) {
  return std::make_unique<SqliteBag>(path);
}
#else
std::unique_ptr<BagReader> openSqliteBag(const std::string& path) {
  throw InputError(path + ": is a .db3 recording, which this build of headway cannot read: " +
                   "install libsqlite3-dev and build again, or record with `-s mcap`");
}
#endif

}  // namespace headway::bags
