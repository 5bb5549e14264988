// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/detect/network_detector.h>

#include <opencv2/core/mat.hpp>
#include <vector>

#include "network_classes.h"

namespace headway::detect {

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

}  // namespace headway::detect
