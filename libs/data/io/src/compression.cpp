// SPDX-License-Identifier: BSD-3-Clause
#include "compression.h"

#include <headway/core/error.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

namespace headway::io {
namespace {

constexpr unsigned kGzBufferBytes = 1 << 17;
constexpr std::size_t kGzChunkBytes = 1 << 30;  // gzread and gzwrite count with int
constexpr int kZstandardLevel = 1;              // images are compressed already
constexpr int kMaxWindowLog = 27;               // 128 MiB, the largest that zstd makes by default

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

class GzDecompressor : public Decompressor {
 public:
  explicit GzDecompressor(const std::string& path) : file_(gzopen(path.c_str(), "rb")) {
    if (file_ == nullptr) throw InputError(path + ": cannot be opened for reading");
    gzbuffer(file_, kGzBufferBytes);
  }
  ~GzDecompressor() override { gzclose(file_); }
  GzDecompressor(const GzDecompressor&) = delete;
  GzDecompressor& operator=(const GzDecompressor&) = delete;

  std::size_t read(char* bytes, std::size_t count) override {
    std::size_t done = 0;
    while (done < count) {
      const auto chunk = static_cast<unsigned>(std::min(count - done, kGzChunkBytes));
      const int got = gzread(file_, bytes + done, chunk);
      if (got <= 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }
  [[nodiscard]] std::string error() const override {
    int status = Z_OK;
    const char* text = gzerror(file_, &status);
    return status < 0 && text != nullptr ? text : "";
  }
  [[nodiscard]] std::uint64_t position() const override {
    return static_cast<std::uint64_t>(std::max<z_off_t>(0, gzoffset(file_)));
  }

 private:
  gzFile file_;
};

/// One or several frames, one after the other.
class ZstdDecompressor : public Decompressor {
 public:
  explicit ZstdDecompressor(const std::string& path)
      : file_(std::fopen(path.c_str(), "rb")),
        stream_(ZSTD_createDCtx(), ZSTD_freeDCtx),
        compressed_(ZSTD_DStreamInSize()) {
    if (file_ == nullptr || stream_ == nullptr) {
      throw InputError(path + ": cannot be opened for reading");
    }
    ZSTD_DCtx_setParameter(stream_.get(), ZSTD_d_windowLogMax, kMaxWindowLog);
  }

  std::size_t read(char* bytes, std::size_t count) override {
    ZSTD_outBuffer out{bytes, count, 0};
    while (out.pos < out.size && error_.empty()) {
      if (input_.pos == input_.size && !refill()) break;
      const std::size_t status = ZSTD_decompressStream(stream_.get(), &out, &input_);
      if (ZSTD_isError(status) != 0) error_ = ZSTD_getErrorName(status);
      is_between_frames_ = status == 0;
    }
    return out.pos;
  }
  [[nodiscard]] std::string error() const override { return error_; }
  [[nodiscard]] std::uint64_t position() const override { return position_; }

 private:
  /// Reads more compressed bytes. At the end of the file, what the stream still holds may be had
  /// from an empty input, once.
  bool refill() {
    const std::size_t got = std::fread(compressed_.data(), 1, compressed_.size(), file_.get());
    position_ += got;
    input_ = {compressed_.data(), got, 0};
    if (got > 0) return true;
    if (is_between_frames_) return false;
    if (std::exchange(was_flushed_, true)) {
      error_ = "the compressed data end early";
      return false;
    }
    return true;
  }

  File file_;
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> stream_;
  std::vector<char> compressed_;
  ZSTD_inBuffer input_{nullptr, 0, 0};
  std::uint64_t position_ = 0;
  bool is_between_frames_ = true;
  bool was_flushed_ = false;
  std::string error_;
};

class GzCompressor : public Compressor {
 public:
  explicit GzCompressor(gzFile file) : file_(file) { gzbuffer(file_, kGzBufferBytes); }
  ~GzCompressor() override {
    if (file_ != nullptr) gzclose(file_);
  }
  GzCompressor(const GzCompressor&) = delete;
  GzCompressor& operator=(const GzCompressor&) = delete;

  std::size_t write(const char* bytes, std::size_t count) override {
    for (std::size_t done = 0; done < count;) {
      const auto chunk = static_cast<unsigned>(std::min(count - done, kGzChunkBytes));
      if (gzwrite(file_, bytes + done, chunk) != static_cast<int>(chunk)) return done;
      done += chunk;
    }
    return count;
  }
  [[nodiscard]] bool close() override { return gzclose(std::exchange(file_, nullptr)) == Z_OK; }

 private:
  gzFile file_;
};

class ZstdCompressor : public Compressor {
 public:
  explicit ZstdCompressor(File file)
      : file_(std::move(file)),
        stream_(ZSTD_createCCtx(), ZSTD_freeCCtx),
        compressed_(ZSTD_CStreamOutSize()) {
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_compressionLevel, kZstandardLevel);
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_checksumFlag, 1);
  }

  std::size_t write(const char* bytes, std::size_t count) override {
    ZSTD_inBuffer input{bytes, count, 0};
    while (input.pos < input.size) {
      if (!compress(input, ZSTD_e_continue)) return input.pos < count ? input.pos : count - 1;
    }
    return count;
  }
  [[nodiscard]] bool close() override {
    ZSTD_inBuffer nothing{nullptr, 0, 0};
    bool is_written = true;
    while (is_written && !is_complete_) is_written = compress(nothing, ZSTD_e_end);
    return std::fclose(file_.release()) == 0 && is_written;
  }

 private:
  bool compress(ZSTD_inBuffer& input, ZSTD_EndDirective directive) {
    ZSTD_outBuffer out{compressed_.data(), compressed_.size(), 0};
    const std::size_t left = ZSTD_compressStream2(stream_.get(), &out, &input, directive);
    is_complete_ = left == 0 && directive == ZSTD_e_end;
    return ZSTD_isError(left) == 0 &&
           std::fwrite(compressed_.data(), 1, out.pos, file_.get()) == out.pos;
  }

  File file_;
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> stream_;
  std::vector<char> compressed_;
  bool is_complete_ = false;
};

bool isZstandard(const std::string& path) {
  constexpr std::array<char, 4> kMagic = {'\x28', '\xB5', '\x2F', '\xFD'};
  std::array<char, 4> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  return magic == kMagic;
}

}  // namespace

std::unique_ptr<Decompressor> openCompressed(const std::string& path) {
  if (isZstandard(path)) return std::make_unique<ZstdDecompressor>(path);
  return std::make_unique<GzDecompressor>(path);
}

Compression compressionOf(const std::string& name) {
  constexpr std::string_view kEnding = ".zst";
  const bool is_zstandard =
      name.size() >= kEnding.size() &&
      name.compare(name.size() - kEnding.size(), kEnding.size(), kEnding) == 0;
  return is_zstandard ? Compression::kZstandard : Compression::kGzip;
}

std::unique_ptr<Compressor> createCompressed(const std::string& path, Compression compression) {
  if (compression == Compression::kZstandard) {
    File file(std::fopen(path.c_str(), "wb"));
    if (file == nullptr) return nullptr;
    return std::make_unique<ZstdCompressor>(std::move(file));
  }
  gzFile file = gzopen(path.c_str(), "wb1");
  if (file == nullptr) return nullptr;
  return std::make_unique<GzCompressor>(file);
}

}  // namespace headway::io
