// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/compression.h>
#include <mrpt/io/zip.h>
#include <mrpt/system/crc.h>

#include <random>
#include <sstream>

namespace headway {
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
  Compressor writer(out, Compression::kZlib);
  for (; !plain.empty(); plain.remove_prefix(std::min(piece, plain.size()))) {
    writer.write(plain.substr(0, piece));
  }
  writer.finish();
  return {out.str(), writer.plainSize(), writer.packedSize(), writer.packedChecksum()};
}

TEST(Compression, WritesTheBytesOfOneCallWhateverThePieces) {
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

/// So many bytes of the decompressed contents, or fewer if they end before.
std::string taken(Decompressor& data, std::size_t count) {
  std::string bytes(count, '\0');
  bytes.resize(data.read(bytes.data(), count));
  return bytes;
}

TEST(Compression, ReadsZlibInAnyPieces) {
  const std::string plain = longText();
  const std::string packed = written(plain, plain.size()).packed;
  const auto data = decompressorOf(packed, Compression::kZlib);
  EXPECT_TRUE(taken(*data, 3) == plain.substr(0, 3));
  EXPECT_TRUE(taken(*data, 4'000'000) == plain.substr(3, 4'000'000));
  EXPECT_TRUE(taken(*data, plain.size()) == plain.substr(4'000'003));
  EXPECT_EQ(taken(*data, 1), "");
  EXPECT_EQ(data->error(), "");
  EXPECT_EQ(data->position(), packed.size());
}

TEST(Compression, DamagedZlibDataAreAnError) {
  const std::string plain = longText();
  const std::string packed = written(plain, plain.size()).packed;
  const auto half = packed.substr(0, packed.size() / 2);
  const auto cut = decompressorOf(half, Compression::kZlib);
  EXPECT_LT(taken(*cut, plain.size()).size(), plain.size());
  EXPECT_NE(cut->error(), "");
  const auto other = decompressorOf("not compressed", Compression::kZlib);
  EXPECT_EQ(taken(*other, 100), "");
  EXPECT_NE(other->error(), "");
}

TEST(Compression, ZstandardIsReadAsItWasWritten) {
  const std::string plain = longText();
  std::ostringstream out;
  Compressor writer(out, Compression::kZstandard);
  writer.write(plain);
  writer.finish();
  const std::string packed = out.str();
  EXPECT_TRUE(isZstandard(packed));
  const auto data = decompressorOf(packed, Compression::kZstandard);
  EXPECT_TRUE(taken(*data, plain.size() + 1) == plain);
  EXPECT_EQ(data->error(), "");
  const auto half = packed.substr(0, packed.size() / 2);
  const auto cut = decompressorOf(half, Compression::kZstandard);
  EXPECT_LT(taken(*cut, plain.size()).size(), plain.size());
  EXPECT_NE(cut->error(), "");
}

TEST(Compression, NothingIsAValidContent) {
  const auto nothing = written("", 1).packed;
  const auto data = decompressorOf(nothing, Compression::kZlib);
  EXPECT_EQ(taken(*data, 1), "");
  EXPECT_EQ(data->error(), "");
}

}  // namespace
}  // namespace headway
