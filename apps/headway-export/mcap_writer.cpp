// SPDX-License-Identifier: BSD-3-Clause
// The MCAP format: chunks of timed messages with their indices.
#include "mcap_writer.h"

#include <headway/core/error.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>

namespace headway::exporting {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = 1 << 20;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// An unsigned number, little-endian.
template <typename Number>
std::string number(Number value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU);
  }
  return bytes;
}

std::string u16(std::uint64_t value) { return number(static_cast<std::uint16_t>(value)); }
std::string u32(std::uint64_t value) { return number(static_cast<std::uint32_t>(value)); }
std::string u64(std::uint64_t value) { return number(value); }

/// A string, map or array with its length before it.
std::string sized(std::string_view bytes) { return u32(bytes.size()) + std::string(bytes); }

std::string record(std::uint8_t opcode, std::string_view contents) {
  return std::string(1, static_cast<char>(opcode)) + u64(contents.size()) + std::string(contents);
}

std::uint32_t crcOf(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string compressed(const std::string& bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) throw InputError("a chunk cannot be compressed");
  result.resize(size);
  return result;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path) : file_(path) {
  put(kMagic);
  putRecord(kHeader, sized("") + sized("headway"));
}

std::uint16_t McapWriter::addTopic(const std::string& topic, const std::string& schema,
                                   const std::string& encoding, const std::string& description) {
  const auto next = static_cast<std::uint16_t>(schema_ids_.size() + 1);  // 0: no schema
  const auto [id, is_new] = schema_ids_.try_emplace(schema, next);
  if (is_new) {
    schemas_.push_back(u16(next) + sized(schema) + sized(encoding) + sized(description));
    chunk_ += record(kSchema, schemas_.back());
  }
  const auto channel = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back(u16(channel) + u16(id->second) + sized(topic) + sized(encoding) + sized(""));
  chunk_ += record(kChannel, channels_.back());
  message_counts_[channel] = 0;
  return channel;
}

void McapWriter::write(std::uint16_t topic, std::uint64_t time, std::string_view message) {
  index_[topic].emplace_back(time, chunk_.size());
  const std::uint64_t sequence = message_counts_[topic]++;
  chunk_ +=
      record(kMessage, u16(topic) + u32(sequence) + u64(time) + u64(time) + std::string(message));
  if (chunk_.size() >= kChunkBytes) endChunk();
}

void McapWriter::put(std::string_view bytes) {
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

void McapWriter::putRecord(std::uint8_t opcode, std::string_view contents) {
  put(record(opcode, contents));
}

void McapWriter::endChunk() {
  if (chunk_.empty()) return;
  ChunkIndex index;
  bool is_first = true;
  for (const auto& [topic, entries] : index_) {
    for (const auto& [time, offset] : entries) {
      index.start_time = is_first ? time : std::min(index.start_time, time);
      index.end_time = std::max(index.end_time, time);
      is_first = false;
    }
  }
  const std::string bytes = compressed(chunk_);
  index.offset = position_;
  putRecord(kChunk, u64(index.start_time) + u64(index.end_time) + u64(chunk_.size()) +
                        u32(crcOf(chunk_)) + sized("zstd") + u64(bytes.size()) + bytes);
  index.length = position_ - index.offset;
  index.compressed_size = bytes.size();
  index.size = chunk_.size();
  const std::uint64_t indices_at = position_;
  for (auto& [topic, entries] : index_) {
    std::stable_sort(entries.begin(), entries.end());
    index.index_offsets[topic] = position_;
    std::string list;
    for (const auto& [time, offset] : entries) list += u64(time) + u64(offset);
    putRecord(kMessageIndex, u16(topic) + sized(list));
  }
  index.index_length = position_ - indices_at;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  index_.clear();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, start = 0, end = 0;
  std::string counts;
  for (const auto& [topic, count] : message_counts_) {
    messages += count;
    counts += u16(topic) + u64(count);
  }
  bool is_first = true;
  for (const auto& chunk : chunks_) {
    if (chunk.index_offsets.empty()) continue;
    start = is_first ? chunk.start_time : std::min(start, chunk.start_time);
    end = std::max(end, chunk.end_time);
    is_first = false;
  }
  return u64(messages) + u16(schemas_.size()) + u32(channels_.size()) + u32(0) + u32(0) +
         u32(chunks_.size()) + u64(start) + u64(end) + sized(counts);
}

/// Groups of records of one kind, and where each group is.
void McapWriter::putSummary(std::uint64_t start) {
  std::string summary, offsets;
  const auto group = [&](std::uint8_t opcode, const std::vector<std::string>& contents) {
    const std::uint64_t group_start = start + summary.size();
    for (const auto& content : contents) summary += record(opcode, content);
    const std::uint64_t length = start + summary.size() - group_start;
    if (length == 0) return;
    offsets += record(kSummaryOffset,
                      std::string(1, static_cast<char>(opcode)) + u64(group_start) + u64(length));
  };
  std::vector<std::string> chunks;
  for (const auto& chunk : chunks_) {
    std::string places;
    for (const auto& [topic, offset] : chunk.index_offsets) places += u16(topic) + u64(offset);
    chunks.push_back(u64(chunk.start_time) + u64(chunk.end_time) + u64(chunk.offset) +
                     u64(chunk.length) + sized(places) + u64(chunk.index_length) + sized("zstd") +
                     u64(chunk.compressed_size) + u64(chunk.size));
  }
  group(kSchema, schemas_);
  group(kChannel, channels_);
  group(kStatistics, {statistics()});
  group(kChunkIndex, chunks);
  const std::uint64_t offsets_start = start + summary.size();
  // The checksum covers the footer up to itself.
  const std::string footer_start =
      std::string(1, static_cast<char>(kFooter)) + u64(20) + u64(start) + u64(offsets_start);
  const std::string checked = summary + offsets + footer_start;
  put(checked + u32(crcOf(checked)));
}

void McapWriter::finish() {
  endChunk();
  putRecord(kDataEnd, u32(0));  // without a checksum of all data; the chunks have theirs
  putSummary(position_);
  put(kMagic);
  file_.commit();
}

}  // namespace headway::exporting
