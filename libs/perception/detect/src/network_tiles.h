// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "network_classes.h"

namespace headway::detect {

/// Boxes that a network found in one tile, in pixels of the whole image.
struct TileBoxes {
  cv::Rect tile;
  std::vector<NetworkBox> boxes;
};

/// Cuts a wide image into overlapping tiles of the network input's proportions, from left to right.
///
/// Scaled to the input as a whole, a wide image would lose most of its pixels. Tiles are as high
/// as the image and overlap by at least a fifth of their width.
///
/// @return  the whole image alone if the input shows at least two thirds of the pixels per row
///          that a tile would show
[[nodiscard]] std::vector<cv::Rect> tilesOf(cv::Size image, cv::Size input);

/// Joins the boxes of overlapping tiles.
///
/// Boxes of one class that overlap more than `nms_iou` are one object (non-maximum suppression).
/// A box that ends at a tile's inner edge is a part of an object: it is suppressed by a box of
/// another tile that contains most of it, or is joined with the part beyond the edge; alone it
/// remains. Of two parts joined the greater score is kept.
///
/// @param image_width  of the whole image [px]
/// @return             best first
[[nodiscard]] std::vector<NetworkBox> joinTiles(const std::vector<TileBoxes>& tiles,
                                                int image_width, double nms_iou);

}  // namespace headway::detect
