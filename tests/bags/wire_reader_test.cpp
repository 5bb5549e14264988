// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <limits>

#include "messages.h"

namespace headway::bags {
namespace {

std::string bytesOf(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes.push_back(static_cast<char>(value));
  return bytes;
}

TEST(WireReaderTest, CdrIsAlignedAfterItsEncapsulation) {
  const std::string bytes = bytesOf({0, 1, 0, 0, 7, 0, 0, 0, 5, 0, 0, 0, 2, 0, 0, 0, 'a', 0});
  WireReader in(bytes, Encoding::kCdr);
  EXPECT_FALSE(in.isRos1());
  EXPECT_EQ(7, in.number<std::uint8_t>());
  EXPECT_EQ(5u, in.number<std::uint32_t>());
  EXPECT_EQ("a", in.text());
  EXPECT_NO_THROW(in.requireEnd());
}

TEST(WireReaderTest, DoublesOfVersion2AreAlignedTo4) {
  std::string bytes = bytesOf({0, 7, 0, 0, 1, 0, 0, 0});
  const double value = 0.5;
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  WireReader in(bytes, Encoding::kCdr);
  EXPECT_EQ(1u, in.number<std::uint32_t>());
  EXPECT_EQ(0.5, in.number<double>());
  EXPECT_NO_THROW(in.requireEnd());
}

TEST(WireReaderTest, ReadsBigEndian) {
  const std::string bytes = bytesOf({0, 0, 0, 0, 0, 0, 1, 2});
  WireReader in(bytes, Encoding::kCdr);
  EXPECT_EQ(258u, in.number<std::uint32_t>());
}

TEST(WireReaderTest, Ros1IsNeitherAlignedNorTerminated) {
  const std::string bytes = bytesOf({7, 5, 0, 0, 0, 1, 0, 0, 0, 'a'});
  WireReader in(bytes, Encoding::kRos1);
  EXPECT_EQ(7, in.number<std::uint8_t>());
  EXPECT_EQ(5u, in.number<std::uint32_t>());
  EXPECT_EQ("a", in.text());
  EXPECT_NO_THROW(in.requireEnd());
}

TEST(WireReaderTest, LengthsAreCheckedBeforeMemoryIsAllocated) {
  const std::string huge = bytesOf({0xFF, 0xFF, 0xFF, 0xFF, 1, 2});
  EXPECT_THROW(WireReader(huge, Encoding::kRos1).text(), BrokenData);
  EXPECT_THROW(WireReader(huge, Encoding::kRos1).bytes(), BrokenData);
  EXPECT_THROW(WireReader(huge, Encoding::kRos1).numbers<double>(), BrokenData);
  EXPECT_THROW(WireReader(huge, Encoding::kRos1).number<double>(), BrokenData);
  EXPECT_THROW(WireReader(huge, Encoding::kRos1).requireEnd(), BrokenData);
  EXPECT_THROW(WireReader("", Encoding::kCdr), BrokenData);
  EXPECT_THROW(WireReader(bytesOf({0, 9, 0, 0}), Encoding::kCdr), BrokenData);
  EXPECT_THROW(WireReader(huge, Encoding::kOther), BrokenData);
}

TEST(MessagesTest, ARotationWithoutLengthIsBroken) {
  const std::string header(4 + 4 + 4, '\0');  // number, time
  const std::string empty(4, '\0');           // a string
  const std::string zeros(8 * (7 + 36 + 6 + 36), '\0');
  EXPECT_THROW((void)decodeOdometry(header + empty + empty + zeros, Encoding::kRos1), BrokenData);
}

}  // namespace
}  // namespace headway::bags
