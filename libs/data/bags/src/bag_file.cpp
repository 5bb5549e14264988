// SPDX-License-Identifier: BSD-3-Clause
// Reading a file of a bag within bounds: records, their values, and compressed chunks.
#include "bag_file.h"

#include <headway/core/compression.h>
#include <headway/core/error.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#if HEADWAY_HAS_LZ4
#include <lz4frame.h>
#endif
#if HEADWAY_HAS_BZIP2
#include <bzlib.h>
#endif

namespace headway::bags {

BagFile::BagFile(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": does not exist");
  size_ = std::filesystem::file_size(path, error);
  if (error || !file_) throw InputError(path + ": cannot be opened for reading");
}

void BagFile::goTo(std::uint64_t position) {
  position_ = std::min(position, size_);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position_));
}

std::string_view BagFile::read(std::uint64_t count) {
  if (count > left() || count > kMaxRecordBytes) return {};
  buffer_.resize(static_cast<std::size_t>(count));
  file_.read(buffer_.data(), static_cast<std::streamsize>(count));
  if (!file_) {
    goTo(size_);  // a read error ends the file
    return {};
  }
  position_ += count;
  return buffer_;
}

namespace {

/// Memory for the next decompressed bytes: what is filled doubles, up to the stated size.
class GrowingBuffer {
 public:
  GrowingBuffer(std::string& bytes, std::uint64_t size)
      : bytes_(bytes), size_(static_cast<std::size_t>(size)) {
    bytes_.clear();
  }
  /// False if the stated size is reached.
  [[nodiscard]] bool makeRoom() {
    if (filled_ < bytes_.size()) return true;
    if (filled_ == size_) return false;
    bytes_.resize(std::min(std::max<std::size_t>(2 * filled_, 1 << 16), size_));
    return true;
  }
  [[nodiscard]] char* room() { return bytes_.data() + filled_; }
  [[nodiscard]] std::size_t roomBytes() const { return bytes_.size() - filled_; }
  void fill(std::size_t count) { filled_ += count; }
  [[nodiscard]] bool isComplete() const { return filled_ == size_; }

 private:
  std::string& bytes_;
  std::size_t size_;
  std::size_t filled_ = 0;
};

[[noreturn]] void failDecompression() { throw BrokenData("a compressed chunk is damaged"); }

[[maybe_unused]] [[noreturn]] void requirePackage(const char* what, const char* package) {
  throw InputError(std::string("the bag has chunks compressed by ") + what +
                   ", which this build of headway cannot read: install " + package +
                   " and build again");
}

void decompressZstandard(std::string_view bytes, GrowingBuffer& buffer) {
  const auto data = decompressorOf(bytes, Compression::kZstandard);
  while (buffer.makeRoom()) {
    const std::size_t count = data->read(buffer.room(), buffer.roomBytes());
    if (count == 0) failDecompression();
    buffer.fill(count);
  }
}

#if HEADWAY_HAS_LZ4
void decompressLz4(std::string_view bytes, GrowingBuffer& buffer) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)) != 0) {
    failDecompression();
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      created, LZ4F_freeDecompressionContext);
  while (buffer.makeRoom()) {
    std::size_t written = buffer.roomBytes();
    std::size_t taken = bytes.size();
    const std::size_t status =
        LZ4F_decompress(context.get(), buffer.room(), &written, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(status) != 0 || (written == 0 && taken == 0)) failDecompression();
    buffer.fill(written);
    bytes.remove_prefix(taken);
  }
}
#else
void decompressLz4(std::string_view /*bytes*/, GrowingBuffer& /*buffer*/) {
  requirePackage("lz4", "liblz4-dev");
}
#endif

#if HEADWAY_HAS_BZIP2
void decompressBz2(std::string_view bytes, GrowingBuffer& buffer) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) failDecompression();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(bytes.data());
  stream.avail_in = static_cast<unsigned>(bytes.size());
  while (buffer.makeRoom()) {
    stream.next_out = buffer.room();
    stream.avail_out = static_cast<unsigned>(buffer.roomBytes());
    const unsigned room = stream.avail_out;
    const unsigned input = stream.avail_in;
    const int status = BZ2_bzDecompress(&stream);
    buffer.fill(room - stream.avail_out);
    if (status == BZ_STREAM_END) break;
    if (status != BZ_OK || (stream.avail_out == room && stream.avail_in == input)) {
      failDecompression();
    }
  }
}
#else
void decompressBz2(std::string_view /*bytes*/, GrowingBuffer& /*buffer*/) {
  requirePackage("bzip2", "libbz2-dev");
}
#endif

}  // namespace

std::string_view decompress(const std::string& compression, std::string_view bytes,
                            std::uint64_t size, std::string& buffer) {
  if (compression.empty() || compression == "none") return bytes;
  if (size > kMaxRecordBytes) throw BrokenData("a chunk is larger than 128 MB");
  GrowingBuffer growing(buffer, size);
  if (compression == "zstd") {
    decompressZstandard(bytes, growing);
  } else if (compression == "lz4") {
    decompressLz4(bytes, growing);
  } else if (compression == "bz2") {
    decompressBz2(bytes, growing);
  } else {
    throw BrokenData("a chunk has an unknown compression");
  }
  if (!growing.isComplete()) failDecompression();
  return buffer;
}

}  // namespace headway::bags
