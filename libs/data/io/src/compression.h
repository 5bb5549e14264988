// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace headway::io {

/// Contents of a compressed or plain file, in order.
class Decompressor {
 public:
  virtual ~Decompressor() = default;
  /// Fewer bytes than asked for only at the end of the file or on an error.
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

/// Compresses what is written to a file.
class Compressor {
 public:
  virtual ~Compressor() = default;
  /// Returns fewer bytes than given only on an error.
  virtual std::size_t write(const char* bytes, std::size_t count) = 0;
  /// Completes the file; false if it could not be written. At most once.
  [[nodiscard]] virtual bool close() = 0;
};

enum class Compression { kGzip, kZstandard };

/// Zstandard for names that end with ".zst", otherwise gzip.
[[nodiscard]] Compression compressionOf(const std::string& name);

/// Null if the file cannot be written.
[[nodiscard]] std::unique_ptr<Compressor> createCompressed(const std::string& path,
                                                           Compression compression);

}  // namespace headway::io
