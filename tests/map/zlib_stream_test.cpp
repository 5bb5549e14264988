// SPDX-License-Identifier: BSD-3-Clause
#include "zlib_stream.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <mrpt/io/zip.h>
#include <mrpt/system/crc.h>

#include <random>
#include <sstream>

namespace headway::map {
namespace {

/// Bytes that compress a little, longer than the pieces that zlib gets.
std::string longText() {
  std::mt19937 random(3);
  std::string text(5'000'000, '\0');
  for (char& c : text) c = static_cast<char>('a' + random() % 11);
  return text;
}

struct Written {
  std::string packed;
  std::uint64_t plain_size, packed_size;
  std::uint32_t checksum;
};

Written written(std::string_view plain, std::size_t piece) {
  std::ostringstream out;
  ZlibWriter writer(out);
  for (; !plain.empty(); plain.remove_prefix(std::min(piece, plain.size()))) {
    writer.write(plain.substr(0, piece));
  }
  writer.finish();
  return {out.str(), writer.plainSize(), writer.packedSize(), writer.packedChecksum()};
}

TEST(ZlibStream, WritesTheBytesOfOneCallWhateverThePieces) {
  std::string plain = longText();
  std::vector<unsigned char> at_once;
  mrpt::io::zip::compress(plain.data(), plain.size(), at_once);
  for (const std::size_t piece : {plain.size(), std::size_t{1'000'003}, std::size_t{777}}) {
    const Written result = written(plain, piece);
    EXPECT_TRUE(result.packed == std::string(at_once.begin(), at_once.end())) << piece;
    EXPECT_EQ(result.plain_size, plain.size());
    EXPECT_EQ(result.packed_size, at_once.size());
    EXPECT_EQ(result.checksum, mrpt::system::compute_CRC32(at_once));
  }
}

TEST(ZlibStream, ReadsInAnyPieces) {
  const std::string plain = longText();
  const std::string packed = written(plain, plain.size()).packed;
  ZlibReader reader(packed, plain.size());
  EXPECT_TRUE(reader.take(3) == plain.substr(0, 3));
  EXPECT_TRUE(reader.take(4'000'000) == plain.substr(3, 4'000'000));
  EXPECT_FALSE(reader.atEnd());
  EXPECT_TRUE(reader.take(plain.size() - 4'000'003) == plain.substr(4'000'003));
  EXPECT_TRUE(reader.atEnd());
  EXPECT_THROW((void)reader.take(1), InputError);
}

TEST(ZlibStream, DamagedDataAreAnError) {
  const std::string plain = longText();
  const std::string packed = written(plain, plain.size()).packed;
  const auto half = packed.substr(0, packed.size() / 2);
  EXPECT_THROW((void)ZlibReader(half, plain.size()).take(plain.size()), InputError);
  EXPECT_THROW((void)ZlibReader(packed, plain.size() + 9).take(plain.size() + 9), InputError);
  EXPECT_THROW((void)ZlibReader("not compressed", 100).take(100), InputError);
  EXPECT_THROW((void)ZlibReader(packed, plain.size()).take(plain.size() + 1), InputError);
}

TEST(ZlibStream, NothingIsAValidContent) {
  const Written nothing = written("", 1);
  EXPECT_TRUE(ZlibReader(nothing.packed, 0).atEnd());
  EXPECT_EQ(ZlibReader(nothing.packed, 0).take(0), "");
}

}  // namespace
}  // namespace headway::map
