// SPDX-License-Identifier: BSD-3-Clause
#include "network_output.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace headway::detect {
namespace {

constexpr std::array<int, 3> kStrides = {8, 16, 32};

struct GridCell {
  int column;
  int row;
  int stride;
};

std::vector<GridCell> yoloxCells(int width, int height) {
  std::vector<GridCell> cells;
  for (const int stride : kStrides) {
    for (int row = 0; row < height / stride; ++row) {
      for (int column = 0; column < width / stride; ++column) {
        cells.push_back({column, row, stride});
      }
    }
  }
  return cells;
}

// Centre and size in pixels of the network's input.
cv::Vec4d inputBox(const float* row, const NetworkParams& params, const GridCell* cell) {
  if (cell != nullptr) {
    const double stride = cell->stride;
    return {(static_cast<double>(row[0]) + cell->column) * stride,
            (static_cast<double>(row[1]) + cell->row) * stride,
            std::exp(static_cast<double>(row[2])) * stride,
            std::exp(static_cast<double>(row[3])) * stride};
  }
  return {row[0] * static_cast<double>(params.input_width_px),
          row[1] * static_cast<double>(params.input_height_px),
          row[2] * static_cast<double>(params.input_width_px),
          row[3] * static_cast<double>(params.input_height_px)};
}

}  // namespace

int yoloxRows(int input_width_px, int input_height_px) {
  int rows = 0;
  for (const int stride : kStrides) rows += (input_width_px / stride) * (input_height_px / stride);
  return rows;
}

std::vector<NetworkBox> decodeRows(const cv::Mat& rows, const NetworkParams& params,
                                   const InputFit& fit) {
  const bool yolox = params.family == NetworkParams::Family::kYolox;
  const auto cells =
      yolox ? yoloxCells(params.input_width_px, params.input_height_px) : std::vector<GridCell>{};
  std::vector<NetworkBox> boxes;
  for (int i = 0; i < rows.rows; ++i) {
    const float* row = rows.ptr<float>(i);
    const float* best = std::max_element(row + 5, row + rows.cols);
    const double score = yolox ? static_cast<double>(row[4]) * *best : *best;
    if (!(score >= params.min_score)) continue;
    const cv::Vec4d box = inputBox(row, params, yolox ? &cells[i] : nullptr);
    NetworkBox found;
    found.score = score;
    found.network_class = static_cast<std::size_t>(best - row - 5);
    found.box = {(box[0] - 0.5 * box[2]) / fit.scale_x, (box[1] - 0.5 * box[3]) / fit.scale_y,
                 (box[0] + 0.5 * box[2]) / fit.scale_x, (box[1] + 0.5 * box[3]) / fit.scale_y};
    boxes.push_back(found);
  }
  return boxes;
}

std::vector<NetworkBox> withoutOverlaps(std::vector<NetworkBox> boxes, double nms_iou) {
  std::sort(boxes.begin(), boxes.end(), [](const NetworkBox& a, const NetworkBox& b) {
    return std::make_tuple(-a.score, a.box.left, a.box.top) <
           std::make_tuple(-b.score, b.box.left, b.box.top);
  });
  std::vector<NetworkBox> kept;
  for (const auto& box : boxes) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const NetworkBox& other) {
      return other.network_class == box.network_class && overlap2d(other.box, box.box) > nms_iou;
    });
    if (!known) kept.push_back(box);
  }
  return kept;
}

}  // namespace headway::detect
