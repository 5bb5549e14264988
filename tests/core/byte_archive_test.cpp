// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/byte_archive.h>

#include <limits>

namespace headway {
namespace {

enum class Lamp { kRed, kGreen };

TEST(ByteArchiveTest, RoundTrips) {
  ByteWriter out;
  out.value<std::int32_t>(-7);
  out.value(2.5);
  out.value(true);
  out.values(std::array<std::uint8_t, 3>{1, 2, 3});
  const Eigen::Matrix<double, 2, 3> matrix =
      (Eigen::Matrix<double, 2, 3>() << 1, 2, 3, 4, 5, 6).finished();
  out.matrix(matrix);
  out.text(std::string_view("a\0b", 3));
  ByteReader in(out.bytes);
  EXPECT_EQ(in.value<std::int32_t>(), -7);
  EXPECT_EQ(in.value<double>(), 2.5);
  EXPECT_EQ(in.value<std::uint8_t>(), 1);
  std::array<std::uint8_t, 3> values{};
  in.values(values);
  EXPECT_EQ(values, (std::array<std::uint8_t, 3>{1, 2, 3}));
  EXPECT_EQ((in.matrix<Eigen::Matrix<double, 2, 3>>()), matrix);
  EXPECT_EQ(in.text(), std::string("a\0b", 3));
  EXPECT_TRUE(in.atEnd());
}

TEST(ByteArchiveTest, NumbersAreLittleEndian) {
  ByteWriter out;
  out.value<std::uint32_t>(0x01020304);
  EXPECT_EQ(out.bytes, "\x04\x03\x02\x01");
}

TEST(ByteArchiveTest, TruncationAtAnyByteIsRefused) {
  ByteWriter out;
  out.count(3);
  for (const double x : {1.0, 2.0, 3.0}) out.value(x);
  const auto read = [](std::string_view bytes) {
    return ByteReader(bytes).list<double>([](ByteReader& in) { return in.value<double>(); });
  };
  EXPECT_EQ(read(out.bytes), (std::vector<double>{1.0, 2.0, 3.0}));
  for (std::size_t size = 0; size < out.bytes.size(); ++size) {
    EXPECT_THROW(static_cast<void>(read(std::string_view(out.bytes).substr(0, size))), InputError);
  }
}

TEST(ByteArchiveTest, ALargeCountFailsAtTheEndOfTheBytes) {
  ByteWriter out;
  out.count(std::numeric_limits<std::size_t>::max());
  ByteReader in(out.bytes), text(out.bytes);
  EXPECT_THROW(in.list<double>([](ByteReader& r) { return r.value<double>(); }), InputError);
  EXPECT_THROW(static_cast<void>(text.text()), InputError);
}

TEST(ByteArchiveTest, RefusesNonFiniteValuesAndUnknownEnumerators) {
  ByteWriter out;
  out.value(std::numeric_limits<double>::quiet_NaN());
  ByteReader number(out.bytes), matrix(out.bytes), unchecked(out.bytes);
  EXPECT_THROW(static_cast<void>(number.finiteValue<double>()), InputError);
  EXPECT_THROW((static_cast<void>(matrix.finiteMatrix<Eigen::Matrix<double, 1, 1>>())), InputError);
  EXPECT_TRUE(std::isnan(unchecked.value<double>()));
  const std::string one(1, '\1'), two(1, '\2');
  EXPECT_EQ(ByteReader(one).enumerator<Lamp>(2), Lamp::kGreen);
  EXPECT_THROW(static_cast<void>(ByteReader(two).enumerator<Lamp>(2)), InputError);
}

}  // namespace
}  // namespace headway
