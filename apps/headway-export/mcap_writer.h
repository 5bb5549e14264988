// SPDX-License-Identifier: BSD-3-Clause
// The MCAP format: chunks of timed messages with their indices.
#pragma once

#include <headway/core/output_file.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace headway::exporting {

/// Writes a file of timed messages in the MCAP format, version 0: chunks compressed with Zstandard,
/// each with an index, and a summary, so that viewers can jump to any time.
///
///     McapWriter mcap("street.mcap");
///     const auto topic = mcap.addTopic("/pose", "foxglove.PoseInFrame", "protobuf", descriptor);
///     mcap.write(topic, time_ns, message);
///     mcap.finish();
///
/// @see https://mcap.dev/spec
class McapWriter {
 public:
  /// @throws InputError if the file cannot be written
  explicit McapWriter(const std::filesystem::path& path);

  /// Declares a topic, before its first message.
  ///
  /// @param schema       name of the message's type
  /// @param encoding     of schema and messages: "protobuf"
  /// @param description  of the type, in its encoding
  [[nodiscard]] std::uint16_t addTopic(const std::string& topic, const std::string& schema,
                                       const std::string& encoding, const std::string& description);

  /// Appends a message. @param time  since 1970 [ns]
  void write(std::uint16_t topic, std::uint64_t time, std::string_view message);

  /// Writes the summary. @throws InputError if the file could not be written
  void finish();

 private:
  using TimesAndOffsets = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

  struct ChunkIndex {
    std::uint64_t start_time = 0, end_time = 0;
    std::uint64_t offset = 0, length = 0;                  ///< of the record in the file
    std::map<std::uint16_t, std::uint64_t> index_offsets;  ///< by topic
    std::uint64_t index_length = 0;
    std::uint64_t compressed_size = 0, size = 0;
  };

  void put(std::string_view bytes);
  void putRecord(std::uint8_t opcode, std::string_view contents);
  void endChunk();
  void putSummary(std::uint64_t start);
  [[nodiscard]] std::string statistics() const;

  OutputFile file_;
  std::uint64_t position_ = 0;
  std::string chunk_;
  std::map<std::uint16_t, TimesAndOffsets> index_;  ///< of the chunk, by topic
  std::vector<ChunkIndex> chunks_;
  std::vector<std::string> schemas_, channels_;  ///< contents of their records
  std::map<std::string, std::uint16_t> schema_ids_;
  std::map<std::uint16_t, std::uint64_t> message_counts_;
};

}  // namespace headway::exporting
