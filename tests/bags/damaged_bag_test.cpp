// SPDX-License-Identifier: BSD-3-Clause
// Bags that are truncated, changed byte by byte, or lie about lengths and types.
#include <gmock/gmock.h>
#include <headway_test/process.h>

#include <fstream>
#include <random>

#include "imported_bag.h"
#include "read_whole_bag.h"

namespace headway::bags {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class DamagedBag : public test::BagTest, public ::testing::WithParamInterface<test::BagFormat> {
 protected:
  [[nodiscard]] std::string bag() const { return at(std::string("b.") + GetParam().ending); }
};

TEST_P(DamagedBag, WhatPrecedesATruncationIsRead) {
  HEADWAY_WRITE_BAG(GetParam(), "mono", bag());
  const std::string bytes = headway::test::contentsOf(bag());
  std::size_t most = 0;
  for (const double ratio : {0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999}) {
    write(bag(),
          bytes.substr(0, static_cast<std::size_t>(ratio * static_cast<double>(bytes.size()))));
    most = std::max(most, test::readWholeBag(bag()));
  }
  EXPECT_GT(most, 100u);
  write(bag(), bytes.substr(0, bytes.size() * 7 / 10));
  const auto result = import(bag() + " -o " + at("x.rawlog"));
  if (std::string(GetParam().ending) == "db3") return;  // its pages are in no order of time
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("note: "), HasSubstr("truncated")));
}

TEST_P(DamagedBag, AnyByteMayBeWrong) {
  HEADWAY_WRITE_BAG(GetParam(), "mono", bag());
  const std::string bytes = headway::test::contentsOf(bag());
  std::mt19937 random(17);
  for (int i = 0; i < 120; ++i) {
    std::string damaged = bytes;
    // Half of the damage is where the structure is: at the beginning, and in the index at the end.
    const std::size_t span = i % 2 == 0 ? bytes.size() : std::min<std::size_t>(6000, bytes.size());
    const bool at_end = i % 4 == 1;
    for (int k = 0; k < 3; ++k) {
      const std::size_t place = random() % span;
      auto& byte = damaged[at_end ? bytes.size() - 1 - place : place];
      byte = i % 3 == 0 ? '\xFF' : static_cast<char>(byte ^ (1 << (random() % 8)));
    }
    write(bag(), damaged);
    (void)test::readWholeBag(bag());
  }
}

TEST_P(DamagedBag, LengthsOf4GigabytesAllocateNothing) {
  HEADWAY_WRITE_BAG(GetParam(), "mono", bag());
  const std::string bytes = headway::test::contentsOf(bag());
  for (std::size_t place = 0; place < std::min<std::size_t>(bytes.size() - 8, 3000); place += 23) {
    std::string damaged = bytes;
    damaged.replace(place, 4, "\xFF\xFF\xFF\xFF");
    write(bag(), damaged);
    (void)test::readWholeBag(bag());
  }
}

INSTANTIATE_TEST_SUITE_P(Bags, DamagedBag,
                         ::testing::Values(test::BagFormat{"bag", "none"},
                                           test::BagFormat{"bag", "lz4"},
                                           test::BagFormat{"mcap", "none"},
                                           test::BagFormat{"mcap", "zstd"},
                                           test::BagFormat{"db3", "none"}),
                         [](const auto& format) {
                           return std::string(format.param.ending) + "_" + format.param.compression;
                         });

using BrokenBagTest = test::BagTest;

TEST_F(BrokenBagTest, ForeignFilesAreRefusedWithTheCause) {
  write(at("a.bag"), "#ROSBAG V1.2\n");
  EXPECT_THAT(import(at("a.bag") + " --list").output, HasSubstr("rosbag fix"));
  write(at("a.bag"), "#ROSBAG V2.0\n");
  EXPECT_THAT(import(at("a.bag") + " --list").output, HasSubstr("a.bag: is empty"));
  write(at("a.bag"), "rubbish");
  EXPECT_THAT(import(at("a.bag") + " --list").output, HasSubstr("is no bag of ROS 1"));
  for (const char* name : {"a.bag", "a.mcap", "a.db3"}) {
    write(at(name), "version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n");
    EXPECT_THAT(import(at(name) + " --list").output,
                HasSubstr(std::string(name) + ": is a Git-LFS pointer"));
  }
  write(at("a.db3.zstd"), "\x28\xB5\x2F\xFD");
  EXPECT_THAT(import(at("a.db3.zstd") + " --list").output, HasSubstr("zstd -d"));
  write(at("a.mcap"), "\x89MCAP0\r\n");
  const auto result = import(at("a.mcap") + " --list");
  EXPECT_EQ(1, result.status);
  EXPECT_EQ(1, std::count(result.output.begin(), result.output.end(), '\n'));
}

/// A recorder that was killed leaves no index.
TEST_F(BrokenBagTest, Ros1BagsWithoutIndexAreRead) {
  HEADWAY_WRITE_BAG((test::BagFormat{"bag", "lz4"}), "mono", at("b.bag"));
  std::string bytes = headway::test::contentsOf(at("b.bag"));
  const auto field = bytes.find("index_pos=");
  ASSERT_NE(std::string::npos, field);
  bytes.replace(field + 10, 8, std::string(8, '\0'));
  write(at("b.bag"), bytes);
  EXPECT_THAT(import(at("b.bag") + " --list").output, HasSubstr("/imu/data  sensor_msgs/Imu  120"));
  EXPECT_THAT(import(at("b.bag") + " -o " + at("x.rawlog")).output, HasSubstr("12 frames, 120"));
}

TEST_F(BrokenBagTest, EncryptedBagsAreRefused) {
  HEADWAY_WRITE_BAG((test::BagFormat{"bag", "none"}), "mono", at("b.bag"));
  std::string bytes = headway::test::contentsOf(at("b.bag"));
  const auto field = bytes.find("chunk_count=");  // the header's length and padding stay
  const std::string added = "encryptor=rosbag/AesCbcEncryptor";
  bytes.replace(field + 16, 4 + added.size(), std::string("\x20\0\0\0", 4) + added);
  const auto grown = static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[13]) + 36);
  bytes[13] = static_cast<char>(grown);
  write(at("b.bag"), bytes);
  const auto result = import(at("b.bag") + " --list");
  EXPECT_EQ(1, result.status) << result.output;
}

/// A chunk whose checksum is wrong costs itself only.
TEST_F(BrokenBagTest, ABrokenChunkIsCounted) {
  HEADWAY_WRITE_BAG((test::BagFormat{"mcap", "none"}), "mono", at("b.mcap"));
  std::string bytes = headway::test::contentsOf(at("b.mcap"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write(at("b.mcap"), bytes);
  const auto result = import(at("b.mcap") + " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("broken_chunk 1"));
}

TEST_F(BrokenBagTest, MessagesOfAnotherTypeAreCounted) {
  HEADWAY_WRITE_BAG((test::BagFormat{"db3", "none"}), "mono", at("b.db3"));
  const std::string change =
      "import sqlite3; d = sqlite3.connect(\"" + at("b.db3") +
      "\"); d.execute(\"UPDATE topics SET type = \\\"sensor_msgs/msg/Imu\\\" WHERE name = "
      "\\\"/odom\\\"\"); d.commit()";
  ASSERT_EQ(0, headway::test::runProcess("/usr/bin/python3 -c '" + change + "'").status);
  const auto result = import(at("b.db3") + " --imu /odom -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("unreadable_sensor_msgs/Imu 12"));
}

}  // namespace
}  // namespace headway::bags
