#include "gz_stream.h"

#include <headway/core/error.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace headway::io {
namespace {

constexpr unsigned kBufferBytes = 1 << 17;
constexpr std::size_t kChunkBytes = 1 << 30;  // gzwrite counts with int
constexpr std::size_t kReadBytes = 1 << 17;

/// Rejects compressed formats that zlib would return as plain data.
void requireKnownCompression(const std::string& path) {
  std::array<unsigned char, 4> magic{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(magic.data()), magic.size());
  if (magic == std::array<unsigned char, 4>{0x28, 0xB5, 0x2F, 0xFD}) {
    throw InputError(path + ": is compressed with zstd (MRPT 2.15.7 and later), which " +
                     "is not supported; decompress it with 'zstd -d' or record with gz");
  }
}

}  // namespace

GzOutput::GzOutput(const std::string& path, std::string name)
    : name_(std::move(name)), file_(gzopen(path.c_str(), "wb1")) {
  if (file_ == nullptr) {
    throw InputError(name_ + ": cannot be written; check that its folder exists and is writable");
  }
  gzbuffer(file_, kBufferBytes);
}

GzOutput::~GzOutput() {
  if (file_ != nullptr) gzclose(file_);
}

size_t GzOutput::Write(const void* buffer, size_t count) {
  const auto* bytes = static_cast<const char*>(buffer);
  for (std::size_t done = 0; done < count;) {
    const auto chunk = static_cast<unsigned>(std::min(count - done, kChunkBytes));
    if (gzwrite(file_, bytes + done, chunk) != static_cast<int>(chunk)) {
      has_failed_ = true;
      return done;
    }
    done += chunk;
  }
  return count;
}

void GzOutput::close() {
  const int status = gzclose(file_);
  file_ = nullptr;
  if (status != Z_OK) {
    throw InputError(name_ + ": not written completely; check the disk space");
  }
}

size_t GzOutput::Read(void* /*buffer*/, size_t /*count*/) {
  THROW_EXCEPTION("GzOutput cannot be read");
}

uint64_t GzOutput::Seek(int64_t /*offset*/, TSeekOrigin /*origin*/) {
  THROW_EXCEPTION("GzOutput has no random access");
}

uint64_t GzOutput::getTotalBytesCount() const { return getPosition(); }

uint64_t GzOutput::getPosition() const { return static_cast<uint64_t>(gztell(file_)); }

GzInput::GzInput(const std::string& path) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a rawlog");
  }
  file_size_ = std::filesystem::file_size(path, error);
  if (error) throw InputError(path + ": cannot be opened: " + error.message());
  if (file_size_ == 0) throw InputError(path + ": is empty");
  requireKnownCompression(path);
  file_ = gzopen(path.c_str(), "rb");
  if (file_ == nullptr) throw InputError(path + ": cannot be opened for reading");
  gzbuffer(file_, kBufferBytes);
}

GzInput::~GzInput() {
  if (file_ != nullptr) gzclose(file_);
}

std::string_view GzInput::peek(std::size_t count) {
  if (filled_ - read_ < count && !at_end_) fill(count);
  return {buffer_.data() + read_, std::min(count, filled_ - read_)};
}

void GzInput::take(std::size_t count) { read_ += std::min(count, filled_ - read_); }

void GzInput::goTo(std::uint64_t position) {
  ASSERT_(position >= origin_ + mark_ && position <= origin_ + filled_);
  read_ = static_cast<std::size_t>(position - origin_);
}

std::string_view GzInput::at(std::uint64_t position, std::size_t count) const {
  ASSERT_(position >= origin_ && position + count <= origin_ + filled_);
  return {buffer_.data() + static_cast<std::size_t>(position - origin_), count};
}

/// Reads until `count` bytes follow, or the file ends.
void GzInput::fill(std::size_t count) {
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
    const int got = gzread(file_, buffer_.data() + filled_, static_cast<unsigned>(chunk));
    if (got <= 0) {
      at_end_ = true;
      return;
    }
    filled_ += static_cast<std::size_t>(got);
  }
}

std::string GzInput::compressionError() const {
  int status = Z_OK;
  const char* text = gzerror(file_, &status);
  return status < 0 && text != nullptr ? text : "";
}

double GzInput::progress() const {
  const auto offset = std::max<z_off_t>(0, gzoffset(file_));
  return std::min(1.0, static_cast<double>(offset) / static_cast<double>(file_size_));
}

}  // namespace headway::io
