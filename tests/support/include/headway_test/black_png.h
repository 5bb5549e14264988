// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>

namespace headway::test {

inline std::string bigEndian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
  return bytes;
}

inline std::string pngChunk(const std::string& type, const std::string& data) {
  const std::string content = type + data;
  const auto checksum =
      crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
  return bigEndian(static_cast<std::uint32_t>(data.size())) + content +
         bigEndian(static_cast<std::uint32_t>(checksum));
}

/// A valid black PNG with a bit per pixel, which is small on the disk and 8 times as large as its
/// pixels in memory.
inline std::string blackPng(std::uint32_t width, std::uint32_t height) {
  z_stream stream{};
  deflateInit(&stream, 1);
  std::string row(1 + (width + 7) / 8, '\0');
  std::string pixels(deflateBound(&stream, row.size() * height), '\0');
  stream.next_out = reinterpret_cast<Bytef*>(pixels.data());
  stream.avail_out = static_cast<uInt>(pixels.size());
  for (std::uint32_t i = 0; i < height; ++i) {
    stream.next_in = reinterpret_cast<Bytef*>(row.data());
    stream.avail_in = static_cast<uInt>(row.size());
    deflate(&stream, i + 1 < height ? Z_NO_FLUSH : Z_FINISH);
  }
  pixels.resize(stream.total_out);
  deflateEnd(&stream);
  return "\x89PNG\r\n\x1a\n" +
         pngChunk("IHDR", bigEndian(width) + bigEndian(height) + std::string("\1\0\0\0\0", 5)) +
         pngChunk("IDAT", pixels) + pngChunk("IEND", "");
}

}  // namespace headway::test
