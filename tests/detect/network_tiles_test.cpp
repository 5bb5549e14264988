// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "network_boxes.h"

namespace headway::detect {
namespace {

constexpr double kIou = 0.5;

/// Two tiles of 400 px of an image of 700 px.
const cv::Rect kLeft(0, 0, 400, 400);
const cv::Rect kRight(300, 0, 400, 400);
constexpr int kWidth = 700;

NetworkBox box(double left, double right, double score, std::size_t network_class = 2) {
  return {{left, 100, right, 200}, score, network_class};
}

TEST(NetworkTilesTest, CoverAWideImageAndOverlap) {
  const auto tiles = tilesOf({1242, 375}, {416, 416});
  ASSERT_EQ(4u, tiles.size());
  EXPECT_EQ(0, tiles.front().x);
  EXPECT_EQ(1242, tiles.back().x + tiles.back().width);
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    EXPECT_EQ(375, tiles[k].width) << "the network's proportions";
    EXPECT_EQ(375, tiles[k].height);
    if (k > 0) {
      EXPECT_GE(tiles[k - 1].x + tiles[k - 1].width - tiles[k].x, 75) << k;
    }
  }
}

TEST(NetworkTilesTest, AreFewInAnyImage) {
  for (const cv::Size size : {cv::Size(10000, 64), cv::Size(30000, 1), cv::Size(4000, 3)}) {
    EXPECT_LE(tilesOf(size, {416, 416}).size(), 12u) << size;
    EXPECT_EQ(size.width, tilesOf(size, {416, 416}).back().br().x) << size;
  }
}

TEST(NetworkTilesTest, PartsInThreeTilesAreOneObject) {
  const std::vector<TileBoxes> tiles = {
      {{0, 0, 1000, 400}, {}},
      {{0, 0, 400, 400}, {box(250, 399, 0.4)}},
      {{300, 0, 400, 400}, {box(301, 699, 0.6)}},
      {{600, 0, 400, 400}, {box(601, 800, 0.5)}},
  };
  const auto joined = joinTiles(tiles, 1000, kIou);
  ASSERT_EQ(1u, joined.size());
  EXPECT_EQ(250, joined.front().box.left);
  EXPECT_EQ(800, joined.front().box.right);
}

TEST(NetworkTilesTest, LeaveOthersWhole) {
  EXPECT_EQ(1u, tilesOf({640, 480}, {416, 416}).size());
  EXPECT_EQ(1u, tilesOf({480, 640}, {416, 416}).size());
  EXPECT_EQ(1u, tilesOf({1242, 375}, {1248, 384}).size());
}

TEST(NetworkTilesTest, AnObjectInTheOverlapIsOne) {
  const auto joined =
      joinTiles({{kLeft, {box(310, 380, 0.6)}}, {kRight, {box(312, 381, 0.8)}}}, kWidth, kIou);
  ASSERT_EQ(1u, joined.size());
  EXPECT_EQ(0.8, joined[0].score);
}

TEST(NetworkTilesTest, AWholeBoxSuppressesAPartOfGreaterScore) {
  const auto joined =
      joinTiles({{kLeft, {box(280, 390, 0.6)}}, {kRight, {box(301, 392, 0.9)}}}, kWidth, 0.9);
  ASSERT_EQ(1u, joined.size());
  EXPECT_EQ(280, joined[0].box.left);
}

TEST(NetworkTilesTest, TwoPartsOfALargeObjectAreJoined) {
  const auto joined =
      joinTiles({{kLeft, {box(200, 399, 0.6)}}, {kRight, {box(301, 560, 0.9)}}}, kWidth, kIou);
  ASSERT_EQ(1u, joined.size());
  EXPECT_EQ(200, joined[0].box.left);
  EXPECT_EQ(560, joined[0].box.right);
  EXPECT_EQ(0.9, joined[0].score);
}

TEST(NetworkTilesTest, KeepsObjectsThatOnlyMeetAtAnEdge) {
  const auto rows_differ = [](NetworkBox low) {
    low.box.top = 300;
    low.box.bottom = 390;
    return low;
  };
  EXPECT_EQ(2u,
            joinTiles({{kLeft, {box(200, 399, 0.6)}}, {kRight, {rows_differ(box(301, 560, 0.9))}}},
                      kWidth, kIou)
                .size());
  EXPECT_EQ(2u, joinTiles({{kLeft, {box(200, 399, 0.6)}}, {kRight, {box(301, 560, 0.9, 0)}}},
                          kWidth, kIou)
                    .size())
      << "of another class";
  EXPECT_EQ(1u, joinTiles({{kLeft, {box(200, 399, 0.6)}}, {kRight, {}}}, kWidth, kIou).size())
      << "a part alone remains";
}

TEST(NetworkTilesTest, TheImagesOwnBordersCutNothing) {
  const auto joined =
      joinTiles({{kLeft, {box(0, 150, 0.6)}}, {kRight, {box(600, 700, 0.9)}}}, kWidth, kIou);
  ASSERT_EQ(2u, joined.size());
  EXPECT_EQ(0.9, joined[0].score) << "best first";
}

}  // namespace
}  // namespace headway::detect
