// SPDX-License-Identifier: BSD-3-Clause
// One of two cameras fails in mid-run: the pair is not to be trusted within a second of motion, nor
// for a second after.
#include <gtest/gtest.h>
#include <headway_test/paths.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "failing_rig.h"

namespace headway::pipeline {
namespace {

constexpr std::size_t kStreetFrames = 57, kHallFrames = 86;  // 5.6 s of both

/// The beginning of a bundled recording.
Frames recorded(const std::string& name, std::size_t count, int width) {
  return recordedFrames(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/" + name, count, width);
}

class OneEyeTest : public testing::TestWithParam<std::size_t> {
 protected:
  /// Lets the rig fail for 1.5 s from several moments on, while it moves.
  static void failIn(const Frames& frames, const std::vector<std::size_t>& moments) {
    const FailingRig& tried = failingRigs()[GetParam()];
    const double interval_s = frames[1].time - frames[0].time;
    const auto second = static_cast<std::size_t>(std::lround(1.0 / interval_s));
    for (const std::size_t begin : moments) {
      SCOPED_TRACE(std::to_string(frames[0].stereo->left.cols) + " px, from frame " +
                   std::to_string(begin));
      const std::size_t end = begin + second + second / 2;
      const auto doubted = doubtedFrames(frames, tried.fail, begin, end);
      for (std::size_t i = 0; i < begin; ++i) EXPECT_FALSE(doubted[i]) << i;
      const auto noticed =
          begin + static_cast<std::size_t>(std::lround(tried.seconds / interval_s));
      // The right image is no longer wrong in the frame after the last one that it was late in.
      for (std::size_t i = noticed; i + 1 < end + second; ++i) EXPECT_TRUE(doubted[i]) << i;
      EXPECT_FALSE(doubted.at(end + second + second / 2));
    }
  }
};

TEST_P(OneEyeTest, IsNoticedInAStreetAtTwoSizes) {
  for (const int width : {672, 336}) {
    failIn(recorded("street.rawlog", kStreetFrames, width), {12, 25});
  }
}

TEST_P(OneEyeTest, IsNoticedInAHallAtTwoSizes) {
  for (const int width : {640, 320}) failIn(recorded("hall.rawlog", kHallFrames, width), {30, 40});
}

/// What the map alone shows: a right image that is shifted.
class ShiftedImageTest : public testing::TestWithParam<std::size_t> {};

TEST_P(ShiftedImageTest, IsNoticedByTheMap) {
  for (const auto& [name, width] : {std::pair("street.rawlog", 336), std::pair("hall.rawlog", 320),
                                    std::pair("hall.rawlog", 173)}) {
    SCOPED_TRACE(name + std::to_string(width));
    constexpr std::size_t kBegin = 30, kEnd = 45;
    const Frames frames = recorded(name, kStreetFrames + 10, width);
    const Noticed seen = noticed(frames, failingRigs()[GetParam()].fail, kBegin, kEnd);
    for (std::size_t i = 0; i < kBegin; ++i) EXPECT_FALSE(seen.doubted[i]) << i;
    for (std::size_t i = kBegin + 2; i < kEnd; ++i) EXPECT_TRUE(seen.doubted[i]) << i;
    const auto isNamed = [](const std::string& names) {
      return names.find("images_disagree") != std::string::npos;
    };
    EXPECT_TRUE(
        std::any_of(seen.findings.begin() + kBegin, seen.findings.begin() + kBegin + 10, isNamed));
  }
}

/// In small images, where rows differ by a fraction of a pixel.
class SmallImageTest : public testing::TestWithParam<std::size_t> {};

TEST_P(SmallImageTest, OfAnotherTimeIsNoticedWithinASecond) {
  for (const auto& [name, begin] : {std::pair("street.rawlog", 25), std::pair("hall.rawlog", 40)}) {
    SCOPED_TRACE(name);
    const Frames frames = recorded(name, kStreetFrames + 10, 173);
    const double interval_s = frames[1].time - frames[0].time;
    const auto second = static_cast<std::size_t>(std::lround(1.0 / interval_s));
    const auto first = static_cast<std::size_t>(begin);
    const auto doubted =
        doubtedFrames(frames, failingRigs()[GetParam()].fail, first, first + second + 5);
    for (std::size_t i = 0; i < first; ++i) EXPECT_FALSE(doubted[i]) << i;
    for (std::size_t i = first + second; i < first + second + 5; ++i) EXPECT_TRUE(doubted[i]) << i;
  }
}

/// Good images at the recorded rate, and at a half and a third of it.
TEST(GoodImagesTest, AreNotDoubted) {
  for (const auto& [name, width] :
       {std::pair("street.rawlog", 336), std::pair("hall.rawlog", 320),
        std::pair("street.rawlog", 173), std::pair("hall.rawlog", 173)}) {
    const Frames all = recorded(name, 90, width);
    for (const std::size_t every : {1U, 2U, 3U}) {
      SCOPED_TRACE(name + std::string(", every ") + std::to_string(every));
      Frames frames;
      for (std::size_t i = 0; i < all.size(); i += every) {
        frames.push_back(all[i]);
        frames.back().index = frames.size() - 1;
      }
      for (const std::string& finding :
           noticed(frames, {}, frames.size(), frames.size()).findings) {
        for (const char* doubt : {"one_image", "camera_frozen", "images_", "vertical_offset"}) {
          EXPECT_EQ(std::string::npos, finding.find(doubt)) << finding;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, ShiftedImageTest, testing::Range<std::size_t>(9, 12),
                         [](const auto& index) { return failingRigs()[index.param].name; });
INSTANTIATE_TEST_SUITE_P(Pairs, SmallImageTest, testing::Range<std::size_t>(4, 6),
                         [](const auto& index) { return failingRigs()[index.param].name; });
INSTANTIATE_TEST_SUITE_P(Pairs, OneEyeTest, testing::Range<std::size_t>(0, 9),
                         [](const auto& index) { return failingRigs()[index.param].name; });

}  // namespace
}  // namespace headway::pipeline
