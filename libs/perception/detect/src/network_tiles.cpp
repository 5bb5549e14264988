// SPDX-License-Identifier: BSD-3-Clause
#include "network_tiles.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <cmath>

#include "network_output.h"

namespace headway::detect {
namespace {

constexpr double kMinOverlap = 0.2;          // of neighbouring tiles, over their width
constexpr double kEnoughPixels = 2.0 / 3.0;  // per row of the whole image, over those of a tile
constexpr double kEdge_px = 6.0;             // boxes that end nearer to a tile's edge are cut by it
constexpr int kMaxTiles = 8;                 // narrower than a tile by less than the overlap
constexpr double kSameRows = 0.5;            // of the lower of two parts of one object, in common
constexpr double kPartInside = 0.7;          // of a cut box inside the whole one

/// A box, and by which inner edges of its tile it is cut.
struct TileBox {
  NetworkBox box;
  bool cut_left = false;
  bool cut_right = false;
  std::size_t first_tile = 0;
  std::size_t last_tile = 0;  ///< another one if the box is joined of parts

  [[nodiscard]] bool isCut() const { return cut_left || cut_right; }
};

std::vector<TileBox> markCuts(const std::vector<TileBoxes>& tiles, int image_width) {
  std::vector<TileBox> marked;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const cv::Rect& tile = tiles[t].tile;
    for (const NetworkBox& box : tiles[t].boxes) {
      TileBox one{box, false, false, t, t};
      one.cut_left = tile.x > 0 && box.box.left < tile.x + kEdge_px;
      one.cut_right =
          tile.x + tile.width < image_width && box.box.right > tile.x + tile.width - kEdge_px;
      marked.push_back(one);
    }
  }
  // Complete boxes first, so that they suppress their parts.
  std::stable_sort(marked.begin(), marked.end(), [](const TileBox& a, const TileBox& b) {
    if (a.isCut() != b.isCut()) return b.isCut();
    return a.box.score > b.box.score;
  });
  return marked;
}

bool sameRows(const Box2d& a, const Box2d& b) {
  const double common = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return common > kSameRows * std::max(a.height(), b.height());
}

/// Whether two cut boxes of neighbouring tiles are parts of one object.
bool areParts(const TileBox& a, const TileBox& b) {
  const TileBox& left = a.first_tile < b.first_tile ? a : b;
  const TileBox& right = a.first_tile < b.first_tile ? b : a;
  return right.first_tile == left.last_tile + 1 && left.cut_right && right.cut_left &&
         left.box.box.right > right.box.box.left && sameRows(left.box.box, right.box.box);
}

/// Extends a part by another one, which may be cut on its far side.
void join(const TileBox& part, TileBox& whole) {
  const bool from_left = part.first_tile < whole.first_tile;
  Box2d& box = whole.box.box;
  const Box2d& other = part.box.box;
  box = {std::min(box.left, other.left), std::min(box.top, other.top),
         std::max(box.right, other.right), std::max(box.bottom, other.bottom)};
  (from_left ? whole.cut_left : whole.cut_right) = from_left ? part.cut_left : part.cut_right;
  (from_left ? whole.first_tile : whole.last_tile) = from_left ? part.first_tile : part.last_tile;
}

bool suppresses(const TileBox& kept, const TileBox& other, double nms_iou) {
  if (overlap2d(kept.box.box, other.box.box) > nms_iou) return true;
  const bool is_other_tile = kept.first_tile > other.last_tile || kept.last_tile < other.first_tile;
  return other.isCut() && is_other_tile && ratioInside(other.box.box, kept.box.box) > kPartInside;
}

}  // namespace

std::vector<cv::Rect> tilesOf(cv::Size image, cv::Size input) {
  const int narrowest = (image.width + kMaxTiles - 1) / kMaxTiles;
  const int width =
      std::max(narrowest, static_cast<int>(std::lround(static_cast<double>(image.height) *
                                                       input.width / input.height)));
  if (width >= kEnoughPixels * image.width) return {{0, 0, image.width, image.height}};
  const double step = (1.0 - kMinOverlap) * width;
  const int steps = static_cast<int>(std::ceil((image.width - width) / step));
  std::vector<cv::Rect> tiles;
  for (int k = 0; k <= steps; ++k) {
    tiles.emplace_back((image.width - width) * k / steps, 0, width, image.height);
  }
  return tiles;
}

std::vector<NetworkBox> joinTiles(const std::vector<TileBoxes>& tiles, int image_width,
                                  double nms_iou) {
  std::vector<TileBox> kept;
  for (const TileBox& box : markCuts(tiles, image_width)) {
    bool known = false;
    for (TileBox& other : kept) {
      if (other.box.network_class != box.box.network_class) continue;
      if (other.isCut() && box.isCut() && areParts(other, box)) {
        join(box, other);
        known = true;
      } else {
        known = suppresses(other, box, nms_iou);
      }
      if (known) break;
    }
    if (!known) kept.push_back(box);
  }
  std::vector<NetworkBox> boxes;
  for (const TileBox& box : kept) boxes.push_back(box.box);
  return withoutOverlaps(std::move(boxes), nms_iou);
}

}  // namespace headway::detect
