// SPDX-License-Identifier: BSD-3-Clause
// Rawlogs compressed by gzip and Zstandard.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <zstd.h>

#include <filesystem>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr std::size_t kWalls = 4;

std::string decompressed(const std::string& bytes) {
  std::string result(8 << 20, '\0');
  const std::size_t size =
      ZSTD_decompress(result.data(), result.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  result.resize(size);
  return result;
}

std::string compressed(const std::string& bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 19);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  result.resize(size);
  return result;
}

class ZstandardRawlogTest : public ::testing::Test {
 protected:
  ZstandardRawlogTest() { recordWalls(path_, kWalls); }
  static void recordWalls(const std::string& path, std::size_t frames) {
    test::recordWalls(path, frames);
  }
  void expectAllWalls() const {
    const auto frames = test::framesOf(path_);
    ASSERT_EQ(frames.size(), kWalls);
    for (std::size_t i = 0; i < kWalls; ++i) {
      EXPECT_TRUE(test::sameImage(frames[i].stereo->left, test::wall(static_cast<int>(i)).left));
      EXPECT_DOUBLE_EQ(frames[i].time, test::frameTime(i));
    }
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog.zst";
};

TEST_F(ZstandardRawlogTest, TheEndingOfTheNameDecidesOnWriting) {
  EXPECT_THAT(test::contentOf(path_), ::testing::StartsWith("\x28\xB5\x2F\xFD"));
  expectAllWalls();
  recordWalls(folder_ / "x.rawlog", kWalls);
  EXPECT_THAT(test::contentOf(folder_ / "x.rawlog"), ::testing::StartsWith("\x1f\x8b"));
}

TEST_F(ZstandardRawlogTest, TheFirstBytesDecideOnReading) {
  fs::rename(path_, folder_ / "x.rawlog");
  path_ = folder_ / "x.rawlog";
  expectAllWalls();
}

TEST_F(ZstandardRawlogTest, HoldsTheBytesOfAPlainRawlog) {
  const std::string plain = decompressed(test::contentOf(path_));
  path_ = folder_ / "plain.rawlog";
  test::writeContent(path_, plain);
  expectAllWalls();
}

TEST_F(ZstandardRawlogTest, FramesOfTheZstandardFormatFollowEachOther) {
  const std::string plain = decompressed(test::contentOf(path_));
  const std::size_t cut = plain.size() / 3;  // within an observation
  test::writeContent(
      path_, compressed(plain.substr(0, cut)) + compressed("") + compressed(plain.substr(cut)));
  expectAllWalls();
}

TEST_F(ZstandardRawlogTest, OneThatIsCutOffGivesWhatItHolds) {
  const std::string whole = test::contentOf(path_);
  std::size_t frames = 0;
  for (std::size_t size = 5; size < whole.size(); size += whole.size() / 97) {
    test::writeContent(path_, whole.substr(0, size));
    try {
      RawlogSource source(path_, {});
      const std::size_t count = test::framesOf(source).size();
      EXPECT_GE(count, frames);
      frames = count;
      EXPECT_TRUE(source.truncation()) << size;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("x.rawlog.zst")) << size;
    }
  }
  EXPECT_GE(frames, kWalls - 1);
}

TEST_F(ZstandardRawlogTest, OneWithAWrongBitIsAnErrorOrGivesFewerFrames) {
  const std::string whole = test::contentOf(path_);
  for (std::size_t at = 4; at < whole.size(); at += whole.size() / 211) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    test::writeContent(path_, bytes);
    try {
      RawlogSource source(path_, {});
      EXPECT_LE(test::framesOf(source).size(), kWalls);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("x.rawlog.zst")) << at;
    }
  }
}

TEST_F(ZstandardRawlogTest, ImagesAndTruthBelongToTheNameWithoutEndings) {
  test::recordWalls(path_, 1, ImageStorage::kExternalPng);
  EXPECT_TRUE(fs::is_directory(folder_ / "x_Images"));
  EXPECT_EQ(test::framesOf(path_).size(), 1U);
  for (const char* name : {"a/x.rawlog", "a/x.rawlog.gz", "a/x.rawlog.zst"}) {
    EXPECT_TRUE(hasRawlogName(name)) << name;
    EXPECT_EQ(rawlogStem(name), "a/x") << name;
  }
  for (const char* name : {"a/x.zst", "a/x.csv", "rawlog"}) EXPECT_FALSE(hasRawlogName(name));
}

}  // namespace
}  // namespace headway::io
