// SPDX-License-Identifier: BSD-3-Clause
// What the rows and boxes of a detection network mean: decoding, classes, tiles, overlaps.
#pragma once

#include <headway/core/detection.h>
#include <headway/detect/network_detector.h>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::detect {

/// What one class of a network means to us.
struct NetworkClass {
  std::optional<ObjectClass> object_class;  ///< nullopt: nothing of ours
  bool bicycle = false;                     ///< without its rider
};

/// The classes of a network in its order.
///
/// @param names  "coco" for the 80 of the COCO data set, or names in KITTI's spelling separated by
///               commas; any other word among them stands for a class that is left out
[[nodiscard]] std::vector<NetworkClass> networkClasses(const std::string& names);

/// One box as a network gave it.
struct NetworkBox {
  Box2d box;  ///< [px] of the image
  double score = 0.0;
  std::size_t network_class = 0;
};

/// Makes detections of a network's boxes: classes translated, riders joined with their bicycles,
/// and of two classes of one vehicle the one of greater score.
///
/// @param boxes  best first
[[nodiscard]] std::vector<Detection> toDetections(const std::vector<NetworkBox>& boxes,
                                                  const std::vector<NetworkClass>& classes);

/// How an image was fitted into a network's input: input = image * (scale_x, scale_y).
struct InputFit {
  double scale_x = 1.0;
  double scale_y = 1.0;
};

/// Number of rows that a YOLOX network of this input has: the cells of strides 8, 16 and 32.
[[nodiscard]] int yoloxRows(int input_width_px, int input_height_px);

/// Boxes in a network's output with at least the score wanted, in image pixels.
///
/// A row is centre x, centre y, width, height, objectness, then one score a class.
/// YOLOX: centre = (value + cell) * stride, size = exp(value) * stride [px of the input].
/// Darknet: shares of the input; class scores hold the objectness already.
///
/// @param rows  32-bit float, one box a row, 5 + classes columns
/// @see  Ge et al. 2021 (YOLOX); Redmon & Farhadi 2018 (YOLOv3)
[[nodiscard]] std::vector<NetworkBox> decodeRows(const cv::Mat& rows, const NetworkParams& params,
                                                 const InputFit& fit);

/// Of boxes of one class that overlap more than `nms_iou`, keeps the best; best first.
[[nodiscard]] std::vector<NetworkBox> withoutOverlaps(std::vector<NetworkBox> boxes,
                                                      double nms_iou);

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
