// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/plots.h>

#include "cell_picture.h"

namespace headway::eval {
namespace {

const std::vector<Shade>& shades() {
  static const std::vector<Shade> kShades = {
      {"free, correct", {246, 246, 246}},
      {"occupied, correct", {40, 40, 40}},
      {"occupied, truly free", {60, 120, 255}},
      {"occupied, truly free, on a moving object's path", {200, 0, 200}},
      {"free, truly occupied", {220, 120, 20}},
      {"observed, truth unknown", {214, 204, 190}},
      {"not observed", {176, 176, 176}}};
  return kShades;
}

cv::Vec3b shadeOf(CellState truth, CellState estimate, bool swept) {
  if (estimate == CellState::kUnknown) return shades()[6].bgr;
  if (truth == CellState::kUnknown) return shades()[5].bgr;
  if (truth == estimate) return shades()[truth == CellState::kFree ? 0 : 1].bgr;
  if (truth == CellState::kOccupied) return shades()[4].bgr;
  return shades()[swept ? 3 : 2].bgr;
}

}  // namespace

cv::Mat gridPlot(const GridCells& truth, const GridCells& estimate,
                 const std::vector<std::uint8_t>& swept) {
  cv::Mat cells(truth.rows, truth.columns, CV_8UC3);
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * truth.columns + column);
      cells.at<cv::Vec3b>(truth.rows - 1 - row, column) =
          shadeOf(truth.states[i], estimate.states[i], swept[i] != 0);
    }
  }
  return cellPicture(cells, truth.resolution_m, shades());
}

}  // namespace headway::eval
