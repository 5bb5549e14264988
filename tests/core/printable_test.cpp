// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/text.h>

namespace headway {
namespace {

TEST(PrintableTest, TextsRemain) {
  EXPECT_EQ("", printable(""));
  EXPECT_EQ("Größe 3 µm, 物体 \xF0\x9F\x9A\x97", printable("Größe 3 µm, 物体 \xF0\x9F\x9A\x97"));
}

TEST(PrintableTest, EscapeSequencesAndLineBreaksAreRemoved) {
  EXPECT_EQ("?[31mred?[0m", printable("\x1b[31mred\x1b[0m"));
  EXPECT_EQ("a b??", printable("a\nb\r\x7f"));
  EXPECT_EQ("?2J", printable("\xC2\x9B"
                             "2J"))
      << "U+009B introduces escape sequences, too";
  EXPECT_EQ("a?b", printable(std::string_view("a\0b", 3)));
}

TEST(PrintableTest, WhatIsNotUtf8IsReplaced) {
  EXPECT_EQ("?x", printable("\xFFx"));
  EXPECT_EQ("??", printable("\xC0\xAF")) << "overlong";
  EXPECT_EQ("???", printable("\xED\xA0\x80")) << "a surrogate";
  EXPECT_EQ("????", printable("\xF4\x90\x80\x80")) << "beyond U+10FFFF";
  EXPECT_EQ("ab?", printable("ab\xE2")) << "cut";
}

}  // namespace
}  // namespace headway
