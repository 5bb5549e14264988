// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/io/CStream.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compression.h"

namespace headway::io {

/// Compressed output stream that reports all write errors, including those of the final flush,
/// which MRPT's CFileGZOutputStream ignores.
class CompressedOutput : public mrpt::io::CStream {
 public:
  /// @param name  of the file in messages; it decides on the compression
  /// @throws InputError if the file cannot be written
  CompressedOutput(const std::string& path, std::string name);
  ~CompressedOutput() override = default;
  CompressedOutput(const CompressedOutput&) = delete;
  CompressedOutput& operator=(const CompressedOutput&) = delete;

  /// Returns fewer bytes than given only on a write error; hasFailed() is then true.
  size_t Write(const void* buffer, size_t count) override;
  [[nodiscard]] bool hasFailed() const { return has_failed_; }
  /// @throws InputError if the data could not be written
  void close();

  size_t Read(void* buffer, size_t count) override;
  uint64_t Seek(int64_t offset, TSeekOrigin origin) override;
  uint64_t getTotalBytesCount() const override;
  uint64_t getPosition() const override;

 private:
  std::string name_;
  std::unique_ptr<Compressor> file_;
  std::uint64_t written_ = 0;
  bool has_failed_ = false;
};

/// Input of a compressed or plain file, from which bytes can be looked at before they are taken
/// and to which a reader can return after a failure.
///
/// The buffer grows only with bytes that the file has supplied, so that a length in a broken file
/// allocates no more than twice of what the file contains.
class CompressedInput {
 public:
  /// @throws InputError if the file cannot be opened or is empty
  explicit CompressedInput(const std::string& path);
  ~CompressedInput() = default;
  CompressedInput(const CompressedInput&) = delete;
  CompressedInput& operator=(const CompressedInput&) = delete;

  /// The next bytes, without taking them; fewer than `count` only at the end of the file or on an
  /// error. Valid until the next call.
  [[nodiscard]] std::string_view peek(std::size_t count);
  /// Takes bytes that peek() has returned.
  void take(std::size_t count);

  /// Keeps all bytes from here on, for goTo() and at().
  void mark() { mark_ = read_; }
  /// Continues at a position between the mark and the last byte looked at.
  void goTo(std::uint64_t position);
  /// Bytes between the mark and the last byte looked at. Valid until the next peek().
  [[nodiscard]] std::string_view at(std::uint64_t position, std::size_t count) const;

  /// Number of uncompressed bytes taken so far.
  [[nodiscard]] std::uint64_t position() const { return origin_ + read_; }
  /// The decompressor's error message; empty if there is none.
  [[nodiscard]] std::string compressionError() const;
  /// Ratio of the file taken so far, 0 to 1.
  [[nodiscard]] double progress() const;

 private:
  void fill(std::size_t count);

  std::string path_;
  std::uint64_t file_size_ = 0;
  std::optional<std::uint64_t> contents_;  ///< uncompressed bytes of a small file
  std::vector<char> buffer_;
  std::uint64_t origin_ = 0;  ///< position of the first byte of the buffer
  std::size_t mark_ = 0;      ///< in the buffer, as the following
  std::size_t read_ = 0;
  std::size_t filled_ = 0;
  bool at_end_ = false;
  std::unique_ptr<Decompressor> file_;
};

}  // namespace headway::io
