// SPDX-License-Identifier: BSD-3-Clause
#include "compressed_stream.h"

#include <headway/core/error.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

namespace headway::io {
namespace {

constexpr std::size_t kReadBytes = 1 << 17;
// Smaller files, such as those with images outside, are read in a few steps, so that the position
// in the file does not tell how much of its contents is processed.
constexpr std::uint64_t kSmallFile = 1 << 21;
constexpr std::uint64_t kMaxCounted = 1 << 27;

/// Uncompressed bytes of a file; nullopt if there are many.
std::optional<std::uint64_t> countContents(const std::string& path) {
  const auto file = openCompressed(path);
  std::vector<char> chunk(kReadBytes);
  std::uint64_t count = 0;
  while (count <= kMaxCounted) {
    const std::size_t got = file->read(chunk.data(), chunk.size());
    count += got;
    if (got < chunk.size()) return std::max<std::uint64_t>(1, count);
  }
  return std::nullopt;
}

}  // namespace

CompressedOutput::CompressedOutput(const std::string& path, std::string name)
    : name_(std::move(name)), file_(createCompressed(path, compressionOf(name_))) {
  if (file_ == nullptr) {
    throw InputError(name_ + ": cannot be written; check that its folder exists and is writable");
  }
}

size_t CompressedOutput::Write(const void* buffer, size_t count) {
  const std::size_t done = file_->write(static_cast<const char*>(buffer), count);
  has_failed_ = has_failed_ || done < count;
  written_ += done;
  return done;
}

void CompressedOutput::close() {
  const bool is_written = file_->close();
  file_.reset();
  if (!is_written) {
    throw InputError(name_ + ": not written completely; check the disk space");
  }
}

size_t CompressedOutput::Read(void* /*buffer*/, size_t /*count*/) {
  THROW_EXCEPTION("CompressedOutput cannot be read");
}

uint64_t CompressedOutput::Seek(int64_t /*offset*/, TSeekOrigin /*origin*/) {
  THROW_EXCEPTION("CompressedOutput has no random access");
}

uint64_t CompressedOutput::getTotalBytesCount() const { return getPosition(); }

uint64_t CompressedOutput::getPosition() const { return written_; }

CompressedInput::CompressedInput(const std::string& path) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a rawlog");
  }
  file_size_ = std::filesystem::file_size(path, error);
  if (error) throw InputError(path + ": cannot be opened: " + error.message());
  if (file_size_ == 0) throw InputError(path + ": is empty");
  file_ = openCompressed(path);
  const bool is_file = std::filesystem::is_regular_file(path, error);
  if (is_file && file_size_ <= kSmallFile) contents_ = countContents(path);
}

std::string_view CompressedInput::peek(std::size_t count) {
  if (filled_ - read_ < count && !at_end_) fill(count);
  return {buffer_.data() + read_, std::min(count, filled_ - read_)};
}

void CompressedInput::take(std::size_t count) { read_ += std::min(count, filled_ - read_); }

void CompressedInput::goTo(std::uint64_t position) {
  ASSERT_(position >= origin_ + mark_ && position <= origin_ + filled_);
  read_ = static_cast<std::size_t>(position - origin_);
}

std::string_view CompressedInput::at(std::uint64_t position, std::size_t count) const {
  ASSERT_(position >= origin_ && position + count <= origin_ + filled_);
  return {buffer_.data() + static_cast<std::size_t>(position - origin_), count};
}

/// Reads until `count` bytes follow, or the file ends.
void CompressedInput::fill(std::size_t count) {
  const std::size_t kept = std::min(mark_, read_);
  if (kept > 0) {
    std::memmove(buffer_.data(), buffer_.data() + kept, filled_ - kept);
    origin_ += kept;
    mark_ -= kept;
    read_ -= kept;
    filled_ -= kept;
  }
  while (filled_ - read_ < count) {
    const std::size_t chunk =
        std::min(std::max({count - (filled_ - read_), kReadBytes}), std::max(filled_, kReadBytes));
    if (buffer_.size() < filled_ + chunk) buffer_.resize(filled_ + chunk);
    const std::size_t got = file_->read(buffer_.data() + filled_, chunk);
    filled_ += got;
    if (got < chunk) {
      at_end_ = true;
      return;
    }
  }
}

std::string CompressedInput::compressionError() const { return file_->error(); }

double CompressedInput::progress() const {
  if (contents_) return static_cast<double>(position()) / static_cast<double>(*contents_);
  return std::min(1.0, static_cast<double>(file_->position()) / static_cast<double>(file_size_));
}

}  // namespace headway::io
