// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/shared_chunks.h>

#include <numeric>

namespace headway {
namespace {

using Numbers = SharedChunks<int>;

std::shared_ptr<const std::vector<int>> chunk(std::vector<int> numbers) {
  return std::make_shared<const std::vector<int>>(std::move(numbers));
}

Numbers oneToFive() {
  Numbers numbers;
  numbers.append(chunk({1, 2}));
  numbers.append(chunk({}));
  numbers.append(chunk({3}));
  numbers.append(chunk({4, 5}));
  return numbers;
}

TEST(SharedChunksTest, IsOneSequence) {
  const Numbers numbers = oneToFive();
  EXPECT_EQ(std::vector<int>(numbers.begin(), numbers.end()), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(numbers.size(), 5U);
  EXPECT_EQ(numbers.front(), 1);
  EXPECT_EQ(numbers.back(), 5);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(numbers[i], static_cast<int>(i) + 1);
  EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), 0), 15);
}

TEST(SharedChunksTest, MayBeEmpty) {
  for (const Numbers& numbers : {Numbers(), Numbers({}), Numbers(std::vector<int>())}) {
    EXPECT_TRUE(numbers.empty());
    EXPECT_EQ(numbers.begin(), numbers.end());
  }
}

TEST(SharedChunksTest, CopiesShareTheirChunks) {
  const Numbers numbers = oneToFive();
  Numbers copy = numbers;
  copy.append(chunk({6}));
  EXPECT_EQ(&copy[3], &numbers[3]);
  EXPECT_EQ(numbers.size(), 5U);
  EXPECT_EQ(copy.back(), 6);
}

}  // namespace
}  // namespace headway
