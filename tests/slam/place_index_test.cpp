// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "place_recognition.h"

namespace headway::slam {
namespace {

std::vector<Descriptor> place(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Descriptor> descriptors(150);
  for (Descriptor& descriptor : descriptors) {
    for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random());
  }
  return descriptors;
}

/// The place seen again: a third of its corners are gone, and one bit in twelve has changed.
std::vector<Descriptor> seenAgain(unsigned seed) {
  auto descriptors = place(seed);
  descriptors.resize(100);
  std::mt19937 random(seed + 1000);
  for (Descriptor& descriptor : descriptors) {
    for (int flip = 0; flip < 21; ++flip) {
      const unsigned bit = random() % 256U;
      descriptor[bit / 8] = static_cast<std::uint8_t>(descriptor[bit / 8] ^ (1U << (bit % 8)));
    }
  }
  return descriptors;
}

bool any(KeyframeId /*id*/) { return true; }

TEST(PlaceIndexTest, FindsThePlaceAmongMany) {
  PlaceIndex index;
  for (unsigned i = 0; i < 200; ++i) index.add(KeyframeId{i}, place(i));
  for (unsigned i = 0; i < 200; i += 17) {
    const auto matches = index.query(seenAgain(i), 2, any);
    ASSERT_FALSE(matches.empty());
    EXPECT_EQ(matches[0].keyframe, KeyframeId{i});
    if (matches.size() > 1) {
      EXPECT_GT(matches[0].score, 2.0 * matches[1].score);
    }
  }
}

TEST(PlaceIndexTest, GivesOnlyWhatIsWantedAndNoMoreThanAskedFor) {
  PlaceIndex index;
  for (unsigned i = 0; i < 10; ++i) index.add(KeyframeId{i}, place(7));
  const auto matches = index.query(place(7), 3, [](KeyframeId id) { return id.value % 2 == 1; });
  ASSERT_EQ(matches.size(), 3U);
  for (const auto& match : matches) EXPECT_EQ(match.keyframe.value % 2, 1);
}

/// Neighbours see a place's corners, too, while those of a lonely keyframe are its own.
TEST(PlaceIndexTest, PrefersThePlaceToAKeyframeWithMoreWordsOfItsOwn) {
  PlaceIndex index;
  for (unsigned i = 0; i < 8; ++i) index.add(KeyframeId{i}, place(1));
  std::vector<Descriptor> crowded;
  for (unsigned i = 0; i < 40; ++i) {
    const auto more = place(100 + i);
    crowded.insert(crowded.end(), more.begin(), more.end());
  }
  index.add(KeyframeId{50}, crowded);
  auto asked = seenAgain(1);
  const auto clutter = place(99);
  asked.insert(asked.end(), clutter.begin(), clutter.end());
  EXPECT_LT(index.query(asked, 1, any).at(0).keyframe.value, 8);
}

TEST(PlaceIndexTest, DoesNotReturnWhatIsRemoved) {
  PlaceIndex index;
  index.add(KeyframeId{1}, place(1));
  index.remove(KeyframeId{1});
  index.remove(KeyframeId{5});
  EXPECT_TRUE(index.query(place(1), 5, any).empty());
}

TEST(PlaceIndexTest, IgnoresPointsWithoutDescriptor) {
  PlaceIndex index;
  index.add(KeyframeId{1}, std::vector<Descriptor>(20));
  EXPECT_TRUE(index.query(std::vector<Descriptor>(20), 5, any).empty());
}

}  // namespace
}  // namespace headway::slam
