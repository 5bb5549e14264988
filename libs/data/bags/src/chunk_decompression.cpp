// SPDX-License-Identifier: BSD-3-Clause
#include "chunk_decompression.h"

#include <headway/core/error.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "bag_file.h"
#include "broken_data.h"
#if HEADWAY_HAS_LZ4
#include <lz4frame.h>
#endif
#if HEADWAY_HAS_BZIP2
#include <bzlib.h>
#endif

namespace headway::bags {
namespace {

constexpr std::size_t kFirstBytes = 1 << 16;
constexpr int kMaxWindow = 27;  // 128 MiB

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
    bytes_.resize(std::min(std::max(2 * filled_, kFirstBytes), size_));
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

void decompressZstd(std::string_view bytes, GrowingBuffer& buffer) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        ZSTD_freeDCtx);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kMaxWindow);
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  while (buffer.makeRoom()) {
    ZSTD_outBuffer output{buffer.room(), buffer.roomBytes(), 0};
    const std::size_t taken_before = input.pos;
    const std::size_t status = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(status) != 0) failDecompression();
    buffer.fill(output.pos);
    if (output.pos == 0 && input.pos == taken_before) failDecompression();
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
    decompressZstd(bytes, growing);
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
