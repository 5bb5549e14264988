// SPDX-License-Identifier: BSD-3-Clause
// Compression by zlib, gzip and Zstandard, of files and of bytes in memory; nothing else calls
// these libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace headway {

enum class Compression {
  kZlib,       ///< of map files, at zlib's default level
  kGzip,       ///< of rawlogs and MRPT's objects, at the fastest level, as MRPT writes them
  kZstandard,  ///< of rawlogs and bags, at the fastest level, with a checksum
};

/// CRC-32 as MRPT computes it (without inversion) of bytes that follow those of `crc`. The CRC-32
/// of zip files is ~checksum(bytes, ~0U).
[[nodiscard]] std::uint32_t checksum(std::string_view bytes, std::uint32_t crc = 0);

/// Compresses bytes to a stream piece by piece, in constant memory. The result does not depend on
/// the pieces; write errors are those of the stream.
class Compressor {
 public:
  Compressor(std::ostream& out, Compression compression);
  ~Compressor();

  void write(std::string_view bytes) { add(bytes, false); }
  /// Ends the compressed data; nothing can be written afterwards.
  void finish() { add({}, true); }

  [[nodiscard]] std::uint64_t plainSize() const { return plain_size_; }
  [[nodiscard]] std::uint64_t packedSize() const { return packed_size_; }
  [[nodiscard]] std::uint32_t packedChecksum() const { return checksum_; }

  class Codec;

 private:
  void add(std::string_view bytes, bool is_end);

  std::ostream& out_;
  std::unique_ptr<Codec> codec_;
  std::uint64_t plain_size_ = 0, packed_size_ = 0;
  std::uint32_t checksum_ = 0;
};

/// Decompressed contents, in order.
class Decompressor {
 public:
  virtual ~Decompressor() = default;
  /// Fewer bytes than asked for only at the end of the contents or on an error.
  virtual std::size_t read(char* bytes, std::size_t count) = 0;
  /// Why the contents ended early; empty if they did not.
  [[nodiscard]] virtual std::string error() const = 0;
  /// Number of compressed bytes read so far.
  [[nodiscard]] virtual std::uint64_t position() const = 0;
};

/// Opens a file that is compressed by gzip or Zstandard, told apart by their first bytes, or plain.
///
/// @throws InputError if it cannot be opened
[[nodiscard]] std::unique_ptr<Decompressor> openCompressed(const std::string& path);

/// Decompresses bytes that outlive it.
///
/// @param compression  kZlib or kZstandard
[[nodiscard]] std::unique_ptr<Decompressor> decompressorOf(std::string_view packed,
                                                           Compression compression);

/// Whether bytes begin as Zstandard's do.
[[nodiscard]] bool isZstandard(std::string_view bytes);
/// Number of bytes that Zstandard's data state for their contents; nullopt if they state none.
[[nodiscard]] std::optional<std::uint64_t> statedSize(std::string_view zstandard);

}  // namespace headway
