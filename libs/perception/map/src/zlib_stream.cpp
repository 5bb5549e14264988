// SPDX-License-Identifier: BSD-3-Clause
#include "zlib_stream.h"

#include <headway/core/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>

namespace headway::map {
namespace {

/// Bytes handed to zlib at once; its counters have 32 bits.
constexpr std::size_t kPiece = 1u << 20;
constexpr int kMemoryLevel = 8;  // zlib's default

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

}  // namespace

std::uint32_t checksum(std::string_view bytes, std::uint32_t crc) {
  forEachPiece(bytes, [&](std::string_view piece) {
    crc = ~static_cast<std::uint32_t>(
        crc32(~crc, mutableBytes(piece), static_cast<uInt>(piece.size())));
  });
  return crc;
}

ZlibWriter::ZlibWriter(std::ostream& out, Format format)
    : out_(out), stream_(std::make_unique<z_stream>()) {
  const bool is_gz = format == Format::kGz;
  const int level = is_gz ? Z_BEST_SPEED : Z_DEFAULT_COMPRESSION;  // as MRPT's gz files
  const int window_bits = is_gz ? MAX_WBITS + 16 : MAX_WBITS;
  if (deflateInit2(stream_.get(), level, Z_DEFLATED, window_bits, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
}

ZlibWriter::~ZlibWriter() { deflateEnd(stream_.get()); }

void ZlibWriter::write(std::string_view bytes) {
  forEachPiece(bytes, [this](std::string_view piece) {
    stream_->next_in = mutableBytes(piece);
    stream_->avail_in = static_cast<uInt>(piece.size());
    deflateAll(Z_NO_FLUSH);
  });
  plain_size_ += bytes.size();
}

void ZlibWriter::finish() { deflateAll(Z_FINISH); }

void ZlibWriter::deflateAll(int flush) {
  std::array<char, 1u << 16> packed;
  do {
    stream_->next_out = reinterpret_cast<Bytef*>(packed.data());
    stream_->avail_out = packed.size();
    deflate(stream_.get(), flush);
    const std::string_view made(packed.data(), packed.size() - stream_->avail_out);
    out_.write(made.data(), static_cast<std::streamsize>(made.size()));
    packed_size_ += made.size();
    checksum_ = checksum(made, checksum_);
  } while (stream_->avail_out == 0);
}

ZlibReader::ZlibReader(std::string_view packed, std::uint64_t plain_size)
    : stream_(std::make_unique<z_stream>()), remaining_(plain_size) {
  if (inflateInit(stream_.get()) != Z_OK) throw std::bad_alloc();
  stream_->next_in = mutableBytes(packed);
  stream_->avail_in = static_cast<uInt>(packed.size());
}

ZlibReader::~ZlibReader() { inflateEnd(stream_.get()); }

std::string ZlibReader::take(std::uint64_t size) {
  if (size > remaining_) throw InputError("damaged: the data end early");
  std::string plain(size, '\0');
  forEachPiece(plain, [this](std::string_view piece) {
    stream_->next_out = mutableBytes(piece);
    stream_->avail_out = static_cast<uInt>(piece.size());
    const int result = inflate(stream_.get(), Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END) {
      throw InputError("damaged: cannot be decompressed");
    }
    if (stream_->avail_out != 0) throw InputError("damaged: fewer data than its header states");
  });
  remaining_ -= size;
  return plain;
}

}  // namespace headway::map
