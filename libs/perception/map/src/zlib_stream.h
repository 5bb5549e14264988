// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

struct z_stream_s;

namespace headway::map {

/// CRC-32 as MRPT computes it (without inversion) of bytes that follow those of `crc`.
[[nodiscard]] std::uint32_t checksum(std::string_view bytes, std::uint32_t crc = 0);

/// Compresses bytes to a stream piece by piece, in constant memory. The result does not depend on
/// the pieces.
class ZlibWriter {
 public:
  enum class Format { kZlib, kGz };

  explicit ZlibWriter(std::ostream& out, Format format = Format::kZlib);
  ~ZlibWriter();

  void write(std::string_view bytes);
  /// Ends the compressed data; nothing can be written afterwards.
  void finish();

  [[nodiscard]] std::uint64_t plainSize() const { return plain_size_; }
  [[nodiscard]] std::uint64_t packedSize() const { return packed_size_; }
  [[nodiscard]] std::uint32_t packedChecksum() const { return checksum_; }

 private:
  void deflateAll(int flush);

  std::ostream& out_;
  std::unique_ptr<z_stream_s> stream_;
  std::uint64_t plain_size_ = 0, packed_size_ = 0;
  std::uint32_t checksum_ = 0;
};

/// Decompresses the bytes of a ZlibWriter piece by piece; they must outlive the reader.
class ZlibReader {
 public:
  /// @param plain_size  number of bytes after decompression, as stored beside the data
  ZlibReader(std::string_view packed, std::uint64_t plain_size);
  ~ZlibReader();

  /// The next `size` bytes.
  ///
  /// @throws InputError if the data are damaged or end before
  [[nodiscard]] std::string take(std::uint64_t size);
  [[nodiscard]] bool atEnd() const { return remaining_ == 0; }

 private:
  std::unique_ptr<z_stream_s> stream_;
  std::uint64_t remaining_;
};

}  // namespace headway::map
