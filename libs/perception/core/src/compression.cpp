// SPDX-License-Identifier: BSD-3-Clause
// zlib and Zstandard, with bounds on what is unpacked.
#include <headway/core/compression.h>
#include <headway/core/error.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <new>
#include <utility>
#include <vector>

namespace headway {
namespace {

constexpr std::size_t kPiece = 1 << 20;       // handed to zlib at once; its counters have 32 bits
constexpr unsigned kGzBufferBytes = 1 << 17;  // of the disk's reads
constexpr int kMaxWindowLog = 27;             // 128 MiB, the largest that zstd makes by default

Bytef* mutableBytes(std::string_view bytes) {
  return const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
}

/// Calls f with the parts of `bytes`, none longer than kPiece.
template <typename Function>
void forEachPiece(std::string_view bytes, const Function& f) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kPiece, bytes.size()))) {
    f(bytes.substr(0, kPiece));
  }
}

/// By gzread(), which also passes plain files through and continues with the next member.
class GzFile : public Decompressor {
 public:
  explicit GzFile(const std::string& path) : file_(gzopen(path.c_str(), "rb")) {
    if (file_ == nullptr) throw InputError(path + ": cannot be opened for reading");
    gzbuffer(file_, kGzBufferBytes);
  }
  ~GzFile() override { gzclose(file_); }
  GzFile(const GzFile&) = delete;
  GzFile& operator=(const GzFile&) = delete;

