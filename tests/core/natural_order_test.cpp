// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/text.h>

#include <random>
#include <string>
#include <vector>

namespace headway {
namespace {

TEST(EndsWithTest, LooksAtTheLastCharactersOnly) {
  EXPECT_TRUE(endsWith("cam_left", "_left"));
  EXPECT_TRUE(endsWith("_left", "_left"));
  EXPECT_FALSE(endsWith("left", "_left"));
  EXPECT_FALSE(endsWith("_left_0", "_left"));
}

TEST(NaturalOrderTest, NumbersCountByTheirValue) {
  const std::vector<std::string> ordered = {"",
                                            "2_0.mcap",
                                            "10_0.mcap",
                                            "10_1.mcap",
                                            "10_11.mcap",
                                            "a",
                                            "a1",
                                            "a01b",
                                            "a1b2",
                                            "a01b10",
                                            "img0099",
                                            "img100",
                                            "img100.png",
                                            "img123456789012345678901234567890",
                                            "left_9.png",
                                            "left_10.png",
                                            "left_10_a.png"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      EXPECT_EQ(i < j, isNaturallyBefore(ordered[i], ordered[j]))
          << ordered[i] << ", " << ordered[j];
    }
  }
}

TEST(NaturalOrderTest, IsAStrictOrder) {
  std::mt19937 random(1);
  const auto text = [&random] {
    std::string result;
    for (auto length = random() % 5; length > 0; --length) result += "019a_"[random() % 5];
    return result;
  };
  for (int i = 0; i < 20000; ++i) {
    const std::string a = text(), b = text(), c = text();
    EXPECT_EQ(a != b, isNaturallyBefore(a, b) != isNaturallyBefore(b, a)) << a << ", " << b;
    if (isNaturallyBefore(a, b) && isNaturallyBefore(b, c)) {
      EXPECT_TRUE(isNaturallyBefore(a, c)) << a << ", " << b << ", " << c;
    }
  }
}

}  // namespace
}  // namespace headway
