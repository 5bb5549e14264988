#pragma once

#include <mrpt/io/CStream.h>
#include <zlib.h>

#include <string>

namespace headway::io {

/// Gz output stream that reports all write errors, including those of the final flush, which MRPT's
/// CFileGZOutputStream ignores.
class GzOutput : public mrpt::io::CStream {
 public:
  /// @throws InputError if the file cannot be written
  explicit GzOutput(const std::string& path);
  ~GzOutput() override;
  GzOutput(const GzOutput&) = delete;
  GzOutput& operator=(const GzOutput&) = delete;

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
  std::string path_;
  gzFile file_;
  bool has_failed_ = false;
};

/// Input stream of a gz-compressed or plain file, with access to zlib's error and the position,
/// which MRPT's CFileGZInputStream does not provide.
class GzInput : public mrpt::io::CStream {
 public:
  /// @throws InputError if the file cannot be opened, is empty or has another compression
  explicit GzInput(const std::string& path);
  ~GzInput() override;
  GzInput(const GzInput&) = delete;
  GzInput& operator=(const GzInput&) = delete;

  /// Returns fewer bytes than requested only at the end of the file or on an error.
  size_t Read(void* buffer, size_t count) override;
  /// Returns bytes to the stream, to be read again.
  void unread(const std::string& bytes);

  /// Whether the last Read() returned fewer bytes than requested.
  [[nodiscard]] bool lastWasShort() const { return last_was_short_; }
  /// zlib's error message; empty if there is none.
  [[nodiscard]] std::string compressionError() const;
  /// Number of uncompressed bytes read so far.
  uint64_t getPosition() const override { return position_ - (unread_.size() - unread_taken_); }
  /// Ratio of the file read so far, 0 to 1.
  [[nodiscard]] double progress() const;

  size_t Write(const void* buffer, size_t count) override;
  uint64_t Seek(int64_t offset, TSeekOrigin origin) override;
  uint64_t getTotalBytesCount() const override { return file_size_; }

 private:
  std::string path_;
  uint64_t file_size_ = 0;
  uint64_t position_ = 0;
  std::string unread_;            ///< bytes returned to the stream
  std::size_t unread_taken_ = 0;  ///< of these, read again
  bool last_was_short_ = false;
  gzFile file_ = nullptr;
};

}  // namespace headway::io