  std::size_t read(char* bytes, std::size_t count) override {
    constexpr std::size_t kMaxCount = 1 << 30;  // gzread() counts with int
    std::size_t done = 0;
    while (done < count) {
      const auto chunk = static_cast<unsigned>(std::min(count - done, kMaxCount));
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

class ZlibBytes : public Decompressor {
 public:
  explicit ZlibBytes(std::string_view packed) : packed_(packed) {
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~ZlibBytes() override { inflateEnd(&stream_); }
  ZlibBytes(const ZlibBytes&) = delete;
  ZlibBytes& operator=(const ZlibBytes&) = delete;

  std::size_t read(char* bytes, std::size_t count) override {
    std::size_t done = 0;
    while (done < count && !at_end_ && error_.empty()) {
      if (stream_.avail_in == 0) {
        const auto piece = packed_.substr(0, kPiece);
        packed_.remove_prefix(piece.size());
        stream_.next_in = mutableBytes(piece);
        stream_.avail_in = static_cast<uInt>(piece.size());
      }
      const auto room = static_cast<uInt>(std::min(count - done, kPiece));
      stream_.next_out = reinterpret_cast<Bytef*>(bytes + done);
      stream_.avail_out = room;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      done += room - stream_.avail_out;
      at_end_ = status == Z_STREAM_END;
      if (status == Z_BUF_ERROR) error_ = "the compressed data end early";
      if (status != Z_OK && status != Z_BUF_ERROR && !at_end_) error_ = "they are damaged";
    }
    return done;
  }
  [[nodiscard]] std::string error() const override { return error_; }
  [[nodiscard]] std::uint64_t position() const override { return stream_.total_in; }

 private:
  std::string_view packed_;  ///< not yet handed to zlib
  z_stream stream_{};
  bool at_end_ = false;
  std::string error_;
};

/// One or several frames, one after the other.
class Zstandard : public Decompressor {
 public:
  using Refill = std::function<std::string_view()>;

  /// @param refill  the next compressed bytes, none at the end
  explicit Zstandard(Refill refill)
      : refill_(std::move(refill)), stream_(ZSTD_createDCtx(), ZSTD_freeDCtx) {
    if (stream_ == nullptr) throw std::bad_alloc();
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
  /// Takes more compressed bytes. At their end, what the stream still holds may be had from an
  /// empty input, once.
  bool refill() {
    const std::string_view more = refill_();
    position_ += more.size();
    input_ = {more.data(), more.size(), 0};
    if (!more.empty()) return true;
    if (is_between_frames_) return false;
    if (!std::exchange(was_flushed_, true)) return true;
    error_ = "the compressed data end early";
    return false;
  }

  Refill refill_;
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> stream_;
  ZSTD_inBuffer input_{nullptr, 0, 0};
  std::uint64_t position_ = 0;
  bool is_between_frames_ = true;
  bool was_flushed_ = false;
  std::string error_;
};

Zstandard::Refill piecesOf(const std::string& path) {
  auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (!*file) throw InputError(path + ": cannot be opened for reading");
  return [file, piece = std::vector<char>(ZSTD_DStreamInSize())]() mutable {
    file->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    return std::string_view(piece.data(), static_cast<std::size_t>(file->gcount()));
  };
}

}  // namespace

/// Hands compressed bytes to a sink.
class Compressor::Codec {
 public:
  using Sink = std::function<void(std::string_view)>;
  virtual ~Codec() = default;
  virtual void add(std::string_view bytes, bool is_end, const Sink& sink) = 0;
};

namespace {

class ZlibCodec : public Compressor::Codec {
 public:
  explicit ZlibCodec(bool is_gzip) {
    constexpr int kGzipHeader = 16, kMemoryLevel = 8;  // of deflateInit2(), the latter its default
    const int level = is_gzip ? Z_BEST_SPEED : Z_DEFAULT_COMPRESSION;
    if (deflateInit2(&stream_, level, Z_DEFLATED, MAX_WBITS + (is_gzip ? kGzipHeader : 0),
                     kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~ZlibCodec() override { deflateEnd(&stream_); }
  ZlibCodec(const ZlibCodec&) = delete;
  ZlibCodec& operator=(const ZlibCodec&) = delete;

  void add(std::string_view bytes, bool is_end, const Sink& sink) override {
    forEachPiece(bytes, [&](std::string_view piece) {
      stream_.next_in = mutableBytes(piece);
      stream_.avail_in = static_cast<uInt>(piece.size());
      deflateAll(Z_NO_FLUSH, sink);
    });
    if (is_end) deflateAll(Z_FINISH, sink);
  }

 private:
  void deflateAll(int flush, const Sink& sink) {
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(packed_.data());
      stream_.avail_out = static_cast<uInt>(packed_.size());
      deflate(&stream_, flush);
      sink({packed_.data(), packed_.size() - stream_.avail_out});
    } while (stream_.avail_out == 0);
  }

  z_stream stream_{};
  std::array<char, 1U << 16U> packed_{};
};

class ZstandardCodec : public Compressor::Codec {
 public:
  ZstandardCodec() : stream_(ZSTD_createCCtx(), ZSTD_freeCCtx), packed_(ZSTD_CStreamOutSize()) {
    if (stream_ == nullptr) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_compressionLevel, 1);  // images are packed already
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_checksumFlag, 1);
  }

  void add(std::string_view bytes, bool is_end, const Sink& sink) override {
    ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
    std::size_t left = is_end ? 1 : 0;  // to be flushed
    while (input.pos < input.size || left > 0) {
      ZSTD_outBuffer out{packed_.data(), packed_.size(), 0};
      const std::size_t status =
          ZSTD_compressStream2(stream_.get(), &out, &input, is_end ? ZSTD_e_end : ZSTD_e_continue);
      if (ZSTD_isError(status) != 0) {
        throw InputError(std::string("cannot be compressed: ") + ZSTD_getErrorName(status));
      }
      sink({packed_.data(), out.pos});
      left = is_end ? status : 0;
    }
  }

 private:
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> stream_;
  std::vector<char> packed_;
};

}  // namespace

std::uint32_t checksum(std::string_view bytes, std::uint32_t crc) {
  forEachPiece(bytes, [&](std::string_view piece) {
    crc = ~static_cast<std::uint32_t>(
        crc32(~crc, mutableBytes(piece), static_cast<uInt>(piece.size())));
  });
  return crc;
}

Compressor::Compressor(std::ostream& out, Compression compression) : out_(out) {
  if (compression == Compression::kZstandard) {
    codec_ = std::make_unique<ZstandardCodec>();
  } else {
    codec_ = std::make_unique<ZlibCodec>(compression == Compression::kGzip);
  }
}

Compressor::~Compressor() = default;

void Compressor::add(std::string_view bytes, bool is_end) {
  codec_->add(bytes, is_end, [this](std::string_view packed) {
    out_.write(packed.data(), static_cast<std::streamsize>(packed.size()));
    packed_size_ += packed.size();
    checksum_ = checksum(packed, checksum_);
  });
  plain_size_ += bytes.size();
}

bool isZstandard(std::string_view bytes) { return bytes.substr(0, 4) == "\x28\xB5\x2F\xFD"; }

std::optional<std::uint64_t> statedSize(std::string_view zstandard) {
  const auto size = ZSTD_getFrameContentSize(zstandard.data(), zstandard.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return size;
}

std::unique_ptr<Decompressor> openCompressed(const std::string& path) {
  std::array<char, 4> first{};
  std::ifstream(path, std::ios::binary).read(first.data(), first.size());
  if (isZstandard({first.data(), first.size()})) return std::make_unique<Zstandard>(piecesOf(path));
  return std::make_unique<GzFile>(path);
}

std::unique_ptr<Decompressor> decompressorOf(std::string_view packed, Compression compression) {
  if (compression == Compression::kZlib) return std::make_unique<ZlibBytes>(packed);
  return std::make_unique<Zstandard>([packed]() mutable { return std::exchange(packed, {}); });
}

}  // namespace headway
