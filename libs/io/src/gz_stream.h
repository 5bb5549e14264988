#pragma once

#include <mrpt/io/CStream.h>
#include <zlib.h>

#include <string>

namespace headway::io {

/// A file written as gz whose errors all come out, those of the last flush included.
class GzOutput : public mrpt::io::CStream {
 public:
  /// @throws InputError if the file cannot be written
  explicit GzOutput(const std::string& path);
  ~GzOutput() override;
  GzOutput(const GzOutput&) = delete;
  GzOutput& operator=(const GzOutput&) = delete;

  /// Fewer bytes than given only where the file cannot take them; hasFailed() from then on.
  size_t Write(const void* buffer, size_t count) override;
  [[nodiscard]] bool hasFailed() const { return has_failed_; }
  /// @throws InputError if what was written did not reach the file
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

/// A file read as gz, or as it is where it is not compressed.
class GzInput : public mrpt::io::CStream {
 public:
  /// @throws InputError if the file cannot be opened, is empty or is compressed in another way
  explicit GzInput(const std::string& path);
  ~GzInput() override;
  GzInput(const GzInput&) = delete;
  GzInput& operator=(const GzInput&) = delete;

  /// Fewer bytes than asked for only at the end of the file, or where it is broken.
  size_t Read(void* buffer, size_t count) override;
  /// Puts bytes back, to be read again next.
  void unread(const std::string& bytes);

  /// Whether the last Read() gave fewer bytes than asked for.
  [[nodiscard]] bool lastWasShort() const { return last_was_short_; }
  /// What zlib says of a broken compression; empty if it has nothing to say.
  [[nodiscard]] std::string compressionError() const;
  /// Bytes handed out so far, of the uncompressed content.
  uint64_t getPosition() const override { return position_ - (unread_.size() - unread_taken_); }
  /// Share of the file read so far, 0 to 1.
  [[nodiscard]] double progress() const;

  size_t Write(const void* buffer, size_t count) override;
  uint64_t Seek(int64_t offset, TSeekOrigin origin) override;
  uint64_t getTotalBytesCount() const override { return file_size_; }

 private:
  std::string path_;
  uint64_t file_size_ = 0;
  uint64_t position_ = 0;
  std::string unread_;            ///< bytes put back
  std::size_t unread_taken_ = 0;  ///< of them, read again
  bool last_was_short_ = false;
  gzFile file_ = nullptr;
};

}  // namespace headway::io
